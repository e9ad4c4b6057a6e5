"""The ledger: an append-only record of paid trials that survives kill -9; resuming is replaying.

A folder holds ``trials.jsonl`` (deterministic fields only: two runs are equal when its sorted lines are),
``timing.jsonl`` (seconds) and ``manifest.json`` (what ran, with which versions, where). A batch of lines is
written, flushed and fsynced before the agent hears of it; a line cut short by a crash was never told to anybody
and is dropped when the ledger is opened again.
"""

import fcntl
import json
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from io import FileIO
from pathlib import Path
from types import TracebackType
from typing import Any, NamedTuple

from antgym.errors import LedgerError
from antgym.tuning.session import Record, Trial

SCHEMA = 1
TRIALS, TIMING, MANIFEST = "trials.jsonl", "timing.jsonl", "manifest.json"


class Outcome(NamedTuple):
    """How a run ended: the recommended setting, and the lengths and gaps of its fresh, uncharged runs.

    Where the agent failed, ``failure`` says how; then nothing was recommended, ``unit`` is the published default, and
    every fresh run counts as one that found no path.
    """

    unit: tuple[float, ...]
    lengths: tuple[float, ...]
    gaps: tuple[float, ...]
    failure: str = ""


class LedgerRun:
    """One agent on one problem with one seed: its recorded trials, and where new ones go."""

    def __init__(self, ledger: "Ledger", key: str, records: list[Record], outcome: Outcome | None) -> None:
        self.key = key
        self.records = records
        self.outcome = outcome
        self._ledger = ledger

    def replay(self, index: int, unit: tuple[float, ...], seed: int) -> Record | None:
        """Return recorded trial ``index``; LedgerError where agent or problem now have another setting or seed."""
        if index >= len(self.records):
            return None
        record = self.records[index]
        for what, then, now in (("setting", record.trial.unit, unit), ("planner seed", record.seed, seed)):
            if then != now:
                raise LedgerError(
                    f"run {self.key!r}, trial {index}: the ledger in {self._ledger.folder} holds the {what} {then}, "
                    f"now it is {now}{self._ledger.version_changes()}; restore what changed or use another folder"
                )
        return record

    def append(self, records: Sequence[Record]) -> None:
        """Write trials; on return they are on disk."""
        self._ledger.write([{"run": self.key, "kind": "trial", **_record_fields(r)} for r in records])
        self.records.extend(records)

    def finish(self, outcome: Outcome) -> None:
        """Write how the run ended; on return it is on disk."""
        lengths = [_number(length) for length in outcome.lengths]
        fields: dict[str, Any] = {"unit": list(outcome.unit), "lengths": lengths, "gaps": list(outcome.gaps)}
        if outcome.failure:
            fields["failure"] = outcome.failure
        self._ledger.write([{"run": self.key, "kind": "outcome", **fields}])
        self.outcome = outcome

    def time(self, **seconds: float) -> None:
        """Write seconds spent, apart from the deterministic record."""
        self._ledger.write_timing(
            {"run": self.key, **{name: round(value, 6) for name, value in seconds.items()}}
        )


