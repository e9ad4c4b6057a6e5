"""The ledger's rows behind a site: trials and outcomes by run, read as data while the ledger may still be open."""

import json
from collections.abc import Container, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from antgym.errors import LedgerError
from antgym.tuning.ledger import TRIALS
from experiments.board import Board, Row

TOLERANCE = 1e-9
DIGITS = 5


class Trial(NamedTuple):
    """A paid run: the setting in [0, 1]^d, what the agent was told of it, and the length in world units or None."""

    unit: tuple[float, ...]
    cost: float
    length: float | None


class Run:
    """What the ledger holds of one agent on one map under one seed."""

    def __init__(self) -> None:
        self.trials: list[Trial] = []
        self.outcome: dict[str, Any] | None = None

    def data(self) -> dict[str, Any]:
        """Return what the page shows of it, rounded for that."""
        assert self.outcome is not None
        return {
            "unit": _short(self.outcome["unit"]),
            "lengths": _short(self.outcome["lengths"]),
            "gaps": _short(self.outcome["gaps"]),
            "trials": [_short([*trial.unit, trial.cost, trial.length]) for trial in self.trials],
        }


def read_runs(folder: Path, keys: Container[str]) -> dict[str, Run]:
    """Return the runs of these keys in a ledger's folder; a last line cut short is not there yet.

    Raises:
        LedgerError: if there is no ledger or a line is damaged.
    """
    runs: dict[str, Run] = {}
    for number, line in _lines(folder / TRIALS):
        try:
            fields = json.loads(line)
            if fields["run"] in keys:
                _enter(runs.setdefault(fields["run"], Run()), fields)
        except (ValueError, KeyError, TypeError) as error:
            raise LedgerError(f"{folder / TRIALS}, line {number} is damaged ({error})") from None
    return runs


def behind(board: Board, row: Row, scenario: int, seed: int, runs: dict[str, Run]) -> Run | None:
    """Return the run behind a gap of a board; None for a reference that was computed and not run.

    Raises:
        LedgerError: if an agent's gap has no finished run, or another one.
    """
    key = board.key(row.name, board.scenarios[scenario], seed)
    run, gap = runs.get(key), row.gaps[scenario][seed]
    if run is None or run.outcome is None:
        if row.kind == "reference":
            return None
        raise LedgerError(f"{board.title}: the ledger has no finished run {key!r} for a gap of {gap}")
    found = float(np.mean(run.outcome["gaps"]))
    if abs(found - gap) > TOLERANCE:
        raise LedgerError(
            f"{board.title}: run {key!r} has a gap of {found} in the ledger, {gap} on the board"
        )
    return run


def _lines(path: Path) -> Iterator[tuple[int, bytes]]:
    try:
        with path.open("rb") as file:
            yield from ((i, line) for i, line in enumerate(file, start=1) if line.endswith(b"\n"))
    except OSError as error:
        raise LedgerError(f"{path} cannot be read: {error.strerror}; a page is made from a ledger") from None


def _enter(run: Run, fields: dict[str, Any]) -> None:
    if fields["kind"] == "outcome":
        run.outcome = {name: fields[name] for name in ("unit", "lengths", "gaps")}
    else:
        run.trials.append(Trial(tuple(fields["unit"]), fields["cost"], fields["length"]))


def _short(numbers: list[float | None]) -> list[float | None]:
    return [None if number is None else float(f"{number:.{DIGITS}g}") for number in numbers]
