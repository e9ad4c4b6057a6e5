"""The four tables: three of the first draw beside the paper's, the fourth of all draws."""

from collections.abc import Sequence

import numpy as np

from experiments.tables.liu2020.draw import MAPS, Answer, Draw
from experiments.tables.liu2020.findings import Standing
from experiments.tables.liu2020.methods import METHODS, RUNS
from experiments.tables.report import percent
from experiments.tables.sheet import table

PAPER_TABLE_1 = (
    (None, -0.0034, 0.1077, -0.00038, 0.0188),
    (0.0207, None, 0.1077, 0.0015, -0.0434),
    (-0.0506, 0.1167, None, -0.0122, 0.0048),
    (0.0107, 0.0229, 0.1156, None, 0.0100),
    (-0.0061, 0.0302, 0.0595, 0.0109, None),
)
PAPER_TABLE_2 = (0.0254, 0.0679, 0.1131, -0.0245, 0.0542)
SOURCES = tuple(f"map{i}" for i in range(1, MAPS))
NOTHING = "–"


def table_1(draw: Draw) -> str:
    """Return the transfers between the sources."""
    rows = [
        [SOURCES[i]]
        + [NOTHING if i == j else f"{value:+.4f} ({PAPER_TABLE_1[i][j]:+.4f})" for j, value in enumerate(row)]
        for i, row in enumerate(draw.transfers)
    ]
    return table(["", *SOURCES], rows)


def table_2(draw: Draw) -> str:
    """Return the transfers to the target."""
    rows = [
        [who, *(f"{value:+.4f}" for value in row)]
        for who, row in (("ours", draw.to_target), ("paper", PAPER_TABLE_2))
    ]
    return table(["", *SOURCES], rows)


def table_3(draw: Draw) -> str:
    """Return what every method found for the target of one draw."""
    headings = (
        *("method", "α", "β", "ρ", "Q", "evaluations", "time/s", "paper's time/s", "ratio"),
        *("length/mm ± sd", "solved", "gap %", "paper's length/mm"),
    )
    exact = (
        *("exact planner", *NOTHING * 4, "0", *NOTHING * 3),
        *(f"{draw.optimum:.2f}", f"{RUNS}/{RUNS}", "0.00", NOTHING),
    )
    return table(headings, [*map(_row_3, draw.answers), exact])


def _row_3(answer: Answer) -> tuple[str, ...]:
    method = next(each for each in METHODS if each.label == answer.method)
    found = [length for length in answer.lengths if length is not None]
    ratio = None if method.seconds is None else method.seconds / max(answer.seconds, 1e-6)
    return (
        method.label,
        *(f"{value:.4g}" for value in answer.values),
        f"{answer.evaluations:,}",
        f"{answer.seconds:.2f}",
        *_paper_time(method.seconds, ratio),
        f"{np.mean(found):.2f} ± {np.std(found):.2f}" if found else NOTHING,
        f"{len(found)}/{RUNS}",
        f"{100 * np.mean(answer.gaps):.2f}",
        f"{method.length:.2f}" if method.length else NOTHING,
    )


def table_4(standings: Sequence[Standing]) -> str:
    """Return what every method is worth over all draws."""
    headings = (
        *("method", "gap / %", "less transfer (14) / points", "solved / %", "evaluations of the target"),
        *("of other maps, before", "time/s", "paper's time/s", "ratio"),
    )
    exact = ("exact planner", "0.0", NOTHING, "100", "0", "0", *NOTHING * 3)
    return table(headings, [*map(_row_4, standings), exact])


def _row_4(row: Standing) -> tuple[str, ...]:
    return (
        row.method.label,
        percent(row.gap),
        percent(row.difference, sign="+") if row.difference else NOTHING,
        f"{100 * row.solved:.0f}",
        f"{row.evaluations:,.0f}",
        f"{row.before:,.0f}",
        f"{row.seconds:.2f}",
        *_paper_time(row.method.seconds, row.ratio),
    )


def _paper_time(seconds: float | None, ratio: float | None) -> tuple[str, str]:
    if seconds is None or ratio is None:
        return NOTHING, NOTHING
    return f"{seconds:,.0f}", f"{ratio:,.0f}x"