class Ledger:
    """An open ledger folder; one process at a time. Use it as a context manager.

    Args:
        folder: created where absent.
        config: what is run, JSON; a folder made with another config is refused.
        versions: library versions, kept from the first opening; changes are named when a replay differs.
        facts: anything else worth keeping (commit, CPU, threads), JSON.

    Raises:
        LedgerError: if the folder belongs to another config or schema, is in use, or holds a damaged line.
    """

    def __init__(
        self,
        folder: Path | str,
        config: Mapping[str, Any],
        versions: Mapping[str, str],
        facts: Mapping[str, Any] | None = None,
    ) -> None:
        self.folder = Path(folder)
        self._versions = dict(versions)
        with ExitStack() as files:
            try:
                self.folder.mkdir(parents=True, exist_ok=True)
                self._trials = files.enter_context((self.folder / TRIALS).open("a+b", buffering=0))
                self._lock()
                self._timing = files.enter_context((self.folder / TIMING).open("a+b", buffering=0))
                self._manifest = self._open_manifest(dict(config), dict(facts or {}))
            except OSError as error:
                raise LedgerError(f"{self.folder} cannot hold a ledger: {error}") from None
            _whole_lines(self._timing)
            self._runs = self._load()
            self._files = files.pop_all()

    def __enter__(self) -> "Ledger":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._files.close()

    @property
    def manifest(self) -> dict[str, Any]:
        """The manifest as it lies in the folder."""
        return self._manifest

    def run(self, key: str) -> LedgerRun:
        """Return the run of this key, with what is recorded of it."""
        if key not in self._runs:
            self._runs[key] = LedgerRun(self, key, [], None)
        return self._runs[key]

    def runs(self) -> Iterator[LedgerRun]:
        """Return every run recorded or begun."""
        return iter(self._runs.values())

    def version_changes(self) -> str:
        """Return the clause of a message that names versions that differ from the manifest's, or nothing."""
        then = self._manifest["versions"]
        names = sorted(set(then) | set(self._versions))
        changes = [
            f"{n} {then.get(n)} -> {self._versions.get(n)}"
            for n in names
            if then.get(n) != self._versions.get(n)
        ]
        return f" (versions changed: {', '.join(changes)})" if changes else " (no library version changed)"

    def write(self, lines: Sequence[Mapping[str, Any]]) -> None:
        """Append lines to the trials and wait for the disk."""
        _append(self._trials, lines)

    def write_timing(self, line: Mapping[str, Any]) -> None:
        """Append a line of seconds."""
        _append(self._timing, [line])

    def _lock(self) -> None:
        try:
            fcntl.flock(self._trials, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise LedgerError(
                f"{self.folder} is in use by another process; wait for it or use another folder"
            ) from None

    def _open_manifest(self, config: dict[str, Any], facts: dict[str, Any]) -> dict[str, Any]:
        path = self.folder / MANIFEST
        config = json.loads(json.dumps(config))
        if not path.exists():
            manifest = {"schema": SCHEMA, "config": config, "versions": self._versions, **facts}
            self._write_manifest(manifest)
            return manifest
        try:
            found: dict[str, Any] = json.loads(path.read_text())
        except ValueError as error:
            raise LedgerError(f"{path} is damaged ({error}); use another folder") from None
        if found.get("schema") != SCHEMA:
            raise LedgerError(
                f"{path}: schema {found.get('schema')}, this antgym reads {SCHEMA}; use another folder"
            )
        if found["config"] != config:
            keys = sorted(k for k in {*found["config"], *config} if found["config"].get(k) != config.get(k))
            then = "; ".join(f"{key}: {found['config'].get(key)}, now {config.get(key)}" for key in keys)
            raise LedgerError(
                f"{self.folder} was begun with other settings ({then}); use another folder, or what it was begun with"
            )
        return found

    def pin(self, digests: Mapping[str, str]) -> None:
        """Tie the ledger to files by their hashes; LedgerError where one differs from what was pinned before."""
        pinned = self._manifest.setdefault("pinned", {})
        for name, digest in digests.items():
            if pinned.setdefault(name, digest) != digest:
                raise LedgerError(
                    f"{name} is not the file that the runs in {self.folder} were made with; restore it or use "
                    "another folder"
                )
        self._write_manifest(self._manifest)

    def _write_manifest(self, manifest: dict[str, Any]) -> None:
        scratch = (self.folder / MANIFEST).with_suffix(".tmp")
        scratch.write_text(json.dumps(manifest, indent=2) + "\n")
        os.replace(scratch, self.folder / MANIFEST)

    def _load(self) -> dict[str, LedgerRun]:
        runs: dict[str, LedgerRun] = {}
        for number, line in enumerate(_whole_lines(self._trials), start=1):
            try:
                fields = json.loads(line)
                run = runs.setdefault(fields["run"], LedgerRun(self, fields["run"], [], None))
                _enter(run, fields)
            except (ValueError, KeyError, TypeError) as error:
                place = f"{self.folder / TRIALS}, line {number}"
                raise LedgerError(
                    f"{place} is damaged ({error}); remove this line's run or use another folder"
                ) from None
        return runs


def _whole_lines(file: FileIO) -> list[bytes]:
    """Return a file's lines; one that a crash cut short is dropped: nobody was told of it."""
    file.seek(0)
    data = file.read()
    whole = data.rfind(b"\n") + 1
    if whole < len(data):
        file.truncate(whole)
    return data[:whole].splitlines()


def _append(file: FileIO, lines: Sequence[Mapping[str, Any]]) -> None:
    """Add lines and wait for the disk; where that fails, the file is what it was before."""
    before = file.seek(0, os.SEEK_END)
    rest = b"".join(json.dumps(line, separators=(",", ":")).encode() + b"\n" for line in lines)
    try:
        while rest:
            rest = rest[file.write(rest) :]
        os.fsync(file.fileno())
    except BaseException as error:
        file.truncate(before)
        if isinstance(error, OSError):
            advice = "nothing of this batch is kept; make room and give the same command again"
            raise LedgerError(f"{file.name!s} cannot be written: {error.strerror}; {advice}") from None
        raise


def _record_fields(record: Record) -> dict[str, Any]:
    trial = record.trial
    return {
        "index": trial.index,
        "unit": list(trial.unit),
        "cost": trial.cost,
        "work": trial.work,
        "length": _number(record.length),
        "seed": record.seed,
    }


def _enter(run: LedgerRun, fields: Mapping[str, Any]) -> None:
    if fields["kind"] == "outcome":
        lengths = tuple(_length(length) for length in fields["lengths"])
        unit, gaps = tuple(fields["unit"]), tuple(fields["gaps"])
        run.outcome = Outcome(unit, lengths, gaps, fields.get("failure", ""))
        return
    if fields["index"] != len(run.records):
        raise ValueError(f"trial {fields['index']} where {len(run.records)} was due")
    trial = Trial(fields["index"], tuple(fields["unit"]), fields["cost"], fields["work"])
    run.records.append(Record(trial, _length(fields["length"]), fields["seed"]))


def _number(length: float) -> float | None:
    return length if length < float("inf") else None  # JSON has no infinity


def _length(value: float | None) -> float:
    return float("inf") if value is None else value
