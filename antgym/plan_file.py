"""``antgym plan``: from an elevation file to a path, a report on the terminal, and files."""

import importlib.util
import io
import json
import math
import time
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antgym.console import write_whole
from antgym.errors import MapError, MissingExtraError, ParameterError, ScenarioError
from antgym.maps.motion import LAYERED, Motion
from antgym.maps.readers import HeightField, read_heights
from antgym.maps.shaping import fill_missing, voxelise
from antgym.maps.world import Cell, GridWorld, Scenario
from antgym.planners.colony import Plan, plan
from antgym.planners.parameters import BEE_LIMITS, LIMITS, ColonyParameters
from antgym.planners.rules import find_rules

if TYPE_CHECKING:
    from antgym.cli import MapFile, PlanFile

AIR = 2  # free levels above the summit by default, so that a path can cross it
MAX_CELLS = 512**3


class Terrain(NamedTuple):
    """A world over an elevation file, and the height of its floor in the file's unit."""

    world: GridWorld
    heights: NDArray[np.float64]
    floor: float

    def coordinates(self, cells: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return the centres of (n, 3) cells: x, y from the file's corner, z its elevation, in its unit."""
        return self.world.centre(cells) + np.array([0.0, 0.0, self.floor])


@dataclass(frozen=True, eq=False)
class Found:
    """What one command found: the setting, the plan, and the wall seconds that planning took."""

    command: "PlanFile"
    terrain: Terrain
    scenario: Scenario
    setting: ColonyParameters
    plan: Plan
    seconds: float

    @property
    def gap(self) -> float | None:
        """(L − L*) / L*; None where no ant arrived."""
        return self.plan.length / self.scenario.optimum - 1 if self.plan.solved else None


def plan_file(command: "PlanFile") -> int:
    """Plan, print, write; return 0, or 1 where no ant arrived.

    Raises:
        AntgymError: if the file, an end, a parameter or the place to write to cannot be used.
    """
    if command.out is not None and command.picture:
        require_matplotlib()
    found = find(command)
    print(report(found))
    if command.out is not None:
        write(found, command.out)
    return 0 if found.plan.solved else 1


def require_matplotlib() -> None:
    """Raise MissingExtraError where matplotlib is not installed: told before the work, not after it."""
    if importlib.util.find_spec("matplotlib") is None:
        raise MissingExtraError("matplotlib", "viz")


def require_left_out(command: "PlanFile", options: Iterable[str], reason: str) -> None:
    """Raise ParameterError where one of these options was given, which would have no effect."""
    for field in fields(command):
        if field.name in options and getattr(command, field.name) != field.default:
            raise ParameterError(f"--{field.name.replace('_', '-')} has no effect here: {reason}")


def write(found: Found, stem: Path, more: Mapping[str, Any] | None = None) -> None:
    """Write the files of what was found, each whole or not at all, and say so; ``more`` joins the JSON."""
    for path, data in files(found, stem, more).items():
        write_whole(path, data)
        print(f"wrote    {path}")


def read(command: "MapFile") -> tuple[Terrain, Scenario]:
    """Read the file and return the terrain, and the scenario that the command's ends, motion and rules make of it."""
    rules = find_rules(command.rules)
    terrain = build(read_heights(command.file), command.levels, command.rise, command.fill)
    start, goal = (_end(terrain.world, name, getattr(command, name)) for name in ("start", "goal"))
    checks = command.motion != LAYERED.name or rules.check_segments
    motion = Motion(command.motion, check_segments=checks)
    scenario = Scenario(terrain.world, start, goal, motion, name=command.file.name)
    _ = scenario.optimum  # where no path exists, no ant need try
    return terrain, scenario


def find(command: "PlanFile") -> Found:
    """Read the file and plan."""
    require_left_out(command, BEE_LIMITS, f"rules {command.rules!r} are of ants")
    terrain, scenario = read(command)
    rules = find_rules(command.rules)
    default = rules.ranges.space(scenario.straight_line, rules.initial_pheromone).default.tolist()
    given = [getattr(command, name) for name in LIMITS]
    setting = ColonyParameters(*(d if g is None else g for g, d in zip(given, default, strict=True)))
    effort = {"ants": command.ants, "iterations": command.iterations, "seed": command.seed}
    plan(
        scenario, setting, rules=rules, ants=1, iterations=1
    )  # loads the kernels, or compiles them the first time
    begun = time.perf_counter()
    done = plan(scenario, setting, rules=rules, **effort)
    return Found(command, terrain, scenario, setting, done, time.perf_counter() - begun)


def build(field: HeightField, levels: int | None, rise: float, fill: float | None) -> Terrain:
    """Return the world over a height field; its floor lies at a whole number of cells of the file's own zero.

    Raises:
        MapError: if heights are missing and nothing fills them, or the box would be too large.
    """
    heights = field.heights if fill is None else fill_missing(field.heights, fill)
    if not np.isfinite(heights).all():
        missing = int((~np.isfinite(heights)).sum())
        raise MapError(f"{field.source}: {missing} heights are missing; give a stand-in with --fill HEIGHT")
    edge, low, high = min(field.spacing), float(heights.min()), float(heights.max())
    clearance = rise if math.isfinite(rise) and rise > 0 else 0.0  # any other is refused below
    floor = low // edge * edge
    count = (high - floor + clearance) / edge + AIR if levels is None else float(levels)
    if not heights.size * count <= MAX_CELLS:
        raise MapError(
            f"{field.source}: {heights.size} columns of {count:.6g} cells are more than {MAX_CELLS:,} in all; heights "
            f"and spacing ({edge:g}) must share a unit; thin the file, or cut the box with --levels"
        )
    world = voxelise(heights - floor, math.ceil(count), (*field.spacing, edge), rise)
    return Terrain(world, heights, floor)


def _end(world: GridWorld, name: str, numbers: tuple[int, ...]) -> Cell:
    if len(numbers) not in (2, 3):
        raise ScenarioError(
            f"--{name} takes a cell x y z, or x y for the surface, got {len(numbers)} numbers"
        )
    if len(numbers) == 3:
        return numbers[0], numbers[1], numbers[2]
    x, y = numbers
    nx, ny, levels = world.shape
    if not (0 <= x < nx and 0 <= y < ny):
        raise ScenarioError(f"{name} {numbers} lies outside the map of {nx} x {ny} columns (counted from 0)")
    if not world.free[x, y].any():
        raise ScenarioError(f"{name} {numbers}: no free cell above the surface in {levels} levels; give more")
    return x, y, int(world.free[x, y].argmax())


def report(found: Found) -> str:
    """Return the lines that the terminal shows."""
    done, command = found.plan, found.command
    values = " ".join(f"--{name} {value:.6g}" for name, value in found.setting._asdict().items())
    effort = f"--ants {command.ants} --iterations {command.iterations} --seed {command.seed}"
    length = "none: no ant arrived" if found.gap is None else f"{done.length:.6g}"
    gap = "" if found.gap is None else f"gap      {found.gap:.2%}\n"
    lines = (
        f"world    {' x '.join(str(n) for n in found.scenario.world.shape)} cells of "
        f"{' x '.join(f'{edge:g}' for edge in found.scenario.world.cell)}, "
        f"{found.scenario.start} to {found.scenario.goal}\n"
        f"length   {length}\n"
        f"optimum  {found.scenario.optimum:.6g}\n"
        f"{gap}"
        f"arrived  {int(done.arrived.sum()):,} of {command.ants * command.iterations:,} ants\n"
        f"seconds  {found.seconds:.4f}\n"
        f"setting  --motion {command.motion} --rules {command.rules} {values} {effort}"
    )
    return lines if done.solved else f"{lines}\nhint     {hint(found)}"


def hint(found: Found) -> str:
    """Return what to try where no ant arrived."""
    return (
        f"ants that follow the heuristic run into walls and die there: try --beta {found.setting.beta / 10:.2g}, "
        f"or more of them: --ants {4 * found.command.ants}"
    )


def files(found: Found, stem: Path, more: Mapping[str, Any] | None = None) -> dict[Path, bytes]:
    """Return what is written, by path: the way as CSV and JSON and, where asked for, a picture."""
    cells, points = found.plan.path, found.terrain.coordinates(found.plan.path)
    rows = [
        f"{i},{j},{k},{x!r},{y!r},{z!r}"
        for (i, j, k), (x, y, z) in zip(cells.tolist(), points.tolist(), strict=True)
    ]
    written = {
        beside(stem, ".csv"): "\n".join(("i,j,k,x,y,z", *rows, "")).encode(),
        beside(stem, ".json"): (
            json.dumps({**_record(found, points), **(more or {})}, indent=2) + "\n"
        ).encode(),
    }
    if found.command.picture:
        written[beside(stem, ".png")] = picture(found)
    return written


def beside(stem: Path, suffix: str) -> Path:
    """Return the path of a file beside a stem."""
    return stem.with_name(stem.name + suffix)  # not with_suffix: a stem may hold a dot


def _record(found: Found, points: NDArray[np.float64]) -> dict[str, Any]:
    done, command = found.plan, found.command
    return {
        "file": str(command.file),
        "status": done.status,
        "length": done.length if done.solved else None,
        "optimum": found.scenario.optimum,
        "gap": found.gap,
        "arrived": int(done.arrived.sum()),
        "seconds": found.seconds,
        "motion": command.motion,
        "rules": command.rules,
        "parameters": found.setting._asdict(),
        "ants": command.ants,
        "iterations": command.iterations,
        "seed": command.seed,
        "shape": found.scenario.world.shape,
        "cell": found.scenario.world.cell,
        "floor": found.terrain.floor,
        "rise": command.rise,
        "start": found.scenario.start,
        "goal": found.scenario.goal,
        "cells": done.path.tolist(),
        "points": points.tolist(),
    }


def picture(found: Found) -> bytes:
    """Return a PNG: the terrain from above with the path, and the path's height over the ground below it.

    Raises:
        MissingExtraError: if matplotlib is not installed.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise MissingExtraError("matplotlib", "viz") from None
    scenario, terrain = found.scenario, found.terrain
    (dx, dy, _), (nx, ny, _) = scenario.world.cell, scenario.world.shape
    points, ends = (
        terrain.coordinates(np.asarray(c)) for c in (found.plan.path, (scenario.start, scenario.goal))
    )
    figure = Figure(figsize=(7, 7), layout="constrained")
    above, side = figure.subplots(2, 1, height_ratios=(3, 1))
    image = above.imshow(terrain.heights.T, origin="lower", extent=(0, nx * dx, 0, ny * dy), cmap="terrain")
    figure.colorbar(image, ax=above, label="height")
    above.plot(points[:, 0], points[:, 1], color="crimson")
    ground = terrain.heights[tuple(found.plan.path[:, :2].T)] + found.command.rise
    side.fill_between(points[:, 0], ground, terrain.floor, color="0.7", label="ground below the path, raised")
    side.plot(points[:, 0], points[:, 2], color="crimson", label="path")
    for axes, axis, name in ((above, 1, "y"), (side, 2, "z")):
        axes.scatter(ends[:, 0], ends[:, axis], color=("green", "orange"), zorder=3)
        axes.set(xlabel="x", ylabel=name)
    side.legend(fontsize="small")
    status = (
        found.plan.status if found.gap is None else f"length {found.plan.length:.6g}, gap {found.gap:.2%}"
    )
    figure.suptitle(f"{scenario.name}: {status}")
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=120)
    return buffer.getvalue()
