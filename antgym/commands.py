"""What the subcommands of ``antgym`` are given: a dataclass each, whose texts are what ``--help`` says."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import tyro


def _numbers(words: list[str]) -> tuple[float, ...]:
    return tuple(float(part) for word in words for part in word.split(",") if part)


Place = Annotated[
    tuple[float, ...],
    tyro.constructors.PrimitiveConstructorSpec(
        nargs="*",
        metavar="X Y [Z]",
        instance_from_str=_numbers,
        is_instance=lambda place: isinstance(place, tuple),
        str_from_instance=lambda place: [f"{number:g}" for number in place],
    ),
]
"""Numbers with spaces or commas between them."""
Places = Annotated[
    tuple[tuple[float, ...], ...],
    tyro.constructors.PrimitiveConstructorSpec(
        nargs="*",
        metavar="X,Y[,Z]",
        instance_from_str=lambda words: tuple(_numbers([word]) for word in words),
        is_instance=lambda places: isinstance(places, tuple),
        str_from_instance=lambda places: [",".join(f"{number:g}" for number in place) for place in places],
    ),
]
"""Places with spaces between them, their numbers with commas."""


@dataclass(frozen=True, kw_only=True)
class Reading:
    """How a file becomes a map. What a kind of file does not know is refused."""

    radius: float = 0.0
    """Of the robot, in the map's unit: obstacles are grown by it."""
    levels: int | None = None
    """Elevations: cells along z; by default as many as the relief and some air above need."""
    rise: float = 0.0
    """Elevations: clearance, how far the surface is raised, in the file's unit."""
    fill: float | None = None
    """Elevations: height that stands in for missing ones; without it they are an error."""
    pixel: float | None = None
    """Pictures: metres that a pixel is wide. Elevations: distance between samples instead of the file's."""
    cell: float | None = None
    """Pictures and scenes: edge of a cell; of pictures by default a pixel's."""
    threshold: float | None = None
    """Pictures: grey level, 0 to 255, below which a pixel is an obstacle; by default Otsu's."""
    negate: bool = False
    """Pictures: bright pixels are the obstacles."""
    crop: tuple[int, int, int, int] | None = None
    """Pictures: left, top, right, bottom pixels that the floor lies between."""
    relief: tuple[float, float] | None = None
    """Pictures: they are elevations, and these the heights of black and white."""
    ros: int | None = None
    """ROS maps: thresholds as ROS 1 or 2 takes them; by default 2."""
    unknown: str | None = None
    """OctoMaps: what the file says nothing of is blocked, the default, or free."""


@dataclass(frozen=True)
class MapFile(Reading):
    """A map file, where to go on it, and the swarm that is to find the way."""

    file: tyro.conf.Positional[Path]
    """Map, picture or elevation file."""
    start: Place = ()
    """x y z, or x y alone: the ground of an elevation map, the lowest free cell of others."""
    goal: Place = ()
    """Likewise; under the layered motion at a larger x than the start."""
    unit: Literal["cells", "map"] = "cells"
    """What start and goal count: cells, from 0, or the map's own unit, as metres."""
    motion: str | None = None
    """How ants step: layered, along x; grid26, to any neighbour; grid8 or grid4 over flat maps. By default as the kind
    of file has it."""
    convex: bool = False
    """Flat maps: concave obstacles are filled to convex ones, but never over start or goal (zhang2011)."""
    rules: str | None = None
    """The swarm's rules; an unknown name lists them all. By default liu2020, or ant_colony_system on grids."""


@dataclass(frozen=True, kw_only=True)
class ColonySetting:
    """The parameters of a colony, its effort and its seed."""

    alpha: float | None = None
    """Weight of the pheromone."""
    beta: float | None = None
    """Weight of the heuristic; smaller is less greedy."""
    rho: float | None = None
    """Persistence of the pheromone per iteration."""
    Q: float | None = None
    """Deposit constant."""
    ants: int = 20
    """Ants per iteration, or bees."""
    iterations: int = 100
    """Iterations, or cycles."""
    seed: int = 0
    """The same seed gives the same path on every machine."""


@dataclass(frozen=True)
class PlanFile(MapFile, ColonySetting):
    """Plan a path on a map of your own.

    MovingAI .map and .3dmap, ROS .yaml, OctoMap .bt, pictures, scenes of shapes (.json), elevations (.asc, .txt, .npy,
    .npz). Cells of elevations are as wide as the file's spacing, and as high; the path advances one cell along x per
    move. Parameters left out take the published default of the rules.
    Rules of bees (--rules wu2018) plan a scene of discs, a .json that holds its own start and goal; they fly well as
    40 bees for 1,000 cycles.
    """

    limit: float | None = None
    """Bees: tries in vain after which a source is abandoned."""
    xi_max: float | None = None
    """Bees: largest share by which one moves, in the first cycle."""
    xi_min: float | None = None
    """Bees: the same in the last cycle."""
    tabu_radius: float | None = None
    """Bees of rules with a tabu list: how far from abandoned sources a new one must lie."""
    smooth: Literal["shortcut", "spline"] | None = None
    """Smooth the path: shortcut, straight lines between some of its cells, or spline, these with their corners rounded;
    written as OUT.smooth.csv. It enters no blocked cell."""
    out: Path | None = None
    """Write OUT.csv, OUT.json, OUT.poses.json (frame and poses, as ROS has paths) and OUT.png."""
    picture: bool = True
    """Whether OUT.png is among them; it needs matplotlib."""


