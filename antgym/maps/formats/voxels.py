"""Voxels: the .3dmap files of the Warframe benchmark (hog2, VoxelGrid.cpp), gzipped or not.

``voxel X Y Z``, then a line ``x y z`` for every blocked voxel, counted from 0. Moves lead to the 26 neighbours, where
every cell of the box that they span is free.
"""

from itertools import islice
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from antgym.errors import MapError
from antgym.maps.formats.files import Line, lines, require_cells, whole
from antgym.maps.formats.movingai import UNIT, require_square
from antgym.maps.map import Frame, Map
from antgym.maps.motion import Motion
from antgym.maps.world import GridWorld

_CHUNK = 100_000  # lines that are parsed at a time


def read_voxels(path: Path) -> Map:
    """Read a .3dmap file, or .3dmap.gz.

    Raises:
        MapError: if the file is missing, promises too many cells, or a line is no voxel of the box; it names the line.
    """
    rows = lines(path)
    at, header = next(rows, (1, ""))
    words = header.split()
    if len(words) != 4 or words[0] != "voxel":
        raise MapError(f"{path}:{at}: {header[:40]!r}; a .3dmap begins with: voxel X Y Z")
    shape = tuple(whole(word, f"{path}:1", least=1) for word in words[1:])
    require_cells(shape, f"{path}:1")
    free = np.ones(shape, np.uint8)
    while chunk := list(islice(rows, _CHUNK)):
        voxels = _voxels([line for line in chunk if line[1].strip()], shape, path)
        free[tuple(voxels.T)] = 0
    return Map(GridWorld(free, UNIT), Motion("grid26"), Frame(unit="cells"), path.name, "voxel map")


def _voxels(chunk: list[Line], shape: tuple[int, ...], path: Path) -> NDArray[np.int64]:
    """Return (n, 3) voxels; where a whole chunk cannot be parsed at once, the line that is at fault is looked for."""
    if not chunk:
        return np.empty((0, 3), np.int64)
    try:
        voxels = np.loadtxt([line for _, line in chunk], dtype=np.int64, comments=None, ndmin=2)
    except (ValueError, OverflowError):
        voxels = np.empty((0, 0), np.int64)
    if voxels.shape == (len(chunk), 3) and voxels.min() >= 0 and (voxels < shape).all():
        return voxels
    return np.array([_voxel(line, shape, f"{path}:{at}") for at, line in chunk], np.int64)


def _voxel(line: str, shape: tuple[int, ...], place: str) -> list[int]:
    words = line.split()
    if len(words) != 3:
        raise MapError(f"{place}: {len(words)} numbers, a voxel is x y z")
    return [whole(word, place, most=side - 1) for word, side in zip(words, shape, strict=True)]


def voxel_bytes(world: GridWorld) -> bytes:
    """Return a world as the bytes of a .3dmap file; cells become cubes of edge 1.

    Raises:
        MapError: if its cells are no cubes.
    """
    require_square(world, flat=False)
    rows = [f"voxel {' '.join(map(str, world.shape))}"]
    rows += [f"{x} {y} {z}" for x, y, z in np.argwhere(world.free == 0).tolist()]
    return ("\n".join(rows) + "\n").encode()
