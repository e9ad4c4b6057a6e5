"""Runs that are steered: who sets the parameters on the way, the runs of a contest of them, and how they are played.

What takes part is an agent, whose recommendation without a trial then stays; the schedule that a suite's card tells of,
on top of such a setting; or the file of a policy: one of Control steers, one of OneShot chooses once. All play the same
seeds, which no training and no other harness uses.
"""

import time
from collections.abc import Callable, Iterable, Sequence
from copy import copy
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from agents import find_card
from agents.policy import PolicyAgent
from agents.published import beside, read_card, stem_of
from agents.shipped import find_policy
from agents.steering import (
    ConstantController,
    Controller,
    HeldController,
    PolicyController,
    Schedule,
    ScheduleController,
)
from agents.stranger import Stranger
from agents.submission import SubmittedController
from antgym.envs.cards import load_card
from antgym.envs.catalogue import world_of
from antgym.envs.control import BLOCKS, LEAST_ITERATIONS
from antgym.errors import AgentError, ParameterError
from antgym.maps.fleet import Fleet
from antgym.maps.suites import SuiteItem, load_suite
from antgym.planners.swarms import parameter_names
from antgym.tuning.ledger import Ledger, LedgerRun, Outcome
from antgym.tuning.problem import TuningProblem
from antgym.tuning.run_features import observe_run
from antgym.tuning.session import Session, steer_together
from experiments import contest, provenance
from experiments.artefacts import derived_seed, problem
from experiments.contest import failed, play_missing, told
from experiments.headroom.schedules import family
from experiments.stopwatch import UNLIKE

SCHEDULE, HELD = "schedule", "held:"


class Entrant(NamedTuple):
    """A controller in the race, and the planner runs that made it; None where its card says so."""

    name: str
    controller: Controller
    training: int | None
    kind: Literal["agent", "reference"] = "agent"
    summary: str = ""

    @property
    def steers(self) -> bool:
        """Whether it may change a setting within the run."""
        return type(self.controller) is not ConstantController


class Job(NamedTuple):
    """One entrant on one map under one seed."""

    entrant: Entrant
    item: SuiteItem
    seed: int

    @property
    def key(self) -> str:
        """How the ledger calls this run."""
        return f"{self.entrant.name}/{self.item.name}/{self.seed}"

    @property
    def problem(self) -> TuningProblem:
        """What is planned; the same planner seed for every entrant."""
        return problem(self.item, "control", self.seed)

    @property
    def controller(self) -> Controller:
        """A copy of the entrant's controller for this run alone."""
        controller = copy(self.entrant.controller)
        if isinstance(controller, ConstantController):
            controller.agent = told(controller.agent, self.item)
        return controller


def play(todo: Sequence[Job], ledger: Ledger, advance: Callable[[int], None]) -> None:
    """Play what is missing of a race, many runs in lock-step: a block of all of them is one planner call."""
    play_missing(todo, ledger, _play_together, advance)


class _Steered(NamedTuple):
    """A run under way: who steers it, what pays for it, and where it is kept."""

    controller: Controller
    session: Session
    run: LedgerRun


def _play_together(some: Sequence[Job], runs: Sequence[LedgerRun]) -> None:
    started, thinking = time.perf_counter(), 0.0
    begun = [_begin(job, run) for job, run in zip(some, runs, strict=True)]
    under_way = [steered for steered in begun if steered is not None]
    with runs[0].hold():  # a trial and its outcome are one write: a board that goes on finds both or none
        for _ in range(BLOCKS):
            before = time.perf_counter()
            units = [_act(steered) for steered in under_way]
            thinking += time.perf_counter() - before
            asked = [(s, unit) for s, unit in zip(under_way, units, strict=True) if unit is not None]
            under_way = [steered for steered, _ in asked]
            steer_together([(steered.session, unit) for steered, unit in asked])
        planning = time.perf_counter() - started - thinking
        for _, session, run in under_way:
            (trial,) = session.trials
            gaps = session.problem.gap(np.array(session.lengths))
            run.finish(Outcome(trial.unit, session.lengths, tuple(gaps.tolist())))
            run.time(tuner=thinking / len(some), planner=planning / len(some))


def _begin(job: Job, run: LedgerRun) -> _Steered | None:
    """Open the run of a job; None where its agent failed, and the run has ended so."""
    session, controller = Session(job.problem, 1, run), job.controller
    try:
        controller.reset(
            session.task, seed=derived_seed(job.entrant.name, job.item.scenario.digest, job.seed)
        )
        _require_as_before(controller, run)
    except AgentError as error:
        run.finish(failed(len(session.task.space), 1, str(error)))
        return None
    session.open(BLOCKS)
    return _Steered(controller, session, run)


