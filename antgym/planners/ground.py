"""The ground of a batch: its worlds one behind the other, as the kernels read them."""

from collections.abc import Callable, Sequence
from itertools import accumulate
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antgym.kernels.layout import Ground
from antgym.maps.world import GridWorld

MOST_KEPT = 1 << 26  # bytes of each layout that outlive their batch


class _Layout(NamedTuple):
    """Worlds that lie one behind the other, by id, and where each begins."""

    worlds: dict[int, GridWorld]
    begins: dict[int, int]
    flat: NDArray[Any]


class Layouts:
    """Lays one array of every world out, and keeps the last layout: batches draw from the same worlds, step by step.

    Args:
        array_of: the array of a world; read-only, as layouts are: one type, one compilation.
        dtype: of it.
    """

    def __init__(self, array_of: Callable[[GridWorld], NDArray[Any]], dtype: type) -> None:
        self._array_of, self._dtype = array_of, dtype
        self._kept = self._laid_out({})

    def of(self, worlds: Sequence[GridWorld]) -> tuple[NDArray[Any], NDArray[np.int64]]:
        """Return a flat array that holds every world once, maybe among others, and where each of them begins."""
        layout, wanted = self._kept, {id(world): world for world in worlds}
        if len(wanted) == 1:  # is used where it lies, whatever its size
            layout = self._laid_out(wanted)
        elif not wanted.keys() <= layout.worlds.keys():
            layout = self._laid_out({**layout.worlds, **wanted})
            if layout.flat.nbytes > MOST_KEPT:
                layout = self._laid_out(wanted)
            if layout.flat.nbytes <= MOST_KEPT:
                self._kept = layout
        return layout.flat, np.array([layout.begins[id(world)] for world in worlds], dtype=np.int64)

    def _laid_out(self, worlds: dict[int, GridWorld]) -> _Layout:
        parts = [self._array_of(world).reshape(-1) for world in worlds.values()]
        flat = parts[0] if len(parts) == 1 else np.concatenate(parts or [np.empty(0, self._dtype)])
        flat.setflags(write=False)
        return _Layout(worlds, dict(zip(worlds, accumulate(map(len, parts), initial=0), strict=False)), flat)


_BITS = Layouts(lambda world: world.bits, np.uint8)
_CLEARANCE = Layouts(lambda world: world.clearance, np.float32)


def pack(worlds: Sequence[GridWorld], wary: NDArray[np.bool_], runs: Any) -> Ground:
    """Lay out the worlds of some runs, clearance where a run is wary of obstacles, and write where each begins."""
    bits, begins = _BITS.of(worlds)
    runs["origin"] = 8 * begins
    clearance, places = _CLEARANCE.of([worlds[i] for i in np.flatnonzero(wary).tolist()])
    runs["clear_shift"][wary] = places - runs["origin"][wary]
    return Ground(bits, clearance)
