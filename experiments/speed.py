"""How fast the planner is: CPU time per move of an ant, or path of a bee, as a ratio to codes that take turns with it.

    python -m experiments.speed --json out/speed.json --figure out/growth.png

These machines are shared: a figure alone says little, a ratio of two codes that take turns says more. The peers come
with ``pip install -e ".[bench]"``; where they are absent their rows say so. An ant colony is never the fastest way to
a shortest path: the exact planners stand in the table too.
"""

import json
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Annotated, Any

import numba
import tyro
from rich.console import Console
from rich.table import Table
from rich.text import Text

from antgym.bench import (
    Work,
    Workload,
    find_workloads,
    load_average,
    take_turns,
    threads,
)
from antgym.console import main, parse, write_whole
from antgym.errors import MissingExtraError, ParameterError
from antgym.planners.planning import plan_many
from experiments import batches
from experiments.growth import figure, growth, to_sentence, to_table, vast
from experiments.ports import plain_digest
from experiments.rivals import CODES, Code, peak_megabytes

GATE = "30x150"
"""The workload whose ratio to the plain port a slow test guards."""
BATCH = 32  # plans of a turn where two threads are compared with one


@dataclass(frozen=True)
class Arguments:
    """Measure the planner beside a plain numba port, a numpy colony, exact planners and peers."""

    repeats: int = 5
    """Turns of each code; the median counts."""
    workload: tuple[str, ...] = ()
    """Workloads by name (20x100, 30x150, 50x200, 50x200-greedy, plane-50x100, bees); all by default."""
    memory: bool = True
    """Whether to measure peak memory, a fresh process for every code."""
    growth: bool = True
    """Whether to measure how the cost of ants grows with ants, iterations, layers and world, up to a cube of 512 cells
    a side."""
    two_threads: bool = True
    """Whether to measure what a second thread gains."""
    envs: bool = True
    """Whether to measure what a batch of environments costs beside its planner, and against single ones."""
    out: Annotated[Path | None, tyro.conf.arg(name="json")] = None
    """File to write the figures to."""
    figure: Path | None = None
    """PNG to draw cost growth into; needs matplotlib."""


@numba.njit(nogil=True)
def arithmetic(rounds: int) -> float:
    """Multiply and add in registers: the most that a second thread can gain on this machine now."""
    value = 0.5
    for _ in range(rounds):
        value = 3.7 * value * (1.0 - value)
    return value


def measure(workload: Workload, repeats: int, memory: bool) -> list[dict[str, Any]]:
    """Let all codes take turns on one thread; return a row each, or the reason why it is skipped."""
    works: dict[str, Work] = {}
    rows: list[dict[str, Any]] = []
    codes = [code for code in CODES if code.takes(workload)]
    for code in codes:
        try:
            works[code.name] = code.prepare(workload)
        except MissingExtraError as error:
            rows.append({"workload": workload.name, "code": code.name, "skipped": str(error)})
    with threads(1):
        turns = take_turns(works, repeats)
        moves = {name: work(1) for name, work in works.items()}
    ours = [turn.nanoseconds for turn in turns["antgym"]]
    for code in codes:
        if code.name in works:
            cost = [turn.nanoseconds for turn in turns[code.name]]
            row: dict[str, Any] = {
                "workload": workload.name,
                "code": code.name,
                "skipped": None,
                "note": code.note,
            }
            row |= _figures(code, workload, cost, ours, moves[code.name])
            row["peak_mb"] = round(peak_megabytes(code, workload)) if memory else None
            rows.append(row)
    return rows


def _figures(
    code: Code, workload: Workload, cost: list[float], ours: list[float], moves: int
) -> dict[str, float | None]:
    whole = moves * workload.iterations / code.iterations(workload) if code.moves else 1.0
    ratio = median(other / own for other, own in zip(cost, ours, strict=True))
    return {
        "ns_per_move": round(median(cost), 1) if code.moves else None,
        "ratio": round(ratio, 2) if code.moves else None,
        "plans_per_second": round(1e9 / (median(cost) * whole), 3),
    }


