"""Pictures of maps: as a PNG by matplotlib, with a path on it, and in letters for a terminal."""

import io
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antgym.errors import MissingExtraError
from antgym.maps.camera import coverage
from antgym.maps.map import Map

COLUMNS = 76  # of a terminal
SHADES = " .:-=+*%"
_NOWHERE = np.empty((0, 3), np.int64)
_START, _GOAL, _PATH = "green", "orange", "crimson"

Cells = NDArray[np.int64]


def drawn(
    map_: Map,
    title: str,
    path: Cells = _NOWHERE,
    ends: Cells = _NOWHERE,
    rise: float = 0.0,
    smoothed: NDArray[np.float64] | None = None,
) -> bytes:
    """Return a PNG: the map from above with a path and, where it has heights or levels, the path from the side.

    Args:
        map_: what is shown, as its cells lie: a turned map is not turned.
        title: above it.
        path: (n, 3) cells, none where there is no path.
        ends: (2, 3) cells, or none.
        rise: how far the ground of an elevation map was raised.
        smoothed: (n, 3) points of the smoothed path in cells, None without one.

    Raises:
        MissingExtraError: if matplotlib is not installed.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise MissingExtraError("matplotlib", "viz") from None
    flat = map_.world.shape[2] == 1
    across, along, _ = np.multiply(map_.world.shape, map_.world.cell).tolist()
    height = min(max(7 * along / across, 3.0), 9.0) + 0.8 + (0 if flat else 2.0)
    figure = Figure(figsize=(7, height), layout="constrained")
    above, side = (figure.subplots(), None) if flat else figure.subplots(2, 1, height_ratios=(3, 1)).tolist()
    points, marks = (_within(map_, cells) for cells in (path, ends))
    _draw_above(above, map_)
    _draw_way(above, points, marks, 1)
    if smoothed is not None:
        above.plot(*_within(map_, smoothed)[:, :2].T, color="black", lw=1, label="smoothed")
        above.legend(fontsize="small")
    above.set(xlabel=f"x ({map_.frame.unit})", ylabel=f"y ({map_.frame.unit})", aspect="equal")
    if side is not None:
        _draw_side(side, map_, path, rise)
        _draw_way(side, points, marks, 2)
        side.set(xlabel=f"x ({map_.frame.unit})", ylabel="z")
        side.legend(fontsize="small")
    figure.suptitle(title)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=100)
    return buffer.getvalue()


def _within(map_: Map, cells: NDArray[Any]) -> NDArray[np.float64]:
    """Return (n, 3) centres in the map's unit; in a turned map, from the corner of its cells."""
    return map_.points(cells) if map_.frame.yaw == 0 else map_.world.centre(cells)


def _draw_above(axes: Any, map_: Map) -> None:
    (x, y, _), (dx, dy, _), (nx, ny, _) = map_.frame.origin, map_.world.cell, map_.world.shape
    x, y = (x, y) if map_.frame.yaw == 0 else (0.0, 0.0)
    extent = (x, x + nx * dx, y, y + ny * dy)
    if map_.heights is not None:
        image = axes.imshow(map_.heights.T, origin="lower", extent=extent, cmap="terrain")
        axes.figure.colorbar(image, ax=axes, label="height")
    else:
        share = 1 - map_.world.free.mean(axis=2)
        axes.imshow(share.T, origin="lower", extent=extent, cmap="Greys", vmin=0, vmax=1.25)
    if map_.frame.down:
        axes.invert_yaxis()


def _draw_way(axes: Any, points: NDArray[np.float64], marks: NDArray[np.float64], axis: int) -> None:
    axes.plot(points[:, 0], points[:, axis], color=_PATH, lw=2, label="path")
    if len(marks):
        axes.scatter(marks[:, 0], marks[:, axis], color=(_START, _GOAL), zorder=3)


def _draw_side(axes: Any, map_: Map, path: Cells, rise: float) -> None:
    """Draw what lies under a path: the ground, or the highest blocked cell below."""
    floor, dz = map_.frame.origin[2], map_.world.cell[2]
    if map_.heights is not None:
        ground, label = map_.heights[tuple(path[:, :2].T)] + rise, "ground below the path, raised"
    else:
        columns = map_.world.free[tuple(path[:, :2].T)] == 0
        below = np.where(np.arange(columns.shape[1]) < path[:, 2:], columns, False)
        top = np.where(below.any(axis=1), below.shape[1] - below[:, ::-1].argmax(axis=1), 0)
        ground, label = floor + top * dz, "obstacles below the path"
    axes.fill_between(_within(map_, path)[:, 0], ground, floor, color="0.7", label=label)


def letters(map_: Map, ends: Cells = _NOWHERE) -> str:
    """Return the map from above in letters, at most ``COLUMNS`` wide: darker is more blocked, or higher.

    A letter is twice as high as it is wide. ``S`` and ``G`` are the ends. Margins where nothing is free are cut off.
    """
    columns, rows, _ = map_.world.free.nonzero()
    if not len(columns):
        return "(nothing is free)"
    (left, right), (bottom, top) = (
        (max(places.min() - 1, 0), places.max() + 2) for places in (columns, rows)
    )
    shade = _darkness(map_)[left:right, bottom:top]
    edge = max(1.0, max(shade.shape) / COLUMNS)
    shade = coverage(shade, edge)
    pairs = np.array([shade[:, j : j + 2].mean(axis=1) for j in range(0, shade.shape[1], 2)])
    drawn = np.array(list(SHADES))[np.minimum(pairs * len(SHADES), len(SHADES) - 1).astype(int)]
    for (i, j, _), letter in zip(ends.tolist(), "SG", strict=False):
        drawn[int((j - bottom) / edge) // 2, int((i - left) / edge)] = letter
    return "\n".join("".join(row) for row in (drawn if map_.frame.down else drawn[::-1]))


def _darkness(map_: Map) -> NDArray[np.float64]:
    if map_.heights is not None:
        low, span = map_.heights.min(), np.ptp(map_.heights)
        return np.asarray((map_.heights - low) / (span or 1.0))
    return np.asarray(1 - map_.world.free.mean(axis=2))
