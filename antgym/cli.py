"""The command ``antgym``: plan a map of one's own, list the environments, measure the planner.

Exit codes: 0 done, 1 no ant or bee arrived, 2 unusable input (one line says what and what to do), 130 Ctrl-C.
Everything heavy is imported by the subcommand that needs it, so that ``antgym --help`` is quick.
"""

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from antgym import console


@dataclass(frozen=True)
class MapFile:
    """A map file, where to go on it, and the swarm that is to find the way."""

    file: tyro.conf.Positional[Path]
    """Elevation file; heights and spacing in one unit."""
    start: tuple[int, ...] = ()
    """Cell x y z, counted from 0; x y alone stands on the surface."""
    goal: tuple[int, ...] = ()
    """Cell x y z or x y; under the layered motion at a larger x than the start."""
    motion: str = "layered"
    """How ants step: layered, along x; grid26, to any neighbour; grid8 or grid4 over flat ground, with --levels 1."""
    levels: int | None = None
    """Cells along z; by default as many as the relief and some air above need."""
    rise: float = 0.0
    """Clearance: how far the surface is raised, in the file's unit."""
    fill: float | None = None
    """Height that stands in for missing ones; without it they are an error."""
    rules: str = "liu2020"
    """The swarm's rules; an unknown name lists them all."""


@dataclass(frozen=True)
class PlanFile(MapFile):
    """Plan a path over an elevation file, an ESRI ASCII grid (.asc, .txt), .npy or .npz; or by bees past discs.

    Cells are as wide as the file's spacing, and as high. By default the path advances one cell along x per move.
    Rules of bees (--rules wu2018) plan a scene of discs, a .json that holds its own start and goal; they fly well as
    40 bees for 1,000 cycles. Parameters left out take the published default of the rules.
    """

    alpha: float | None = None
    """Weight of the pheromone."""
    beta: float | None = None
    """Weight of the heuristic; smaller is less greedy."""
    rho: float | None = None
    """Persistence of the pheromone per iteration."""
    Q: float | None = None
    """Deposit constant."""
    limit: float | None = None
    """Bees: tries in vain after which a source is abandoned."""
    xi_max: float | None = None
    """Bees: largest share by which one moves, in the first cycle."""
    xi_min: float | None = None
    """Bees: the same in the last cycle."""
    tabu_radius: float | None = None
    """Bees of rules with a tabu list: how far from abandoned sources a new one must lie."""
    ants: int = 20
    """Ants per iteration, or bees."""
    iterations: int = 100
    """Iterations, or cycles."""
    seed: int = 0
    """The same seed gives the same path on every machine."""
    out: Path | None = None
    """Write OUT.csv, OUT.json and OUT.png."""
    picture: bool = True
    """Whether OUT.png is among them; it needs matplotlib."""


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


Command = (
    Annotated[PlanFile, tyro.conf.subcommand("plan")]
    | Annotated[Envs, tyro.conf.subcommand("envs")]
    | Annotated[Bench, tyro.conf.subcommand("bench")]
)


def envs(arguments: Envs) -> int:
    """Print the table of environments, or the page of one."""
    from antgym import listing

    _print(listing.table() if arguments.id is None else listing.page(arguments.id))
    return 0


def bench(arguments: Bench) -> int:
    """Measure the workloads, print the table, write the JSON."""
    import json

    from rich.table import Table

    from antgym import bench
    from antgym.errors import ParameterError

    if arguments.repeats < 1:
        raise ParameterError(f"repeats = {arguments.repeats}: at least one turn is needed")
    rows = [
        bench.measure(workload, arguments.repeats) for workload in bench.find_workloads(arguments.workload)
    ]
    load = bench.load_average()
    table = Table(
        title=f"Mountains 21³, one thread, median of {arguments.repeats} turns, load average {load}"
    )
    for heading in ("ants x iterations", "ns/move", "plans/s", "exact plans/s"):
        table.add_column(heading, justify="right")
    for row in rows:
        table.add_row(*(f"{value:,}" if isinstance(value, float) else str(value) for value in row.values()))
    _print(table)
    if arguments.json is not None:
        figures = {"load_average": load, "repeats": arguments.repeats, "rows": rows}
        console.write_whole(arguments.json, (json.dumps(figures, indent=2) + "\n").encode())
    return 0


def plan(arguments: PlanFile) -> int:
    """Plan the file, print what was found, write the files."""
    from antgym.errors import ParameterError
    from antgym.planners.planning import are_bees

    if are_bees(arguments.rules):
        from antgym.plan_scene import plan_scene

        return plan_scene(arguments)
    if arguments.file.suffix.lower() == ".json":
        raise ParameterError(
            f"{arguments.file}: past the discs of a scene bees fly; name their --rules, as wu2018"
        )
    from antgym.plan_file import plan_file

    return plan_file(arguments)


def run(arguments: Sequence[str] | None = None) -> int:
    """Run one command line and return its exit code; raises AntgymError for unusable input."""
    command = console.parse(Command, arguments, "antgym")
    if isinstance(command, PlanFile):
        return plan(command)
    return envs(command) if isinstance(command, Envs) else bench(command)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the console script."""
    console.main(lambda: sys.exit(run(arguments)), interrupted="interrupted")


def _print(table: object) -> None:
    from rich.console import Console

    Console(width=None if Console().is_terminal else 160).print(table)


if __name__ == "__main__":
    main()
