"""MovingAI: flat maps of letters, .map files; :mod:`antgym.maps.formats.rows` has the scenario files.

In both, x counts columns from the left and y rows from the top: cell (x, y) is letter x of row y. One may step
between cells of one class alone: ground ``.GSB``, water ``W``, trees ``T``, out of bounds ``@O`` (hog2, Map.cpp). A
robot starts on ground; a few rows of the benchmarks walk within another class.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from antgym.errors import MapError
from antgym.maps.formats.files import Line, lines, require_cells, whole
from antgym.maps.map import Frame, Map
from antgym.maps.motion import Motion
from antgym.maps.world import GridWorld

CLASSES = (".GSB", "W", "T", "@O")
UNIT = (1.0, 1.0, 1.0)
_LETTERS = "".join(CLASSES)
_KNOWN = {*_LETTERS, *_LETTERS.lower()}  # hog2 takes either
_CLASS_OF = np.full(256, len(CLASSES), np.uint8)  # by letter
for _i, _kind in enumerate(CLASSES):
    _CLASS_OF[list(_kind.encode())] = _i
_HEADER = "a MovingAI map begins with type octile, height H, width W, map"


@dataclass(frozen=True, eq=False)
class Terrain:
    """The letters of a map.

    Attributes:
        letters: (width, height) uint8, the code of the upper-case letter of cell (x, y).
        source: the file.
    """

    letters: NDArray[np.uint8]
    source: str

    def walkable(self, letter: str = ".") -> GridWorld:
        """Return the cells that can be walked from one with this letter: those of its class."""
        return self._worlds[next(i for i, kind in enumerate(CLASSES) if letter in kind)]

    @cached_property
    def _worlds(self) -> tuple[GridWorld, ...]:
        classes = _CLASS_OF[self.letters]
        return tuple(GridWorld(classes == i, UNIT) for i in range(len(CLASSES)))


def read_movingai(path: Path) -> Map:
    """Read a .map file as the ground that a robot walks on, in cells, under octile moves that cut no corner.

    Raises:
        MapError: if the file is missing or is no such map; it names the line.
    """
    terrain = read_terrain(path)
    return Map(terrain.walkable(), Motion("grid8"), Frame(unit="cells", down=True), path.name, "MovingAI map")


def read_terrain(path: Path) -> Terrain:
    """Read the letters of a .map file; MapError names the line of what is wrong with it."""
    rows = lines(path)
    width, height = _size(rows, path)
    letters = np.empty((height, width), np.uint8)
    at = 4
    for y in range(height):
        at, row = next(rows, (at, None))
        if row is None:
            raise MapError(f"{path}: the file ends after {y} of the {height} rows that its header promises")
        if len(row) != width:
            raise MapError(f"{path}:{at}: {len(row)} letters in a row, the header promises {width}")
        unknown = set(row) - _KNOWN
        if unknown:
            letter = min(unknown)
            raise MapError(
                f"{path}:{at}: unknown letter {letter!r} in column {row.index(letter)}; known: {_LETTERS}"
            )
        letters[y] = np.frombuffer(row.upper().encode(), np.uint8)
    _require_end(rows, path, f"more than the {height} rows that its header promises")
    return Terrain(letters.T, path.name)


def _size(rows: Iterator[Line], path: Path) -> tuple[int, int]:
    found: dict[str, int] = {}
    for expected in ("type", "height", "width", "map"):
        at, line = next(rows, (0, ""))
        words = line.split()
        if expected in ("type", "map"):
            if words != {"type": ["type", "octile"], "map": ["map"]}[expected]:
                raise MapError(f"{path}:{at}: {line[:40]!r}; {_HEADER}")
        elif len(words) != 2 or words[0] not in ("height", "width") or words[0] in found:
            raise MapError(f"{path}:{at}: {line[:40]!r}; {_HEADER}")
        else:
            found[words[0]] = whole(words[1], f"{path}:{at}: {words[0]}", least=1)
    require_cells((found["width"], found["height"]), f"{path}:3")
    return found["width"], found["height"]


def _require_end(rows: Iterator[Line], path: Path, problem: str) -> None:
    for at, line in rows:
        if line.strip():
            raise MapError(f"{path}:{at}: {problem}")


def map_bytes(world: GridWorld) -> bytes:
    """Return a flat world as the bytes of a .map file: ``.`` free, ``@`` blocked; cells become squares of edge 1.

    Raises:
        MapError: if the world is not flat, or its cells are not square.
    """
    require_square(world, flat=True)
    nx, ny, _ = world.shape
    rows = np.where(world.free[:, :, 0].T, np.uint8(ord(".")), np.uint8(ord("@")))
    return f"type octile\nheight {ny}\nwidth {nx}\nmap\n".encode() + b"".join(
        row.tobytes() + b"\n" for row in rows
    )


def require_square(world: GridWorld, flat: bool) -> None:
    """Raise MapError where a world is no map of squares, or of cubes where it is not to be flat."""
    x, y, z = world.cell
    if flat and world.shape[2] != 1:
        raise MapError(f"a flat map holds one level, this world has {world.shape} cells; write a .3dmap")
    if x != y or (not flat and x != z):
        raise MapError(f"the file has cells of equal edges, this world's are {world.cell}")
