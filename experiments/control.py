"""Race controllers: who sets the parameters of a run on the way, against settings that stay.

    python -m experiments.control best_static_by_rules schedule open-control --suite open-v0 --out out/control

plays every controller on the maps of a split, one run of ten blocks per map and seed, all at the same effort and on
the same seeds, which no training and no other harness uses. What is raced is an agent of the catalogue, whose
recommendation without a trial then stays; ``schedule``, the best one of the suite's card on top of the setting of
``--against``; or a policy, its file, ``rl:NAME`` or the name of a shipped one: one of Control steers, one of OneShot
chooses once. With ``--held`` a policy that steers is raced against its own first setting, too. Trainings that differ
in their seed alone, as out/steer-1 and out/steer-2 may, are shown together, too.
Stopped, the same command goes on; with more controllers, it plays those that are new.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import tyro
from numpy.typing import NDArray

import agents
from agents.steering import PolicyController, Schedule
from antgym.console import main, parse, progress, write_whole
from antgym.errors import ParameterError
from antgym.maps.suites import SuiteItem, load_suite
from antgym.tuning.ledger import Ledger
from experiments import provenance
from experiments.artefact_files import MAKEABLE, policy_file, require_there, trained_hashes
from experiments.artefacts import prepare
from experiments.contest import enter
from experiments.orders import ask
from experiments.presets import PRESETS
from experiments.rehearsal import rehearse, rehearse_controllers
from experiments.statistics import cluster_interval, paired_difference
from experiments.steering import (
    HELD,
    SCHEDULE,
    Entrant,
    Job,
    card_schedule,
    controllers,
    play,
    policy_hashes,
    steerable,
    with_held,
)
from experiments.tables.sheet import table
from experiments.trainings import trainings

STATIC = "best_static_by_rules"


@dataclass(frozen=True)
class Arguments:
    """Race controllers, or go on with a race that was stopped."""

    controllers: Annotated[tuple[str, ...], tyro.conf.Positional] = ("published_default", STATIC, SCHEDULE)
    """Agents of the catalogue, "schedule", and policies of Control or OneShot: files, rl:NAME of one in the folder of
    trained agents' files, or names of shipped ones."""
    suite: str = "open-v0"
    """Suite of the maps."""
    split: Literal["validation", "test", "ood"] = "test"
    """Its split."""
    maps: int | None = None
    """The first so many maps; all by default."""
    seeds: int = 3
    """Runs of every controller on every map."""
    held: bool = False
    """Race each policy of Control a second time, as held:NAME, with its setting for the first block throughout."""
    against: str = STATIC
    """The agent whose setting all are compared with, and which a schedule changes."""
    preset: Literal["smoke", "quick", "full"] = "quick"
    """How much agents that need training are trained with, where their files are not there yet."""
    artefacts: Path | None = None
    """Folder of these files; by default OUT/trained."""
    out: Path = Path("out/control")
    """Folder of the ledger and of control.md."""


def race(arguments: Arguments) -> str:
    """Play what is missing, write the table and return it."""
    agents.find_card(arguments.against)
    names = list(dict.fromkeys([arguments.against, *arguments.controllers]))
    items, folder = _items(arguments), _folder(arguments)
    known = [name for name in names if name == arguments.against or _is_agent(name)]
    named = [name for name in names if name not in (*known, SCHEDULE)]
    policies = list(dict.fromkeys(str(policy_file(name, folder)) for name in named))
    require_there(known, folder, arguments.suite, makes=MAKEABLE)
    rehearse(known, folder, items[0], 0)
    rehearsed = rehearse_controllers(policies, items[0], known)
    if arguments.held and not any(entrant.steers for entrant in rehearsed):
        raise ParameterError("--held: no policy of Control is raced; name one, as open-control")
    changes = card_schedule(arguments.suite) if SCHEDULE in names else None
    config = {
        "code": provenance.code_hash(*provenance.CONTEST),
        "suite": arguments.suite,
        "split": arguments.split,
        "maps": [item.scenario.digest[:16] for item in items],
        "seeds": arguments.seeds,
    }
    versions = provenance.versions([*known, *(["rl"] if policies else [])])
    with Ledger(arguments.out, config, versions, provenance.facts()) as ledger:
        ask(ledger.folder, (), anew=ledger.renewed)  # before a training, which may be stopped
        entrants = _entrants(arguments, known, policies, changes)
        ledger.pin(trained_hashes(folder, known) | policy_hashes(policies))
        todo = [Job(e, item, seed) for e in entrants for item in items for seed in range(arguments.seeds)]
        with progress(f"{len(entrants)} controllers, {len(items)} maps", len(todo)) as advance:
            play(todo, ledger, advance)
        table = to_markdown(entrants, items, arguments, ledger)
    write_whole(arguments.out / "control.md", table.encode())
    return table


