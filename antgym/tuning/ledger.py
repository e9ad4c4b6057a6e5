"""The ledger: an append-only record of paid trials that survives kill -9; resuming is replaying.

A folder holds ``trials.jsonl`` (deterministic fields only: two runs are equal when its sorted lines are),
``timing.jsonl`` (seconds) and ``manifest.json`` (what ran, with which versions, where); docs/ledgers.md lists the
fields.

What is on disk when: a batch of trials is one write and one fsync before the agent hears of it, and so are the batches
of runs that tune in lock-step, round by round; then their outcomes, and their seconds. A manifest is synced, put in
the place of the one before, and then its folder is synced. So neither a killed process nor a lost power takes a trial
that anybody was told of, as far as the disk keeps its word.
A line cut short by a crash was told to nobody; it is dropped, and said to be, when the ledger is opened again. A batch
that does not fit on the disk is taken back as a whole. A lock on ``trials.jsonl`` keeps a second process out.

Schema 2 writes planner seeds, 64 bits, as strings such as "0x00f1…", for readers of JSON that know numbers as doubles
would round them; schema 1 wrote them as numbers. A ledger goes on in the schema that it was begun in.
"""

import fcntl
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager
from pathlib import Path
from types import TracebackType
from typing import Any, NamedTuple

from numpy.typing import ArrayLike

from antgym.errors import LedgerError
from antgym.tuning.kept import (
    TRIALS,
    KeptRun,
    Outcome,
    enter,
    enter_fields,
    outcome_fields,
    read_runs,
    trial_fields,
)
from antgym.tuning.lines import append, mend, read_fields
from antgym.tuning.manifest import MANIFEST, SCHEMA, Manifest, read_manifest
from antgym.tuning.session import Record
from antgym.tuning.traces import copy_traces, write_trace

__all__ = ["MANIFEST", "SCHEMA", "TIMING", "TRIALS", "KeptRun", "Ledger", "LedgerRun", "Outcome", "read_runs"]
TIMING = "timing.jsonl"


class LedgerRun(KeptRun):
    """A run of an open ledger: its recorded trials, and where new ones go."""

    def __init__(self, ledger: "Ledger", key: str) -> None:
        super().__init__(key)
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
                    f"now it is {now}{self._ledger.changes()}; restore what changed or use another folder"
                )
        return record

    def append(self, records: Sequence[Record]) -> None:
        """Write trials; on return they are on disk, unless they are held."""
        self._ledger.write(self._trial_lines(records), lambda: self.records.extend(records))

    def finish(self, outcome: Outcome) -> None:
        """Write how the run ended; on return it is on disk, unless it is held."""
        self._ledger.write([self._outcome_line(outcome)], lambda: setattr(self, "outcome", outcome))

    def hold(self) -> AbstractContextManager[None]:
        """Let what is written within be one write of the ledger, of this run and of others."""
        return self._ledger.hold()

    def lacks(self, other: KeptRun, folder: Path) -> list[dict[str, Any]]:
        """Return the lines of what a folder's ledger holds more of this run; LedgerError where they do not agree."""
        shorter, longer = sorted((self, other), key=lambda run: (run.outcome is not None, len(run.records)))
        known = len(shorter.records) if shorter.outcome is None else len(longer.records)
        if longer.records[:known] != shorter.records or shorter.outcome not in (None, longer.outcome):
            raise LedgerError(
                f"run {self.key!r} is another one in {self._ledger.folder} than in {folder}; one of the two was made "
                "with other code or libraries: remove its lines there and play it again"
            )
        lines = self._trial_lines(other.records[len(self.records) :])
        if self.outcome is None and other.outcome is not None:
            lines.append(self._outcome_line(other.outcome))
        return lines

    def _trial_lines(self, records: Sequence[Record]) -> list[dict[str, Any]]:
        schema = self._ledger.schema
        return [{"run": self.key, "kind": "trial", **trial_fields(record, schema)} for record in records]

    def _outcome_line(self, outcome: Outcome) -> dict[str, Any]:
        return {"run": self.key, "kind": "outcome", **outcome_fields(outcome)}

    @property
    def traced(self) -> bool:
        """Whether the ledger keeps traces."""
        return self._ledger.traces

    def trace(self, best: ArrayLike) -> None:
        """Write the (fresh, iterations) best lengths so far of the runs that judge the recommendation."""
        write_trace(self._ledger.folder, self.key, best)

    def time(self, **seconds: float) -> None:
        """Write seconds spent, apart from the deterministic record."""
        rounded = {name: round(value, 6) for name, value in seconds.items()}
        self._ledger.write_timing({"run": self.key, **rounded})


class _Held(NamedTuple):
    """What is not on disk yet: lines of trials, of seconds, and who takes note of the trials when they are."""

    trials: list[Mapping[str, Any]]
    timing: list[Mapping[str, Any]]
    then: list[Callable[[], None]]


