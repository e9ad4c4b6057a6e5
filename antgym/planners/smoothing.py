"""Smoothing: a planned path made shorter and rounder, without entering a blocked cell.

``shortcut`` keeps those of the path's cells that make the shortest polyline of all through some of them, every line
checked exactly. ``spline`` rounds the corners of that polyline: a cubic B-spline whose control points lie on its lines,
so that it leaves them near a corner alone, by as much as the cells around allow.
"""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antgym.errors import ParameterError, ScenarioError, nearest
from antgym.maps.sight import sees, shortest_chain
from antgym.maps.world import Cell, GridWorld, Scenario

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

METHODS = ("shortcut", "spline")
DEEPEST = 6  # halvings of a piece of the curve until each part's box must be free
FEWEST = 3  # halvings for the sake of the points returned
APART = 1e-9  # cells that a box is widened by, more than rounding can move a curve
BOX = 4096  # cells of a box that is worth looking at before it is halved

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SmoothPath:
    """A path that has been smoothed. It is no longer one of the motion's moves, and may be shorter than the optimum.

    Attributes:
        method: ``"shortcut"`` or ``"spline"``.
        points: (n, 3) float64 world units, from the centre of the first cell to that of the last; the lines between
            them enter no blocked cell.
        length: of these lines, in world units.
        before: the length of the path as it was planned.
        curve: the spline that the points of ``"spline"`` lie on, from 0 to 1; it enters no blocked cell either. None
            for ``"shortcut"``.
    """

    method: str
    points: Floats = field(repr=False)
    length: float
    before: float
    curve: "BSpline | None" = field(repr=False)


def smooth(path: ArrayLike, scenario: Scenario[Any, Any], method: str = "spline") -> SmoothPath:
    """Smooth a planned path under the scenario's own corner rule.

    Args:
        path: (n, 3) integer cells, n ≥ 2, as :attr:`Plan.path` has them.
        scenario: where it leads, a grid's.
        method: ``"shortcut"`` or ``"spline"``.

    Raises:
        ParameterError: if the method is unknown, the path is none of cells, or the scenario lies among discs.
        ScenarioError: if the path itself leaves the world, enters a blocked cell or cuts a corner that it must not, as
            one may that was planned with ``check_segments=False``.
    """
    if method not in METHODS:
        raise ParameterError(f"method {method!r} is unknown; {nearest(str(method), METHODS)}")
    world = scenario.world
    if not isinstance(world, GridWorld):
        raise ParameterError("only paths of cells are smoothed; among discs a path is a few lines already")
    cells = _checked_path(path, scenario)
    points, curve = world.centre(cells[shortest_chain(world, scenario.motion, cells)]), None
    if method == "spline":
        curve, points = _rounded(world, points)
    return SmoothPath(method, points, _length(points), _length(world.centre(cells)), curve)


def _checked_path(path: ArrayLike, scenario: Scenario) -> NDArray[np.int64]:
    """Return the cells of a path, none twice in a row."""
    cells, shape = np.asarray(path), np.asarray(scenario.world.shape)
    if cells.ndim != 2 or cells.shape[1] != 3 or cells.dtype.kind not in "iu":
        raise ParameterError(
            f"a path is an (n, 3) array of integer cells, got {cells.dtype} of shape {cells.shape}"
        )
    cells = cells.astype(np.int64)
    cells = cells[np.append(True, (np.diff(cells, axis=0) != 0).any(axis=1))[: len(cells)]]
    if len(cells) < 2:
        raise ParameterError(f"a path has at least two different cells, got {len(cells)}; was none found?")
    for i, cell in enumerate(cells):
        if not ((cell >= 0) & (cell < shape)).all() or not scenario.world.is_free(cell):
            raise ScenarioError(f"cell {i} of the path, {_named(cell)}, is blocked or outside the world")
        if i and not sees(scenario.world, scenario.motion, cells[i - 1], cell):
            raise ScenarioError(
                f"the path enters a blocked cell or cuts a corner between {_named(cells[i - 1])} and {_named(cell)}; "
                "plan it under the scenario's own motion, with check_segments"
            )
    return cells


def _named(cell: NDArray[np.int64]) -> Cell:
    x, y, z = cell.tolist()
    return x, y, z


