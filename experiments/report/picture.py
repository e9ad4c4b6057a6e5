"""The 3D picture of a page: one scenario and its paths as plotly traces, written as plain dictionaries.

Colours and dashes are not set here: the page's script takes them from the agents' hues, so that they follow its theme.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from experiments.board import EXACT, Board, Picture

Points = NDArray[np.float64]
DECIMALS = 3
FLATTEST = 0.3  # height of the drawn box over its longer side; flatter worlds are stretched towards it
STEEPEST = 3.0  # factor by which heights are stretched at most: paths hide behind spikes
DIAGONAL = 2.0  # of the drawn box, in plotly's units: what the camera below has in view
CONTOURS = 12
AT_FIRST = 3  # paths of agents shown before the reader asks for more


def figure(board: Board, picture: Picture) -> dict[str, Any]:
    """Return what the script draws: the ground's trace, the paths' traces, the layout and the names in order."""
    names = drawn(board, picture)
    lines = [_line(picture, name, shown=name == EXACT or i <= AT_FIRST) for i, name in enumerate(names)]
    return {"ground": _ground(picture), "lines": lines, "layout": _layout(picture)}


def drawn(board: Board, picture: Picture) -> list[str]:
    """Return the names of the paths in the order of the legend: the exact optimum first, then by rank."""
    ranked = [EXACT, *(row.name for row in board.ranked if row.name != EXACT)]
    return [name for name in ranked if name in picture.paths]


def stretch(picture: Picture) -> float:
    """Return how much higher the picture draws heights than they are: 1, or up to ``STEEPEST`` for a flat ground."""
    width, depth, height = _extent(picture)
    if _heights(picture) is None:
        return 1.0
    return float(np.clip(FLATTEST * max(width, depth) / height, 1.0, STEEPEST))


def _extent(picture: Picture) -> Points:
    """Return the edges of the drawn box: air above both the ground and the paths is left out."""
    extent = np.array(picture.free.shape) * picture.cell
    heights = _heights(picture)
    if heights is not None:
        highest = max((np.nanmax(path[:, 2]) + 1 for path in picture.paths.values() if len(path)), default=1)
        extent[2] = max(float(heights.max()), highest * picture.cell[2])
    return extent


def _heights(picture: Picture) -> Points | None:
    """Return the heights of the ground, if need be as tops of blocked cells; None for caves and flat worlds."""
    if picture.heights is not None:
        return picture.heights
    if picture.free.shape[2] == 1 or (np.diff(picture.free.astype(np.int8), axis=2) < 0).any():
        return None
    tops: Points = (picture.free == 0).sum(axis=2) * picture.cell[2]
    return tops


def _layout(picture: Picture) -> dict[str, Any]:
    extent = _extent(picture)
    box = extent * [1, 1, stretch(picture)]
    aspect = DIAGONAL * box / np.linalg.norm(box)
    axes = {
        f"{axis}axis": {
            "title": {"text": title},
            "range": [-0.005 * edge, 1.005 * edge],  # a plateau at the very end would flicker
            "nticks": 5,
            "showbackground": False,
            "showspikes": False,
            "zeroline": False,
        }
        for axis, title, edge in zip("xyz", ("x", "y", "height"), extent.tolist(), strict=True)
    }
    axes["zaxis"]["visible"] = picture.free.shape[2] > 1
    flat = box[2] < FLATTEST / 2 * box[:2].max()  # seen from higher up, for its blocks would hide paths
    camera = {
        "eye": {"x": -0.3, "y": -0.55, "z": 1.9} if flat else {"x": -0.62, "y": -1.1, "z": 1.62},
        "center": {"x": 0, "y": 0, "z": -0.2},
        "projection": {"type": "perspective"},
    }
    ratio = dict(zip("xyz", aspect.round(DECIMALS).tolist(), strict=True))
    return {
        "scene": {
            **axes,
            "aspectmode": "manual",
            "aspectratio": ratio,
            "camera": camera,
            "dragmode": "turntable",
            "annotations": _ends(picture),
        },
        "margin": {"l": 0, "r": 0, "t": 0, "b": 0},
        "showlegend": False,
        "paper_bgcolor": "rgba(0,0,0,0)",
        "uirevision": "stay",
    }


def _ground(picture: Picture) -> dict[str, Any]:
    heights = _heights(picture)
    if heights is None:
        return _walls(picture.free, picture.cell)
    nx, ny = heights.shape
    dx, dy, _ = picture.cell
    return {
        "type": "surface",
        "x": _numbers((np.arange(nx) + 0.5) * dx),
        "y": _numbers((np.arange(ny) + 0.5) * dy),
        "z": _numbers(heights.T),  # plotly's rows run along y
        "showscale": False,
        "hoverinfo": "skip",
        "lighting": {"ambient": 0.75, "diffuse": 0.55, "roughness": 0.95, "specular": 0.02, "fresnel": 0.01},
        "contours": {"x": {"highlight": False}, "y": {"highlight": False}, "z": _contours(heights)},
    }


def _contours(heights: Points) -> dict[str, Any]:
    low, high = float(heights.min()), float(heights.max())
    step = max(high - low, 1e-9) / CONTOURS
    return {"show": True, "width": 1, "highlight": False, "start": low + step / 2, "end": high, "size": step}


def _walls(free: NDArray[np.uint8], cell: tuple[float, float, float]) -> dict[str, Any]:
    """Return the faces between free and blocked cells as a see-through mesh; the box itself stays open.

    A flat world gets solid blocks with lids instead: there is nothing to see through to.
    """
    flat = free.shape[2] == 1
    if flat:
        free = np.pad(free, ((0, 0), (0, 0), (0, 1)), constant_values=1)
    corners = np.concatenate([_faces(free, axis) for axis in range(3)]) * cell
    first = 4 * np.arange(len(corners) // 4)
    triangles = np.concatenate([first + np.array([[0], [1], [2]]), first + np.array([[0], [2], [3]])], axis=1)
    return {
        "type": "mesh3d",
        **dict(zip("xyz", map(_numbers, corners.T), strict=True)),
        **dict(zip("ijk", triangles.tolist(), strict=True)),
        "opacity": 1.0 if flat else 0.22,
        "flatshading": True,
        "hoverinfo": "skip",
    }


def _faces(free: NDArray[np.uint8], axis: int) -> Points:
    """Return the corners of the faces across an axis, four in a row each, in cells; shape (4 faces, 3)."""
    cells = np.argwhere(np.diff(free.astype(np.int8), axis=axis) != 0)
    square = np.insert([[0, 0], [1, 0], [1, 1], [0, 1]], axis, 1, axis=1)
    return (cells[:, None, :] + square).reshape(-1, 3).astype(np.float64)


def _line(picture: Picture, name: str, shown: bool) -> dict[str, Any]:
    return {
        "type": "scatter3d",
        "mode": "lines",
        **_centres(picture, picture.paths[name]),
        "visible": shown,
        "line": {},
        "hoverinfo": "none",
    }


def _ends(picture: Picture) -> list[dict[str, Any]]:
    """Return the labels of starts and goals; unlike traces, labels are never hidden behind a mountain."""
    path = next((path for path in picture.paths.values() if len(path)), None)
    if path is None:
        return []
    there = ~np.isnan(path[:, 0])  # between the robots of a fleet there is nothing
    before, after = np.append(False, there[:-1]), np.append(there[1:], False)
    starts, goals = (np.flatnonzero(there & ~beside).tolist() for beside in (before, after))
    labels = [*((i, "start", -1) for i in starts), *((i, "goal", 1) for i in goals)]
    return [
        {
            **dict(zip("xyz", _numbers((path[i] + 0.5) * picture.cell), strict=True)),
            "text": text,
            "ax": side * 24,
            "ay": -34,
            "arrowwidth": 1,
        }
        for i, text, side in labels
    ]


def _centres(picture: Picture, path: NDArray[np.int64]) -> dict[str, list[float]]:
    return dict(zip("xyz", map(_numbers, ((path + 0.5) * picture.cell).T), strict=True))


def _numbers(array: NDArray[np.floating[Any]]) -> list[Any]:
    """Return numbers as JSON has them: none where there is a gap."""
    rounded = array.round(DECIMALS).astype(object)
    rounded[np.isnan(array)] = None
    numbers: list[Any] = rounded.tolist()
    return numbers