def _require_as_before(controller: Controller, run: LedgerRun) -> None:
    """Raise AgentError where a stranger chose otherwise before the board was stopped, as its trial shows."""
    if not (isinstance(controller, ConstantController) and isinstance(controller.agent, Stranger)):
        return  # whatever else plays and answers otherwise is a fault, and stops the board
    chosen = tuple(controller.setting.tolist()) * BLOCKS
    if any(record.trial.unit != chosen for record in run.records):
        raise AgentError(f"{controller.agent.name}: recommend() {UNLIKE}")


def _act(steered: _Steered) -> NDArray[np.float64] | None:
    """Return the setting for the next block; None where the controller failed, and the run has ended so."""
    controller, session, run = steered
    assert session.opened is not None
    try:
        return controller.act(observe_run(session.task, session.opened))
    except AgentError as error:
        run.finish(failed(len(session.task.space), 1, str(error)))
        return None


def steerable(items: Iterable[SuiteItem]) -> list[SuiteItem]:
    """Return the items, no run shorter than the regime allows; ParameterError where one is a fleet."""
    items = list(items)
    fleets = [item.name for item in items if isinstance(item.scenario, Fleet)]
    if fleets:
        raise ParameterError(
            f"{fleets[0]} is a fleet, whose plans are several runs, and one run is steered; take a suite of single "
            "robots, or leave track C out"
        )
    return [item._replace(iterations=max(item.iterations, LEAST_ITERATIONS)) for item in items]


def controllers(
    constants: Iterable[contest.Entrant],
    policies: Sequence[str],
    against: str,
    schedule: Schedule | None,
    submitted: Sequence[str] = (),
) -> list[Entrant]:
    """Return who steers a run: agents whose recommendation stays, a schedule, and policies.

    Args:
        constants: never told of the run.
        policies: their files, of Control or OneShot, or names of those that are shipped.
        against: the one of the constants whose setting a schedule changes.
        schedule: None for no such entrant.
        submitted: folders of submissions that steer.

    Raises:
        ParameterError: where two have the same name, or a policy cannot be read.
    """
    found = []
    for name, kind, summary, agent, training, track, _ in constants:
        role = "reference" if track else kind  # its place is in the track that it was submitted for
        found.append(Entrant(name, ConstantController(agent), training, role, summary))
        if schedule and name == against:
            changed = f"{against}, changed once within the run as the card of the world says"
            found.append(Entrant(SCHEDULE, ScheduleController(agent, schedule), None, "agent", changed))
    found += [_submission(folder) for folder in submitted]
    found += [policy_entrant(path) for path in policies]
    require_apart([entrant.name for entrant in found])
    return found


def require_apart(names: Sequence[str]) -> None:
    """Raise ParameterError where two controllers have the same name."""
    if len(set(names)) < len(names):
        raise ParameterError(
            f"controllers need names of their own, got {', '.join(names)}; rename a policy's files"
        )


def _submission(folder: str) -> Entrant:
    card = find_card(folder)
    return Entrant(folder, SubmittedController(card.files[1]), card.training, "agent", card.summary)


def policy_entrant(name: str) -> Entrant:
    """Return a policy of Control as it steers, one of OneShot as a constant; ParameterError on one of Trials."""
    path = find_policy(name)
    card = read_card(path)
    if card.regime == "Trials":
        raise ParameterError(
            f"{path}: picks trials, and a run that is steered pays for none before it; policies of Control and OneShot "
            "take part"
        )
    controller = PolicyController(path) if card.regime == "Control" else ConstantController(PolicyAgent(path))
    training = card.evaluations + card.start_evaluations
    return Entrant(stem_of(path).name, controller, training, "agent", f"published policy of {card.regime}")


def with_held(entrants: Sequence[Entrant]) -> list[Entrant]:
    """Return the entrants, and for each policy of Control among them another, held:NAME, whose first setting stays."""
    found = [*entrants]
    for name, controller, training, kind, _ in entrants:
        if type(controller) is PolicyController:
            first = f"the setting of {name} for the first block, throughout"
            found.append(Entrant(HELD + name, HeldController(controller.path), training, kind, first))
    require_apart([entrant.name for entrant in found])
    return found


def card_schedule(suite: str) -> Schedule:
    """Return the schedule that the card of a suite's world found best on train maps."""
    found = find_schedule(suite)
    if found is None:
        raise ParameterError(f"no card tells of schedules on {suite}; leave {SCHEDULE!r} out")
    return found


def find_schedule(suite: str) -> Schedule | None:
    """Return the schedule that the card of a suite's world found best on train maps, None where no card tells."""
    world = world_of(suite)
    card = load_card(world) if world else None
    if not card or not card["dynamic"]:
        return None
    names = parameter_names(load_suite(suite, "train").rules[0])
    return next(one for one in family() if one.label(names) == card["dynamic"]["schedule"])


def policy_hashes(policies: Sequence[str]) -> dict[str, str]:
    """Return the hashes of policies' files, by names that no other file of a ledger has."""
    stems = [stem_of(find_policy(name)) for name in policies]
    files = [beside(stem, suffix) for stem in stems for suffix in (".json", ".safetensors")]
    return {f"policy {file.name}": provenance.file_hash(file) for file in files}
