"""What a ledger keeps: trials and outcomes by run, as objects and as the fields of lines."""

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from antgym.errors import LedgerError
from antgym.tuning.lines import read
from antgym.tuning.manifest import read_manifest
from antgym.tuning.session import Record, Trial

TRIALS = "trials.jsonl"


class Outcome(NamedTuple):
    """How a run ended: the recommended setting, and the lengths and gaps of its fresh, uncharged runs.

    Where the agent failed, ``failure`` says how; then nothing was recommended, ``unit`` is the published default, and
    every fresh run counts as one that found no path.
    """

    unit: tuple[float, ...]
    lengths: tuple[float, ...]
    gaps: tuple[float, ...]
    failure: str = ""


class KeptRun:
    """What a ledger holds of one agent on one problem with one seed.

    Attributes:
        key: how the ledger calls it.
        records: its trials, in order.
        outcome: None as long as it is not finished.
    """

    def __init__(self, key: str) -> None:
        self.key = key
        self.records: list[Record] = []
        self.outcome: Outcome | None = None


def read_runs(folder: Path) -> dict[str, KeptRun]:
    """Return what a ledger holds by key, open in another process or not; nothing is locked, mended or written.

    Raises:
        LedgerError: if the folder holds no ledger that can be read, or a damaged line.
    """
    read_manifest(folder)
    runs: dict[str, KeptRun] = {}

    def run(key: str) -> KeptRun:
        return runs.setdefault(key, KeptRun(key))

    enter(read(folder / TRIALS), folder, run)
    return runs


def enter(lines: Sequence[bytes], folder: Path, run: Callable[[str], KeptRun]) -> None:
    """Enter the lines of a ledger's trials into its runs."""
    for number, line in enumerate(lines, start=1):
        try:
            fields = json.loads(line)
            enter_fields(run(fields["run"]), fields)
        except (ValueError, KeyError, TypeError) as error:
            raise LedgerError(
                f"{folder / TRIALS}, line {number} is damaged ({error}); remove this line's run or use another folder"
            ) from None


def enter_fields(run: KeptRun, fields: Mapping[str, Any]) -> None:
    """Enter one line into its run; ValueError, KeyError or TypeError where it does not fit what is there."""
    if run.outcome is not None:
        raise ValueError(f"a line of {run.key!r} after the one that ends it")
    if fields["kind"] == "outcome":
        lengths = tuple(_length(length) for length in fields["lengths"])
        unit, gaps = tuple(fields["unit"]), tuple(fields["gaps"])
        run.outcome = Outcome(unit, lengths, gaps, fields.get("failure", ""))
        return
    if fields["index"] != len(run.records):
        raise ValueError(f"trial {fields['index']} where {len(run.records)} was due")
    trial = Trial(fields["index"], tuple(fields["unit"]), fields["cost"], fields["work"])
    run.records.append(Record(trial, _length(fields["length"]), _seed(fields["seed"])))


def trial_fields(record: Record, schema: int) -> dict[str, Any]:
    """Return what a line says of a trial."""
    trial = record.trial
    return {
        "index": trial.index,
        "unit": list(trial.unit),
        "cost": trial.cost,
        "work": trial.work,
        "length": _number(record.length),
        "seed": record.seed if schema == 1 else f"{record.seed:#018x}",
    }


def outcome_fields(outcome: Outcome) -> dict[str, Any]:
    """Return what a line says of an outcome."""
    lengths = [_number(length) for length in outcome.lengths]
    fields: dict[str, Any] = {"unit": list(outcome.unit), "lengths": lengths, "gaps": list(outcome.gaps)}
    return {**fields, "failure": outcome.failure} if outcome.failure else fields


def _seed(value: int | str) -> int:
    return value if isinstance(value, int) else int(value, 16)


def _number(length: float) -> float | None:
    return length if length < float("inf") else None  # JSON has no infinity


def _length(value: float | None) -> float:
    return float("inf") if value is None else value
