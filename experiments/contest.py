"""A contest: agents on maps, with seeds and budgets, one ledger underneath; every harness that compares plays it."""

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any, Literal, NamedTuple, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

import agents
from agents.stranger import CALL_SECONDS
from agents.submission import TableAgent
from antgym.errors import LedgerError, ParameterError
from antgym.maps.suites import SuiteItem
from antgym.planners.fleet import FleetPlans
from antgym.planners.plans import Plans
from antgym.tuning.agent import Agent, Result, tune_together
from antgym.tuning.ledger import Ledger, LedgerRun, Outcome
from antgym.tuning.problem import FRESH, GAP_CAP, TuningProblem, run_together
from antgym.tuning.session import Session
from experiments import provenance
from experiments.artefact_files import trained_argument
from experiments.artefacts import derived_seed, problem
from experiments.orders import ask
from experiments.stopwatch import DEFAULT, Stopwatch

Floats = NDArray[np.float64]
STRANGER = "agents.stranger:Stranger"
TOGETHER = 64  # runs in lock-step: a round of them is one planner call


class Entrant(NamedTuple):
    """An agent in the contest, what its training spent, and for what it was submitted, if it was.

    Attributes:
        name: of the agent.
        kind: whether it competes.
        summary: one line.
        agent: itself.
        training: planner runs spent before any new map.
        track: the only one that it has a place in; "" for any.
        trials: on each map that were paid for it before, by the word of whoever submitted it.
    """

    name: str
    kind: Literal["agent", "reference"]
    summary: str
    agent: Agent
    training: int
    track: str = ""
    trials: int = 0


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


def told(agent: Agent, item: SuiteItem) -> Agent:
    """Return an agent; a submitted table is told which map it is asked about, since no task says so."""
    return agent.on(item.name) if isinstance(agent, TableAgent) else agent


def enter(
    names: Sequence[str],
    folder: Path,
    spent: dict[str, int],
    references: Sequence[str] = (),
    call_seconds: float = CALL_SECONDS,
) -> list[Entrant]:
    """Return entrants with the artefacts of a folder: first agents, then references.

    Args:
        names: agents of the catalogue, ``path/to/file.py:ClassName`` of strangers', and folders of submissions.
        folder: where their artefacts are.
        spent: what each artefact's training spent.
        references: agents of the catalogue that take no place.
        call_seconds: that a stranger's agent may take for one call.
    """
    if not call_seconds > 0:
        raise ParameterError(f"--call-seconds {call_seconds}: an agent needs more than 0 seconds for a call")
    out = []
    for name in (*names, *references):
        card = agents.find_card(name)
        argument: dict[str, Any] = trained_argument(name, folder)
        training = card.training + sum(spent[path.name] for path in argument.values())
        if card.entry_point == STRANGER:
            argument["seconds"] = call_seconds
        kind: Literal["agent", "reference"] = "reference" if name in references else "agent"
        agent = agents.make(name, **argument)
        out.append(Entrant(name, kind, card.summary, agent, training, card.track, card.trials))
    return out


def foreign_files(names: Sequence[str]) -> dict[str, str]:
    """Return the hashes of strangers' files, with what these import from beside them, and submissions, by name.

    A ledger is tied to them.
    """
    found = {}
    for card in map(agents.find_card, names):
        for path in _consists_of(card):
            name = path.relative_to(card.files[0].parent)
            found[f"{card.name} ({name})"] = provenance.file_hash(path)
    return found


def _consists_of(card: agents.Card) -> list[Path]:
    if card.entry_point != STRANGER:
        return list(card.files)
    (file,) = card.files
    return [file, *provenance.imported_beside(file)]


def failures(outcomes: Sequence[Outcome]) -> str:
    """Return how many runs of an agent failed and how the first did; empty where none did."""
    said = [outcome.failure for outcome in outcomes if outcome.failure]
    count = f"{len(said)} of {len(outcomes)} runs failed and count as if they had found no path"
    return f"{count}, the first because {said[0]}" if said else ""


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
    ask(ledger.folder, [job.key for job in asked], anew=ledger.renewed)
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
    watches = [
        Stopwatch(told(job.entrant.agent, job.item), run.records) for job, run in zip(some, runs, strict=True)
    ]
    try:
        results = _tune(some, problems, watches, runs)
        tuning = time.perf_counter() - begun - sum(watch.seconds for watch in watches)
    finally:
        for watch in watches:
            watch.stop()
    for run, result, watch in zip(runs, results, watches, strict=True):
        if len(result.trials) < len(run.records) and not watch.failure:
            raise LedgerError(
                f"{run.key}: the ledger holds {len(run.records)} trials, now it stops at {len(result.trials)}"
            )
    begun = time.perf_counter()
    judged = _judge(problems, [result.recommendation for result in results], watches, fresh)
    judging = (time.perf_counter() - begun) / len(some)
    work = np.array([sum(trial.work for trial in result.trials) for result in results])
    shares = work / max(1, work.sum())  # of the batches' wall time: single runs have none of their own
    with runs[0].hold():
        for i, (run, (outcome, plans)) in enumerate(zip(runs, judged, strict=True)):
            if run.traced and isinstance(plans, Plans):  # a fleet has no length on its way
                run.trace([plans[k].best for k in range(fresh)])
            run.finish(outcome)
            run.time(tuner=watches[i].seconds, planner=float(tuning * shares[i]), judging=judging)


def _judge(
    problems: Sequence[TuningProblem], units: Sequence[Floats], watches: Sequence[Stopwatch], fresh: int
) -> list[tuple[Outcome, Plans | FleetPlans | None]]:
    """Run recommendations on fresh seeds; return outcomes, and the runs of those whose agents did not fail."""
    sound = [i for i, watch in enumerate(watches) if not watch.failure]
    requests = [(problems[i], np.repeat(units[i][None], fresh, axis=0), FRESH, 0) for i in sound]
    ran = dict(zip(sound, run_together(requests), strict=True))
    judged: list[tuple[Outcome, Plans | FleetPlans | None]] = []
    for i, (unit, watch) in enumerate(zip(units, watches, strict=True)):
        plans = ran.get(i)
        if plans is None:
            judged.append((failed(len(unit), fresh, watch.failure), None))
        else:
            gaps = problems[i].gap(plans.lengths)
            judged.append(
                (Outcome(tuple(unit.tolist()), tuple(plans.lengths.tolist()), tuple(gaps.tolist())), plans)
            )
    return judged


def failed(dimension: int, runs: int, failure: str) -> Outcome:
    """Return how a run ends whose agent failed: as if no path were found, for a crash must not pay."""
    return Outcome((DEFAULT,) * dimension, (np.inf,) * runs, (GAP_CAP,) * runs, failure)


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
