"""The numbers that a page's script draws: gaps and targets over budgets by track, performance profiles by board."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from experiments.board import EXACT, Board, Row
from experiments.report.hues import Hue
from experiments.statistics import performance_profile, targets_reached

POINTS = 120
LOWEST = 1e-3  # gap at which a profile begins at the latest; its axis is logarithmic
DIGITS = 4


def anytime(boards: Sequence[Board], hues: dict[str, Hue]) -> list[dict[str, Any]]:
    """Return one curve a name: budgets, mean gaps, and the ends of their 95 % intervals where there are any.

    Args:
        boards: of one track.
        hues: of their rows.
    """
    return [_gaps(hues[name].number, rows) for name, rows in _by_name(boards).items()]


def reached(boards: Sequence[Board], hues: dict[str, Hue]) -> list[dict[str, Any]]:
    """Return one curve a name: budgets, and the mean share of all (map, target) within reach, with its interval's ends.

    Args:
        boards: of one track, on the same maps, two or more.
        hues: of their rows.
    """
    return [_shares_reached(hues[name].number, rows) for name, rows in _by_name(boards).items()]


def _by_name(boards: Sequence[Board]) -> dict[str, dict[int, Row]]:
    """Return the rows of all boards but the exact one's, by name and then by budget, smallest first."""
    boards = sorted(boards, key=lambda board: board.budget)
    names = dict.fromkeys(row.name for board in boards for row in board.ranked if row.name != EXACT)
    return {
        name: {board.budget: row for board in boards for row in board.rows if row.name == name}
        for name in names
    }


def _gaps(agent: int, rows: dict[int, Row]) -> dict[str, Any]:
    ends = [row.interval or (row.mean, row.mean) for row in rows.values()]
    return {
        "agent": agent,
        "budgets": list(rows),
        "means": _short([row.mean for row in rows.values()]),
        "lows": _short([low for low, _ in ends]),
        "highs": _short([high for _, high in ends]),
    }


def _shares_reached(agent: int, rows: dict[int, Row]) -> dict[str, Any]:
    band = targets_reached(np.stack([row.gaps for row in rows.values()], axis=-1))
    return {
        "agent": agent,
        "budgets": list(rows),
        "means": _short(band.mean),
        "lows": _short(band.low),
        "highs": _short(band.high),
    }


def profile(board: Board, hues: dict[str, Hue]) -> dict[str, Any]:
    """Return the gaps of a board's axis, and for every row the share of its runs with at most that gap.

    Args:
        board: of two maps or more; one has no band.
        hues: of its rows.
    """
    rows = [row for row in board.ranked if row.name != EXACT]
    taus = _taus(rows)
    return {"gaps": _short(taus), "rows": [_shares(row, taus, hues[row.name]) for row in rows]}


def _shares(row: Row, taus: NDArray[np.float64], hue: Hue) -> dict[str, Any]:
    band = performance_profile(row.gaps, taus)
    return {
        "agent": hue.number,
        "shares": _short(band.mean),
        "lows": _short(band.low),
        "highs": _short(band.high),
    }


def _taus(rows: Sequence[Row]) -> NDArray[np.float64]:
    gaps = np.concatenate([np.ravel(row.gaps) for row in rows]) if rows else np.ones(1)
    low = max(LOWEST, float(np.quantile(gaps, 0.002)) * 0.9)
    return np.geomspace(min(low, 0.5), max(1.0, float(gaps.max())), POINTS)


def _short(values: Sequence[float] | NDArray[np.float64]) -> list[float]:
    return [float(f"{value:.{DIGITS}g}") for value in values]
