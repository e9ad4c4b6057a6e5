"""``antgym plan`` past discs: from a scene to a path by bees, a report on the terminal, and files."""

import io
import json
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from antgym.console import write_whole
from antgym.errors import MissingExtraError
from antgym.maps.discs import DiscScenario, DiscWorld
from antgym.maps.optimum import shortest_path
from antgym.maps.scenes import read_discs
from antgym.plan_file import beside, require_left_out, require_matplotlib
from antgym.planners.bee_rules import find_bee_rules
from antgym.planners.parameters import LIMITS
from antgym.planners.planning import plan
from antgym.planners.plans import Plan

if TYPE_CHECKING:
    from antgym.commands import MapFile, PlanFile

GRID = (
    *(
        "start",
        "goal",
        "unit",
        "motion",
        "convex",
        "smooth",
        "radius",
        "levels",
        "rise",
        "fill",
        "pixel",
        "cell",
    ),
    *("threshold", "negate", "crop", "relief", "ros", "unknown", *LIMITS),
)
"""Options that mean nothing past discs: a scene says itself where start and goal are."""


@dataclass(frozen=True, eq=False)
class Flown:
    """What one command found past discs: the setting, the plan, and the wall seconds that planning took.

    The setting has as many numbers as the rules choose: no radius without a tabu list.
    """

    command: "PlanFile"
    scenario: DiscScenario
    setting: dict[str, float]
    plan: Plan
    seconds: float

    @property
    def gap(self) -> float | None:
        """(L − L*) / L*; None where no bee arrived."""
        return self.plan.length / self.scenario.optimum - 1 if self.plan.solved else None

    @property
    def sources(self) -> int:
        """How many sources the bees keep."""
        return self.command.ants // 2


def plan_scene(command: "PlanFile") -> int:
    """Plan, print, write; return 0, or 1 where no bee arrived.

    Raises:
        AntgymError: if the file, a parameter or the place to write to cannot be used.
    """
    if command.out is not None and command.picture:
        require_matplotlib()
    flown = find(command)
    print(report(flown))
    if command.out is not None:
        write(flown, command.out)
    return 0 if flown.plan.solved else 1


def write(flown: Flown, stem: Path, more: Mapping[str, Any] | None = None) -> None:
    """Write the files of what was found, each whole or not at all, and say so; ``more`` joins the JSON."""
    for path, data in files(flown, stem, more).items():
        write_whole(path, data)
        print(f"wrote    {path}")


def read(command: "MapFile") -> DiscScenario:
    """Read the scene of a command under rules of bees; ParameterError where it gives options of grids."""
    require_left_out(
        command, GRID, f"rules {command.rules!r} are of bees, and a scene holds its own start and goal"
    )
    scenario = read_discs(command.file)
    _ = scenario.optimum  # where no path exists, no bee need try
    return scenario


def find(command: "PlanFile") -> Flown:
    """Read the scene and plan."""
    assert command.rules is not None  # they are what leads here
    rules = find_bee_rules(command.rules)
    if not rules.tabu:
        require_left_out(command, ("tabu_radius",), f"rules {command.rules!r} have no tabu list")
    scenario = read(command)
    space = rules.space(command.ants, scenario.world.width)
    given = zip(space.names, space.default.tolist(), strict=True)
    setting = {
        name: default if getattr(command, name) is None else getattr(command, name) for name, default in given
    }
    values, effort = list(setting.values()), {"ants": command.ants, "iterations": command.iterations}
    plan(
        scenario, values, rules=rules, ants=4, iterations=1
    )  # loads the kernels, or compiles them the first time
    begun = time.perf_counter()
    done = plan(scenario, values, rules=rules, seed=command.seed, **effort)
    return Flown(command, scenario, setting, done, time.perf_counter() - begun)