def _rounded(world: GridWorld, corners: Floats) -> tuple["BSpline", Floats]:
    """Return a curve around the corners of a polyline, and points on it that lie as densely as it bends.

    Beside a corner lie two control points on either line, at once and twice a distance from it: at most a quarter of
    the shorter line, halved until the boxes around the curve are free. It ends where all of them lie in the corner's
    own cell.
    """
    lengths = np.linalg.norm(np.diff(corners, axis=0), axis=1)
    distances = np.minimum(lengths[:-1], lengths[1:]) / 4
    depths = np.full(len(distances), -1)
    bent = 1 + 5 * np.arange(len(distances))[:, None] + np.arange(2)  # all other pieces are straight
    while True:
        curve = _curve(corners, lengths, distances)
        bends = _pieces(curve)[bent]
        for i in np.flatnonzero(depths < 0):
            depths[i] = _depth(world, bends[i])
        if (depths >= 0).all():
            break
        distances[depths < 0] /= 2
    parts = [_halved(bend, max(FEWEST, depth)) for bend, depth in zip(bends, depths, strict=True)]
    ends = [np.concatenate([part[:, 0], part[-1:, 3]]) for part in parts]
    return curve, np.concatenate([corners[:1], *ends, corners[-1:]])


def _curve(corners: Floats, lengths: Floats, distances: Floats) -> "BSpline":
    """Return the clamped cubic B-spline over five control points a corner, or along the line where there is none."""
    from scipy.interpolate import BSpline

    controls = [corners[:1]]
    for i, distance in enumerate(distances):
        shares = distance * np.array([2, 1, 0, 1, 2]) / np.repeat(lengths[i : i + 2], (2, 3))
        towards = corners[[i, i, i, i + 2, i + 2]]
        controls.append(corners[i + 1] + shares[:, None] * (towards - corners[i + 1]))
    if not len(distances):
        controls.append(corners[0] + np.array([[1], [2]]) / 3 * (corners[1] - corners[0]))
    points = np.concatenate([*controls, corners[-1:]])
    knots = np.concatenate([np.zeros(3), np.linspace(0, 1, len(points) - 2), np.ones(3)])
    return BSpline(knots, points, 3)


def _pieces(curve: "BSpline") -> Floats:
    """Return the (m, 4, 3) Bézier points of the pieces of a curve, by its points and slopes at the knots."""
    knots = curve.t[3:-3]
    points, thirds = curve(knots), curve(knots, 1) * (knots[1] - knots[0]) / 3
    return np.stack([points[:-1], (points + thirds)[:-1], (points - thirds)[1:], points[1:]], axis=1)


def _depth(world: GridWorld, pieces: Floats) -> int:
    """Return after how many halvings each part of some pieces lies in a box of free cells, -1 where none will do.

    A part lies in the hull of its Bézier points, and so does the line between its ends.
    """
    for depth in range(DEEPEST + 1):
        if all(_is_free(world, part / np.asarray(world.cell)) for part in _halved(pieces, depth)):
            return depth
    return -1


def _halved(pieces: Floats, times: int) -> Floats:
    """Return (m · 2^times, 4, 3) Bézier points of the parts of (m, 4, 3) pieces, halved so often (de Casteljau)."""
    for _ in range(times):
        a, b, c, d = np.moveaxis(pieces, 1, 0)
        ab, bc, cd = (a + b) / 2, (b + c) / 2, (c + d) / 2
        abc, bcd = (ab + bc) / 2, (bc + cd) / 2
        middle = (abc + bcd) / 2
        both = np.stack([np.stack([a, ab, abc, middle], 1), np.stack([middle, bcd, cd, d], 1)], axis=1)
        pieces = both.reshape(-1, 4, 3)
    return pieces


def _is_free(world: GridWorld, points: Floats) -> bool:
    """Return whether all cells that the box around points, in cells, touches are free; False of too large a box."""
    low = np.floor(points.min(axis=0) - APART).astype(np.int64)
    high = np.floor(points.max(axis=0) + APART).astype(np.int64) + 1
    (x, y, z), (last_x, last_y, last_z) = low.tolist(), high.tolist()
    if (high - low).prod() > BOX:
        return False
    return bool(world.planes(x, last_x)[:, y:last_y, z:last_z].all())


def _length(points: Floats) -> float:
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
