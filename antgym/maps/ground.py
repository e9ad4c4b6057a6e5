"""Ground: from heights to a map of the air above them."""

import math

import numpy as np

from antgym.errors import MapError
from antgym.maps.formats.elevation import HeightField, read_heights
from antgym.maps.formats.files import MOST_CELLS
from antgym.maps.map import Frame, Map
from antgym.maps.motion import LAYERED
from antgym.maps.shaping import fill_missing, voxelise

AIR = 2  # free levels above the summit by default, so that a path can cross it
MOST_LEVELS = 10_000  # by default: where there are more, units differ, or a height stands for a missing one


def over(field: HeightField, levels: int | None = None, rise: float = 0.0, fill: float | None = None) -> Map:
    """Return the map over a height field; its floor lies at a whole number of cells of the file's own zero.

    Cells are as wide as the field's spacing, and as high as the smaller of the two.

    Args:
        field: the heights; they and the spacing are in one unit.
        levels: cells along z; by default as many as the relief and some air above need.
        rise: clearance: how far the surface is raised.
        fill: height that stands in for missing ones; without it they are an error.

    Raises:
        MapError: if heights are missing and nothing fills them, or the box would be too large.
    """
    heights = field.heights if fill is None else fill_missing(field.heights, fill)
    if not np.isfinite(heights).all():
        missing = int((~np.isfinite(heights)).sum())
        raise MapError(
            f"{field.source}: {missing} heights are missing; give a stand-in: fill (--fill HEIGHT)"
        )
    edge, low, high = min(field.spacing), float(heights.min()), float(heights.max())
    clearance = rise if math.isfinite(rise) and rise > 0 else 0.0  # any other is refused below
    floor = low // edge * edge
    count = (high - floor + clearance) / edge + AIR if levels is None else float(levels)
    if not heights.size * count <= MOST_CELLS or (levels is None and count > MOST_LEVELS):
        raise MapError(
            f"{field.source}: {heights.size} columns of {count:.6g} cells are more than {MOST_CELLS:,} in all, or "
            f"{MOST_LEVELS:,} each; heights ({low:g} to {high:g}) and spacing ({edge:g}) must share a unit; thin the "
            "file, or cut the box (--levels)"
        )
    world = voxelise(heights - floor, math.ceil(count), (*field.spacing, edge), rise)
    return Map(world, LAYERED, Frame((0.0, 0.0, floor)), field.source, "elevation", heights)


def read_ground(
    path: str,
    levels: int | None = None,
    rise: float = 0.0,
    fill: float | None = None,
    relief: tuple[float, float] | None = None,
    pixel: float | None = None,
) -> Map:
    """Read an elevation file as a map.

    Args:
        path: see :func:`antgym.read_heights`.
        levels: see :func:`over`.
        rise: likewise.
        fill: likewise.
        relief: of a picture, the heights of black and white.
        pixel: distance between samples, in the unit of the heights, instead of the file's.

    Raises:
        MapError: as for :func:`antgym.read_heights` and :func:`over`.
    """
    field = read_heights(path)
    if relief is not None:
        low, high = relief
        if not (math.isfinite(low) and math.isfinite(high)):
            raise MapError(f"{path}: relief = {relief}: needs two heights, of black and of white")
        field = HeightField(low + field.heights * ((high - low) / 255), field.spacing, field.source)
    if pixel is not None:
        field = HeightField(field.heights, (pixel, pixel), field.source)
    return over(field, levels, rise, fill)
