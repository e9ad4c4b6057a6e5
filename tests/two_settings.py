"""Two scenarios that want different settings, and what random, the best single and the best own settings earn there.

In the open every greedy ant walks straight to the goal, and a curious one strays; in the cup every greedy ant walks
into a dead end, and dies there. Both are small enough for an oracle that tries a grid of settings, many runs each.
"""

from functools import cache
from itertools import product

import numpy as np
from scenarios import drawn

from antgym import SuiteItem, TuningProblem
from antgym.tuning.problem import TRIAL

OPEN = ["...S...", *["......."] * 11, "...G..."]
CUP = ["...S...", *["......."] * 2, *[".#...#."] * 4, ".#####.", *["......."] * 4, "...G..."]
ANTS, ITERATIONS = 5, 10
GRID = np.array(list(product(np.linspace(0, 1, 5), repeat=4)))
RUNS = 8  # of every setting of the grid


def items(iterations=ITERATIONS):
    """The two scenarios as an environment takes them."""
    worlds = {"open": OPEN, "cup": CUP}
    return [SuiteItem(name, drawn(lines, name=name), ANTS, iterations) for name, lines in worlds.items()]


def problems():
    return [TuningProblem(item.scenario, item.rules, item.ants, item.iterations, seed=7) for item in items()]


def rewards(problem, units, first=0):
    """The reward of each of some settings, each on a seed of its own, from the ``first`` on."""
    return -problem.gap(problem.run(np.asarray(units), TRIAL, first).lengths)


@cache
def oracle():
    """(2, 625) mean rewards of the grid, (2,) rewards of random settings, (2,) of the best, on other seeds."""
    means, chance, best = [], [], []
    for problem in problems():
        seen = rewards(problem, np.repeat(GRID, RUNS, axis=0)).reshape(-1, RUNS).mean(axis=1)
        means.append(seen)
        chance.append(rewards(problem, np.random.default_rng(0).random((4000, 4))).mean())
        best.append(-problem.gap(problem.fresh(GRID[seen.argmax()], 1000).lengths).mean())
    return np.array(means), np.array(chance), np.array(best)


def share(reached):
    """(r − r_random) / (r_best − r_random) of (2, ...) rewards: 0 is chance, 1 the oracle."""
    _, chance, best = oracle()
    return (np.asarray(reached).T - chance) / (best - chance)


def shares(policy, runs=200, first=0):
    """The share that a policy, features -> action, earns in the open and in the cup."""
    units = [np.clip((np.asarray(policy(p.task(1).features), float) + 1) / 2, 0, 1) for p in problems()]
    means = [rewards(p, [u] * runs, first).mean() for p, u in zip(problems(), units, strict=True)]
    return share(means)
