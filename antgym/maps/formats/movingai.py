"""MovingAI: flat maps of letters, and the scenario files of 2D, MAPF and voxel benchmarks.

In these files x counts columns from the left and y rows from the top: cell (x, y) is letter x of row y. One may step
between cells of one class alone: ground ``.GSB``, water ``W``, trees ``T``, out of bounds ``@O`` (hog2, Map.cpp). A
robot starts on ground; a few rows of the benchmarks walk within another class.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import NamedTuple, overload

import numpy as np
from numpy.typing import NDArray

from antgym.errors import MapError, ScenarioError
from antgym.maps.formats.files import Line, is_file, lines, real, require_cells, whole
from antgym.maps.map import Frame, Map
from antgym.maps.motion import Motion
from antgym.maps.world import GridWorld, Scenario

CLASSES = (".GSB", "W", "T", "@O")
UNIT = (1.0, 1.0, 1.0)
MOST_ROWS = 500_000
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


class Row(NamedTuple):
    """A row of a scenario file.

    Attributes:
        start: (x, y) or (x, y, z), as the file has it.
        goal: likewise.
        length: the shortest, as the file declares it.
        bucket: ⌊length / 4⌋ in most files; None where the file has none.
        shape: (width, height) that the row expects of its map, None where the file does not say.
        line: where it is in the file, from 1.
    """

    start: tuple[int, ...]
    goal: tuple[int, ...]
    length: float
    bucket: int | None
    shape: tuple[int, ...] | None
    line: int


class Rows(Sequence[Row]):
    """The rows of a scenario file, as they are; one becomes a scenario, and is checked, when it is asked for.

    Attributes:
        source: the file.
        map_path: its map.
        rows: all of them; of a MAPF file, row i is agent i.
    """

    def __init__(self, path: Path, map_path: Path, rows: Sequence[Row]) -> None:
        self.source, self.map_path, self.rows = path, map_path, tuple(rows)

    def __len__(self) -> int:
        return len(self.rows)

    @overload
    def __getitem__(self, index: int) -> Row: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Row, ...]: ...
    def __getitem__(self, index: int | slice) -> Row | tuple[Row, ...]:
        return self.rows[index]

    @cached_property
    def terrain(self) -> Terrain | GridWorld:
        """The map, read when first asked for."""
        from antgym.maps.formats.voxels import read_voxels

        flat = self.source.suffix.lower() == ".scen"
        return read_terrain(self.map_path) if flat else read_voxels(self.map_path).world

    def world(self, index: int) -> GridWorld:
        """Return the world of a row: the cells of the class that it starts on.

        Raises:
            MapError: if the map cannot be read.
            ScenarioError: if the map is not of the row's size, or the start lies outside.
        """
        row, terrain = self.rows[index], self.terrain
        if isinstance(terrain, GridWorld):
            return terrain
        shape = terrain.letters.shape
        if row.shape not in (None, shape):
            raise ScenarioError(
                f"{self.source}:{row.line}: a map of {row.shape} cells is expected, {self.map_path} has {shape}"
            )
        if not all(i < n for i, n in zip(row.start, shape, strict=True)):
            raise ScenarioError(
                f"{self.source}:{row.line}: start {row.start} lies outside the map of {shape} cells"
            )
        return terrain.walkable(chr(terrain.letters[row.start]))

    def scenario(self, index: int, motion: Motion | None = None) -> Scenario:
        """Return a row as a scenario, by default under the motion of the benchmark.

        Raises:
            ScenarioError: if start and goal are equal, outside or of different classes; it names the line.
        """
        row, world = self.rows[index], self.world(index)
        moves = Motion("grid8" if len(row.start) == 2 else "grid26")
        name = f"{self.source.name}:{row.line}"
        try:
            return Scenario(world, row.start, row.goal, motion or moves, name)  # type: ignore[arg-type]
        except ScenarioError as error:
            raise ScenarioError(f"{self.source}:{row.line}: {error}") from None


def read_rows(path: Path, map_path: Path | None = None) -> Rows:
    """Read a .scen file; its map lies beside it under the name, without folders, that the file gives.

    Raises:
        MapError: if the file is missing, or a row is not 7 or 9 fields (bucket, map, width and height, start, goal,
            length); it names the line.
    """
    found: list[Row] = []
    name = ""
    for at, line in lines(path):
        words = line.split()
        if not words or (at == 1 and words[0] == "version"):
            continue
        place = f"{path}:{at}"
        if len(words) not in (7, 9):
            raise MapError(
                f"{place}: {len(words)} fields in a row; a .scen row is bucket, map, width, height, start x, y, "
                "goal x, y, length"
            )
        if len(found) == MOST_ROWS:
            raise MapError(f"{place}: more than {MOST_ROWS:,} rows")
        numbers = [whole(word, place) for word in words[2:-1]]
        shape = (numbers[0], numbers[1]) if len(words) == 9 else None
        start, goal = (numbers[-4], numbers[-3]), (numbers[-2], numbers[-1])
        found.append(Row(start, goal, _length(words[-1], place), whole(words[0], place), shape, at))
        if name and words[1] != name:
            raise MapError(f"{place}: a second map, {words[1][:60]!r}; the rows before are of {name!r}")
        name = words[1]
    if not found:
        raise MapError(f"{path}: no rows")
    return Rows(path, map_path or beside(path, name), found)


def beside(path: Path, name: str) -> Path:
    """Return the map beside a scenario file: of the base name that it gives, or else of its own name."""
    named = path.with_name(Path(name.replace("\\", "/")).name or path.stem)
    return named if is_file(named) else path.with_name(path.stem)


def _length(word: str, place: str) -> float:
    length = real(word, place)
    if length < 0:
        raise MapError(f"{place}: a length of {length} is negative")
    return length


def scen_bytes(scenarios: Sequence[Scenario], map_name: str) -> bytes:
    """Return scenarios on one flat map as a .scen file, each with its exact optimum under octile moves, in cells.

    Raises:
        MapError: if a world is not flat or its cells not square.
        ScenarioError: if no path leads from a start to its goal.
    """
    rows = ["version 1"]
    for scenario in scenarios:
        require_square(scenario.world, flat=True)
        nx, ny, _ = scenario.world.shape
        length = in_cells(scenario, Motion("grid8"))
        ends = (*scenario.start[:2], *scenario.goal[:2])
        rows.append("\t".join(map(str, (int(length // 4), map_name, nx, ny, *ends, f"{length:.8f}"))))
    return ("\n".join(rows) + "\n").encode()


def in_cells(scenario: Scenario, motion: Motion) -> float:
    """Return the exact shortest length under a motion where every cell has edge 1."""
    world = GridWorld(scenario.world.free, UNIT)
    return Scenario(world, scenario.start, scenario.goal, motion, scenario.name).optimum
