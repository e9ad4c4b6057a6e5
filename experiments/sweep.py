"""A leaderboard beyond one process: the same runs on any backend of joblib, or in shards on machines of their own.

    python -m experiments.sweep --preset quick --out out/sweep --backend loky --jobs 8
    python -m experiments.sweep --preset quick --out out/sweep --shard 2/16      # one of a job array's 16 tasks
    python -m experiments.sweep --preset quick --out out/sweep --merge           # when they are done
    python -m experiments.sweep --preset full --dry-run                          # what it would take

Every option of the leaderboard is one here. What comes out is the leaderboard's ledger, line for line, whatever the
backend, the number of jobs and of shards: ``experiments.leaderboard`` with the same options shows it. Given again, a
command goes on where it was; ``experiments.status`` says what is missing.
"""

import fcntl
import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, fields
from pathlib import Path
from shutil import rmtree
from typing import Any

from antgym.console import main, parse, progress
from antgym.errors import AntgymError, LedgerError, MissingExtraError, ParameterError
from antgym.tuning.ledger import MANIFEST, TRIALS, Ledger
from antgym.tuning.manifest import as_json, read_manifest
from experiments import leaderboard, provenance
from experiments.orders import ask, note_broken
from experiments.units import (
    UNITS,
    Shard,
    Unit,
    board_runs,
    finished,
    missing,
    play_unit,
    shard_folders,
    take_in,
    units,
)

PROGRAM = "python -m experiments.sweep"


@dataclass(frozen=True)
class Arguments(leaderboard.Arguments):
    """Run a leaderboard in many processes or on many machines, or go on with one that was stopped."""

    backend: str = "loky"
    """loky: processes here; dask: workers of Dask, here or of --scheduler; any other backend that joblib knows."""
    jobs: int = -1
    """Workers at a time; -1: one a core."""
    scheduler: str | None = None
    """Address of a Dask scheduler whose workers see the same --out; none: workers here."""
    shard: str | None = None
    """Only one of n equal parts of all runs, such as 2/8, in a ledger of its own."""
    merge: bool = False
    """Put the shards together, and show the board when all is there."""
    unit: int = 16
    """Runs that a worker plays in lock-step; fewer spread better, more have fewer planner calls."""
    traces: bool = False
    """Keep the best lengths so far of the judging runs."""
    dry_run: bool = False
    """Run nothing; say what it would take, on 1, 100 and 10,000 cores."""
    timed: Path | None = None
    """With --dry-run: a board whose seconds tell what agents think; else that is left out."""


class Sweep:
    """A sweep's board: what it asks for, and its runs by their keys, which is all that this process needs of them."""

    def __init__(self, arguments: Arguments) -> None:
        self.arguments = arguments
        self.board = board_of(arguments)
        leaderboard.plan_board(self.board)  # what cannot be played is told before anything is written
        with _training(arguments.out):
            self.plan, runs = board_runs(self.board)
        self.keys = [job.key for job in runs]

    @contextmanager
    def ledger(self, folder: Path, keys: Sequence[str]) -> Iterator[Ledger]:
        """Open the ledger of the whole or of a shard, and note what is asked of it, and of the sweep.

        Every shard notes the same of the sweep, so that none needs to wait for another.
        """
        out, begun = self.arguments.out, self._begun()
        with Ledger(folder, self.plan.config, self.plan.versions, provenance.facts()) as ledger:
            ledger.pin(leaderboard.pins(self.board))
            if folder != out:
                ask(folder, keys, anew=ledger.renewed)
            ask(out, self.keys, anew=not begun)
            yield ledger

    def _begun(self) -> bool:
        """Whether a ledger of the sweep holds a trial or is of its config, so that what was asked of it counts."""
        config = as_json(self.plan.config)
        return any(
            (folder / TRIALS).stat().st_size or read_manifest(folder)["config"] == config
            for folder in (self.arguments.out, *shard_folders(self.arguments.out))
            if (folder / TRIALS).exists() and (folder / MANIFEST).exists()
        )


def board_of(arguments: Arguments) -> leaderboard.Arguments:
    """Return the leaderboard's part of a sweep's arguments."""
    names = [field.name for field in fields(leaderboard.Arguments)]
    return leaderboard.Arguments(**{name: getattr(arguments, name) for name in names})


@contextmanager
def _training(out: Path) -> Iterator[None]:
    """Let one process at a time train agents: of many that begin together the others find the files there."""
    try:
        out.mkdir(parents=True, exist_ok=True)
        lock = (out / "training.lock").open("w")
    except OSError as error:
        raise LedgerError(f"{out} cannot hold a sweep: {error}") from None
    with lock as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            print(f"another process trains the agents of {out}; waiting for it", file=sys.stderr)
            fcntl.flock(file, fcntl.LOCK_EX)
        yield


