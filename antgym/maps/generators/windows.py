"""Windows: scenarios cut from real terrain."""

from collections.abc import Sequence
from itertools import chain, product, zip_longest
from pathlib import Path

import numpy as np

from antgym.errors import MapError
from antgym.maps.formats.elevation import HeightField
from antgym.maps.generators.draws import has_path
from antgym.maps.generators.relief import Heights, over_surface
from antgym.maps.shaping import block_max, voxelise
from antgym.maps.world import Scenario

SAMPLES_PER_CELL = 4


def terrain_windows(
    field: HeightField, size: int = 21, rotations: Sequence[int] = (0,), count: int | None = None
) -> tuple[Scenario, ...]:
    """Cut scenarios from real terrain: square windows side by side, four samples a cell, none overlapping.

    A cell is a cube whose edge is four mean horizontal spacings, in the field's unit. The relief of a
    window is stretched until its lowest sample lies on the floor and its highest touches the ceiling: the
    vertical exaggeration is size · edge / relief. A column is as high as its highest sample. Start and goal
    lie on the surface of the first and the last layer, in the middle third of their columns: the pair of
    least summed height between which there is a path. Windows that are flat, hold missing samples or have
    no such pair are skipped.

    Args:
        field: the terrain.
        size: cells along x, y and z.
        rotations: degrees by which each window is turned before its x becomes the way to go: 0, 90, 180, 270,
            counter-clockwise seen from above.
        count: how many scenarios at most; all where None.

    Returns:
        Every window in its first possible rotation, then every one in its second, and so on, named
        ``source-r{row}c{column}-{rotation}`` with row counted along axis 0 of the heights.

    Raises:
        MapError: if the field is smaller than one window or a rotation is no multiple of 90 degrees.
    """
    samples = SAMPLES_PER_CELL * size
    rows, columns = (n // samples for n in field.heights.shape)
    if size < 2 or not rows * columns:
        raise MapError(
            f"{field.source}: {field.heights.shape} samples hold no window of {size} cells a side; "
            f"choose a size from 2 to {min(field.heights.shape) // SAMPLES_PER_CELL}"
        )
    if any(degrees % 90 for degrees in rotations):
        raise MapError(f"windows turn by multiples of 90 degrees, got {tuple(rotations)}")
    turned = []
    for i, j in product(range(rows), range(columns)):
        window = field.heights[i * samples :, j * samples :][:samples, :samples]
        name = f"{Path(field.source).stem}-r{i}c{j}"
        turned.append(_turned(window, rotations, size, SAMPLES_PER_CELL * sum(field.spacing) / 2, name))
    in_turn = chain.from_iterable(zip_longest(*turned))
    return tuple(scenario for scenario in in_turn if scenario is not None)[:count]


def _turned(window: Heights, rotations: Sequence[int], size: int, edge: float, name: str) -> list[Scenario]:
    low, relief = window.min(), np.ptp(window)
    if not 0 < relief < np.inf:  # flat, or not a number where a sample is missing
        return []
    scaled = block_max((window - low) * (size * edge / relief), (size, size))
    scenarios = [_lowest_way(np.rot90(scaled, d // 90), edge, f"{name}-{d}") for d in rotations]
    return [scenario for scenario in scenarios if scenario is not None]


def _lowest_way(heights: Heights, edge: float, name: str) -> Scenario | None:
    size = len(heights)
    world = voxelise(heights, size, (edge, edge, edge))
    middle = range(size // 3, size - size // 3)
    pairs = sorted(
        product(middle, middle), key=lambda pair: float(heights[0, pair[0]] + heights[-1, pair[1]])
    )
    scenarios = (over_surface(world, first, last, name) for first, last in pairs)
    return next((found for found in scenarios if found is not None and has_path(found)), None)
