"""Shapes: scenes of circles, rectangles, boxes and spheres as JSON, cut into cells.

A scene has ``circles_x_y_r`` and ``rects_x_y_w_h`` within ``bounds_xmin_xmax_ymin_ymax``, or in space
``boxes_min_max`` and ``spheres`` (x, y, z, r) within ``bounds`` (least x, y, z, greatest x, y, z). A cell is blocked
where a shape reaches into it. Scenes of discs alone can also be planned as they are, by bees:
:func:`antgym.read_discs`. Where a flat scene gives no bounds, they are a box about its shapes and ends.
"""

import json
import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antgym.errors import MapError
from antgym.maps.formats.files import require_cells, text
from antgym.maps.map import Frame, Map
from antgym.maps.motion import Motion
from antgym.maps.world import GridWorld

MOST_BYTES = 10_000_000
MOST_WORK = 200_000_000  # cells, over all shapes, that may lie in one
CELLS = 200  # along the longest side, by default
FLAT, SOLID = "bounds_xmin_xmax_ymin_ymax", "bounds"
_NUMBERS = {"circles_x_y_r": 3, "rects_x_y_w_h": 4, "boxes_min_max": 6, "spheres": 4}
_NEARLY = 1e-9  # of a cell: what only touches a cell does not reach into it

Floats = NDArray[np.float64]


class _Shapes(NamedTuple):
    """Shapes of one kind: boxes about them, and centres and radii of those that are round."""

    low: Floats  # (n, k)
    high: Floats  # (n, k)
    centre: Floats  # (n, k)
    radius: Floats | None  # (n,)


def read_shapes(path: Path, cell: float | None = None) -> Map:
    """Read a scene as a grid.

    Args:
        path: the JSON file.
        cell: edge of a cell in the scene's unit; by default 200 cells lie along the longest side.

    Raises:
        MapError: if the file is missing, no JSON or no scene, or would be too many cells.
    """
    scene = _scene(path)
    found = {
        name: _shapes(name, _rows(scene[name], count, f"{path}: {name}"))
        for name, count in _NUMBERS.items()
        if name in scene
    }
    low, high = _bounds(scene, found, path)
    axes = len(low)
    edge = float((high - low).max()) / CELLS if cell is None else cell
    if not ((high > low).all() and math.isfinite(edge) and edge > 0):
        raise MapError(f"{path}: bounds {low} to {high}, cell = {cell}: must enclose an area, cut into cells")
    with np.errstate(over="ignore"):
        shape = [int(side) for side in np.minimum(np.ceil((high - low) / edge - _NEARLY), 1e12)]
    require_cells(shape, f"{path}: in cells of {edge:g}")
    blocked, looked_at = np.zeros(shape, bool), 0
    for name, shapes in found.items():
        if shapes.low.shape[1] != axes:
            raise MapError(f"{path}: {name} do not fit the bounds: one lies in the plane, the other in space")
        for i in range(len(shapes.low)):
            looked_at += _block(blocked, shapes, i, low, edge)
            if looked_at > MOST_WORK:
                raise MapError(f"{path}: {name}[{i}]: too many cells in large shapes; take larger cells")
    frame = Frame((float(low[0]), float(low[1]), 0.0 if axes == 2 else float(low[2])))
    motion = Motion("grid8" if axes == 2 else "grid26")
    return Map(GridWorld(~blocked, (edge, edge, edge)), motion, frame, path.name, "scene")


def _scene(path: Path) -> dict[str, Any]:
    try:
        scene = json.loads(text(path, MOST_BYTES))
    except json.JSONDecodeError as error:
        raise MapError(f"{path}:{error.lineno}: not JSON ({error.msg})") from None
    except MapError:
        raise
    except (RecursionError, ValueError) as error:  # nested too deep, or a number of too many digits
        raise MapError(f"{path}: not JSON ({error})") from None
    if not isinstance(scene, dict) or not {*_NUMBERS, FLAT, SOLID} & set(scene):
        raise MapError(f"{path}: a scene is a JSON object with {FLAT}, or {SOLID}, and {', '.join(_NUMBERS)}")
    for key in scene:
        if key.startswith(("circles", "rects", "boxes", "spheres", "polygons")) and key not in _NUMBERS:
            raise MapError(f"{path}: unknown shapes {key[:60]!r}; known: {', '.join(_NUMBERS)}")
    return scene


def _bounds(scene: dict[str, Any], found: dict[str, _Shapes], path: Path) -> tuple[Floats, Floats]:
    """Return the least and the greatest corner of a scene."""
    if FLAT in scene:
        (bounds,) = _rows([scene[FLAT]], 4, f"{path}: {FLAT}")
        return bounds[::2], bounds[1::2]
    if SOLID in scene:
        (bounds,) = _rows([scene[SOLID]], 6, f"{path}: {SOLID}")
        return bounds[:3], bounds[3:]
    flat = [shapes for shapes in found.values() if shapes.low.shape[1] == 2]
    ends = _rows([scene[end] for end in ("start", "goal") if end in scene], 2, f"{path}: start, goal")
    corners = np.concatenate([ends, *(part for shapes in flat for part in (shapes.low, shapes.high))])
    if len(flat) < len(found) or not len(corners):
        raise MapError(f"{path}: {SOLID} is missing: a scene in space needs it")
    margin = (corners.max(axis=0) - corners.min(axis=0)).max() / 20
    return corners.min(axis=0) - margin, corners.max(axis=0) + margin


def _rows(value: Any, count: int, place: str) -> Floats:
    """Return (n, count) numbers."""
    if not isinstance(value, list):
        raise MapError(f"{place}: {str(value)[:60]}: must be a list of {count} numbers each")
    for i, row in enumerate(value):
        fits = isinstance(row, list) and len(row) == count
        if not fits or not all(type(part) in (int, float) and abs(part) < 1e12 for part in row):
            raise MapError(f"{place}[{i}]: {str(row)[:60]}: must be {count} numbers")
    return np.array(value, dtype=np.float64).reshape(-1, count)


def _shapes(name: str, rows: Floats) -> _Shapes:
    if name in ("circles_x_y_r", "spheres"):
        centre, radius = rows[:, :-1], rows[:, -1]
        return _Shapes(centre - radius[:, None], centre + radius[:, None], centre, radius)
    half = rows.shape[1] // 2
    low, high = rows[:, :half], rows[:, half:]
    return _Shapes(low, low + high if name.startswith("rects") else high, low, None)


def _block(blocked: NDArray[np.bool_], shapes: _Shapes, i: int, origin: Floats, edge: float) -> int:
    """Block the cells that a shape reaches into, in place; return how many were looked at."""
    first = np.floor((shapes.low[i] - origin) / edge + _NEARLY).clip(0, blocked.shape).astype(int)
    last = np.ceil((shapes.high[i] - origin) / edge - _NEARLY).clip(first, blocked.shape).astype(int)
    box = tuple(slice(a, b) for a, b in zip(first, last, strict=True))
    if shapes.radius is None:
        blocked[box] = True
        return int(np.prod(last - first))
    squares: Any = 0.0  # of the distance from the centre to each cell, axis by axis
    for axis, (a, b) in enumerate(zip(first, last, strict=True)):
        at = origin[axis] + np.arange(a, b) * edge - shapes.centre[i, axis]
        gap = np.maximum(np.maximum(at, -at - edge), 0) ** 2
        squares = squares + gap.reshape([-1 if k == axis else 1 for k in range(len(first))])
    blocked[box] |= squares < shapes.radius[i] ** 2 * (1 - _NEARLY)
    return int(np.prod(last - first))
