"""OctoMap: .bt files, an octree of free and occupied cubes (octomap, OccupancyOcTreeBase.hxx).

After a text header, two bytes for every inner node, in order of depth first: two bits a child, 1 free, 2 occupied, 3
an inner node that follows, 0 unknown. Child i lies at x = bit 0, y = bit 1, z = bit 2 of i. A leaf at depth d is a cube
of 2^(16 - d) cells a side, cell k along an axis spans [k - 32768, k - 32767) times the resolution.

The stream is decoded without a loop over its nodes: how many inner children each has says where its subtree ends, ends
say depths, and depths say places. It is written likewise: the bits of a node's place, interleaved, are its place in the
order of depth first.
"""

import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antgym.errors import MapError
from antgym.maps.formats.files import content, real, require_cells
from antgym.maps.formats.movingai import require_square
from antgym.maps.map import Frame, Map
from antgym.maps.motion import Motion
from antgym.maps.world import GridWorld

DEPTH, CENTRE = 16, 1 << 15
MOST_BYTES = 10_000_000  # 5 million inner nodes
FREE, OCCUPIED, INNER = 1, 2, 3
_FIRST = b"# Octomap OcTree binary file"
_SHIFTS = np.arange(0, 16, 2, dtype=np.uint16)  # of a child's two bits
_CHILDREN = np.array([(i & 1, i >> 1 & 1, i >> 2) for i in range(8)], np.uint16)

Ints = NDArray[np.int64]
Box = tuple[Ints, Ints]


class Leaves(NamedTuple):
    """Leaves of one depth.

    Attributes:
        depth: from 1 to 16.
        corners: (n, 3) uint16, place of each among the cubes of this depth.
        kinds: (n,) FREE or OCCUPIED.
    """

    depth: int
    corners: NDArray[np.uint16]
    kinds: NDArray[np.uint8]


def read_octomap(path: Path, unknown: str = "blocked") -> Map:
    """Read a .bt file as the smallest box that holds all that is known, in metres.

    Args:
        path: the file.
        unknown: what a cell of the box is that the file says nothing of: ``"blocked"`` or ``"free"``.

    Raises:
        MapError: if the file is missing, is no such tree, or its box holds too many cells; it names line or byte.
    """
    if unknown not in ("blocked", "free"):
        raise MapError(f"{path}: unknown = {unknown!r}: must be 'blocked' or 'free'")
    resolution, words, begins = _parts(path)
    leaves = decode(words, f"{path}: byte {begins}")
    low, high = _bounds(leaves, path)
    require_cells((high - low).tolist(), str(path))
    kinds = _painted(leaves, low, high)
    free = kinds != OCCUPIED if unknown == "free" else kinds == FREE
    x, y, z = ((low - CENTRE) * resolution).tolist()
    world = GridWorld(free, (resolution, resolution, resolution))
    return Map(world, Motion("grid26"), Frame((x, y, z), 0.0, "m"), path.name, "OctoMap")


def _parts(path: Path) -> tuple[float, NDArray[np.uint16], int]:
    """Return the resolution, the words of the tree, and the byte at which they begin."""
    data = content(path, MOST_BYTES)
    if not data.startswith(_FIRST):
        raise MapError(f"{path}:1: {data[:40]!r}; a .bt file begins with {_FIRST.decode()!r}")
    header = re.search(rb"^data[ \t\r]*\n", data, re.MULTILINE)
    if header is None:
        raise MapError(f"{path}: the line 'data' that ends the header is missing")
    values = {}
    for number, line in enumerate(data[: header.start()].decode("utf-8", "replace").split("\n"), 1):
        words = line.split()
        if words and not words[0].startswith("#"):
            values[words[0]] = (" ".join(words[1:]), f"{path}:{number}: {words[0][:40]}")
    for key in ("id", "res"):
        if key not in values:
            raise MapError(f"{path}: the header lacks {key!r}; found {', '.join(values)[:80] or 'nothing'}")
    kind, place = values["id"]
    if kind != "OcTree":
        raise MapError(f"{place} {kind[:40]!r}: only trees of id OcTree are read")
    resolution = real(*values["res"])
    if not 1e-6 < resolution < 1e6:
        raise MapError(f"{values['res'][1]} = {resolution}: must be a positive number of metres")
    if (len(data) - header.end()) % 2:
        raise MapError(f"{path}: byte {len(data)}: the tree ends within a node of two bytes")
    return resolution, np.frombuffer(data, "<u2", offset=header.end()), header.end()


