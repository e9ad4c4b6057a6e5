"""Motion rules: which moves a planner may make, which cells each one needs free, and what it costs.

``layered`` is the motion of liu2020: x advances one layer per move, y and z change by at most two cells, and the
goal must stay within reach (two cells a layer), so that a move that can no longer arrive is not a candidate.
``grid4`` and ``grid8`` are the neighbours of a flat world, ``grid26`` those of a voxel world. Among discs there are no
cells: ``straight`` leads along straight segments between any points, and has no table of moves.
"""

from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antgym.errors import ParameterError, nearest

REACH = 2
CORNERS = {
    "layered": ("both",),
    "grid4": ("both", "one", "cut"),
    "grid8": ("both", "one", "cut"),
    "grid26": ("both", "cut"),
}
"""Every motion from cell to cell and the corner rules it knows."""
_ALL = {**CORNERS, "straight": ("both",)}


@dataclass(frozen=True)
class Motion:
    """A motion rule.

    Attributes:
        name: ``"layered"``; ``"grid4"`` or ``"grid8"``, the four or eight neighbours in a world one cell high;
            ``"grid26"``, all neighbours of a voxel; ``"straight"``, among discs, along straight segments.
        check_segments: a layered move that skips a cell (|dy| or |dz| = 2) is legal only if the cells its
            straight segment crosses are free too. Off in ``liu2020-paper``, where only the end point is checked.
            No other motion can skip a cell.
        corners: what a diagonal move of a grid needs besides its end cell: ``"both"`` side cells free, as
            MovingAI has it (in 3D all cells of the box it spans), ``"one"`` of the two at least (2D only), or
            nothing, ``"cut"``.

    Raises:
        ParameterError: if the name or the corner rule is unknown, or an option does not belong to the motion.
    """

    name: str = "layered"
    check_segments: bool = True
    corners: str = "both"

    def __post_init__(self) -> None:
        if self.name not in _ALL:
            raise ParameterError(f"motion {self.name!r} is unknown; {nearest(self.name, list(_ALL))}")
        if self.corners not in _ALL[self.name]:
            hint = nearest(str(self.corners), _ALL[self.name])
            raise ParameterError(
                f"corners = {self.corners!r}: the {self.name} motion has no such rule; {hint}"
            )
        if not (self.layered or self.check_segments):
            raise ParameterError(f"check_segments = False: no move of the {self.name} motion skips a cell")

    @property
    def layered(self) -> bool:
        """Whether every move advances one layer along x."""
        return self.name == "layered"

    @property
    def key(self) -> tuple[str, bool | str]:
        """The name and the one option that counts; part of a scenario's digest."""
        return self.name, self.check_segments if self.layered else self.corners


LAYERED, STRAIGHT = Motion(), Motion("straight")
MOTIONS = (
    LAYERED,
    Motion(check_segments=False),
    *(Motion(name, corners=rule) for name in list(CORNERS)[1:] for rule in CORNERS[name]),
)
"""Every motion rule from cell to cell."""


class MoveTable(NamedTuple):
    """The moves of one motion rule, one row per move; all arrays are read-only.

    A move is legal if all its ``required`` cells and at least one of its ``either`` cells are free, relative to
    the cell it leaves; rows with fewer cells than others repeat their end.

    Attributes:
        steps: (k, 3) int64, cells moved along x, y, z.
        before: (k, 3) int64, the cell crossed before the layer boundary (zero where none is crossed).
        after: (k, 3) int64, the cell crossed behind it (equal to the step where none is crossed).
        required: (k, r, 3) int64, cells that must all be free.
        either: (k, 2, 3) int64, cells of which one must be free.
    """

    steps: NDArray[np.int64]
    before: NDArray[np.int64]
    after: NDArray[np.int64]
    required: NDArray[np.int64]
    either: NDArray[np.int64]


@lru_cache
def move_table(motion: Motion) -> MoveTable:
    """Return the moves of a motion rule.

    A segment from the centre of a cell to the centre of the cell (1, dy, dz) away passes, for |d| = 2, through
    the cells (0, ±1, ·) and (1, ±1, ·): half-way along x it has moved dy/2 and dz/2. Moves with |dy|, |dz| ≤ 1
    touch no third cell over a positive length.
    """
    table = _layered_moves(motion.check_segments) if motion.layered else _grid_moves(motion)
    for array in table:
        array.setflags(write=False)
    return table


def _layered_moves(check_segments: bool) -> MoveTable:
    reach = range(-REACH, REACH + 1)
    steps = np.array([(1, dy, dz) for dy in reach for dz in reach], dtype=np.int64)
    lateral, sign = steps[:, 1:], np.sign(steps[:, 1:])
    before, after = np.zeros_like(steps), steps.copy()
    if check_segments:
        skips = (np.abs(lateral) == REACH).any(axis=1)
        before[skips, 1:] = np.where(np.abs(lateral) == REACH, sign, 0)[skips]
        after[skips, 1:] = sign[skips]
    required = np.stack([before, after, steps], axis=1)
    return MoveTable(steps, before, after, required, np.stack([steps, steps], axis=1))


def _grid_moves(motion: Motion) -> MoveTable:
    steps = np.array(_neighbours(motion.name), dtype=np.int64)
    ends = np.stack([steps, steps], axis=1)
    required, either = ends[:, :1].copy(), ends.copy()
    if motion.corners == "both":
        boxes = [_box(step) for step in steps.tolist()]
        widest = max(map(len, boxes))
        required = np.array([box + box[-1:] * (widest - len(box)) for box in boxes], dtype=np.int64)
    elif motion.corners == "one":
        diagonal = (steps != 0).sum(axis=1) == 2
        either[diagonal, 0, 1] = either[diagonal, 1, 0] = 0
    return MoveTable(steps, np.zeros_like(steps), steps.copy(), required, either)


def _neighbours(name: str) -> list[tuple[int, ...]]:
    """Return the steps of a grid motion, straight ones first."""
    most, axes = {"grid4": (1, 2), "grid8": (2, 2), "grid26": (3, 3)}[name]
    around = (step for step in product((-1, 0, 1), repeat=3) if not any(step[axes:]))
    steps = [step for step in around if 0 < sum(map(abs, step)) <= most]
    return sorted(steps, key=lambda step: sum(map(abs, step)))


def _box(step: list[int]) -> list[tuple[int, ...]]:
    """Return the cells of the box that a step spans, the one it leaves excepted, its end last."""
    cells = product(*((0, d) if d else (0,) for d in step))
    return [cell for cell in cells if any(cell)]


def step_lengths(motion: Motion, cell: tuple[float, float, float]) -> NDArray[np.float64]:
    """Return the Euclidean length of every move in world units, (k,) float64."""
    x, y, z = (move_table(motion).steps * np.asarray(cell)).T
    return np.sqrt(x * x + y * y + z * z)
