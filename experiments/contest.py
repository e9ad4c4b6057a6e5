"""A contest: agents on maps, with seeds and budgets, one ledger underneath; every harness that compares plays it."""

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from copy import copy
from itertools import groupby
from pathlib import Path
from typing import Any, Literal, NamedTuple, Protocol, TypeVar

import numpy as np

import agents
from antgym.errors import LedgerError
from antgym.maps.suites import SuiteItem
from antgym.tuning.agent import Agent, Result, tune_together
from antgym.tuning.ledger import Ledger, LedgerRun, Outcome
from antgym.tuning.problem import FRESH, TuningProblem, run_together
from antgym.tuning.session import Session
from experiments.artefacts import derived_seed, problem, trained_argument
from experiments.orders import ask

TOGETHER = 64  # runs in lock-step: a round of them is one planner call


class Entrant(NamedTuple):
    """An agent in the contest, and what its training spent."""

    name: str
    kind: Literal["agent", "reference"]
    summary: str
    agent: Agent
    training: int


class Job(NamedTuple):
    """One entrant on one map with one tuner seed, and the trials that it may pay for; 0 asks without any."""

    entrant: Entrant
    item: SuiteItem
    seed: int
    budget: int

    @property
    def key(self) -> str:
        """How the ledger calls this run."""
        return f"{self.entrant.name}/{self.budget}/{self.item.name}/{self.seed}"

    @property
    def problem(self) -> TuningProblem:
        """What is tuned; the same planner seeds for every entrant and budget."""
        return problem(self.item, "board", self.seed)

    @property
    def agent_seed(self) -> int:
        """The seed of the agent's own draws."""
        return derived_seed(self.entrant.name, self.item.scenario.digest, self.seed)


class Stopwatch:
    """A copy of an agent, and the seconds spent inside it."""

    def __init__(self, agent: Agent) -> None:
        self._agent = copy(agent)  # what training left is shared, what a task brings is not
        self.seconds = 0.0

    def _timed(self, name: str, *args: Any, **kwargs: Any) -> Any:
        begun = time.perf_counter()
        try:
            return getattr(self._agent, name)(*args, **kwargs)
        finally:
            self.seconds += time.perf_counter() - begun

    def reset(self, task: Any, *, seed: int) -> None:
        """Pass on."""
        self._timed("reset", task, seed=seed)

    def ask(self) -> Any:
        """Pass on."""
        return self._timed("ask")

    def tell(self, trials: Any) -> None:
        """Pass on."""
        self._timed("tell", trials)

    def recommend(self) -> Any:
        """Pass on."""
        return self._timed("recommend")


def enter(
    names: Sequence[str], folder: Path, spent: dict[str, int], references: Sequence[str] = ()
) -> list[Entrant]:
    """Return entrants with the artefacts of a folder: first agents, then references.

    Args:
        names: agents of the catalogue.
        folder: where their artefacts are.
        spent: what each artefact's training spent.
        references: agents of the catalogue that take no place.
    """
    out = []
    for name in (*names, *references):
        card = agents.find_card(name)
        argument = trained_argument(name, folder)
        training = sum(spent[path.name] for path in argument.values())
        kind: Literal["agent", "reference"] = "reference" if name in references else "agent"
        out.append(Entrant(name, kind, card.summary, agents.make(name, **argument), training))
    return out


def jobs(
    contest: Sequence[Entrant], items: Sequence[SuiteItem], seeds: int, budgets: Sequence[int]
) -> Iterator[Job]:
    """Return every run of a contest, those that can be played together next to each other."""
    for budget in budgets:
        for entrant in contest:
            for item in items:
                for seed in range(seeds):
                    yield Job(entrant, item, seed, budget)


class Run(Protocol):
    """What a contest is made of: something that a ledger keeps under a key."""

    @property
    def key(self) -> str:
        """How the ledger calls it."""
        ...


_Run = TypeVar("_Run", bound=Run)


