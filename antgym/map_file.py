"""``antgym map``: what there is to say of a map file, and the map as other files."""

import textwrap
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from antgym import exports, map_pictures
from antgym.console import write_whole
from antgym.errors import MapError, ScenarioError
from antgym.maps.features import FEATURES
from antgym.maps.map import Map
from antgym.maps.pairs import components, drawn
from antgym.maps.world import Scenario
from antgym.plan_file import read_file, require_matplotlib

if TYPE_CHECKING:
    from antgym.commands import ShowFile

COLUMNS = 3  # of features


def map_file(command: "ShowFile") -> int:
    """Print what there is to say, write the files; return 0.

    Raises:
        AntgymError: if the file, an end or a place to write to cannot be used.
    """
    writers = [_writer(path) for path in command.out]
    map_ = read_file(command, command.file)
    scenario = _scenario(command, map_)
    print(report(map_, scenario))
    for write, path in zip(writers, command.out, strict=True):
        for written in write(path, map_, scenario):
            print(f"wrote      {written}")
    return 0


def _scenario(command: "ShowFile", map_: Map) -> Scenario | None:
    """Return the scenario that is asked for, or one that is drawn; None where no two places are joined."""
    if bool(command.start) != bool(command.goal):
        raise ScenarioError("start and goal come together: give both, or neither")
    if command.start:
        start, goal = (map_.end(getattr(command, name), name, command.unit) for name in ("start", "goal"))
        return map_.scenario(start, goal)
    return next(iter(drawn(map_, 1)), None)


def report(map_: Map, scenario: Scenario | None) -> str:
    """Return the lines that the terminal shows."""
    world, parts = map_.world, components(map_.world)
    largest = (
        f", the largest with {parts.sizes.max() / world.free_count:.1%} of them" if len(parts.sizes) else ""
    )
    ends = np.empty((0, 3), int) if scenario is None else np.array([scenario.start, scenario.goal])
    lines = [
        f"map        {map_.kind}, {map_.source}",
        f"size       {map_.extent}",
        f"cells      {' x '.join(f'{edge:g}' for edge in world.cell)} {map_.frame.unit}",
        f"free       {world.free_count:,} cells, {world.free_count / world.size:.1%}",
        f"parts      {len(parts.sizes):,}{largest}",
        *_question(map_, scenario),
        map_pictures.letters(map_, ends),
    ]
    return "\n".join(lines)


def _question(map_: Map, scenario: Scenario | None) -> list[str]:
    if scenario is None:
        return ["features   none: no two places that are joined were found"]
    points = [
        ", ".join(f"{part:.6g}" for part in point) for point in map_.points([scenario.start, scenario.goal])
    ]
    values = [
        f"{f.name} {value:.3g}" for f, value in zip(FEATURES, scenario.descriptors.tolist(), strict=True)
    ]
    rows = [values[i : i + COLUMNS] for i in range(0, len(values), COLUMNS)]
    return [
        f"ends       {scenario.start} at ({points[0]}), {scenario.goal} at ({points[1]})",
        f"optimum    {scenario.optimum:.6g} {map_.frame.unit} under {scenario.motion.name}, straight line "
        f"{scenario.straight_line:.6g}",
        "features",
        textwrap.indent("\n".join("".join(f"{value:26}" for value in row).rstrip() for row in rows), "  "),
    ]


def _writer(path: Path) -> Callable[[Path, Map, Scenario | None], tuple[Path, ...]]:
    """Return what writes such a file; told before the work, not after it."""
    suffix = path.suffix.lower()
    if suffix == ".png":
        require_matplotlib()
        return _write_picture
    if suffix in exports.SCENARIOS:
        return _write_scenario
    if suffix in exports.MAPS:
        return lambda path, map_, scenario: exports.write_map(path, map_)
    valid = (".png", *exports.MAPS, *exports.SCENARIOS)
    raise MapError(f"{path}: unknown kind of file {suffix!r}; valid: {', '.join(valid)}")


def _write_picture(path: Path, map_: Map, scenario: Scenario | None) -> tuple[Path, ...]:
    ends = np.empty((0, 3), int) if scenario is None else np.array([scenario.start, scenario.goal])
    write_whole(path, map_pictures.drawn(map_, f"{map_.source}: {map_.kind}", ends=ends))
    return (path,)


def _write_scenario(path: Path, map_: Map, scenario: Scenario | None) -> tuple[Path, ...]:
    if scenario is None:
        raise MapError(f"{path}: {map_.source} has no two places that are joined, and so no scenario")
    return (exports.write_scenarios(path, [scenario]),)
