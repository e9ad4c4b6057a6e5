"""Regression by trees and by nets: both tell the two groups of maps apart, and are the same every time."""

import sys
from dataclasses import replace

import numpy as np
import pytest

import agents
from agents.regression import EnsembleAgent, ForestAgent
from antgym.errors import MissingExtraError, ParameterError
from antgym.tuning import tune

OPTIMA = {0.0: (0.3, 0.7, 0.6, 0.4), 1.0: (0.8, 0.2, 0.3, 0.6)}  # of the experience's two groups


@pytest.fixture(params=["trees", "nets"])
def make(request, experience, ensemble):
    """A function that makes an agent of either kind, and takes its arguments."""
    pytest.importorskip({"trees": "sklearn", "nets": "torch"}[request.param])
    if request.param == "trees":
        return lambda **given: ForestAgent(experience, **given)
    if ensemble is None:
        pytest.skip("needs the extra rl")
    return lambda **given: EnsembleAgent(ensemble, **given)


def test_the_agent_prefers_on_each_group_what_did_well_there(make, bowl):
    agent, found = make(), {}
    for group, optimum in OPTIMA.items():
        agent.reset(bowl(0, optimum=optimum, features=(group, 0.1)).task, seed=0)
        found[group] = agent.recommend()
    for group, optimum in OPTIMA.items():
        session = bowl(0, optimum=optimum)
        assert session.cost(found[group])[0] < session.cost(found[1.0 - group])[0]


def test_trials_correct_what_the_features_say(make, bowl):
    """A map that looks like one group and is like the other: a few runs of good settings of either tell."""
    costs = []
    for budget in (0, 40):
        session = bowl(budget, optimum=OPTIMA[1.0], features=(0.0, 0.1))
        costs.append(
            session.cost(tune(make(), session, seed=0).recommendation if budget else _zero(make, session))[0]
        )
    assert costs[1] < costs[0]


def _zero(make, session):
    agent = make()
    agent.reset(session.task, seed=0)
    return agent.recommend()


def test_the_same_experience_gives_the_same_forest(bowl, experience):
    pytest.importorskip("sklearn")
    found = [tune(ForestAgent(experience, trees=10), bowl(9), seed=0).trials for _ in range(2)]
    assert found[0] == found[1]


def test_where_features_tell_nothing_every_tree_says_the_mean_of_all_maps(bowl, experience):
    pytest.importorskip("sklearn")
    blind = replace(experience, features=experience.features[:1] * len(experience.names))
    agent, means = ForestAgent(blind, trees=3), experience.regrets.mean(axis=0)
    advice = agent._advise(bowl(9).task)
    assert advice.candidates[1:].tolist() == experience.settings[np.argsort(means, kind="stable")].tolist()
    np.testing.assert_allclose(advice.expected[1:], np.sort(means))


def test_a_scale_must_be_positive(make):
    with pytest.raises(ParameterError, match="tau = 0: must be positive"):
        make(tau=0)


@pytest.mark.parametrize("library", ["torch", "safetensors"])
def test_nets_without_their_libraries_say_how_to_mend_it(ensemble, tmp_path, monkeypatch, library):
    if ensemble is None:
        pytest.skip("needs the extra rl")
    ensemble.save(tmp_path / "nets")
    monkeypatch.setitem(sys.modules, {"torch": "torch"}.get(library, "safetensors.torch"), None)
    with pytest.raises(MissingExtraError, match=rf"{library} is not .*antgym\[rl\]"):
        agents.make("neural_regression", ensemble=tmp_path / "nets.json")