def play(todo: Iterable[Job], ledger: Ledger, fresh: int, advance: Callable[[int], None]) -> None:
    """Play what is missing of a contest: each entrant tunes many maps in lock-step, then is judged on fresh runs.

    Args:
        todo: jobs as :func:`jobs` orders them.
        ledger: where trials and outcomes go; what it holds is replayed.
        fresh: uncharged runs that judge a recommendation.
        advance: called with the number of jobs that are done.
    """

    def together(some: Sequence[Job], runs: Sequence[LedgerRun]) -> None:
        _play_together(some, runs, fresh)

    play_missing(todo, ledger, together, advance, alike=lambda job: (job.budget, job.entrant.name))


def play_missing(
    todo: Iterable[_Run],
    ledger: Ledger,
    together: Callable[[Sequence[_Run], Sequence[LedgerRun]], None],
    advance: Callable[[int], None],
    alike: Callable[[_Run], Any] = lambda _: None,
) -> None:
    """Play what a ledger lacks of some jobs, a number of them in lock-step.

    Args:
        todo: jobs, those that are alike next to each other.
        ledger: where trials and outcomes go; what it holds is replayed.
        together: plays jobs and finishes their runs.
        advance: called with the number of jobs that are done.
        alike: only jobs for which this is equal are played together.
    """
    missing, asked = [], list(todo)
    ask(ledger.folder, [job.key for job in asked])
    for job in asked:
        if ledger.run(job.key).outcome is None:
            missing.append(job)
        else:
            advance(1)
    for _, group in groupby(missing, alike):
        same = list(group)
        for first in range(0, len(same), TOGETHER):
            some = same[first : first + TOGETHER]
            together(some, [ledger.run(job.key) for job in some])
            advance(len(some))


def _play_together(some: Sequence[Job], runs: Sequence[LedgerRun], fresh: int) -> None:
    begun = time.perf_counter()
    problems = [job.problem for job in some]
    watches = [Stopwatch(job.entrant.agent) for job in some]
    results = _tune(some, problems, watches, runs)
    tuning = time.perf_counter() - begun - sum(watch.seconds for watch in watches)
    for run, result in zip(runs, results, strict=True):
        if len(result.trials) < len(run.records):
            raise LedgerError(
                f"{run.key}: the ledger holds {len(run.records)} trials, now it stops at {len(result.trials)}"
            )
    begun = time.perf_counter()
    units = [result.recommendation for result in results]
    requests = [
        (p, np.repeat(unit[None], fresh, axis=0), FRESH, 0) for p, unit in zip(problems, units, strict=True)
    ]
    plans = run_together(requests)
    judging = (time.perf_counter() - begun) / len(some)
    work = np.array([sum(trial.work for trial in result.trials) for result in results])
    shares = work / max(1, work.sum())  # of the batches' wall time: single runs have none of their own
    for i, (run, p, each) in enumerate(zip(runs, problems, plans, strict=True)):
        outcome = (
            tuple(units[i].tolist()),
            tuple(each.lengths.tolist()),
            tuple(p.gap(each.lengths).tolist()),
        )
        if run.traced:
            run.trace([each[k].best for k in range(fresh)])
        run.finish(Outcome(*outcome))
        run.time(tuner=watches[i].seconds, planner=float(tuning * shares[i]), judging=judging)


def _tune(
    some: Sequence[Job],
    problems: Sequence[TuningProblem],
    watches: Sequence[Stopwatch],
    runs: Sequence[LedgerRun],
) -> list[Result]:
    if some[0].budget:
        sessions = [Session(p, some[0].budget, run) for p, run in zip(problems, runs, strict=True)]
        seeds = [job.agent_seed for job in some]
        return tune_together(list(zip(watches, sessions, seeds, strict=True)))
    results = []
    for job, p, watch in zip(some, problems, watches, strict=True):
        watch.reset(p.task(0), seed=job.agent_seed)
        results.append(Result(p.space.check(watch.recommend())[0], ()))
    return results
