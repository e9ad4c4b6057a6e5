"""Pausing: runs that stand between two blocks, advanced together."""

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antgym.errors import ParameterError
from antgym.planners.threads import run_ranges


class Paused(Protocol):
    """A run between two blocks: a colony or a hive."""

    @property
    def left(self) -> int:
        """Iterations that can still be walked."""

    def check(self, parameters: ArrayLike) -> NDArray[np.float64]:
        """Return (k, 4) natural values; ParameterError where one cannot be used."""

    def _set(self, values: NDArray[np.float64]) -> None: ...
    def _walk(self, iterations: int) -> None: ...


def advance_together(runs: Sequence[Paused], parameters: ArrayLike, iterations: Sequence[int]) -> None:
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
