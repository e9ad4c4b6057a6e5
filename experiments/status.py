"""What is there of a board or a sweep: runs missing, broken off, failed, held twice, ledgers damaged.

    python -m experiments.status out/board

reads the ledgers of folders, those of their shards and of units under way among them, and changes nothing; it may look
while they are written. The exit code is 0 where every run that was asked is finished, 1 where not.
"""

import json
import re
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, NamedTuple

import tyro
from rich.console import Console
from rich.table import Table
from rich.text import Text

from antgym.console import main, parse
from antgym.errors import LedgerError
from antgym.tuning.ledger import MANIFEST, TRIALS, KeptRun, read_runs
from antgym.tuning.manifest import read_manifest
from experiments.orders import asked, broken

SHOWN = 10  # runs of a kind that are listed
SHARD = re.compile(r"\d+-of-(\d+)")  # how units.Shard calls its folder


@dataclass(frozen=True)
class Arguments:
    """List what is missing of boards and sweeps; exit code 1 where something is."""

    folders: Annotated[tuple[Path, ...], tyro.conf.Positional]
    """Folders of boards, sweeps or single ledgers; those of one config are parts of one whole."""
    every: bool = False
    """List every run, not only the first few of a kind."""


class Holding(NamedTuple):
    """What one ledger holds, and why runs broke off; no runs where it is damaged, which is then said."""

    folder: Path
    runs: dict[str, KeptRun]
    reasons: Mapping[str, str] = MappingProxyType({})
    damage: str = ""


@dataclass
class Standing:
    """How the runs of one board or sweep stand, over all ledgers that hold some of them.

    Attributes:
        holdings: the ledgers, those of whole boards before their parts.
        asked: keys in the order in which they were asked for; where no ledger says so, the keys that are there.
        finished: keys of runs that ended in an outcome.
        failed: finished, but by the agent's failure; what the outcome says, by key.
        missing: asked and not finished; why a run broke off, by key, or "".
        twice: finished in several parts, though equally.
        differing: not the same run in every ledger that holds it.
    """

    holdings: list[Holding]
    asked: list[str] = field(default_factory=list)
    finished: set[str] = field(default_factory=set)
    failed: dict[str, str] = field(default_factory=dict)
    missing: dict[str, str] = field(default_factory=dict)
    twice: list[str] = field(default_factory=list)
    differing: list[str] = field(default_factory=list)

    @property
    def whole(self) -> bool:
        """Whether every run is there, once told the same."""
        return not (self.missing or self.differing or any(holding.damage for holding in self.holdings))


def ledgers_below(folder: Path) -> list[Path]:
    """Return the folders of a board, its shards and its units that hold ledgers; LedgerError where none does."""
    found = [path.parent for path in sorted(folder.rglob(MANIFEST)) if (path.parent / TRIALS).exists()]
    if not found:
        raise LedgerError(f"{folder} holds no ledger: no {MANIFEST} beside a {TRIALS} in it or below it")
    return sorted(found, key=lambda path: len(path.parts))


def survey(folders: Iterable[Path]) -> list[Standing]:
    """Return how boards and sweeps stand, one for every config; ledgers that cannot tell theirs stand together.

    What was asked of a sweep is asked where its folder is looked at, but not where one of its shards is.
    """
    orders: dict[Path, dict[Path, None]] = {}
    for folder in folders:
        for ledger in ledgers_below(folder):
            within = [path for path in (*reversed(ledger.parents), ledger) if path.is_relative_to(folder)]
            orders.setdefault(ledger, {}).update(dict.fromkeys(within))
    boards: dict[str, dict[Path, Holding]] = {}
    for ledger in orders:
        boards.setdefault(_config(ledger), {})[ledger] = _holding(ledger)
    return [
        _standing(list(found.values()), dict.fromkeys(path for ledger in found for path in orders[ledger]))
        for found in boards.values()
    ]


def _config(folder: Path) -> str:
    try:
        return json.dumps(read_manifest(folder)["config"], sort_keys=True)
    except LedgerError:
        return ""  # of no board; the row of the ledger says what is wrong


def _holding(folder: Path) -> Holding:
    runs: dict[str, KeptRun] = {}
    try:
        runs = read_runs(folder)
        return Holding(folder, runs, broken(folder))
    except LedgerError as error:
        return Holding(folder, runs, damage=str(error))


