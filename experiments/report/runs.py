"""The ledger's rows behind the numbers of a page."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from antgym.errors import LedgerError
from antgym.tuning.kept import KeptRun
from experiments.board import Board, Row

TOLERANCE = 1e-9
DIGITS = 5


def behind(
    board: Board, row: Row, scenario: int, seed: int, runs: Mapping[str, KeptRun]
) -> dict[str, Any] | None:
    """Return what a page shows of the run behind a gap; None for a reference that was computed and not run.

    Args:
        board: of the gap.
        row: of the board.
        scenario: index of the map.
        seed: index of the tuner's seed.
        runs: of the ledger, by key.

    Raises:
        LedgerError: if an agent's gap has no finished run, or its run has another gap.
    """
    key, gap = board.key(row.name, board.scenarios[scenario], seed), row.gaps[scenario][seed]
    run = runs.get(key)
    if run is None or run.outcome is None:
        if row.kind == "reference":
            return None
        raise LedgerError(f"{board.title}: the ledger has no finished run {key!r} for a gap of {gap}")
    found = float(np.mean(run.outcome.gaps))
    if abs(found - gap) > TOLERANCE:
        raise LedgerError(
            f"{board.title}: run {key!r} has a gap of {found} in the ledger, {gap} on the board"
        )
    return {
        "unit": _short(run.outcome.unit),
        "lengths": _short(run.outcome.lengths),
        "gaps": _short(run.outcome.gaps),
        "failure": run.outcome.failure,
        "trials": [_short([*r.trial.unit, r.trial.cost, r.length]) for r in run.records],
    }


def _short(numbers: Sequence[float]) -> list[float | None]:
    return [float(f"{number:.{DIGITS}g}") if math.isfinite(number) else None for number in numbers]