def _is_agent(name: str) -> bool:
    """Whether what is raced is an agent of the catalogue; ``rl:NAME`` is the policy, which may be one that steers."""
    return name.partition(":")[0] in agents.CATALOGUE and not name.startswith("rl:")


def _folder(arguments: Arguments) -> Path:
    return arguments.artefacts or arguments.out / "trained"


def _items(arguments: Arguments) -> list[SuiteItem]:
    for name in ("seeds", "maps"):
        value = getattr(arguments, name)
        if value is not None and value < 1:
            raise ParameterError(f"--{name} {value}: needs at least one")
    items = load_suite(arguments.suite, arguments.split)[: arguments.maps]
    if len(items) < 2:
        raise ParameterError(
            f"--suite {arguments.suite} --split {arguments.split}: {len(items)} map, and intervals are over maps; "
            "take two at least"
        )
    return steerable(items)


def _entrants(
    arguments: Arguments, known: Sequence[str], policies: Sequence[str], changes: Schedule | None
) -> list[Entrant]:
    folder = _folder(arguments)
    spent = prepare(folder, arguments.suite, PRESETS[arguments.preset], known)
    found = controllers(enter(known, folder, spent), policies, arguments.against, changes)
    return with_held(found) if arguments.held else found


def gaps_of(entrant: Entrant, items: Sequence[SuiteItem], seeds: int, ledger: Ledger) -> NDArray[np.float64]:
    """Return the (maps, seeds) gaps of an entrant."""
    return np.array([list(_gaps(entrant, item, seeds, ledger)) for item in items])


def _gaps(entrant: Entrant, item: SuiteItem, seeds: int, ledger: Ledger) -> Iterator[float]:
    for seed in range(seeds):
        outcome = ledger.run(Job(entrant, item, seed).key).outcome
        assert outcome is not None
        yield outcome.gaps[0]


def to_markdown(
    entrants: Sequence[Entrant], items: Sequence[SuiteItem], arguments: Arguments, ledger: Ledger
) -> str:
    """Return the table: mean gaps in per cent, intervals over maps and seeds, differences paired by map.

    Differences are to ``--against``, to the schedule where it is raced, and, with ``--held``, of a first setting that
    stays to the policy that steers on from it; several trainings are shown as one, too.
    """
    gaps = {entrant.name: gaps_of(entrant, items, arguments.seeds, ledger) for entrant in entrants}
    spent = {entrant.name: entrant.training for entrant in entrants}
    cards = {e.name: e.controller.card for e in entrants if isinstance(e.controller, PolicyController)}
    for label, names in trainings(cards).items():
        gaps[label] = np.concatenate([gaps[name] for name in names], axis=1)
        spent[label] = spent[names[0]]
    against = [arguments.against, *([SCHEDULE] if SCHEDULE in gaps else [])]
    heads = [
        "controller",
        "mean gap",
        "95 % interval",
        "solved",
        *(f"minus {one}" for one in against),
        *(["minus steered"] if arguments.held else []),
        "training",
    ]
    rows = []
    for name in sorted(gaps, key=lambda name: float(gaps[name].mean())):
        low, high = cluster_interval(gaps[name])
        rows.append(
            [
                f"`{name}`",
                f"{100 * gaps[name].mean():.2f}",
                f"{100 * low:.2f} to {100 * high:.2f}",
                f"{100 * (gaps[name] < 1).mean():.0f} %",
                *("–" if name == one else _difference(gaps[name], gaps[one]) for one in against),
                *([_lost(name, gaps)] if arguments.held else []),
                "see the card" if spent[name] is None else f"{spent[name]:,}",
            ]
        )
    title = f"{arguments.suite}, {arguments.split}: {len(items)} maps, {arguments.seeds} runs each; gaps in per cent."
    return f"{title}\n\n{table(heads, rows)}\n"


def _difference(own: NDArray[np.float64], static: NDArray[np.float64]) -> str:
    found = paired_difference(own, static)
    return f"{100 * found.mean:+.2f} [{100 * found.low:+.2f}, {100 * found.high:+.2f}]"


def _lost(name: str, gaps: Mapping[str, NDArray[np.float64]]) -> str:
    """Return what a first setting that stays loses to the policy that steers on from it."""
    steered = name.removeprefix(HELD)
    return "–" if steered == name else _difference(gaps[name], gaps[steered])


def script() -> None:
    """Run the command line."""
    print(race(parse(Arguments, None, "python -m experiments.control")))


if __name__ == "__main__":
    main(script)
