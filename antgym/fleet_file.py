"""``antgym fleet``: from a map file to the timed paths of several robots, a report on the terminal, and files."""

import json
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from antgym import fleet_pictures
from antgym.console import write_whole
from antgym.errors import ParameterError, ScenarioError
from antgym.maps.fleet import Fleet
from antgym.maps.folders import rules_for
from antgym.maps.map import Map
from antgym.maps.motion import Motion
from antgym.plan_file import beside, read_file, require_matplotlib, setting_of
from antgym.planners.fleet import FleetPlan, plan_fleet
from antgym.planners.parameters import ColonyParameters

if TYPE_CHECKING:
    from antgym.commands import FleetFile

DECIMALS = 9  # of times and places in a file: a nanosecond, and none of the binary digits behind it
GROWN = "Walls are grown by the radius of a robot: its centre keeps that far from them."


@dataclass(frozen=True, eq=False)
class Convoy:
    """What one command found: the map, the setting, the plan, and the wall seconds that planning took."""

    command: "FleetFile"
    map: Map
    rules: str
    setting: ColonyParameters
    plan: FleetPlan
    seconds: float


def fleet_file(command: "FleetFile") -> int:
    """Plan, print, write; return 0, or 1 where not every robot has a path.

    Raises:
        AntgymError: if the file, an end, a parameter or the place to write to cannot be used.
    """
    if command.out is not None and command.picture:
        require_matplotlib()
    found = find(command)
    print(report(found))
    for path, data in files(found).items():
        write_whole(path, data)
        print(f"wrote    {path}")
    return 0 if found.plan.solved else 1


def find(command: "FleetFile") -> Convoy:
    """Read the file and plan."""
    map_ = read_file(command, command.file)
    fleet = read_fleet(command, map_)
    rules = command.rules or rules_for(fleet.robots[0])
    setting = setting_of(command, rules, fleet)
    plan_fleet(fleet, setting, rules=rules, ants=1, iterations=1, restarts=0)  # loads the kernels
    begun = time.perf_counter()
    effort = {"ants": command.ants, "iterations": command.iterations, "seed": command.seed}
    plan = plan_fleet(fleet, setting, rules=rules, **effort)
    return Convoy(command, map_, rules, setting, plan, time.perf_counter() - begun)


def read_fleet(command: "FleetFile", map_: Map) -> Fleet:
    """Return the fleet that the command's ends make on a map."""
    if not command.starts or len(command.starts) != len(command.goals):
        raise ScenarioError(
            f"{len(command.starts)} starts and {len(command.goals)} goals: give one of each to every robot, as "
            "--starts 1,1 9,1 --goals 9,9 1,9"
        )
    apart = command.apart or 2 * command.radius
    if not apart:
        raise ParameterError(
            "how near may robots come to each other? Give --radius, or --apart, in the map's unit"
        )
    motion = map_.motion if command.motion is None else Motion(command.motion)
    robots = []
    for i, ends in enumerate(zip(command.starts, command.goals, strict=True)):
        labels = (f"start of robot {i}", f"goal of robot {i}")
        start, goal = (map_.end(end, label, command.unit) for end, label in zip(ends, labels, strict=True))
        robots.append(map_.scenario(start, goal, motion))
    speeds = command.speeds if len(command.speeds) > 1 else command.speeds[0] if command.speeds else 1.0
    return Fleet(robots, apart, speeds, command.file.name)


