"""The columns of a board: what each number means, how to sort by it and how to print it, the same on every face."""

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from experiments.board import Board, Row

NONE = "–"


class Column(NamedTuple):
    """One number per row: its heading, what it means, how to sort by it (None last) and how to print it."""

    heading: str
    meaning: str
    value: Callable[["Row", "Board"], float | None]
    text: Callable[[float], str]


def count(value: float) -> str:
    """Print a number of trials: whole where it is whole."""
    return f"{value:,.0f}" if value >= 100 or value == round(value) else f"{value:.1f}"


def seconds(value: float) -> str:
    """Print seconds with about three digits."""
    return f"{value:,.0f}" if value >= 100 else f"{value:.1f}" if value >= 10 else f"{value:.2f}"


def percent(value: float) -> str:
    """Print a share as per cent, one decimal, without a sign before a rounded zero."""
    return f"{100 * value:.1f}".replace("-0.0", "0.0")


COLUMNS = (
    Column(
        "mean gap %",
        "(L − L*) / L* of the path found with the recommended setting, averaged over maps and tuner seeds; no path "
        "counts as 100 %. In brackets its 95 % interval (bootstrap over maps).",
        lambda row, board: row.mean,
        percent,
    ),
    Column(
        "success %",
        "Share of the fresh planner runs that found a path.",
        lambda row, board: row.success,
        lambda value: f"{100 * value:.0f}",
    ),
    Column(
        "trials per map",
        "Planner runs paid to tune for one new map.",
        lambda row, board: row.deploy,
        count,
    ),
    Column(
        "trials in total",
        "Planner runs paid for this whole board: training, once, plus trials per map × number of maps.",
        lambda row, board: row.training + row.deploy * len(board.scenarios),
        count,
    ),
    Column(
        "tuner s",
        "Seconds of the agent's own thinking on one new map.",
        lambda row, board: row.tuner_seconds,
        seconds,
    ),
    Column(
        "planner s",
        "Seconds of planner runs on one new map.",
        lambda row, board: row.planner_seconds,
        seconds,
    ),
    Column(
        "optimism",
        "Gap on fresh seeds minus the gap the agent had observed itself, in percentage points: above 0 it had been "
        "lucky and took luck for quality.",
        lambda row, board: row.optimism,
        lambda value: f"{100 * value:+.1f}".replace("-", "−"),
    ),
)
TIE = "≈ stands for a tie: the 95 % interval of the paired difference to the agent above contains 0."


def cells(row: "Row", board: "Board") -> list[str]:
    """Return a row's printed numbers, one per column; the mean gap with its interval."""
    values = [column.value(row, board) for column in COLUMNS]
    texts = [NONE if v is None else column.text(v) for column, v in zip(COLUMNS, values, strict=True)]
    if row.interval is not None:
        low, high = map(percent, row.interval)
        texts[0] += f" [{low}–{high}]"
    return texts


def size(board: "Board") -> str:
    """Return the line that says how much data a board stands on."""
    return f"{len(board.scenarios)} maps × {board.seeds} tuner seeds, budget {board.budget:,} trials per map"
