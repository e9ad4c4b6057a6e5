"""A stand-in for a session: a bowl in the unit cube instead of a planner, so that agents are tested alone."""

import numpy as np
import pytest

from antgym.planners.rules import PAPERS
from antgym.tuning import COST_CAP, Task, Trial
from antgym.tuning.features import TASK_FEATURES


class Bowl:
    """The face that agents and ``tune`` see of a session.

    Args:
        budget: trials, ≥ 0.
        optimum: where the cost is lowest, 1.1.
        noise: relative standard deviation of a trial's cost.
        fails: whether every trial fails.
        granted: trials at most in one batch, to send back fewer than asked.
        straight_line: what Q scales with.
        rules: whose parameters are chosen; the features show them.
        iterations: of a run.
        features: the first features of its task; all others but the rules are 0.
    """

    def __init__(
        self,
        budget,
        *,
        optimum=(0.3, 0.7, 0.6, 0.4),
        noise=0.0,
        fails=False,
        granted=None,
        straight_line=100.0,
        rules="liu2020",
        iterations=50,
        features=(),
    ):
        space = PAPERS[rules].ranges.space(straight_line)
        shown = np.array([feature.name == f"rules_{rules}" for feature in TASK_FEATURES], np.float32)
        shown[: len(features)] = features
        self.task = Task(space, shown, 20, iterations, budget)
        self.problem = self  # tune() asks a session's problem for the space
        self.space = space
        self.optimum, self.noise, self.fails = np.array(optimum), noise, fails
        self.granted = budget if granted is None else granted
        self.trials, self.batches = (), []
        self._rng = np.random.default_rng(12345)

    @property
    def left(self):
        return self.task.budget - len(self.trials)

    def evaluate(self, units):
        batch = self.space.check(units)[: min(self.left, self.granted)]
        assert self.left > 0
        self.batches.append(batch)
        costs = self.cost(batch) * np.maximum(0.2, 1 + self.noise * self._rng.standard_normal(len(batch)))
        first = len(self.trials)
        new = tuple(
            Trial(first + i, tuple(unit.tolist()), float(min(cost, COST_CAP)), 1)
            for i, (unit, cost) in enumerate(zip(batch, costs, strict=True))
        )
        self.trials += new
        return new

    def cost(self, units):
        """True costs of (k, d) settings."""
        bowl = 1.1 + ((np.atleast_2d(units) - self.optimum) ** 2).sum(axis=1)
        return np.full(len(bowl), COST_CAP) if self.fails else bowl


@pytest.fixture(scope="session")
def bowl():
    return Bowl


@pytest.fixture(scope="session")
def graph():
    """A graph of three sources whose maps have their optima near each other."""
    pytest.importorskip("agents")
    from agents.transfer import TransferGraph

    optima = [(0.3, 0.7, 0.6, 0.4), (0.4, 0.6, 0.5, 0.5), (0.8, 0.2, 0.3, 0.6)]
    sessions = [Bowl(200, optimum=optimum, noise=0.05) for optimum in optima]
    return TransferGraph.fit(sessions, search=16, repeats=4, seed=3)


@pytest.fixture(scope="session")
def experience():
    """Ten maps in two groups that a feature tells apart, each with an optimum of its own."""
    pytest.importorskip("agents")
    from agents.experience import Experience

    optima = {0.0: (0.3, 0.7, 0.6, 0.4), 1.0: (0.8, 0.2, 0.3, 0.6)}
    sessions = [Bowl(64, optimum=optima[i % 2], noise=0.02, features=(i % 2, i / 50)) for i in range(10)]
    units = np.random.default_rng(0).random((32, 4))
    described = [feature.name for feature in TASK_FEATURES]
    return Experience.gather(sessions, units, described=described)


@pytest.fixture(scope="session")
def ensemble(experience):
    """Two nets fitted to that experience; None without the extra rl, whose agent is then skipped."""
    pytest.importorskip("agents")
    from importlib.util import find_spec

    if not (find_spec("torch") and find_spec("safetensors")):
        return None
    from agents.ensemble import Ensemble

    return Ensemble.fit(experience, nets=2)
