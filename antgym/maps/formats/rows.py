"""Rows: the scenario files of 2D, MAPF and voxel benchmarks, .scen on flat maps and .3dscen on voxels.

A file names the map that lies beside it; every row has its ends and declares the length of the shortest path.
"""

from collections.abc import Iterator, Sequence
from functools import cached_property
from pathlib import Path
from typing import NamedTuple, overload

from antgym.errors import MapError, ScenarioError
from antgym.maps.formats.files import Line, is_file, lines, real, whole
from antgym.maps.formats.movingai import UNIT, Terrain, read_terrain, require_square
from antgym.maps.formats.voxels import read_voxels
from antgym.maps.motion import Motion
from antgym.maps.world import GridWorld, Scenario

MOST_ROWS = 500_000


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
    return Rows(path, map_path or _beside(path, name), found)


def _length(word: str, place: str) -> float:
    length = real(word, place)
    if length < 0:
        raise MapError(f"{place}: a length of {length} is negative")
    return length


def read_voxel_rows(path: Path, map_path: Path | None = None) -> Rows:
    """Read a .3dscen file; its map, or the same gzipped, lies beside it.

    Raises:
        MapError: if the file is missing or a row is not start, goal, length and ratio; it names the line.
    """
    rows = lines(path)
    name = _map_name(rows, path)
    found: list[Row] = []
    for at, line in rows:
        words = line.split()
        if not words:
            continue
        place = f"{path}:{at}"
        if len(words) != 8:
            raise MapError(f"{place}: {len(words)} fields; a .3dscen row is sx sy sz gx gy gz length ratio")
        if len(found) == MOST_ROWS:
            raise MapError(f"{place}: more than {MOST_ROWS:,} rows")
        x, y, z, to_x, to_y, to_z = (whole(word, place) for word in words[:6])
        found.append(Row((x, y, z), (to_x, to_y, to_z), real(words[6], place), None, None, at))
    if not found:
        raise MapError(f"{path}: no rows")
    named = _beside(path, name)
    packed = named.with_name(named.name + ".gz")
    return Rows(path, map_path or (packed if is_file(packed) else named), found)


def _map_name(rows: Iterator[Line], path: Path) -> str:
    at, version = next(rows, (1, ""))
    if version.split() not in (["version", "1"], ["version", "1.0"]):
        raise MapError(f"{path}:{at}: {version[:40]!r}; a .3dscen begins with: version 1")
    at, name = next(rows, (2, ""))
    if not name.strip():
        raise MapError(f"{path}:{at}: the name of the map is missing")
    return name.strip()


def _beside(path: Path, name: str) -> Path:
    """Return the map beside a scenario file: of the base name that it gives, or else of its own name."""
    named = path.with_name(Path(name.replace("\\", "/")).name or path.stem)
    return named if is_file(named) else path.with_name(path.stem)


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
        length = _in_cells(scenario, Motion("grid8"))
        ends = (*scenario.start[:2], *scenario.goal[:2])
        rows.append("\t".join(map(str, (int(length // 4), map_name, nx, ny, *ends, f"{length:.8f}"))))
    return ("\n".join(rows) + "\n").encode()


def voxel_scen_bytes(scenarios: Sequence[Scenario], map_name: str) -> bytes:
    """Return scenarios in one world as a .3dscen file, each with its exact optimum under 26 neighbours, in cells.

    Raises:
        ScenarioError: if no path leads from a start to its goal.
    """
    rows = ["version 1", map_name]
    for scenario in scenarios:
        length = _in_cells(scenario, Motion("grid26"))
        near, mid, far = sorted(abs(g - s) for s, g in zip(scenario.start, scenario.goal, strict=True))
        octile = near * 3**0.5 + (mid - near) * 2**0.5 + (far - mid)
        ends = " ".join(map(str, (*scenario.start, *scenario.goal)))
        rows.append(f"{ends} {length:.8f} {length / octile:.3f}")
    return ("\n".join(rows) + "\n").encode()


def _in_cells(scenario: Scenario, motion: Motion) -> float:
    """Return the exact shortest length under a motion where every cell has edge 1."""
    world = GridWorld(scenario.world.free, UNIT)
    return Scenario(world, scenario.start, scenario.goal, motion, scenario.name).optimum
