"""Draws: which problem an episode is about, a pure function of (root seed, episode index)."""

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from antgym.envs.scenarios import Items
from antgym.errors import ParameterError, is_count
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
        self._made: dict[int, TuningProblem] = {}

    def __reduce__(self) -> tuple[Any, ...]:
        return load_problems, (self._items, self._effort, self._least)

    def __len__(self) -> int:
        return len(self._items)

    @property
    def flat(self) -> bool:
        """Whether every world is one cell high."""
        return self._items.flat

    def draw(self, roots: Sequence[int], episodes: Sequence[int]) -> list[tuple[int, int]]:
        """Return for each episode of a root the index of a scenario and the problem's seed in [0, 2^63)."""
        words = child_states(roots, np.array(episodes)[:, None], 2)
        indices, seeds = words[:, 0] % len(self), words[:, 1] >> 1
        return list(zip(indices.tolist(), seeds.tolist(), strict=True))

    def at(self, index: int, seed: int) -> TuningProblem:
        """Return the problem of one scenario under a seed."""
        if index not in self._made:
            item = self._items[index]
            ants, iterations = self._effort or (item.ants, max(item.iterations, self._least))
            self._made[index] = TuningProblem(item.scenario, item.rules, ants, iterations)
        return self._made[index].seeded(seed)


@lru_cache(maxsize=32)
def load_problems(items: Items, effort: Effort | None, least_iterations: int) -> Problems:
    """Return the problems of items; the same object for the same arguments, so that none is made twice."""
    return Problems(items, effort, least_iterations)


def checked_effort(effort: Sequence[int], least_iterations: int) -> Effort:
    """Return (ants, iterations) as asked for; ParameterError where a run cannot have them."""
    if not isinstance(effort, Sequence) or len(effort) != 2 or not all(map(is_count, effort)):
        raise ParameterError(
            f"effort = {effort!r}: needs (ants, iterations), two whole numbers of at least 1"
        )
    if effort[1] < least_iterations:
        raise ParameterError(
            f"effort = {effort!r}: needs (ants, iterations) with at least {least_iterations} iterations, for a run "
            "is steered in blocks"
        )
    return int(effort[0]), int(effort[1])
