"""Plans: what one planner run found, or many of them."""

from dataclasses import dataclass
from typing import Any, Protocol, overload

import numpy as np
from numpy.typing import NDArray

from antgym.errors import ParameterError


@dataclass(frozen=True, eq=False)
class Plan:
    """What one planner run found.

    Attributes:
        length: of the best path in world units; inf where no ant arrived, or where the bees' best path touches a disc.
        path: from start to goal: (n + 1, 3) int64 cells, n moves, (0, 3) where there is none; among discs
            (p + 2, 2) float64, p way-points between start and goal, whether it touches a disc or not.
        best: (iterations,) float64, the length of the best path so far.
        mean: (iterations,) float64, mean length over the ants that arrived, or the sources that are clear of discs,
            inf where there are none.
        arrived: (iterations,) int64, how many there are.
        moves: moves that all ants made, or paths that bees evaluated.
        walker: what walks, ``"ant"`` or ``"bee"``.
    """

    length: float
    path: NDArray[Any]
    best: NDArray[np.float64]
    mean: NDArray[np.float64]
    arrived: NDArray[np.int64]
    moves: int
    walker: str = "ant"

    @property
    def solved(self) -> bool:
        """Whether there is a path."""
        return bool(np.isfinite(self.length))

    @property
    def status(self) -> str:
        """``"solved"``, ``"no ant arrived"`` or ``"no bee arrived"``."""
        return "solved" if self.solved else f"no {self.walker} arrived"


class _Runs(Protocol):
    """Runs that are done, of ants or of bees."""

    @property
    def runs(self) -> Any: ...
    @property
    def lengths(self) -> NDArray[np.float64]: ...
    @property
    def made(self) -> NDArray[np.int64]: ...
    def plan(self, index: int) -> Plan:
        """Return what run ``index`` found."""


class Plans:
    """What many planner runs found: arrays over the runs, and each as a :class:`Plan` by index.

    Attributes:
        lengths: (B,) float64 in world units, inf where none arrived.
        moves: (B,) int64, moves that all ants of a run made, or paths that its bees evaluated.
        seeds: (B,) uint64, what each was planned with.
    """

    def __init__(self, batch: _Runs, first: int, last: int) -> None:
        self._batch, self._first = batch, first
        self.lengths = batch.lengths[first:last]
        self.moves = batch.made[first:last]
        self.seeds: NDArray[np.uint64] = batch.runs["key"][first:last]

    def __len__(self) -> int:
        return len(self.lengths)

    @overload
    def __getitem__(self, key: int) -> Plan: ...
    @overload
    def __getitem__(self, key: slice) -> "Plans": ...
    def __getitem__(self, key: int | slice) -> "Plan | Plans":
        if not isinstance(key, slice):
            return self.plan(key)
        first, last, step = key.indices(len(self))
        if step != 1:
            raise ParameterError(f"plans are sliced without a step, got {step}")
        return Plans(self._batch, self._first + first, self._first + max(first, last))

    def plan(self, index: int) -> Plan:
        """Return one run."""
        return self._batch.plan(self._first + range(len(self))[index])
