"""The tracks of a leaderboard: who plays on each, at which budgets, and the runs that this takes.

A, per map: everybody tunes every map by itself. B, after training: agents that learnt from train maps meet new ones
without a trial or with a few. C, control: the parameters are set within one run. Runs that A and B share are played
once, for a round of B is one of A with fewer competitors.
"""

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple, get_args

import agents
from antgym.errors import AntgymError, ParameterError
from antgym.maps.suites import SuiteItem
from antgym.tuning.ledger import Ledger
from antgym.tuning.manifest import read_manifest
from experiments import contest, steering
from experiments.board import SBS, Track

TRACKS: tuple[Track, ...] = get_args(Track)
BUDGETS: dict[Track, tuple[int, ...]] = {"A": (1, 5, 20, 100), "B": (0, 1, 5, 20)}
"""Trials per map; each round below the preset's budget is played, and in A one at that budget."""
SBS_BY_RULE = "best_static_by_rules"
WITHOUT_TRIALS = ("uniform_random", "published_default", "rule_of_thumb")
"""Agents that neither learnt nor search: in B and C to compare with."""
SEARCH = "random_search"
ALWAYS = (*WITHOUT_TRIALS[:2], SEARCH, SBS, SBS_BY_RULE, "copy_best_source", "regression")
"""On every board; where they are not asked for as agents, as references without a place."""
Entrant = contest.Entrant | steering.Entrant
Job = contest.Job | steering.Job


KEY = re.compile(r"(?:/(?P<budget>\d+)(?=/.+/))?/(?P<map>.+)/(?P<seed>\d+)")
"""What follows the agent's name in a key."""


class Key(NamedTuple):
    """Which run a key names; the budget is None for one that is steered."""

    agent: str
    budget: int | None
    map: str
    seed: int


class Round(NamedTuple):
    """What one board shows: entrants of a track on every map with every seed, at one budget."""

    track: Track
    budget: int
    entrants: tuple[Any, ...]
    items: tuple[SuiteItem, ...]
    seeds: int

    def job(self, entrant: Any, item: SuiteItem, seed: int) -> Job:
        """Return one run."""
        if self.track == "C":
            return steering.Job(entrant, item, seed)
        return contest.Job(entrant, item, seed, self.budget)

    @property
    def jobs(self) -> Iterator[Job]:
        """Every run, those that can be played together next to each other."""
        for entrant in self.entrants:
            for item in self.items:
                for seed in range(self.seeds):
                    yield self.job(entrant, item, seed)


def budgets_of(track: Track, largest: int, asked: Sequence[int]) -> tuple[int, ...]:
    """Return the budgets of a track's rounds, smallest first.

    Args:
        track: C has but one, the run that is steered.
        largest: of the preset.
        asked: trials per map that were asked for; none for the track's own.

    Raises:
        ParameterError: where nothing that was asked for is a budget of the track.
    """
    if track == "C":
        return (1,)
    least = 1 if track == "A" else 0
    if not asked:
        own = [budget for budget in BUDGETS[track] if budget <= largest]
        return tuple(sorted({*own, largest} if track == "A" else own))
    if min(asked) < 0 or max(asked) < least or len(set(asked)) < len(asked):
        raise ParameterError(
            f"--budgets {' '.join(map(str, asked))}: needs trials per map, each once, {least} or more in track {track}"
        )
    return tuple(sorted(budget for budget in asked if budget >= least))


def admits(track: Track, budget: int, one: agents.Card | contest.Entrant) -> bool:
    """Return whether an agent may play a round: a submission where it says so, at no fewer trials than it took.

    What needs no trial on a map is shown in C, too.
    """
    if track == "C":
        return one.track in ("", "C") or (one.track == "B" and not one.trials)
    return not one.track or (one.track == track and budget >= one.trials)


def _card(entrant: contest.Entrant) -> agents.Card | None:
    return agents.CATALOGUE.get(entrant.name.partition(":")[0])


def _learnt(entrant: contest.Entrant) -> bool:
    """Return whether an agent learnt before it met a new map; one from outside, whether it is charged for that."""
    card = _card(entrant)
    return entrant.training > 0 if card is None else card.trained


def per_map(track: Track, entrants: Sequence[contest.Entrant], budget: int) -> tuple[contest.Entrant, ...]:
    """Return who plays a round of A or B; in B who did not learn is there to compare with, or not at all.

    An agent from outside the catalogue is always there.
    """
    playing = tuple(entrant for entrant in entrants if admits(track, budget, entrant))
    if track == "A":
        return playing
    shown = (*WITHOUT_TRIALS, SEARCH) if budget else WITHOUT_TRIALS
    return tuple(
        entrant if _learnt(entrant) else entrant._replace(kind="reference")
        for entrant in playing
        if _learnt(entrant) or _card(entrant) is None or entrant.name in shown
    )


def within_runs(
    entrants: Sequence[contest.Entrant], suite: str, policies: Sequence[str], submitted: Sequence[str] = ()
) -> tuple[steering.Entrant, ...]:
    """Return who steers in C: what B's agents recommend without a trial, the card's schedule, submissions, policies."""
    constants, schedule = per_map("B", entrants, 0), steering.find_schedule(suite)
    return tuple(steering.controllers(constants, policies, SBS_BY_RULE, schedule, submitted))


def read_key(key: str, names: Iterable[str]) -> Key:
    """Return what a run's key says.

    Args:
        key: of ``contest.Job`` or ``steering.Job``; a map's name may have slashes and begin with a digit.
        names: the agents that the ledger was asked for: those of files and folders have slashes too, all others none.

    Raises:
        AntgymError: if it is the key of no contest's run.
    """
    known = [name for name in names if key.startswith(f"{name}/")]
    agent = max(known, key=len, default=key.partition("/")[0])
    parts = KEY.fullmatch(key, len(agent))
    if parts is None:
        raise AntgymError(f"run {key!r} is none of a contest, which are called AGENT/BUDGET/MAP/SEED")
    budget = parts["budget"]
    return Key(agent, None if budget is None else int(budget), parts["map"], int(parts["seed"]))


def agents_in(folder: Path) -> list[str]:
    """Return the names of the agents that a board's or a transfer's ledger was asked for; none of other ledgers."""
    return list(read_manifest(folder)["config"].get("agents", ()))


def jobs(rounds: Iterable[Round]) -> list[Job]:
    """Return the runs of some rounds, each once, those that can be played together next to each other."""
    found: dict[str, Job] = {}
    for played in rounds:
        for job in played.jobs:
            found.setdefault(job.key, job)
    return list(found.values())


def play(todo: Sequence[Job], ledger: Ledger, fresh: int, advance: Callable[[int], None]) -> None:
    """Play what is missing of some runs, of whatever track."""
    contest.play((job for job in todo if isinstance(job, contest.Job)), ledger, fresh, advance)
    steering.play([job for job in todo if isinstance(job, steering.Job)], ledger, advance)