def sweep(arguments: Arguments) -> str:
    """Play what is missing of a sweep or of one of its shards, or merge; return what there is to say in the end.

    Raises:
        ParameterError: on options that do not fit each other.
        LedgerError: if runs are missing in the end; what is done is kept.
    """
    _check(arguments)
    if arguments.dry_run:
        from experiments.costs import estimate

        return estimate(board_of(arguments), arguments.timed)
    if arguments.merge:
        return merge(Sweep(arguments))
    shard = Shard.parse(arguments.shard) if arguments.shard else None
    whole = Sweep(arguments)
    if shard is None:
        _play(whole, range(len(whole.keys)), arguments.out)
        return f"page: {leaderboard.run_board(whole.board)}"
    places = shard.share(whole.keys)
    _play(whole, places, shard.folder(arguments.out))
    return f"shard {shard.number} of {shard.of}: its {len(places)} runs are done; --merge puts all shards together"


def _check(arguments: Arguments) -> None:
    if arguments.merge and arguments.shard:
        raise ParameterError("--shard plays a part, --merge puts parts together; give one of them")
    if arguments.timed and not arguments.dry_run:
        raise ParameterError("--timed is for --dry-run; add it, or leave --timed out")
    if arguments.scheduler and arguments.backend != "dask":
        raise ParameterError(
            f"--scheduler is Dask's, and --backend is {arguments.backend}; add --backend dask"
        )
    for name in ("jobs", "unit"):
        value = getattr(arguments, name)
        if value < 1 and (name, value) != ("jobs", -1):
            raise ParameterError(f"--{name} {value}: needs a whole number of at least 1")


def merge(whole: Sweep) -> str:
    """Put the shards' ledgers together and show the board; LedgerError where runs are missing."""
    out = whole.arguments.out
    folders = list(shard_folders(out))
    with whole.ledger(out, whole.keys) as ledger, progress("merging shards", len(folders)) as advance:
        for folder in folders:
            ledger.absorb(folder)
            advance(1)
        _require_all(missing(ledger, whole.keys), len(whole.keys), out)
    return f"page: {leaderboard.run_board(whole.board)}"


def _play(whole: Sweep, places: Sequence[int], folder: Path) -> None:
    """Play what is missing of some runs on the backend; LedgerError where some broke off."""
    keys = whole.keys
    asked = [keys[i] for i in places]
    with whole.ledger(folder, asked) as ledger:
        todo = units(keys, places, whole.arguments.unit, finished(ledger), folder)
        with progress(f"{len(asked)} runs on {whole.arguments.backend}", len(asked)) as advance:
            advance(len(asked) - sum(len(unit.places) for unit in todo))
            for unit, reason in _run(whole, todo):
                if reason:
                    note_broken(folder, [keys[i] for i in unit.places], reason)
                else:
                    take_in(ledger, unit)
                advance(len(unit.places))
        _require_all(missing(ledger, asked), len(asked), folder)
        rmtree(folder / UNITS, ignore_errors=True)  # of units of another size that were not ended


def _require_all(lacking: Sequence[str], count: int, folder: Path) -> None:
    if lacking:
        raise LedgerError(
            f"{len(lacking)} of {count} runs are missing, the first is {lacking[0]!r}; what is done is kept, the same "
            f"command tries the others again, and python -m experiments.status {folder} lists them and what went wrong"
        )


def _run(whole: Sweep, todo: Sequence[Unit]) -> Iterator[tuple[Unit, str]]:
    """Play units on the backend, and yield each with what stopped it as it ends."""
    try:
        from joblib import Parallel, delayed
    except ImportError:
        raise MissingExtraError("joblib", "sweep") from None
    arguments = whole.arguments
    with _backend(arguments):
        workers = Parallel(n_jobs=arguments.jobs, batch_size=1, return_as="generator_unordered")
        ended = workers(delayed(play_unit)(whole.board, unit, arguments.traces) for unit in todo)
        try:
            yield from ended
        except Exception as error:  # the backend's own: a worker that was killed, a scheduler that went away
            kind = type(error).__name__
            raise AntgymError(
                f"backend {arguments.backend!r} gave up: {kind}: {error}; what is done is kept, and the same command "
                "goes on"
            ) from error


@contextmanager
def _backend(arguments: Arguments) -> Iterator[None]:
    """Make a backend joblib's own for a while, with Dask's client where it is Dask's."""
    from joblib import parallel_config

    with ExitStack() as stack:
        if arguments.backend == "dask":
            stack.enter_context(_client(arguments))
        try:
            stack.enter_context(parallel_config(backend=arguments.backend))
        except (ValueError, ImportError) as error:
            raise ParameterError(f"--backend {arguments.backend}: {error}") from None
        yield


def _client(arguments: Arguments) -> Any:
    """Return a client of Dask: of a scheduler that runs, or of workers of its own."""
    try:
        from distributed import Client
    except ImportError:
        raise MissingExtraError("distributed", "sweep") from None
    if arguments.scheduler:
        return Client(arguments.scheduler)
    workers = arguments.jobs if arguments.jobs > 0 else None
    return Client(n_workers=workers, threads_per_worker=1, dashboard_address=None)


def script() -> None:
    """Run the command line."""
    print(f"\n{sweep(parse(Arguments, None, PROGRAM))}")


if __name__ == "__main__":
    main(script)