def decode(words: NDArray[np.uint16], place: str) -> list[Leaves]:
    """Return the leaves of a tree, by depth.

    Args:
        words: (n,) of its inner nodes, in order of depth first.
        place: of the first, for the message.

    Raises:
        MapError: if the words are too few or too many for one tree, or it is deeper than 16.
    """
    kinds = np.stack([(words >> 2 * child & 3).astype(np.uint8) for child in range(8)], axis=1)
    depths = _depths((kinds == INNER).sum(axis=1), place)
    if len(depths) and depths.max() >= DEPTH:
        at = int((depths >= DEPTH).argmax())
        raise MapError(f"{place} + {2 * at}: a node lies deeper than {DEPTH}")
    corners, level = np.zeros((1, 3), np.uint16), np.flatnonzero(depths == 0)
    found = []
    for depth in range(1, DEPTH + 1):
        here = kinds[level]
        for child, offset in enumerate(_CHILDREN):
            leaf = (here[:, child] == FREE) | (here[:, child] == OCCUPIED)
            if leaf.any():
                found.append(Leaves(depth, corners[leaf] * 2 + offset, here[leaf, child]))
        # depth first keeps the order of one depth: the inner children of its nodes, one after the other
        nodes, slots = np.nonzero(here == INNER)
        corners, level = corners[nodes] * 2 + _CHILDREN[slots], np.flatnonzero(depths == depth)
    return found


def _depths(children: Ints, place: str) -> Ints:
    """Return the depth of every node of a tree in order of depth first, by how many inner children each has."""
    count = len(children)
    open_ends = 1 + np.cumsum(children - 1)  # subtrees that are still to come after each node
    closed = np.flatnonzero(open_ends <= 0)
    if not len(closed):
        raise MapError(f"{place} + {2 * count}: the tree ends too soon, after {count:,} inner nodes")
    if closed[0] != count - 1:
        raise MapError(f"{place} + {2 * (int(closed[0]) + 1)}: the tree is complete, but the file goes on")
    # a subtree ends where fewer subtrees are to come than before it began: the next such place, by sorting
    keys = np.sort(open_ends * count + np.arange(count))
    before = np.concatenate([[1], open_ends[:-1]]) - 1
    ends = keys[np.searchsorted(keys, before * count + np.arange(count))] % count
    changes = np.zeros(count + 1, np.int64)
    changes[1:] += 1
    np.subtract.at(changes, ends + 1, 1)
    return np.cumsum(changes)[:count]


def _bounds(leaves: list[Leaves], path: Path) -> Box:
    if not leaves:
        raise MapError(f"{path}: nothing is known in this tree: no free and no occupied cell")
    lows = [level.corners.min(axis=0).astype(np.int64) << DEPTH - level.depth for level in leaves]
    highs = [level.corners.max(axis=0).astype(np.int64) + 1 << DEPTH - level.depth for level in leaves]
    return np.min(lows, axis=0), np.max(highs, axis=0)


def _painted(leaves: list[Leaves], low: Ints, high: Ints) -> NDArray[np.uint8]:
    """Return the kinds of the cells from low to high, from coarse to fine: each depth twice the one before."""
    kinds, first = np.zeros((1, 1, 1), np.uint8), np.zeros(3, np.int64)
    for depth in range(1, DEPTH + 1):
        size = DEPTH - depth
        begin, end = low >> size, (high - 1 >> size) + 1
        kinds = _twice(kinds, begin - 2 * first, end - begin)
        first = begin
        for level in leaves:
            if level.depth == depth:
                kinds[tuple((level.corners - first).T)] = level.kinds
    return kinds


def _twice(kinds: NDArray[np.uint8], begin: Ints, shape: Ints) -> NDArray[np.uint8]:
    """Return every cube as eight, cut to a shape from ``begin`` on."""
    for axis in range(3):
        places = (begin[axis] + np.arange(shape[axis])) // 2
        kinds = kinds.take(places, axis=axis)
    return kinds


