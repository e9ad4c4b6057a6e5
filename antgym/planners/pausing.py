"""Pausing: runs that stand between two blocks, advanced together."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antgym.errors import ParameterError
from antgym.planners.threads import run_ranges

Parameters = TypeVar("Parameters")
Buffers = TypeVar("Buffers")


class Paused(ABC, Generic[Parameters, Buffers]):
    """A run between two blocks: what a colony and a hive have in common.

    It is pickled as what was asked of it, and walks again.
    """

    _idle: str  # said of a run before its first block
    _released: str  # and of one whose buffers are gone
    _scenario: Any
    _asked: dict[str, Any]
    _iterations: int

    def _begin(self, buffers: Buffers) -> None:
        self._blocks: list[tuple[Parameters, int]] = []
        self._done, self._first = 0, np.inf
        self._kept: Buffers | None = buffers

    def __reduce__(self) -> tuple[Any, ...]:
        return _walked_again, (type(self), self._scenario, self._asked, self._blocks)

    @property
    def _buffers(self) -> Buffers:
        if self._kept is None:
            raise ParameterError(f"{self._released}; nothing more can be asked of it")
        return self._kept

    @property
    def parameters(self) -> Parameters:
        """Those of the last block; ParameterError before any."""
        if not self._blocks:
            raise ParameterError(f"{self._idle}; advance() it")
        return self._blocks[-1][0]

    @property
    def done(self) -> int:
        """Iterations walked, or cycles flown, so far."""
        return self._done

    @property
    def left(self) -> int:
        """Iterations that can still be walked, or cycles flown."""
        return self._iterations - self._done

    @abstractmethod
    def check(self, parameters: ArrayLike) -> NDArray[np.float64]:
        """Return (k, 4) natural values; ParameterError where one cannot be used."""

    def advance(self, parameters: ArrayLike, iterations: int) -> None:
        """Walk some more iterations under natural values; ParameterError if more are asked for than are left."""
        advance_together([self], parameters, [iterations])

    def release(self) -> Buffers:
        """Give the buffers away to another run of its kind; nothing more can be asked of this one."""
        buffers = self._buffers
        self._kept = None
        return buffers

    @abstractmethod
    def _set(self, values: NDArray[np.float64]) -> None:
        """Write the parameters of the next block, (1, 4)."""

    @abstractmethod
    def _walk(self, iterations: int) -> None:
        """Walk the next block."""


def _walked_again(kind: Any, scenario: Any, asked: dict[str, Any], blocks: list[tuple[Any, int]]) -> Any:
    """Return the run that a pickled one was."""
    run = kind(scenario, **asked)
    for parameters, iterations in blocks:
        run.advance(parameters, iterations)
    return run


def advance_together(
    runs: Sequence[Paused[Any, Any]], parameters: ArrayLike, iterations: Sequence[int]
) -> None:
    """Walk a block of several runs on ANTGYM_THREADS threads; each as its own ``advance`` would.

    Args:
        runs: n different ones, all of ants or all of bees.
        parameters: (n, 4) natural values.
        iterations: n numbers, none larger than what its run has left.

    Raises:
        ParameterError: if one of them cannot be walked; then none is.
    """
    different = len({id(run) for run in runs})
    values = runs[0].check(parameters) if len(runs) else np.empty((0, 4))
    if not different == len(values) == len(iterations):
        raise ParameterError(
            f"{len(values)} parameter sets and {len(iterations)} numbers of iterations for {different} different runs"
        )
    for run, count in zip(runs, iterations, strict=True):
        if not 1 <= count <= run.left:
            raise ParameterError(
                f"iterations = {count}: this {type(run).__name__.lower()} has {run.left} left"
            )
    for i, run in enumerate(runs):
        run._set(values[i : i + 1])

    def walk(first: int, last: int) -> None:
        with np.errstate(over="ignore"):  # interpreted, random numbers and hashes wrap around
            for i in range(first, last):
                runs[i]._walk(iterations[i])

    if len(runs):
        run_ranges(walk, len(runs))
