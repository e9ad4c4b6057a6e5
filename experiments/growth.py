"""How cost grows: CPU time per ant move as ants, iterations, layers or the world grow eightfold.

A larger world costs more per move in two ways that only a table of both tells apart: more moves lead to cells where
no ant has been, which are looked at for the first time, and more memory is in use. So every figure stands beside that
of a colony whose ants follow one another (q0 = 1), whose moves are all revisits.
"""

import io
import json
import subprocess
import sys
from pathlib import Path
from statistics import median
from typing import Any

from rich.table import Table

from antgym.bench import PARAMETERS, Work, Workload, our_planner, take_turns, threads, vast_scenario
from antgym.errors import MissingExtraError

ROOT = Path(__file__).parents[1]
FACTORS = (1, 2, 4, 8)
AXES = ("ants", "iterations", "layers", "world")
VAST_EFFORT = {"ants": 20, "iterations": 20}


def grown(base: Workload, axis: str, factor: int) -> Workload:
    """Return a workload with one measure multiplied; ``"world"`` grows along all three axes."""
    cells = factor * (base.size - 1)
    change: dict[str, Any] = {
        "ants": {"ants": factor * base.ants},
        "iterations": {"iterations": factor * base.iterations},
        "layers": {"layers": cells},
        "world": {"size": cells + 1},
    }[axis]
    return base._replace(name=f"{axis} x{factor}", **change)


def growth(base: Workload, repeats: int) -> list[dict[str, Any]]:
    """Return one row an axis: nanoseconds per move and per revisit at every factor, and each over the ungrown one."""
    kinds = {"move": 0.0, "revisit": 1.0}
    sizes = {
        (axis, factor, kind): grown(base, axis, factor)._replace(name=f"{axis} x{factor} {kind}", q0=q0)
        for axis in AXES
        for factor in FACTORS
        for kind, q0 in kinds.items()
    }
    with threads(1):
        turns = take_turns({w.name: our_planner(w) for w in sizes.values()}, repeats, least=0.01)
    rows = []
    for axis in AXES:
        row: dict[str, Any] = {"axis": axis}
        for kind, suffix in (("move", ""), ("revisit", "_revisit")):
            columns = [[t.nanoseconds for t in turns[sizes[axis, factor, kind].name]] for factor in FACTORS]
            ratios = [median(b / a for a, b in zip(columns[0], column, strict=True)) for column in columns]
            row[f"ns_per_{kind}"] = [round(median(column), 1) for column in columns]
            row[f"ratio{suffix}"] = [round(ratio, 3) for ratio in ratios]
        rows.append(row)
    return rows


def to_table(rows: list[dict[str, Any]], base: Workload) -> Table:
    """Return the table that the terminal shows: nanoseconds per move, in brackets over the ungrown one."""
    table = Table(title=f"ns per move as one measure grows from {base.name}, size {base.size}")
    for heading in ("grows", "moves"):
        table.add_column(heading)
    for factor in FACTORS:
        table.add_column(f"×{factor}", justify="right")
    for row in rows:
        for label, kind, ratio in (
            ("all", "ns_per_move", "ratio"),
            ("revisits", "ns_per_revisit", "ratio_revisit"),
        ):
            cells = zip(row[kind], row[ratio], strict=True)
            table.add_row(row["axis"], label, *(f"{ns:.1f} ({over:.2f})" for ns, over in cells))
    return table


def vast(base: Workload, repeats: int) -> dict[str, float]:
    """Return what a plan on a cube of 512 cells a side costs: time per move and revisit beside ``base``, and memory."""
    from antgym.planners.colony import plan

    scenario = vast_scenario()

    def on_the_cube(q0: float) -> Work:
        effort: dict[str, Any] = {"rules": base._replace(q0=q0).rules, **VAST_EFFORT}
        return lambda seed: plan(scenario, PARAMETERS, seed=seed, **effort).moves

    works = {"move": on_the_cube(0.0), "revisit": on_the_cube(1.0)}
    works |= {
        f"base_{kind}": our_planner(base._replace(q0=q0)) for kind, q0 in (("move", 0.0), ("revisit", 1.0))
    }
    with threads(1):
        turns = take_turns(works, repeats, least=0.01)
    figures = {
        f"ns_per_{name}": round(median(t.nanoseconds for t in each), 1) for name, each in turns.items()
    }
    pairs = zip(turns["revisit"], turns["base_revisit"], strict=True)
    figures["ratio_revisit"] = round(median(a.nanoseconds / b.nanoseconds for a, b in pairs), 3)
    return figures | {"added_mb": round(added_megabytes())}


def to_sentence(figures: dict[str, float]) -> str:
    """Return what :func:`vast` measured in words."""
    return (
        f"{figures['ns_per_move']} ns a move, {figures['ns_per_revisit']} a revisit "
        f"({figures['ratio_revisit']} of the standard mountains'), {figures['added_mb']} MB over `import antgym`"
    )


def added_megabytes() -> float:
    """Return by how much a plan on the vast cube, world included, raises the peak memory of a fresh process."""
    script = "from experiments.growth import _added; _added()"
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=True
    )
    return float(json.loads(done.stdout.splitlines()[-1]))


def _added() -> None:
    before = _imported_megabytes()
    from antgym.planners.colony import plan
    from experiments.rivals import resident_megabytes

    plan(vast_scenario(), PARAMETERS, rules="ant_system", **VAST_EFFORT)
    print(json.dumps(resident_megabytes() - before))


def _imported_megabytes() -> float:
    """Return the peak memory of a fresh process that does nothing but import antgym."""
    script = "import antgym; from experiments.rivals import resident_megabytes; print(resident_megabytes())"
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=True
    )
    return float(done.stdout)


def figure(rows: list[dict[str, Any]]) -> bytes:
    """Return the same as a PNG; MissingExtraError if matplotlib is not installed."""
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise MissingExtraError("matplotlib", "viz") from None
    picture = Figure(figsize=(6, 4), layout="constrained")
    axes = picture.subplots()
    for row in rows:
        axes.plot(FACTORS, row["ratio"], marker="o", label=row["axis"])
    axes.axhline(1.0, color="0.8", zorder=0)
    axes.set_xscale("log", base=2)
    axes.set(xlabel="grown by", ylabel="CPU time per move, ×1 = 1", xticks=FACTORS, ylim=(0, None))
    axes.set_xticklabels([f"×{factor}" for factor in FACTORS])
    axes.legend()
    buffer = io.BytesIO()
    picture.savefig(buffer, format="png", dpi=120)
    return buffer.getvalue()
