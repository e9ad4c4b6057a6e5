"""Packing: cells as bits within blocked borders, as the kernels read them."""

import numpy as np
from numpy.typing import NDArray

from antgym.maps.motion import REACH

PAD = REACH  # blocked border cells on every side, so that no move needs a bounds check


def packed(free: NDArray[np.generic]) -> NDArray[np.uint8]:
    """Return the bits of (nx, ny, nz) cells within blocked borders, eight planes at a time: they end on a byte."""
    nx, ny, nz = (n + 2 * PAD for n in free.shape)
    planes, parts = np.zeros((8, ny, nz), dtype=np.uint8), []
    for first in range(0, nx, 8):
        planes[:] = 0
        low, high = max(first - PAD, 0), min(first - PAD + 8, nx - 2 * PAD)
        if low < high:
            at = low + PAD - first
            planes[at : at + high - low, PAD:-PAD, PAD:-PAD] = free[low:high]
        parts.append(np.packbits(planes[: nx - first].reshape(-1), bitorder="little"))
    bits = np.concatenate(parts)
    bits.setflags(write=False)
    return bits


def is_binary(free: NDArray[np.generic]) -> bool:
    """Whether cells hold nothing but 0 and 1."""
    if free.dtype == np.bool_ or free.dtype.kind == "u":  # no temporary arrays: worlds can be large
        return bool(free.max() <= 1)
    return bool(((free == 0) | (free == 1)).all())