@dataclass(frozen=True)
class FleetFile(Reading, ColonySetting):
    """Plan several robots on a map of your own, so that no two ever come too near to each other.

    Maps as for antgym plan. Each robot is planned by a colony, and waits or goes round where it would meet another.
    """

    file: tyro.conf.Positional[Path]
    """Map, picture or elevation file."""
    starts: Places = ()
    """Of every robot: x,y or x,y,z, with spaces between robots."""
    goals: Places = ()
    """Likewise, in the same order."""
    unit: Literal["cells", "map"] = "cells"
    """What starts and goals count: cells, from 0, or the map's own unit, as metres."""
    apart: float | None = None
    """Smallest distance of two robots' centres, in the map's unit; by default twice the radius."""
    speeds: tuple[float, ...] = ()
    """In the map's unit per second, of all robots or of each; 1 by default."""
    motion: str | None = None
    """As for antgym plan."""
    rules: str | None = None
    """The colony's rules; an unknown name lists them all. By default as for antgym plan."""
    frames: int = 5
    """Of the strip."""
    out: Path | None = None
    """Write OUT.csv, timed way-points, OUT.json, OUT.html, in which the robots move, and OUT.png, a strip of frames."""
    picture: bool = True
    """Whether OUT.png is among them; it needs matplotlib."""


@dataclass(frozen=True)
class ArmFile:
    """Let a robot arm follow a planned path: joint angles over time, by the branch of the inverse that moves least.

    antgym plan MAP … --smooth spline --out way, then antgym arm way.smooth.csv --scale 0.001 --at 0.3 -0.15 0.2.
    Points out of reach, past joint limits or near a singularity are named; whether links hit anything is not checked.
    """

    file: tyro.conf.Positional[Path]
    """Way-points: a CSV file with columns x, y, z, as antgym plan writes it."""
    arm: str = "lr_mate_200id"
    """Who follows; an unknown name lists them all."""
    scale: float = 1.0
    """Metres in one of the file's units: 0.001 for millimetres."""
    at: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Where the map's origin lies in the arm's base frame, x y z in metres."""
    turn: float = 0.0
    """Degrees that the map is turned about the base's z axis, anticlockwise from above."""
    tool: tuple[float, float, float] = (180.0, 0.0, 0.0)
    """How the tool is held: roll, pitch, yaw in degrees about the base's x, y, z; straight down by default."""
    spacing: float = 0.002
    """Metres between samples, at most; the tool may leave the path between them by 0.1 mm."""
    margin: float = 0.05
    """How near to a singularity the arm may come, from 0 to 1: sine of wrist or elbow, or share of the reach."""
    speed: float = 0.25
    """Of the tool, metres per second; joints may be slower."""
    acceleration: float = 1.0
    """Of the tool, metres per second², along the path and where it turns."""
    out: Path | None = None
    """Write OUT.csv, seconds and radians and metres, and OUT.png."""
    picture: bool = True
    """Whether OUT.png is among them; it needs matplotlib."""


@dataclass(frozen=True)
class ShowFile(Reading):
    """Show a map file: its size, free share, parts, features and a picture; write it as another kind of file."""

    file: tyro.conf.Positional[Path]
    """Map, picture or elevation file, as for antgym plan."""
    start: Place = ()
    """Of the scenario that the features are of; without start and goal, they are drawn."""
    goal: Place = ()
    """Likewise."""
    unit: Literal["cells", "map"] = "cells"
    """What start and goal count: cells, from 0, or the map's own unit, as metres."""
    out: tuple[Path, ...] = ()
    """Files to write: .png a picture; .map, .3dmap, .bt, .yaml or .asc the map; .scen or .3dscen the scenario."""


@dataclass(frozen=True)
class Envs:
    """List the environments: id, sizes of action and observation, card; or print the page of one."""

    id: tyro.conf.Positional[str | None] = None
    """Id of one environment, as antgym/OpenTrials-v0; all in a table without it."""


@dataclass(frozen=True)
class Bench:
    """Measure the planner: CPU time per ant move on one thread, beside the exact planner.

    The comparison with other codes is experiments/speed.py, in a checkout.
    """

    workload: tuple[str, ...] = ()
    """Workloads by name; all by default."""
    repeats: int = 5
    """Turns; the median counts."""
    json: Path | None = None
    """File to write the figures to."""
