"""``antgym plan``: from a map file to a path, a report on the terminal, and files."""

import importlib.util
import json
import time
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antgym.console import write_whole
from antgym.errors import MissingExtraError, ParameterError
from antgym.exports import path_csv, poses_json
from antgym.maps.fleet import Fleet
from antgym.maps.folders import rules_for
from antgym.maps.map import Map
from antgym.maps.motion import Motion
from antgym.maps.obstacles import Filled, convex
from antgym.maps.readers import read_map
from antgym.maps.world import Scenario
from antgym.planners.colony import Plan, plan
from antgym.planners.parameters import BEE_LIMITS, LIMITS, ColonyParameters
from antgym.planners.rules import find_rules
from antgym.planners.smoothing import SmoothPath, smooth
from antgym.planners.swarms import space_of

if TYPE_CHECKING:
    from antgym.commands import ColonySetting, MapFile, PlanFile, Reading


OPTIONS = (
    "levels",
    "fill",
    "pixel",
    "cell",
    "threshold",
    "crop",
    "relief",
    "ros",
    "unknown",
)  # of a command, that a reader may take


class Question(NamedTuple):
    """What a command asks: a scenario on a map, and the name of the rules that plan it.

    Attributes:
        map: as it was read and grown.
        scenario: its obstacles may be filled.
        rules: of the colony.
        filled: what filling came to, None where it was not asked for.
    """

    map: Map
    scenario: Scenario
    rules: str
    filled: Filled | None


@dataclass(frozen=True, eq=False)
class Found:
    """What one command found: the setting, the plan, and the wall seconds that planning took."""

    command: "PlanFile"
    question: Question
    setting: ColonyParameters
    plan: Plan
    seconds: float

    @property
    def scenario(self) -> Scenario:
        """What was planned."""
        return self.question.scenario

    @property
    def gap(self) -> float | None:
        """(L − L*) / L*; None where no ant arrived."""
        return self.plan.length / self.scenario.optimum - 1 if self.plan.solved else None

    @cached_property
    def smoothed(self) -> SmoothPath | None:
        """The path smoothed; None where no ant arrived, or nobody asked for it."""
        if self.command.smooth is None or not self.plan.solved:
            return None
        return smooth(self.plan.path, self.scenario, self.command.smooth)

    @property
    def smooth_cells(self) -> NDArray[np.float64] | None:
        """(n, 3) of the smoothed path, in cells; None without one."""
        if self.smoothed is None:
            return None
        return np.asarray(self.smoothed.points / np.array(self.scenario.world.cell) - 0.5)

    @property
    def smooth_points(self) -> NDArray[np.float64]:
        """(n, 3) of the smoothed path, as ``Map.points`` has them; (0, 3) without one."""
        cells = self.smooth_cells
        return np.empty((0, 3)) if cells is None else self.question.map.points(cells)


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


def require_left_out(command: "MapFile", options: Iterable[str], reason: str) -> None:
    """Raise ParameterError where one of these options was given, which would have no effect."""
    for field in fields(command):
        if field.name in options and getattr(command, field.name) != field.default:
            raise ParameterError(f"--{field.name.replace('_', '-')} has no effect here: {reason}")


def write(found: Found, stem: Path, more: Mapping[str, Any] | None = None) -> None:
    """Write the files of what was found, each whole or not at all, and say so; ``more`` joins the JSON."""
    for path, data in files(found, stem, more).items():
        write_whole(path, data)
        print(f"wrote    {path}")


def read_file(command: "Reading", file: Path) -> Map:
    """Read a file with the options of a command."""
    options = {name: getattr(command, name) for name in OPTIONS}
    # what is not asked for is not passed on: not every kind of file knows of it
    options |= {"rise": command.rise or None, "negate": command.negate or None}
    return read_map(file, command.radius, **options)


def read(command: "MapFile") -> Question:
    """Read the file and return the map, and the scenario that the command's ends, motion and rules make of it."""
    if not command.start or not command.goal:
        raise ParameterError(
            f"{command.file}: ants need --start and --goal; a scene of discs holds its own, and is planned by bees, as "
            "--rules wu2018"
        )
    map_ = read_file(command, command.file)
    start, goal = (map_.end(getattr(command, name), name, command.unit) for name in ("start", "goal"))
    motion = map_.motion if command.motion is None else Motion(command.motion)
    filled = convex(map_.world, start, goal) if command.convex else None
    world = map_.world if filled is None else filled.world
    scenario = Scenario(world, start, goal, motion, command.file.name)
    rules = command.rules or rules_for(scenario)
    if motion.layered and not find_rules(rules).check_segments:
        scenario = scenario.with_motion(Motion(check_segments=False))
    _ = scenario.optimum  # where no path exists, no ant need try
    return Question(map_, scenario, rules, filled)


def find(command: "PlanFile") -> Found:
    """Read the file and plan."""
    question = read(command)
    require_left_out(command, BEE_LIMITS, f"rules {question.rules!r} are of ants")
    scenario, rules = question.scenario, find_rules(question.rules)
    setting = setting_of(command, question.rules, scenario)
    effort = {"ants": command.ants, "iterations": command.iterations, "seed": command.seed}
    plan(
        scenario, setting, rules=rules, ants=1, iterations=1
    )  # loads the kernels, or compiles them the first time
    begun = time.perf_counter()
    done = plan(scenario, setting, rules=rules, **effort)
    return Found(command, question, setting, done, time.perf_counter() - begun)


