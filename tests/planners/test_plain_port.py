"""The kernel against the plain port of the equations: the same distribution, and wrong parameters would show."""

import numpy as np
import pytest

from antgym.maps.motion import move_table
from antgym.planners.colony import plan_many
from antgym.planners.rules import Rules
from experiments.ports import plain_colony

TRUE = (1.0, 3.0, 0.5, 300.0)
WRONG = {
    "no deposit": (1.0, 3.0, 0.5, 1e-9),
    "twice the deposit": (1.0, 3.0, 0.5, 600.0),
    "no evaporation": (1.0, 3.0, 1.0, 300.0),
    "more evaporation": (1.0, 3.0, 0.3, 300.0),
    "alpha": (1.2, 3.0, 0.5, 300.0),
    "beta": (1.0, 3.3, 0.5, 300.0),
}
ANTS, ITERATIONS, SEEDS = 10, 15, 10_000


def plain(valley):
    table = move_table(valley.motion)
    crossed = np.stack([table.before, table.after, table.steps])
    free = np.ascontiguousarray(valley.world.free)
    ends = (np.array(valley.start), np.array(valley.goal))
    run = lambda seed: plain_colony(free, crossed, *ends, 15.0, TRUE, ANTS, ITERATIONS, seed)[0]  # noqa: E731
    return np.array([run(seed) for seed in range(SEEDS)])


def ours(valley, parameters):
    rules, seeds = Rules(w1=1.0, w2=0.0, q0=0.0), range(SEEDS)
    effort = {"ants": ANTS, "iterations": ITERATIONS}
    return plan_many([valley] * SEEDS, [parameters] * SEEDS, rules=rules, **effort, seeds=seeds).lengths


@pytest.mark.slow
def test_lengths_follow_the_plain_port_and_would_not_under_wrong_parameters(valley):
    expected = plain(valley)

    def sigmas(lengths):
        return (lengths.mean() - expected.mean()) / np.sqrt((lengths.var() + expected.var()) / SEEDS)

    assert abs(sigmas(ours(valley, TRUE))) < 3
    missed = {name: sigmas(ours(valley, wrong)) for name, wrong in WRONG.items()}
    assert all(abs(z) > 4 for z in missed.values()), missed
