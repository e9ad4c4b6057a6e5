"""The forest: it tells the two groups of maps apart and is the same forest every time."""

import pytest

pytest.importorskip("sklearn")

from agents.regression import ForestAgent
from antgym.tuning import tune


def test_the_forest_prefers_on_each_group_what_did_well_there(bowl, experience):
    agent = ForestAgent(experience)
    optima = {0.0: (0.3, 0.7, 0.6, 0.4), 1.0: (0.8, 0.2, 0.3, 0.6)}
    costs = {}
    for group, optimum in optima.items():
        session = bowl(0, optimum=optimum, features=(group, 0.1))
        agent.reset(session.task, seed=0)
        costs[group] = agent.recommend()
    for group, optimum in optima.items():
        session = bowl(0, optimum=optimum)
        own, other = costs[group], costs[1.0 - group]
        assert session.cost(own)[0] < session.cost(other)[0]


def test_the_same_experience_gives_the_same_forest(bowl, experience):
    found = [tune(ForestAgent(experience, trees=10), bowl(9), seed=0).trials for _ in range(2)]
    assert found[0] == found[1]