class Ledger:
    """An open ledger folder; one process at a time. Use it as a context manager.

    Args:
        folder: created where absent.
        config: what is run, JSON; a folder that holds trials of another config is refused.
        versions: library versions, kept from the first trial on; changes are named when a replay differs.
        facts: anything else worth keeping (commit, CPU, threads), JSON.
        traces: whether runs leave traces, see :mod:`antgym.tuning.traces`.

    Raises:
        LedgerError: if the folder belongs to another config or schema, is in use, or holds a damaged line, or trials
            without a manifest.
    """

    def __init__(
        self,
        folder: Path | str,
        config: Mapping[str, Any],
        versions: Mapping[str, str],
        facts: Mapping[str, Any] | None = None,
        *,
        traces: bool = False,
    ) -> None:
        self.folder, self.traces = Path(folder), traces
        self._holds, self._held = 0, _Held([], [], [])
        with ExitStack() as files:
            try:
                self.folder.mkdir(parents=True, exist_ok=True)
                self._trials = files.enter_context((self.folder / TRIALS).open("a+b", buffering=0))
                self._lock()
                self._timing = files.enter_context((self.folder / TIMING).open("a+b", buffering=0))
            except OSError as error:
                raise LedgerError(f"{self.folder} cannot hold a ledger: {error}") from None
            self._require_manifest()
            self._manifest = Manifest(self.folder, config, versions, facts or {}, anew=not self._begun())
            mend(self._timing)
            self._runs: dict[str, LedgerRun] = {}
            enter(mend(self._trials), self.folder, self.run)
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
        return self._manifest.fields

    @property
    def schema(self) -> int:
        """In which the ledger was begun, and in which it goes on."""
        return self._manifest.schema

    @property
    def renewed(self) -> bool:
        """Whether the folder was begun with another config, of which nothing ran, and nothing ran since."""
        return self._manifest.renewed and not self._begun()

    def run(self, key: str) -> LedgerRun:
        """Return the run of this key, with what is recorded of it."""
        if key not in self._runs:
            self._runs[key] = LedgerRun(self, key)
        return self._runs[key]

    def runs(self) -> Iterator[LedgerRun]:
        """Return every run recorded or begun."""
        return iter(self._runs.values())

    def changes(self) -> str:
        """Return the clause of a message that names versions that differ from the manifest's."""
        return self._manifest.changes()

    def pin(self, digests: Mapping[str, str]) -> None:
        """Tie the ledger to files by their hashes; LedgerError where one differs from what was pinned before."""
        self._manifest.pin(digests)

    def absorb(self, folder: Path) -> None:
        """Take over what the ledger of a part holds: its trials in one write, all or none, then its seconds.

        What is here already is not written again, so that a part may be absorbed twice, or while it goes on.

        Raises:
            LedgerError: if the part belongs to another config or other files, or tells of a run what this one does not.
        """
        manifest = read_manifest(folder)
        self._manifest.require_part(manifest, folder)
        lines = [
            line for part in read_runs(folder).values() for line in self.run(part.key).lacks(part, folder)
        ]
        self._manifest.take_in(manifest)
        copy_traces(folder, self.folder)
        self.write(lines, lambda: self._enter(lines))
        done = {line["run"] for line in lines if line["kind"] == "outcome"}
        timing = read_fields(folder / TIMING, "run")
        self.write_timing(*(line for line in timing if line["run"] in done))

    def _enter(self, lines: Sequence[Mapping[str, Any]]) -> None:
        for line in lines:
            enter_fields(self.run(line["run"]), line)

    @contextmanager
    def hold(self) -> Iterator[None]:
        """Let what is written within be one write: on disk, all or nothing, when the outermost block ends.

        A hundred runs in lock-step so wait for the disk once a round. A block that raises leaves nothing.
        """
        self._holds += 1
        try:
            yield
            if self._holds == 1:
                self._flush()
        finally:
            self._holds -= 1
            if not self._holds:
                self._held = _Held([], [], [])

    def write(self, lines: Sequence[Mapping[str, Any]], then: Callable[[], None]) -> None:
        """Append lines to the trials and wait for the disk; then call what takes note of them."""
        with self.hold():
            self._held.trials.extend(lines)
            self._held.then.append(then)

    def write_timing(self, *lines: Mapping[str, Any]) -> None:
        """Append lines of seconds."""
        with self.hold():
            self._held.timing.extend(lines)

    def _flush(self) -> None:
        append(self._trials, self._held.trials)
        for then in self._held.then:
            then()
        append(self._timing, self._held.timing, "the trials of this batch are kept, their seconds are not")

    def _require_manifest(self) -> None:
        """Refuse trials of which nothing says what they are of: any config could be taken for theirs."""
        if self._begun() and not (self.folder / MANIFEST).exists():
            raise LedgerError(
                f"{self.folder} holds {TRIALS} without the {MANIFEST} that says what was run; put it back, or use "
                "another folder"
            )

    def _begun(self) -> bool:
        return os.fstat(self._trials.fileno()).st_size > 0

    def _lock(self) -> None:
        try:
            fcntl.flock(self._trials, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise LedgerError(
                f"{self.folder} is in use by another process; wait for it or use another folder"
            ) from None