def _standing(holdings: list[Holding], ordering: Iterable[Path]) -> Standing:
    """Return how the runs of some ledgers stand that were asked of some folders."""
    standing = Standing(holdings)
    copies: dict[str, list[tuple[Path, KeptRun]]] = {}
    for holding in holdings:
        for key, run in holding.runs.items():
            copies.setdefault(key, []).append((holding.folder, run))
    reasons = {key: why for holding in holdings for key, why in holding.reasons.items()}
    orders = dict.fromkeys(key for folder in ordering for key in asked(folder))
    standing.asked = list(orders) or list(copies)
    for key, places in copies.items():
        ended = [(folder, run) for folder, run in places if run.outcome is not None]
        if ended:
            standing.finished.add(key)
        for _, run in ended:
            if run.outcome is not None and run.outcome.failure:
                standing.failed[key] = run.outcome.failure
        if not _agree([run for _, run in places]):
            standing.differing.append(key)
        elif _apart([folder for folder, _ in ended]):
            standing.twice.append(key)
    unfinished = (key for key in standing.asked if key not in standing.finished)
    standing.missing = {key: reasons.get(key, "") for key in unfinished}
    return standing


def _agree(runs: Sequence[KeptRun]) -> bool:
    """Whether ledgers tell the same of a run, as far as each has come."""
    most = max(runs, key=lambda run: (run.outcome is not None, len(run.records)))
    return all(
        run.records == most.records[: len(run.records)]
        and (run.outcome is None or (run.outcome, run.records) == (most.outcome, most.records))
        for run in runs
    )


def _apart(folders: Sequence[Path]) -> bool:
    """Whether some of these ledgers are beside each other; a whole holds again what its parts hold."""
    return any(
        one not in other.parents and other not in one.parents
        for i, one in enumerate(folders)
        for other in folders[:i]
    )


def shards_not_begun(standing: Standing) -> list[str]:
    """Return the folders of shards without a ledger, of a split that others have begun and that lacks some runs."""
    if not standing.missing:
        return []
    folders = [holding.folder for holding in standing.holdings]
    split = [(folder.parent, found[1]) for folder in folders if (found := SHARD.fullmatch(folder.name))]
    shards = (
        place / f"{number}-of-{count}"
        for place, count in dict.fromkeys(split)
        for number in range(1, int(count) + 1)
    )
    return [str(shard) for shard in shards if shard not in folders]


def to_table(standing: Standing) -> Table:
    """Return a row a ledger, and one for all."""
    table = Table(caption=_sentence(standing))
    for heading in ("ledger", "finished", "under way", "trials", "damage"):
        table.add_column(
            heading, justify="left" if heading in {"ledger", "damage"} else "right", overflow="fold"
        )
    for holding in standing.holdings:
        runs = holding.runs.values()
        finished = sum(run.outcome is not None for run in runs)
        cells = (str(holding.folder), f"{finished:,}", f"{len(runs) - finished:,}")
        trials = f"{sum(len(run.records) for run in runs):,}"
        table.add_row(*map(Text, (*cells, trials, holding.damage or "–")))
    return table


def _sentence(standing: Standing) -> str:
    count = f"{len(standing.finished):,} of {len(standing.asked):,} runs finished"
    kinds = {
        "missing": len(standing.missing),
        "of them broken off": sum(map(bool, standing.missing.values())),
        "failed by their agents": len(standing.failed),
        "held twice": len(standing.twice),
        "told differently": len(standing.differing),
    }
    return ", ".join([count, *(f"{number:,} {kind}" for kind, number in kinds.items() if number)])


def to_lists(standing: Standing, most: int | None) -> str:
    """Return the lists of runs that somebody should look at, the first of each."""
    lists = {
        "missing": [f"{key}  broke off: {why}" if why else key for key, why in standing.missing.items()],
        "failed by its agent": [f"{key}  {why}" for key, why in standing.failed.items()],
        "held twice": standing.twice,
        "told differently": standing.differing,
        "not begun": shards_not_begun(standing),
    }
    lines = []
    for kind, keys in lists.items():
        lines += [f"{kind}: {key}" for key in keys[:most]]
        if len(keys) > len(keys[:most]):
            lines.append(f"{kind}: {len(keys) - len(keys[:most]):,} more; --every lists them")
    return "".join(f"{line}\n" for line in lines)


def script() -> None:
    """Run the command line."""
    arguments = parse(Arguments, None, "python -m experiments.status")
    if not arguments.folders:
        raise LedgerError("name the folder of a board or a sweep")
    standings = survey(arguments.folders)
    console = Console()
    for standing in standings:
        console.print(to_table(standing))
        print(to_lists(standing, None if arguments.every else SHOWN), end="")
    sys.exit(0 if all(standing.whole for standing in standings) else 1)


if __name__ == "__main__":
    main(script)