def setting_of(command: "ColonySetting", rules: str, scenario: Scenario | Fleet) -> ColonyParameters:
    """Return the parameters that a command gives, those left out as the rules' published defaults."""
    default = space_of(rules, scenario, command.ants).default.tolist()
    given = [getattr(command, name) for name in LIMITS]
    return ColonyParameters(*(d if g is None else g for g, d in zip(given, default, strict=True)))


def report(found: Found) -> str:
    """Return the lines that the terminal shows."""
    done, command = found.plan, found.command
    values = " ".join(f"--{name} {value:.6g}" for name, value in found.setting._asdict().items())
    effort = f"--ants {command.ants} --iterations {command.iterations} --seed {command.seed}"
    length = "none: no ant arrived" if found.gap is None else f"{done.length:.6g}"
    gap = "" if found.gap is None else f"gap      {found.gap:.2%}\n"
    scenario, filled = found.scenario, found.question.filled
    left = (
        f", {filled.left} left as they are: filled, they would part start and goal"
        if filled and filled.left
        else ""
    )
    unit = {"cells": ""}.get(found.question.map.frame.unit, f" {found.question.map.frame.unit}")
    lines = (
        f"world    {' x '.join(str(n) for n in scenario.world.shape)} cells of "
        f"{' x '.join(f'{edge:g}' for edge in scenario.world.cell)}{unit}, "
        f"{scenario.start} to {scenario.goal}\n"
        f"{'' if filled is None else f'convex   {filled.cells:,} cells filled{left}' + chr(10)}"
        f"length   {length}\n"
        f"optimum  {found.scenario.optimum:.6g}\n"
        f"{gap}"
        f"{_smooth_line(found.smoothed)}"
        f"arrived  {int(done.arrived.sum()):,} of {command.ants * command.iterations:,} ants\n"
        f"seconds  {found.seconds:.4f}\n"
        f"setting  --motion {scenario.motion.name} --rules {found.question.rules} {values} {effort}"
    )
    return lines if done.solved else f"{lines}\nhint     {hint(found)}"


def _smooth_line(path: SmoothPath | None) -> str:
    """Return the line that tells what smoothing gained, where there was any."""
    if path is None:
        return ""
    return f"smooth   {path.length:.6g}, {1 - path.length / path.before:.2%} shorter, {len(path.points)} points\n"


def hint(found: Found) -> str:
    """Return what to try where no ant arrived."""
    return (
        f"ants that follow the heuristic run into walls and die there: try --beta {found.setting.beta / 10:.2g}, "
        f"or more of them: --ants {4 * found.command.ants}"
    )


def files(found: Found, stem: Path, more: Mapping[str, Any] | None = None) -> dict[Path, bytes]:
    """Return what is written, by path: the way as CSV, JSON and poses and, where asked for, a picture."""
    cells = found.plan.path
    points = found.question.map.points(cells)
    record = {**_record(found, points), **(more or {})}
    written = {
        beside(stem, ".csv"): path_csv(cells, points),
        beside(stem, ".json"): (json.dumps(record, indent=2) + "\n").encode(),
        beside(stem, ".poses.json"): poses_json(points),
    }
    if found.smoothed is not None:
        smooth_rows = (",".join(map(repr, point)) for point in found.smooth_points.tolist())
        written[beside(stem, ".smooth.csv")] = "\n".join(("x,y,z", *smooth_rows, "")).encode()
    if found.command.picture:
        written[beside(stem, ".png")] = picture(found)
    return written


def beside(stem: Path, suffix: str) -> Path:
    """Return the path of a file beside a stem."""
    return stem.with_name(stem.name + suffix)  # not with_suffix: a stem may hold a dot


def _record(found: Found, points: NDArray[np.float64]) -> dict[str, Any]:
    done, command, frame = found.plan, found.command, found.question.map.frame
    return {
        "file": str(command.file),
        "status": done.status,
        "length": done.length if done.solved else None,
        "optimum": found.scenario.optimum,
        "gap": found.gap,
        "arrived": int(done.arrived.sum()),
        "seconds": found.seconds,
        "motion": found.scenario.motion.name,
        "rules": found.question.rules,
        "parameters": found.setting._asdict(),
        "ants": command.ants,
        "iterations": command.iterations,
        "seed": command.seed,
        "shape": found.scenario.world.shape,
        "cell": found.scenario.world.cell,
        "frame": frame._asdict(),
        "radius": command.radius,
        "rise": command.rise,
        "start": found.scenario.start,
        "goal": found.scenario.goal,
        "cells": done.path.tolist(),
        "points": points.tolist(),
        "smoothed": None
        if found.smoothed is None
        else {
            "method": found.smoothed.method,
            "before": found.smoothed.before,
            "length": found.smoothed.length,
            "points": found.smooth_points.tolist(),
        },
    }


def picture(found: Found) -> bytes:
    """Return a PNG of the path on its map.

    Raises:
        MissingExtraError: if matplotlib is not installed.
    """
    from antgym.map_pictures import drawn

    status = (
        found.plan.status if found.gap is None else f"length {found.plan.length:.6g}, gap {found.gap:.2%}"
    )
    return drawn(
        found.question.map,
        f"{found.scenario.name}: {status}",
        found.plan.path,
        np.array([found.scenario.start, found.scenario.goal]),
        found.command.rise,
        found.smooth_cells,
    )