def report(flown: Flown) -> str:
    """Return the lines that the terminal shows."""
    done, command, world = flown.plan, flown.command, flown.scenario.world
    x_min, x_max, y_min, y_max = world.bounds
    values = " ".join(f"--{name.replace('_', '-')} {value:.6g}" for name, value in flown.setting.items())
    lines = [
        f"world    {len(world.discs)} discs, x {x_min:g} to {x_max:g}, y {y_min:g} to {y_max:g}, "
        f"robot radius {world.robot_radius:g}, {flown.scenario.start} to {flown.scenario.goal}",
        f"length   {'none: no bee arrived' if flown.gap is None else f'{done.length:.6g}'}",
        f"optimum  {flown.scenario.optimum:.6g}",
        f"clear    {int(done.arrived[-1])} of {flown.sources} sources in the end",
        f"seconds  {flown.seconds:.4f}",
        f"setting  --rules {command.rules} {values} --ants {command.ants} --iterations {command.iterations} "
        f"--seed {command.seed}",
    ]
    if flown.gap is None:
        more = f"--ants {2 * command.ants} --iterations {4 * command.iterations}"
        return "\n".join(
            [*lines, f"hint     every path that was tried touches a disc: try more bees, longer: {more}"]
        )
    return "\n".join([*lines[:3], f"gap      {flown.gap:.2%}", *lines[3:]])


def files(flown: Flown, stem: Path, more: Mapping[str, Any] | None = None) -> dict[Path, bytes]:
    """Return what is written, by path: the way as CSV and JSON and, where asked for, a picture.

    A path that touches a disc is no way: it is drawn, and not written as points.
    """
    points = flown.plan.path.tolist() if flown.plan.solved else []
    record = {**_record(flown), "points": points, **(more or {})}
    written = {
        beside(stem, ".csv"): "\n".join(("x,y", *(f"{x!r},{y!r}" for x, y in points), "")).encode(),
        beside(stem, ".json"): (json.dumps(record, indent=2) + "\n").encode(),
    }
    if flown.command.picture:
        written[beside(stem, ".png")] = picture(flown)
    return written


def _record(flown: Flown) -> dict[str, Any]:
    done, command, scenario = flown.plan, flown.command, flown.scenario
    return {
        "file": str(command.file),
        "status": done.status,
        "length": done.length if done.solved else None,
        "optimum": scenario.optimum,
        "gap": flown.gap,
        "clear": int(done.arrived[-1]),
        "seconds": flown.seconds,
        "rules": command.rules,
        "parameters": flown.setting,
        "ants": command.ants,
        "iterations": command.iterations,
        "seed": command.seed,
        "discs": len(scenario.world.discs),
        "bounds": scenario.world.bounds,
        "robot_radius": scenario.world.robot_radius,
        "safe_distance": scenario.world.safe_distance,
        "start": scenario.start,
        "goal": scenario.goal,
    }


def picture(flown: Flown) -> bytes:
    """Return a PNG: the discs from above, grown by the robot's radius, the path and the exact optimum.

    Raises:
        MissingExtraError: if matplotlib is not installed.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise MissingExtraError("matplotlib", "viz") from None
    scenario = flown.scenario
    figure = Figure(figsize=(7, 7), layout="constrained")
    axes = figure.subplots()
    draw_discs(axes, scenario.world, "0.96", "0.6")
    axes.plot(*flown.plan.path.T, color="crimson", marker=".", label="path")
    axes.plot(*np.asarray(shortest_path(scenario)).T, color="black", linestyle=":", label="exact optimum")
    for end, colour in ((scenario.start, "green"), (scenario.goal, "orange")):
        axes.scatter(*end, color=colour, zorder=3)
    axes.set(xlabel="x", ylabel="y", aspect="equal")
    axes.legend(fontsize="small")
    status = (
        flown.plan.status if flown.gap is None else f"length {flown.plan.length:.6g}, gap {flown.gap:.2%}"
    )
    figure.suptitle(f"{scenario.name}, {flown.command.rules}: {status}")
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=120)
    return buffer.getvalue()


def draw_discs(axes: Any, world: DiscWorld, floor: str, colour: str) -> None:
    """Draw the bounds of a world and its discs, as far as they lie within, on the axes of a figure."""
    from matplotlib.patches import Circle, Rectangle

    x_min, x_max, y_min, y_max = world.bounds
    box = Rectangle((x_min, y_min), x_max - x_min, y_max - y_min, facecolor=floor)
    axes.add_patch(box)
    for x, y, radius in world.grown.tolist():
        axes.add_patch(Circle((x, y), radius, facecolor=colour)).set_clip_path(box)
