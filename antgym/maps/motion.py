"""Motion rules: which moves a planner may make, what each one crosses and what it costs.

The layered motion of liu2020: x advances one layer per move, y and z change by at most two cells, and the
goal must stay within reach (two cells a layer), so that a move that can no longer arrive is not a candidate.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

REACH = 2


class Motion(NamedTuple):
    """A motion rule.

    Attributes:
        name: ``"layered"``, the only one so far.
        check_segments: a move that skips a cell (|dy| or |dz| = 2) is legal only if the cells its straight
            segment crosses are free too. Off in ``liu2020-paper``, where only the end point is checked.
    """

    name: str = "layered"
    check_segments: bool = True


LAYERED = Motion()


class MoveTable(NamedTuple):
    """The moves of one motion rule, one row per move; all arrays are read-only.

    Attributes:
        steps: (k, 3) int64, cells moved along x, y, z.
        before: (k, 3) int64, the cell crossed before the layer boundary (zero where none is crossed).
        after: (k, 3) int64, the cell crossed behind it (equal to the step where none is crossed).
    """

    steps: NDArray[np.int64]
    before: NDArray[np.int64]
    after: NDArray[np.int64]


@lru_cache
def move_table(motion: Motion) -> MoveTable:
    """Return the moves of a motion rule.

    A segment from the centre of a cell to the centre of the cell (1, dy, dz) away passes, for |d| = 2, through
    the cells (0, ±1, ·) and (1, ±1, ·): half-way along x it has moved dy/2 and dz/2. Moves with |dy|, |dz| ≤ 1
    touch no third cell over a positive length.
    """
    reach = range(-REACH, REACH + 1)
    steps = np.array([(1, dy, dz) for dy in reach for dz in reach], dtype=np.int64)
    lateral, sign = steps[:, 1:], np.sign(steps[:, 1:])
    before, after = np.zeros_like(steps), steps.copy()
    if motion.check_segments:
        skips = (np.abs(lateral) == REACH).any(axis=1)
        before[skips, 1:] = np.where(np.abs(lateral) == REACH, sign, 0)[skips]
        after[skips, 1:] = sign[skips]
    for array in (steps, before, after):
        array.setflags(write=False)
    return MoveTable(steps, before, after)


def step_lengths(motion: Motion, cell: tuple[float, float, float]) -> NDArray[np.float64]:
    """Return the Euclidean length of every move in world units, (k,) float64."""
    x, y, z = (move_table(motion).steps * np.asarray(cell)).T
    return np.sqrt(x * x + y * y + z * z)
