"""The papers' rules: each reaches the optimum given effort, and without its own idea it is its simpler relative."""

import numpy as np
import pytest
from colonies import world_of
from conftest import random_grid, random_scenario

from antgym.maps.motion import Motion
from antgym.planners.colony import plan, plan_many
from antgym.planners.rules import PAPERS, Rules


def test_much_effort_finds_the_optimum(valley):
    found = plan(valley, (1, 5, 0.9, 100), rules=Rules(w1=1, w2=0, q0=0.0), ants=50, iterations=200)
    assert found.length == valley.optimum


EASY = {
    "liu2020-paper": (
        1.0,
        0.02,
        0.97,
        100.0,
    ),  # as printed it pulls to the start: only pheromone finds the goal
    "zhang_apf-original": (1.0, 1.0, 0.95, 1.0),
    "zhang2011": (1.0, 1.0, 0.97, 200.0),
    "zhang2011-basic": (1.0, 1.0, 0.97, 10.0),
    "wei2018": (1.0, 1.0, 0.97, 1.0),
    "wei2018-basic": (1.0, 1.0, 0.97, 1.0),
}


@pytest.mark.parametrize("name", PAPERS)
def test_every_rule_comes_within_a_hundredth_of_the_optimum_given_effort(valley, room, name):
    scenario, rules = world_of(name, valley, room), PAPERS[name]
    # a small Q locks nothing in
    parameters = EASY.get(name, (1.0, 4.0 / max(rules.w1 + rules.z2 + rules.z3, 1.0), 0.95, 10.0))
    found = plan(scenario, parameters, rules=name, ants=100, iterations=300)
    assert scenario.optimum <= found.length <= 1.01 * scenario.optimum


@pytest.mark.parametrize("name", PAPERS)
def test_no_rule_is_ever_shorter_than_the_optimum(name):
    if name.startswith(("zhang2011", "wei2018")):
        scenarios = [random_grid(seed, Motion("grid8"), 12, 0.2) for seed in range(130)]
    else:
        scenarios = [random_scenario(seed, size=8, blocked=0.35) for seed in range(100)]
    settings = {"rules": name, "ants": 5, "iterations": 8, "seeds": range(len(scenarios))}
    plans = plan_many(scenarios, [(1.0, 1.0, 0.9, 50.0)] * len(scenarios), **settings)
    solved = np.flatnonzero(np.isfinite(plans.lengths))
    assert len(solved) > 50
    assert all(plans.lengths[i] >= scenarios[i].optimum for i in solved)


@pytest.mark.parametrize("name", [name for name, rules in PAPERS.items() if rules.best_only or rules.limits])
def test_a_colony_that_rewards_the_best_learns_at_its_published_default(name, valley, room):
    """With a deposit below τ₀ the best path loses pheromone, and the colony unlearns it."""
    scenario, rules = world_of(name, valley, room), PAPERS[name]
    setting = rules.ranges.space(scenario.straight_line, rules.initial_pheromone).default
    plans = plan_many([scenario] * 20, [setting] * 20, rules=name, ants=10, iterations=150, seeds=range(20))
    means = np.array([plan.mean for plan in plans])
    assert means[:, -20:].mean() < 0.99 * means[:, :5].mean()


OFF = {
    "limits": False,
    "ranked": 0,
    "elite": 0.0,
    "local": 0.0,
    "best_only": False,
    "q0": 0.0,
    "clipped": False,
    "initial": "uniform",
    "deposit": "length",
    "selective": False,
}


@pytest.mark.parametrize(
    ("name", "basic", "changes"),
    [
        ("zhang2011", "zhang2011-basic", {"trap": "die"}),
        ("wei2018", "wei2018-basic", {}),
        ("zhang_apf", "zhang_apf-original", {"z2": 0.0, "z3": 0.0, "w1": 0.0, "ranked": 2, "local": 0.1}),
    ],
)
def test_a_paper_without_its_own_ideas_is_its_baseline(room, valley, name, basic, changes):
    scenario, settings = world_of(name, valley, room), {"ants": 8, "iterations": 25, "seed": 3}
    off = OFF if "apf" not in name else {}
    bare, plain, whole = (
        plan(scenario, (1, 2, 0.8, 40), rules=rules, **settings)
        for rules in (PAPERS[name]._replace(**{**off, **changes}), basic, name)
    )
    assert bare.mean.tolist() == plain.mean.tolist()
    assert whole.mean.tolist() != plain.mean.tolist()


@pytest.mark.parametrize(
    "changes",
    [
        {"elitist": {"elite": 0.0}},
        {"rank_based": {"elite": 0.0, "ranked": 0}},
        {"max_min": {"limits": False, "ranked": 0}},
        {"ant_colony_system": {"q0": 0.0, "local": 0.0, "best_only": False, "elite": 0.0, "ranked": 0}},
    ],
    ids=lambda changes: next(iter(changes)),
)
def test_a_rule_without_its_own_idea_is_the_ant_system(changes):
    (name, fields), scenario = next(iter(changes.items())), random_scenario(4, size=8, blocked=0.2)
    settings = {"ants": 8, "iterations": 25, "seed": 3}
    plain = plan(scenario, (1, 4, 0.8, 40), rules="ant_system", **settings)
    bare = plan(scenario, (1, 4, 0.8, 40), rules=PAPERS[name]._replace(**fields), **settings)
    whole = plan(scenario, (1, 4, 0.8, 40), rules=name, **settings)
    assert bare.mean.tolist() == plain.mean.tolist()
    assert whole.mean.tolist() != plain.mean.tolist()
