"""The bee kernel against a plain port of the equations: the same distribution, and wrong parameters would show."""

import numpy as np
import pytest
from discs import among

from antgym.planners.bee_rules import BEE_PAPERS
from antgym.planners.planning import plan_many
from experiments.ports import plain_hive

TRUE = {"limit": 12.0, "xi": 1.0, "pull": 0.0}
WRONG = {
    "narrower moves": {"xi": 0.6},
    "wider moves": {"xi": 1.6},
    "a pull towards the best": {"pull": 1.0},
    "sources abandoned sooner": {"limit": 8.0},
    "sources kept for good": {"limit": 1e9},
}
BEES, CYCLES, POINTS, SEEDS = 8, 150, 3, 10_000


def world():
    return among((3, 3.5, 1), (6, 5.5, 1.2), (7, 8, 0.8))


def plain():
    scenario = world()
    arguments = (np.array(scenario.world.grown), np.array(scenario.world.bounds))
    ends, effort = np.array([scenario.start, scenario.goal]), (BEES, CYCLES, POINTS, TRUE["limit"])
    return np.array([plain_hive(*arguments, ends, 0.0, effort, seed)[0] for seed in range(SEEDS)])


def ours(limit, xi, pull):
    """Costs of the best paths: half the length over the straight line, or, where none is clear, at least 5."""
    scenario = world()
    rules = BEE_PAPERS["abc_standard"]._replace(points=POINTS, pull=pull)
    setting, effort = (limit, xi, xi), {"ants": BEES, "iterations": CYCLES, "seeds": range(SEEDS)}
    lengths = plan_many([scenario] * SEEDS, [setting] * SEEDS, rules=rules, **effort).lengths
    return np.minimum(0.5 * lengths / scenario.straight_line, 5.0)


@pytest.mark.slow
def test_lengths_follow_the_plain_port_and_would_not_under_wrong_parameters():
    expected = np.minimum(plain(), 5.0)

    def sigmas(costs):
        return (costs.mean() - expected.mean()) / np.sqrt((costs.var() + expected.var()) / SEEDS)

    assert abs(sigmas(ours(**TRUE))) < 3
    missed = {name: sigmas(ours(**{**TRUE, **wrong})) for name, wrong in WRONG.items()}
    assert all(abs(z) > 4 for z in missed.values()), missed
