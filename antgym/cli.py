"""The command ``antgym``: plan or show a map of one's own, for one robot or several, let an arm follow, list, measure.

Exit codes: 0 done, 1 no ant or bee arrived, 2 unusable input (one line says what and what to do), 130 Ctrl-C, 141
where who reads the output has gone.
Everything heavy is imported by the subcommand that needs it, so that ``antgym --help`` is quick.
"""

import sys
from collections.abc import Sequence
from typing import Annotated

import tyro

from antgym import console
from antgym.commands import ArmFile, Bench, Envs, FleetFile, PlanFile, ShowFile

Command = (
    Annotated[PlanFile, tyro.conf.subcommand("plan")]
    | Annotated[FleetFile, tyro.conf.subcommand("fleet")]
    | Annotated[ArmFile, tyro.conf.subcommand("arm")]
    | Annotated[ShowFile, tyro.conf.subcommand("map")]
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
    from antgym.planners.planning import are_bees

    if arguments.rules is not None and are_bees(arguments.rules):
        from antgym.plan_scene import plan_scene

        return plan_scene(arguments)
    from antgym.plan_file import plan_file

    return plan_file(arguments)


def fleet(arguments: FleetFile) -> int:
    """Plan the robots on the file, print what was found, write the files."""
    from antgym.fleet_file import fleet_file

    return fleet_file(arguments)


def arm(arguments: ArmFile) -> int:
    """Let the arm follow the file, print what it takes, write the files."""
    from antgym.arm_file import arm_file

    return arm_file(arguments)


def show(arguments: ShowFile) -> int:
    """Print what there is to say of a map, write the files."""
    from antgym.map_file import map_file

    return map_file(arguments)


def run(arguments: Sequence[str] | None = None) -> int:
    """Run one command line and return its exit code; raises AntgymError for unusable input."""
    command = console.parse(Command, arguments, "antgym")
    if isinstance(command, PlanFile):
        return plan(command)
    if isinstance(command, FleetFile):
        return fleet(command)
    if isinstance(command, ArmFile):
        return arm(command)
    if isinstance(command, ShowFile):
        return show(command)
    return envs(command) if isinstance(command, Envs) else bench(command)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the console script."""
    console.main(lambda: sys.exit(run(arguments)), interrupted="interrupted")


def _print(table: object) -> None:
    from rich.console import Console

    Console(width=None if Console().is_terminal else 160).print(table)


if __name__ == "__main__":
    main()
