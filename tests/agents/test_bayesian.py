"""TPE is Optuna's: through our protocol it proposes what an Optuna study does."""

import numpy as np
import pytest

from agents.bayesian import TreeParzen, fit_batch, narrow_seed
from antgym.errors import ParameterError
from antgym.tuning import tune

optuna = pytest.importorskip("optuna")


def _own(session, trials, batch, seed):
    """Optuna's own ask and tell."""
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    study = optuna.create_study(sampler=optuna.samplers.TPESampler(seed=narrow_seed(seed)))
    space = {f"x{i}": optuna.distributions.FloatDistribution(0.0, 1.0) for i in range(4)}
    rows = []
    while len(rows) < trials:
        asked = [study.ask(space) for _ in range(batch)]
        units = np.array([list(trial.params.values()) for trial in asked])
        for trial, cost in zip(asked, session.cost(units), strict=True):
            study.tell(trial, cost)
        rows.extend(units.tolist())
    return rows


@pytest.mark.parametrize("batch", [1, 6])
def test_an_agent_proposes_what_a_study_proposes(batch, bowl):
    verbosity = optuna.logging.get_verbosity()
    session = bowl(30)
    tune(TreeParzen(batch=batch, rerun_share=0.0), session, seed=4)
    assert optuna.logging.get_verbosity() == verbosity
    try:
        assert np.concatenate(session.batches).tolist() == _own(session, 30, batch, seed=4)
    finally:
        optuna.logging.set_verbosity(verbosity)


def test_no_note_of_optuna_reaches_the_terminal(bowl, capfd):
    tune(TreeParzen(), bowl(12), seed=0)
    assert capfd.readouterr() == ("", "")


def test_seeds_of_any_size_are_taken(bowl):
    session = bowl(5)
    tune(TreeParzen(), session, seed=2**63)
    assert len(session.trials) == 5


@pytest.mark.parametrize(("trials", "batch"), [(1, 1), (16, 1), (80, 8), (5000, 10)])
def test_the_batch_fits_the_budget(trials, batch):
    assert fit_batch(trials) == batch


def test_an_empty_batch_is_refused():
    with pytest.raises(ParameterError, match="batch = 0"):
        TreeParzen(batch=0)
