"""The columns of a board: what each number means, how to sort by it and how to print it, the same on every face."""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

from experiments.board import Board, Row
from experiments.statistics import Estimate

NONE = "–"
TRACKS = {
    "A": ("per map", "Tuned on each map by itself, whatever was learnt before."),
    "B": ("after training", "Trained on other maps before; then no or a few trials on each new map."),
    "C": ("control", "The parameters change on the way, within one run; no trial is paid."),
}
"""Name and meaning of every track."""


def _no_interval(row: Row, board: Board) -> None:  # noqa: ARG001 - a column without one
    return None


class Column(NamedTuple):
    """One number per row.

    Attributes:
        heading: of the column.
        meaning: what the number is.
        value: by which rows are sorted, None last.
        text: how it is printed.
        interval: its 95 % interval, printed in brackets; None where there is none.
        terminal: whether a terminal shows it, too, which has no room for all and for the first one's interval only.
    """

    heading: str
    meaning: str
    value: Callable[[Row, Board], float | None]
    text: Callable[[float], str]
    interval: Callable[[Row, Board], tuple[float, float] | None] = _no_interval
    terminal: bool = True


def count(value: float) -> str:
    """Print a number of trials: whole where it is whole."""
    return f"{value:,.0f}" if value >= 100 or value == round(value) else f"{value:.1f}"


def seconds(value: float) -> str:
    """Print seconds with about three digits."""
    return f"{value:,.0f}" if value >= 100 else f"{value:.1f}" if value >= 10 else f"{value:.2f}"


def percent(value: float) -> str:
    """Print a share as per cent, one decimal, without a sign before a rounded zero."""
    return f"{100 * value:.1f}".replace("-0.0", "0.0")


def signed_share(value: float) -> str:
    """Print a share as whole per cent, with a minus; infinite where a resample had nothing to share."""
    text = f"{value:.0f}".replace("inf", "∞") if math.isinf(value) else f"{round(100 * value):,}"
    return text.replace("-", "−")


COLUMNS = (
    Column(
        "mean gap %",
        "(L − L*) / L* of the path found with the recommended setting, averaged over maps and tuner seeds; no path "
        "counts as 100 %, as does any gap above 100 %. In brackets its 95 % interval (bootstrap over maps).",
        lambda row, board: row.mean,
        percent,
        lambda row, board: row.interval,
    ),
    Column(
        "IQM %",
        "Interquartile mean of the gap: the mean of the middle half of all maps and seeds, which neither the hardest "
        "maps nor the easiest move. In brackets its 95 % interval.",
        lambda row, board: row.interquartile,
        percent,
        lambda row, board: row.interquartile_ends,
        terminal=False,
    ),
    Column(
        "success %",
        "Share of the fresh planner runs that found a path.",
        lambda row, board: row.success,
        lambda value: f"{100 * value:.0f}",
    ),
    Column(
        "closed %",
        "Share that is closed of the gap between the single best static setting (SBS, best_static) and the virtual "
        "best (VBS, a bound): 100 % is the best that anybody recommended on each map, below 0 % is worse than one "
        "setting for all. In brackets its 95 % interval. A dash: there is nothing to close, for on this board VBS is "
        "missing or not told apart from SBS.",
        lambda row, board: _mean(board.closed.get(row.name)),
        signed_share,
        lambda row, board: _ends(board.closed.get(row.name)),
    ),
    Column(
        "P(better) %",
        "Probability of being better than SBS on a map and a seed drawn at random; ties count half. In brackets its "
        "95 % interval.",
        lambda row, board: _mean(board.better.get(row.name)),
        lambda value: f"{100 * value:.0f}",
        lambda row, board: _ends(board.better.get(row.name)),
        terminal=False,
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
        lambda row, board: None if row.training is None else row.training + row.deploy * len(board.scenarios),
        count,
    ),
    Column(
        "tuner s",
        "Seconds of the agent's own thinking on one new map.",
        lambda row, board: row.tuner_seconds,
        seconds,
        terminal=False,
    ),
    Column(
        "planner s",
        "Seconds of planner runs on one new map.",
        lambda row, board: row.planner_seconds,
        seconds,
        terminal=False,
    ),
    Column(
        "optimism",
        "Gap on fresh seeds minus the gap the agent had observed itself, in percentage points: above 0 it had been "
        "lucky and took luck for quality.",
        lambda row, board: row.optimism,
        lambda value: f"{100 * value:+.1f}".replace("-", "−"),
    ),
)
IN_TERMINAL = (
    COLUMNS[0],
    *(column._replace(interval=_no_interval) for column in COLUMNS[1:] if column.terminal),
)
TIE = (
    "≈ stands for a tie: the difference to the agent above, paired by map, may be chance (p > 0.05 after Holm's "
    "correction for all places)."
)


def cells(row: Row, board: Board, columns: Sequence[Column] = COLUMNS) -> list[str]:
    """Return a row's printed numbers, one per column, with their intervals."""
    return [_cell(row, board, column) for column in columns]


def _cell(row: Row, board: Board, column: Column) -> str:
    value, ends = column.value(row, board), column.interval(row, board)
    if value is None:
        return NONE
    if ends is None:
        return column.text(value)
    low, high = map(column.text, ends)
    return f"{column.text(value)} [{low}{' to ' if '−' in low + high else '–'}{high}]"


def _mean(found: Estimate | None) -> float | None:
    return None if found is None else found.mean


def _ends(found: Estimate | None) -> tuple[float, float] | None:
    return None if found is None else (found.low, found.high)


def headline(board: Board) -> str:
    """Return the title of a board among those of other tracks and budgets."""
    return f"{_track(board)}, {_trials(board)} per map" if board.track != "C" else _track(board)


def by_budget_headline(board: Board) -> str:
    """Return the title of the table that shows all budgets of a board's track."""
    return f"{_track(board)}, mean gap % by trials per map"


def _track(board: Board) -> str:
    return f"{board.title}: track {board.track} ({TRACKS[board.track][0]})"


def _trials(board: Board) -> str:
    return "1 trial" if board.budget == 1 else f"{board.budget:,} trials"


def size(board: Board) -> str:
    """Return the line that says how much data a board stands on."""
    if board.track == "C":
        return f"{len(board.scenarios)} maps × {board.seeds} runs, each steered in blocks"
    return f"{len(board.scenarios)} maps × {board.seeds} tuner seeds, budget {_trials(board)} per map"