def octomap_bytes(world: GridWorld, frame: Frame) -> bytes:
    """Return a world as the bytes of a .bt file, in metres: every cell is known, free or occupied.

    Raises:
        MapError: if its cells are no cubes, or do not lie where an octree has them: at multiples of their edge, not
            turned, within 32,768 of them from the origin; or if the tree is larger than what is read.
    """
    require_square(world, flat=False)
    low = _low(world, frame)
    words = encode(np.where(world.free, np.uint8(FREE), np.uint8(OCCUPIED)), low)
    header = f"id OcTree\nsize {1 + _known(words)}\nres {world.cell[0]!r}\ndata\n"
    data = _FIRST + b"\n" + header.encode() + words.tobytes()
    if len(data) > MOST_BYTES:
        raise MapError(
            f"{len(data):,} bytes of an octree, at most {MOST_BYTES:,} are read; take larger cells"
        )
    return data


def encode(kinds: NDArray[np.uint8], low: Ints) -> NDArray[np.uint16]:
    """Return the words of the tree over a box of cells, its inner nodes in order of depth first.

    Args:
        kinds: (nx, ny, nz) FREE, OCCUPIED, or 0 where nothing is known; eight that are alike become one.
        low: (3,) keys of the first cell.
    """
    words, places, first = [], [], low
    for depth in range(DEPTH - 1, -1, -1):
        eights = _eights(kinds, first % 2)
        first = first // 2
        alike = (eights == eights[..., :1]).all(axis=-1)
        kinds = np.where(alike, eights[..., 0], np.uint8(INNER))
        inner = np.nonzero(kinds == INNER)
        words.append((eights[inner].astype(np.uint16) << _SHIFTS).sum(axis=1, dtype=np.uint16))
        # a node has the place of its first child, and comes before it
        places.append(_interleaved(np.stack(inner, axis=1) + first) << 3 * (DEPTH - depth) + 5 | depth)
    return np.concatenate(words)[np.argsort(np.concatenate(places))].astype("<u2")


def _eights(kinds: NDArray[np.uint8], odd: Ints) -> NDArray[np.uint8]:
    """Return cubes by their eight children, (nx, ny, nz, 8); ``odd`` where the first cell is a second child."""
    ends = [(int(left), int(left + side) % 2) for left, side in zip(odd, kinds.shape, strict=True)]
    whole = np.pad(kinds, ends)
    x, y, z = (side // 2 for side in whole.shape)
    return whole.reshape(x, 2, y, 2, z, 2).transpose(0, 2, 4, 5, 3, 1).reshape(x, y, z, 8)


def _interleaved(corners: Ints) -> Ints:
    """Return (n,) places in the order of the tree of (n, 3) corners: bit b of x, y and z becomes 3b, 3b + 1, 3b + 2."""
    bits = corners[:, :, None] >> np.arange(DEPTH) & 1
    return np.asarray((bits << np.arange(DEPTH) * 3 + np.arange(3)[:, None]).sum(axis=(1, 2)))


def _known(words: NDArray[np.uint16]) -> int:
    """Return how many nodes the words are the parents of."""
    return sum(int(np.count_nonzero(words >> shift & 3)) for shift in _SHIFTS)


def _low(world: GridWorld, frame: Frame) -> Ints:
    """Return the keys of the first cell of a world."""
    edge, origin = world.cell[0], np.asarray(frame.origin)
    steps = np.round(origin / edge)
    if frame.yaw != 0 or np.abs(origin - steps * edge).max() > 1e-6 * edge:
        raise MapError(
            f"an octree has its cells at multiples of their edge {edge:g}, not turned; this map begins at "
            f"{frame.origin}, turned by {frame.yaw:g}: write its world alone, map.world"
        )
    if (steps < -CENTRE).any() or (steps + world.shape > CENTRE).any():
        raise MapError(f"an octree ends {CENTRE:,} cells from its origin; this map begins at {frame.origin}")
    return steps.astype(np.int64) + CENTRE
