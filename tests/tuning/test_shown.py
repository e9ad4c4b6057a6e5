"""What regimes show is said once, as environments and cards of policies both need it."""

import gymnasium
import pytest

from antgym.envs.catalogue import CATALOGUE
from antgym.errors import ParameterError
from antgym.tuning import shown_in


@pytest.mark.parametrize("entry", CATALOGUE, ids=lambda entry: entry.id)
def test_what_an_environment_says_it_shows_is_what_it_shows(entry):
    env = gymnasium.make(entry.id).unwrapped
    shown = env.shown
    assert (shown.regime, shown.size) == (entry.regime, *env.observation_space.shape)
    assert len(shown.parameters) == env.action_space.shape[0]
    assert list(shown.features[: len(env.task_features)]) == [each.name for each in env.task_features]
    assert len(shown.features) == (shown.size if shown.window == 0 else len(env.task_features))


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (("Control", ("alpha", "beta")), r"parameters = \['alpha', 'beta'\]: what is chosen is alpha, beta"),
        (("Controls", ("alpha", "beta", "rho", "Q")), "unknown regime 'Controls'; did you mean 'Control'"),
        (("Trials", ("alpha", "beta", "rho", "Q")), "window = 0: trials that Trials shows; one at least"),
        (("Control", ("alpha", "beta", "rho", "Q"), 5), "window = 5: trials that Control shows; 0"),
    ],
)
def test_what_no_regime_shows_is_named(given, message):
    with pytest.raises(ParameterError, match=message):
        shown_in(*given)
