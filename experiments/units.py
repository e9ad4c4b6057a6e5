"""Units: the runs of a board in parts that are played apart, each in a ledger of its own until it is done.

A unit is some runs that follow each other; a shard some of all runs, dealt out by their hashes. Neither matters to what
a run comes to, whose seeds are its own. What a worker needs of a board it makes itself, once, from the board's
arguments and the files of its trained agents.
"""

import hashlib
import shutil
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

from antgym.errors import ParameterError
from antgym.tuning.ledger import Ledger
from experiments import leaderboard, provenance, tracks

UNITS, SHARDS = "units", "shards"


class Shard(NamedTuple):
    """Which of how many shards, from 1."""

    number: int
    of: int

    @classmethod
    def parse(cls, text: str) -> "Shard":
        """Return the shard that a text such as ``"2/8"`` names."""
        number, _, of = text.partition("/")
        if not (number.isdecimal() and of.isdecimal() and 1 <= int(number) <= int(of)):
            raise ParameterError(f"--shard {text}: needs a number from 1 and how many there are, such as 2/8")
        return cls(int(number), int(of))

    def folder(self, out: Path) -> Path:
        """Return the folder of its ledger below that of the sweep."""
        return out / SHARDS / f"{self.number}-of-{self.of}"

    def share(self, keys: Sequence[str]) -> list[int]:
        """Return which runs are its own, in order: every ``of``-th by hash, so that agents and maps are mixed."""
        dealt = sorted(range(len(keys)), key=lambda i: hashlib.sha256(keys[i].encode()).digest())
        return sorted(dealt[self.number - 1 :: self.of])


class Unit(NamedTuple):
    """Runs that one worker plays: their places among the board's, and the folder of their ledger meanwhile."""

    places: tuple[int, ...]
    folder: Path


def units(
    keys: Sequence[str], places: Sequence[int], size: int, finished: set[str], folder: Path
) -> list[Unit]:
    """Return what is left to play of some runs.

    Args:
        keys: of all runs of the board.
        places: of those to play, by their place among the keys.
        size: runs of a unit, at most. The same size gives the same units, so that one that broke off goes on.
        finished: keys of runs that are done.
        folder: of the ledger that takes units in.
    """
    found = []
    for first in range(0, len(places), size):
        some = places[first : first + size]
        name = hashlib.sha256("\n".join(keys[i] for i in some).encode()).hexdigest()[:16]
        left = tuple(i for i in some if keys[i] not in finished)
        if left:
            found.append(Unit(left, folder / UNITS / name))
    return found


def play_unit(board: leaderboard.Arguments, unit: Unit, traces: bool) -> tuple[Unit, str]:
    """Play a unit in its own ledger; return it, and why it broke off, or nothing.

    Whatever stops it is told and not raised: the other units go on, and the sweep says in the end what is missing.
    """
    try:
        plan, todo = board_runs(board)
        with Ledger(unit.folder, plan.config, plan.versions, _facts(), traces=traces) as ledger:
            tracks.play([todo[i] for i in unit.places], ledger, plan.preset.fresh, lambda _: None)
    except Exception as error:  # an agent, a library, a disk: the reason goes into the sweep's list
        return unit, f"{type(error).__name__}: {error}"
    return unit, ""


@lru_cache(maxsize=1)
def board_runs(board: leaderboard.Arguments) -> tuple[leaderboard.Plan, list[tracks.Job]]:
    """Return what a board asks for and its runs, agents trained now where they are not yet; made once a process."""
    plan = leaderboard.plan_board(board)
    return plan, tracks.jobs(leaderboard.enter_board(board, plan))


@lru_cache(maxsize=1)
def _facts() -> dict[str, Any]:
    return provenance.facts()


def take_in(ledger: Ledger, unit: Unit) -> None:
    """Take a unit's runs into a ledger, and remove its own; killed between the two, it is taken in again, once."""
    ledger.absorb(unit.folder)
    shutil.rmtree(unit.folder)


def shard_folders(out: Path) -> Iterator[Path]:
    """Yield the ledgers of all shards of a sweep that were begun."""
    yield from sorted((out / SHARDS).glob("*-of-*"))


def finished(ledger: Ledger) -> set[str]:
    """Return the keys of a ledger's finished runs."""
    return {run.key for run in ledger.runs() if run.outcome is not None}


def missing(ledger: Ledger, keys: Iterable[str]) -> list[str]:
    """Return the keys of runs that a ledger has not finished."""
    return [key for key in keys if ledger.run(key).outcome is None]