def report(found: Convoy) -> str:
    """Return the lines that the terminal shows."""
    plan, fleet, command = found.plan, found.plan.fleet, found.command
    unit = found.map.frame.unit
    values = " ".join(f"--{name} {value:.6g}" for name, value in found.setting._asdict().items())
    lines = [
        f"world    {found.map.extent}",
        f"robots   {len(fleet.robots)}, {fleet.apart:g} {unit} apart at least, at "
        f"{', '.join(f'{pace:g}' for pace in fleet.paces.tolist())} {unit}/s",
        f"status   {plan.status}",
    ]
    if plan.solved:
        waited = sum(path.waited for path in plan.paths)
        lines += [
            f"length   {plan.length:.6g}, of which {plan.length - plan.lengths.sum():.4g} is for {waited:.4g} s of "
            "waits",
            f"optimum  {fleet.optimum:.6g}, each robot alone",
            f"gap      {plan.gap:.2%}",
            f"makespan {plan.makespan:.4g} s, {plan.makespan_gap:.2%} above the slowest robot alone",
            f"order    {', '.join(map(str, plan.order))}, after {plan.restarts} restarts",
        ]
    effort = f"--ants {command.ants} --iterations {command.iterations} --seed {command.seed}"
    return "\n".join(
        [
            *lines,
            f"seconds  {found.seconds:.4f}, {plan.plans} planner runs",
            f"setting  --motion {fleet.motion.name} --rules {found.rules} {values} {effort}",
        ]
    )


def files(found: Convoy) -> dict[Path, bytes]:
    """Return what is written, by path: the record and, where there are paths, these, a strip and a page."""
    stem, plan = found.command.out, found.plan
    if stem is None:
        return {}
    written = {beside(stem, ".json"): (json.dumps(_record(found), indent=2) + "\n").encode()}
    if plan.solved:
        title = f"{plan.fleet.name}: {len(plan.paths)} robots, {plan.makespan:.3g} s, gap {plan.gap:.1%}"
        down, note = found.map.frame.down, GROWN if found.command.radius else ""
        written[beside(stem, ".csv")] = paths_csv(plan, found.map)
        written[beside(stem, ".html")] = fleet_pictures.animation(plan, title, down, note)
        if found.command.picture:
            written[beside(stem, ".png")] = fleet_pictures.strip(
                plan, title, found.command.frames, down, note
            )
    return written


def paths_csv(plan: FleetPlan, map_: Map) -> bytes:
    """Return timed way-points as CSV: robot, t in seconds, x, y, z in the map's coordinates, to ``DECIMALS`` digits."""
    rows = ["robot,t,x,y,z"]
    for i, path in enumerate(plan.paths):
        table = np.column_stack([path.times, map_.points(cells_of(path.points, map_))]).round(DECIMALS)
        rows += [f"{i},{t!r},{x!r},{y!r},{z!r}" for t, x, y, z in table.tolist()]
    return "\n".join((*rows, "")).encode()


def cells_of(points: NDArray[np.float64], map_: Map) -> NDArray[np.int64]:
    """Return the (n, 3) cells whose centres (n, 3) points of the world are."""
    return np.round(points / np.array(map_.world.cell) - 0.5).astype(np.int64)


def _record(found: Convoy) -> dict[str, object]:
    plan, command = found.plan, found.command
    return {
        "file": str(command.file),
        "status": plan.status,
        "length": plan.length if plan.solved else None,
        "optimum": plan.fleet.optimum,
        "gap": plan.gap if plan.solved else None,
        "makespan": plan.makespan if plan.solved else None,
        "order": plan.order,
        "restarts": plan.restarts,
        "plans": plan.plans,
        "seconds": found.seconds,
        "motion": plan.fleet.motion.name,
        "rules": found.rules,
        "parameters": found.setting._asdict(),
        "ants": command.ants,
        "iterations": command.iterations,
        "seed": command.seed,
        "apart": plan.fleet.apart,
        "speeds": plan.fleet.paces.tolist(),
        "radius": command.radius,
        "frame": found.map.frame._asdict(),
        "starts": [robot.start for robot in plan.fleet.robots],
        "goals": [robot.goal for robot in plan.fleet.robots],
        "paths": [
            {"times": path.times.tolist(), "cells": cells_of(path.points, found.map).tolist()}
            for path in plan.paths
        ],
    }