def thread_gain(workload: Workload, repeats: int) -> dict[str, float]:
    """Return how much more two threads do than one: plan_many, an arithmetic-only kernel, and the share of the two."""
    scenarios, settings, rules = [workload.scenario()] * BATCH, [workload.parameters] * BATCH, workload.rules
    effort: dict[str, Any] = {"ants": workload.ants, "iterations": workload.iterations, "seeds": range(BATCH)}
    rounds = 20_000_000

    def plans(count: int) -> None:
        with threads(count):
            plan_many(scenarios, settings, rules=rules, **effort)

    with ThreadPoolExecutor(2) as pool:

        def sums(count: int) -> None:
            list(pool.map(arithmetic, [2 * rounds // count] * count))

        walls: list[list[float]] = []
        for _ in range(repeats + 1):  # the first compiles
            walls.append([_wall(work, count) for work in (plans, sums) for count in (1, 2)])
    gains = [(one / two, low / high) for one, two, low, high in walls[1:]]
    ours, most = (median(column) for column in zip(*gains, strict=True))
    return {"plan_many": round(ours, 3), "arithmetic": round(most, 3), "share": round(ours / most, 3)}


def _wall(work: Callable[[int], None], count: int) -> float:
    begun = time.perf_counter()
    work(count)
    return time.perf_counter() - begun


def side_by_side(workload: Workload, rows: list[dict[str, Any]], load: float | None) -> Table:
    """Return one workload's table."""
    title = f"{workload.name}, one thread, load average {load} (plain port {plain_digest(workload.world)})"
    table = Table(title=title)
    for heading in (
        "code",
        "ns/path" if workload.world == "discs" else "ns/move",
        "ratio to ours",
        "plans/s",
        "peak MB",
        "note",
    ):
        table.add_column(heading, justify="left" if heading in ("code", "note") else "right")
    for row in rows:
        values = (row.get(name) for name in ("ns_per_move", "ratio", "plans_per_second", "peak_mb"))
        cells = (
            "–" if value is None else f"{value:,.4g}" if value < 1e3 else f"{value:,.0f}" for value in values
        )
        table.add_row(row["code"], *cells, Text(row["skipped"] or row["note"]))
    return table


def run(arguments: Arguments) -> dict[str, Any]:
    """Measure what is asked for, print the tables, write the files, return the figures."""
    workloads = find_workloads(arguments.workload)
    if arguments.repeats < 1:
        raise ParameterError(f"repeats = {arguments.repeats}: at least one turn is needed")
    if arguments.figure is not None and not _of_ants(workloads):
        raise ParameterError("--figure shows how the cost of ants grows; name a workload of theirs too")
    console = Console(width=None if Console().is_terminal else 160)
    load = load_average()
    figures: dict[str, Any] = {
        "plain_port": plain_digest(),
        "load_average": load,
        "repeats": arguments.repeats,
    }
    figures["rows"] = []
    if arguments.memory:
        figures["memory_baseline_mb"] = round(peak_megabytes(None, workloads[0]))
    for workload in workloads:
        rows = measure(workload, arguments.repeats, arguments.memory)
        figures["rows"] += rows
        console.print(side_by_side(workload, rows, load))
    if arguments.memory:
        console.print(f"peak memory of a process that only imports numpy: {figures['memory_baseline_mb']} MB")
    figures |= _beside_the_tables(arguments, workloads, console)
    if arguments.out is not None:
        write_whole(arguments.out, (json.dumps(figures, indent=2) + "\n").encode())
    if arguments.figure is not None:
        write_whole(arguments.figure, figure(figures["growth"]))
    return figures


def _of_ants(workloads: Sequence[Workload]) -> list[Workload]:
    return [workload for workload in workloads if workload.world != "discs"]


def _beside_the_tables(
    arguments: Arguments, workloads: Sequence[Workload], console: Console
) -> dict[str, Any]:
    """Measure growth, a second thread and batches, as far as asked for; print and return the figures."""
    figures: dict[str, Any] = {}
    bases = _of_ants(workloads)[:1]
    for base in bases if arguments.growth or arguments.figure is not None else ():
        figures["growth"] = growth(base, arguments.repeats)
        console.print(to_table(figures["growth"], base))
    for base in bases if arguments.growth else ():
        figures["vast"] = vast(base, arguments.repeats)
        console.print("a cube of 512 cells a side, 20 ants x 20 iterations:", to_sentence(figures["vast"]))
    if arguments.two_threads:
        figures["two_threads"] = gain = thread_gain(workloads[0], arguments.repeats)
        console.print("two threads over one:", ", ".join(f"{name} {value}" for name, value in gain.items()))
    if arguments.envs:
        figures["envs"] = batches.batches(arguments.repeats)
        console.print("a batch of environments:", batches.to_sentence(figures["envs"]))
    return figures


def script() -> None:
    """Run the command line."""
    run(parse(Arguments, None, "python -m experiments.speed"))


if __name__ == "__main__":
    main(script, interrupted="interrupted")
