"""Camera: from a picture of a floor, seen from above, to a map in metres (zhang2011, 2.2).

Pixels darker than a threshold are obstacles. The picture is cut into cells of edge δ from its lower left corner on, and
a cell is blocked where obstacles cover at least half of it; obstacles are then grown by the largest robot's radius
(``Map.grown``) and filled to convex ones (``obstacles.convex``). Where the print cuts int(X / δ) + 1 columns, so that
the last may hold nothing, here it is as many as the picture needs; the last counts by what the picture shows of it.
"""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from antgym.errors import MapError
from antgym.maps.formats.files import require_cells
from antgym.maps.formats.pictures import pixels
from antgym.maps.map import Frame, Map
from antgym.maps.motion import Motion
from antgym.maps.world import GridWorld

HALF = 0.5
_NEARLY = 1e-9

Floats = NDArray[np.float64]


def read_picture(
    path: str | Path,
    pixel: float | None = None,
    cell: float | None = None,
    threshold: float | None = None,
    negate: bool = False,
    crop: Sequence[int] | None = None,
) -> Map:
    """Read a picture as a flat map; x points right, y up, the origin is the lower left corner.

    Args:
        path: a picture file.
        pixel: metres that a pixel is wide; without it, coordinates are in pixels.
        cell: δ, the edge of a cell in the same unit, at least a pixel's; by default a pixel is a cell.
        threshold: grey level from 0 to 255 below which a pixel is an obstacle; by default Otsu's.
        negate: whether bright pixels are obstacles instead: those at the threshold or above.
        crop: (left, top, right, bottom) pixels that the floor lies between, right and bottom outside.

    Raises:
        MapError: if the picture cannot be read or an argument is out of its range.
        MissingExtraError: if Pillow is not installed.
    """
    path = Path(path)
    shown = pixels(path)
    grey = _over_white(shown.grey, shown.alpha) if shown.alpha is not None else shown.grey
    grey = grey if crop is None else _cropped(grey, crop, path)
    for name, value in (("pixel", pixel), ("cell", cell)):
        if value is not None and not (math.isfinite(value) and value > 0):
            raise MapError(f"{path}: {name} = {value}: must be a positive number")
    edge = (cell or pixel or 1.0) / (pixel or 1.0)
    if edge < 1:
        raise MapError(f"{path}: a cell of {cell} is smaller than a pixel of {pixel or 1}; take larger cells")
    level = otsu(grey) if threshold is None else threshold
    if not 0 <= level <= 256:
        raise MapError(f"{path}: threshold = {level}: must be a grey level from 0 (black) to 255 (white)")
    dark = (grey < level) != negate
    require_cells([math.ceil(side / edge) for side in dark.shape], str(path))
    free = coverage(dark[::-1].T, edge) < HALF - _NEARLY
    side = edge * (pixel or 1.0)
    frame = Frame(unit="pixels" if pixel is None else "m")
    return Map(GridWorld(free, (side, side, side)), Motion("grid8"), frame, path.name, "picture")


def otsu(grey: NDArray[np.floating]) -> float:
    """Return the level that parts grey levels into two classes of the greatest variance between them (Otsu 1979).

    A level belongs to the bright class from the returned one on; of several that are as good, the middle is taken.

    Args:
        grey: any number of levels from 0 to 255.
    """
    counts = np.bincount(np.floor(grey).astype(np.int64).ravel(), minlength=256).astype(np.float64)
    below, moments = np.cumsum(counts)[:-1], np.cumsum(counts * np.arange(256))
    above = counts.sum() - below
    with np.errstate(divide="ignore", invalid="ignore"):
        apart = below * above * (moments[:-1] / below - (moments[-1] - moments[:-1]) / above) ** 2
    apart = np.nan_to_num(apart)
    best = np.flatnonzero(apart >= apart.max() * (1 - _NEARLY))
    return float(best[0] + best[-1]) / 2 + 1


def coverage(dark: NDArray[np.generic], edge: float) -> Floats:
    """Return the covered share of every cell, by exact area.

    Args:
        dark: (w, h) pixels, true where covered, or the share of each that is.
        edge: of a cell in pixels, 1 or more, whole or not.

    Returns:
        (⌈w / edge⌉, ⌈h / edge⌉) in [0, 1]; of cells that reach beyond the picture, the share of the part within.
    """
    sums = np.asarray(dark, dtype=np.float64)
    for axis in (0, 1):
        sums = _mean_between(np.moveaxis(sums, axis, 0), edge)
        sums = np.moveaxis(sums, 0, axis)
    return sums


def _mean_between(rows: Floats, edge: float) -> Floats:
    """Return the mean of rows over [0, edge), [edge, 2 · edge), ..., the last cut off where rows end."""
    count = len(rows)
    borders = np.minimum(np.arange(math.ceil(count / edge - _NEARLY) + 1) * edge, count)
    whole = np.minimum(borders.astype(int), count - 1)
    sums = np.zeros((count + 1, rows.shape[1]))
    np.cumsum(rows, axis=0, out=sums[1:])
    upto = sums[whole] + (borders - whole)[:, None] * rows[whole]
    return np.asarray(np.diff(upto, axis=0) / np.diff(borders)[:, None])


def _cropped(grey: NDArray[np.float32], crop: Sequence[int], path: Path) -> NDArray[np.float32]:
    height, width = grey.shape
    left, top, right, bottom = crop
    if not (0 <= left < right <= width and 0 <= top < bottom <= height):
        raise MapError(
            f"{path}: crop = {tuple(crop)}: must be left, top, right, bottom within {width} x {height} pixels"
        )
    return grey[top:bottom, left:right]


def _over_white(grey: NDArray[np.float32], alpha: NDArray[np.uint8]) -> NDArray[np.float32]:
    return (255 + (grey - 255) * (alpha / np.float32(255))).astype(np.float32)
