"""Draws: which problem an episode is about, a pure function of (root seed, episode index)."""

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antgym.envs.infos import Columns
from antgym.errors import ParameterError, is_count
from antgym.maps.fleet import Fleet
from antgym.maps.suites import Items
from antgym.planners.batch import MOST_EFFORT
from antgym.planners.planning import are_bees
from antgym.planners.swarms import fewest, parameter_names
from antgym.tuning.features import task_table
from antgym.tuning.problem import TuningProblem
from antgym.tuning.seeding import child_states

Effort = tuple[int, int]  # ants, iterations


class Problems:
    """The problems that a split of a suite holds; made when first drawn, for whatever environment; see `load_problems`.

    Args:
        items: the split, or scenarios of one's own.
        effort: for every scenario instead of its own, or None.
        least_iterations: of a scenario's own effort.
    """

    def __init__(self, items: Items, effort: Effort | None, least_iterations: int) -> None:
        self._items, self._effort, self._least = items, effort, least_iterations
        count = len(items)
        self._made = np.full(count, None, object)
        self._features = np.empty((count, len(task_table(self.discs))), np.float32)
        self._told = [np.empty(count, kind) for kind in (object, np.int64, np.int64, object)]

    def __reduce__(self) -> tuple[Any, ...]:
        return load_problems, (self._items, self._effort, self._least)

    def __len__(self) -> int:
        return len(self._items)

    @property
    def flat(self) -> bool:
        """Whether every world is one cell high, or lies in the plane."""
        return self._items.flat

    @property
    def discs(self) -> bool:
        """Whether bees fly among discs; else, ants walk grids."""
        return are_bees(self._items.rules)

    @property
    def fleets(self) -> bool:
        """Whether fleets are planned; else, single robots."""
        return isinstance(self._items[0].scenario, Fleet)

    @property
    def names(self) -> tuple[str, ...]:
        """What is chosen: the parameters of every problem, in order."""
        return parameter_names(self._items.rules[0])

    def draw(
        self, roots: Sequence[int], episodes: Sequence[int] | NDArray[np.int64]
    ) -> tuple[NDArray[np.intp], NDArray[np.int64]]:
        """Return for each episode of a root the index of a scenario and the problem's seed in [0, 2^63)."""
        words = child_states(roots, np.asarray(episodes)[:, None], 2)
        return (words[:, 0] % len(self)).astype(np.intp), (words[:, 1] >> 1).astype(np.int64)

    def at(self, index: int, seed: int) -> TuningProblem:
        """Return the problem of one scenario under a seed."""
        return self.of(np.array([index]))[0].seeded(seed)

    def of(self, indices: NDArray[np.intp]) -> list[TuningProblem]:
        """Return the problems of scenarios, shared by all their episodes, seeds aside."""
        problems: list[TuningProblem] = self._made[indices].tolist()
        if None in problems:
            for index in indices.tolist():
                self._make(index)
            problems = self._made[indices].tolist()
        return problems

    def features(self, indices: NDArray[np.intp]) -> NDArray[np.float32]:
        """Return the features of tasks that were drawn, one below the other, in an array of its own."""
        return self._features[indices]

    def told(self, indices: NDArray[np.intp], seeds: NDArray[np.int64]) -> Columns:
        """Return what info tells of problems that were drawn, before anything is run."""
        names, ants, iterations, rules = (column[indices] for column in self._told)
        return {"scenario": names, "seed": seeds, "ants": ants, "iterations": iterations, "rules": rules}

    def _make(self, index: int) -> None:
        if self._made[index] is not None:
            return
        item = self._items[index]
        ants, iterations = self._effort or (item.ants, max(item.iterations, self._least))
        problem = TuningProblem(item.scenario, item.rules, ants, iterations)
        self._features[index] = problem.task(0).features
        told = problem.scenario.name, ants, iterations, problem.rules
        for column, value in zip(self._told, told, strict=True):
            column[index] = value
        self._made[index] = problem


@lru_cache(maxsize=32)
def load_problems(items: Items, effort: Effort | None, least_iterations: int) -> Problems:
    """Return the problems of items; the same object for the same arguments, so that none is made twice."""
    return Problems(items, effort, least_iterations)


def checked_effort(
    effort: Sequence[int] | NDArray[np.integer], items: Items, least_iterations: int
) -> Effort:
    """Return (ants, iterations) as asked for; ParameterError where a run of some items cannot have them."""
    pair = effort.tolist() if isinstance(effort, np.ndarray) else effort
    fits = isinstance(pair, Sequence) and len(pair) == 2 and all(map(is_count, pair))
    if not fits or max(pair) > MOST_EFFORT:
        raise ParameterError(
            f"effort = {effort!r}: needs (ants, iterations), two whole numbers from 1 to {MOST_EFFORT:,}"
        )
    if effort[1] < least_iterations:
        raise ParameterError(
            f"effort = {effort!r}: needs (ants, iterations) with at least {least_iterations} iterations, for a run "
            "is steered in blocks"
        )
    least = fewest(items.rules[0])
    if effort[0] < least:
        raise ParameterError(f"effort = {effort!r}: needs (bees, cycles) with at least {least} bees")
    return int(effort[0]), int(effort[1])
