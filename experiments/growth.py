"""How cost grows: CPU time per ant move as ants, iterations, layers or the world grow eightfold."""

import io
from statistics import median
from typing import Any

from rich.table import Table

from antgym.bench import Workload, our_planner, take_turns, threads
from antgym.errors import MissingExtraError

FACTORS = (1, 2, 4, 8)
AXES = ("ants", "iterations", "layers", "world")


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
    """Return one row an axis: nanoseconds per move at every factor, and each over the ungrown one of its turn."""
    sizes = {(axis, factor): grown(base, axis, factor) for axis in AXES for factor in FACTORS}
    with threads(1):
        turns = take_turns({w.name: our_planner(w) for w in sizes.values()}, repeats, least=0.01)
    rows = []
    for axis in AXES:
        columns = [[turn.nanoseconds for turn in turns[sizes[axis, factor].name]] for factor in FACTORS]
        ratios = [median(b / a for a, b in zip(columns[0], column, strict=True)) for column in columns]
        rows.append(
            {
                "axis": axis,
                "ns_per_move": [round(median(column), 1) for column in columns],
                "ratio": [round(ratio, 3) for ratio in ratios],
            }
        )
    return rows


def to_table(rows: list[dict[str, Any]], base: Workload) -> Table:
    """Return the table that the terminal shows: nanoseconds per move, in brackets over the ungrown one."""
    table = Table(title=f"ns per move as one measure grows from {base.name}, size {base.size}")
    table.add_column("grows")
    for factor in FACTORS:
        table.add_column(f"×{factor}", justify="right")
    for row in rows:
        cells = zip(row["ns_per_move"], row["ratio"], strict=True)
        table.add_row(row["axis"], *(f"{ns:.1f} ({ratio:.2f})" for ns, ratio in cells))
    return table


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
