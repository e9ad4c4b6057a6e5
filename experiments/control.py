"""Race controllers: who sets the parameters of a run on the way, against settings that stay.

    python -m experiments.control best_static_by_rules schedule out/steer.json --suite open-v0 --out out/control

plays every controller on the maps of a split, one run of ten blocks per map and seed, all at the same effort and on
the same seeds, which no training and no other harness uses. What is raced is an agent of the catalogue, whose
recommendation without a trial then stays; ``schedule``, the best one of the suite's card on top of the setting of
``--against``; or the file of a policy: one of Control steers, one of OneShot chooses once. Stopped, the same command
goes on; with more controllers, it plays those that are new.
"""

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from copy import copy
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal, NamedTuple

import numpy as np
import tyro
from numpy.typing import NDArray

import agents
from agents.policy import PolicyAgent
from agents.published import beside, read_card, stem_of
from agents.steering import ConstantController, Controller, PolicyController, Schedule, ScheduleController
from antgym.console import main, parse, progress, write_whole
from antgym.envs.cards import load_card
from antgym.envs.catalogue import WORLDS
from antgym.envs.control import BLOCKS, LEAST_ITERATIONS
from antgym.errors import AgentError, ParameterError
from antgym.maps.suites import SuiteItem, load_suite
from antgym.planners.swarms import parameter_names
from antgym.tuning.ledger import Ledger, LedgerRun, Outcome
from antgym.tuning.problem import TuningProblem
from antgym.tuning.run_features import observe_run
from antgym.tuning.session import Session, steer_together
from experiments import contest, provenance
from experiments.artefacts import derived_seed, prepare, problem
from experiments.contest import enter, failed, play_missing, told
from experiments.headroom.schedules import family
from experiments.presets import PRESETS
from experiments.statistics import cluster_interval, paired_difference

STATIC, SCHEDULE = "best_static_by_rules", "schedule"


@dataclass(frozen=True)
class Arguments:
    """Race controllers, or go on with a race that was stopped."""

    controllers: Annotated[tuple[str, ...], tyro.conf.Positional] = ("published_default", STATIC, SCHEDULE)
    """Agents of the catalogue, "schedule", and files of policies of Control or OneShot."""
    suite: str = "open-v0"
    """Suite of the maps."""
    split: Literal["validation", "test", "ood"] = "test"
    """Its split."""
    maps: int | None = None
    """The first so many maps; all by default."""
    seeds: int = 3
    """Runs of every controller on every map."""
    against: str = STATIC
    """The agent whose setting all are compared with, and which a schedule changes."""
    preset: Literal["smoke", "quick", "full"] = "quick"
    """How much agents that need training are trained with, where their files are not there yet."""
    artefacts: Path | None = None
    """Folder of these files; by default OUT/trained."""
    out: Path = Path("out/control")
    """Folder of the ledger and of control.md."""


class Entrant(NamedTuple):
    """A controller in the race, and the planner runs that made it; None where its card says so."""

    name: str
    controller: Controller
    training: int | None
    kind: Literal["agent", "reference"] = "agent"
    summary: str = ""


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


def race(arguments: Arguments) -> str:
    """Play what is missing, write the table and return it."""
    agents.find_card(arguments.against)
    names = list(dict.fromkeys([arguments.against, *arguments.controllers]))
    items = _items(arguments)
    config = {
        "sources": provenance.code_hash(),
        "suite": arguments.suite,
        "split": arguments.split,
        "maps": [item.scenario.digest[:16] for item in items],
        "seeds": arguments.seeds,
    }
    known = [name for name in names if name in agents.CATALOGUE]
    policies = [name for name in names if name not in agents.CATALOGUE and name != SCHEDULE]
    versions = provenance.versions([*known, *(["rl"] if policies else [])])
    with Ledger(arguments.out, config, versions, provenance.facts()) as ledger:
        entrants = _entrants(arguments, known, policies, schedule=SCHEDULE in names)
        ledger.pin(_hashes(arguments, policies))
        todo = [Job(e, item, seed) for e in entrants for item in items for seed in range(arguments.seeds)]
        with progress(f"{len(entrants)} controllers, {len(items)} maps", len(todo)) as advance:
            play(todo, ledger, advance)
        table = to_markdown(entrants, items, arguments, ledger)
    write_whole(arguments.out / "control.md", table.encode())
    return table


def play(todo: Sequence[Job], ledger: Ledger, advance: Callable[[int], None]) -> None:
    """Play what is missing of a race, many runs in lock-step: a block of all of them is one planner call."""
    play_missing(todo, ledger, _play_together, advance)


def _play_together(some: Sequence[Job], runs: Sequence[LedgerRun]) -> None:
    started, thinking = time.perf_counter(), 0.0
    sessions, controllers, sound = [], [], []
    for job, run in zip(some, runs, strict=True):
        session, controller = Session(job.problem, 1, run), job.controller
        try:
            seed = derived_seed(job.entrant.name, job.item.scenario.digest, job.seed)
            controller.reset(session.task, seed=seed)
        except AgentError as error:
            run.finish(failed(len(session.task.space), 1, str(error)))
            continue
        session.open(BLOCKS)
        sessions.append(session)
        controllers.append(controller)
        sound.append(run)
    for _ in range(BLOCKS):
        begun = time.perf_counter()
        units = [_act(controller, session) for controller, session in zip(controllers, sessions, strict=True)]
        thinking += time.perf_counter() - begun
        steer_together(list(zip(sessions, units, strict=True)))
    planning = time.perf_counter() - started - thinking
    with runs[0].hold():
        for session, run in zip(sessions, sound, strict=True):
            (trial,) = session.trials
            gaps = session.problem.gap(np.array(session.lengths))
            run.finish(Outcome(trial.unit, session.lengths, tuple(gaps.tolist())))
            run.time(tuner=thinking / len(some), planner=planning / len(some))


def _act(controller: Controller, session: Session) -> NDArray[np.float64]:
    assert session.opened is not None
    return controller.act(observe_run(session.task, session.opened))


def _items(arguments: Arguments) -> list[SuiteItem]:
    for name in ("seeds", "maps"):
        value = getattr(arguments, name)
        if value is not None and value < 1:
            raise ParameterError(f"--{name} {value}: needs at least one")
    items = load_suite(arguments.suite, arguments.split)[: arguments.maps]
    return steerable(items)


def steerable(items: Iterable[SuiteItem]) -> list[SuiteItem]:
    """Return the items, no run shorter than the regime allows."""
    return [item._replace(iterations=max(item.iterations, LEAST_ITERATIONS)) for item in items]


def _entrants(
    arguments: Arguments, known: Sequence[str], policies: Sequence[str], *, schedule: bool
) -> list[Entrant]:
    folder = arguments.artefacts or arguments.out / "trained"
    spent = prepare(folder, arguments.suite, PRESETS[arguments.preset], known)
    changes = card_schedule(arguments.suite) if schedule else None
    return steering(enter(known, folder, spent), policies, arguments.against, changes)


def steering(
    constants: Iterable[contest.Entrant], policies: Sequence[str], against: str, schedule: Schedule | None
) -> list[Entrant]:
    """Return who steers a run: agents whose recommendation stays, a schedule, and policies.

    Args:
        constants: never told of the run.
        policies: their files, of Control or OneShot.
        against: the one of the constants whose setting a schedule changes.
        schedule: None for no such entrant.

    Raises:
        ParameterError: where two have the same name, or a policy cannot be read.
    """
    found = []
    for name, kind, summary, agent, training in constants:
        found.append(Entrant(name, ConstantController(agent), training, kind, summary))
        if schedule and name == against:
            changed = f"{against}, changed once within the run as the card of the world says"
            found.append(Entrant(SCHEDULE, ScheduleController(agent, schedule), None, "agent", changed))
    found += [_policy(path) for path in policies]
    names = [entrant.name for entrant in found]
    if len(set(names)) < len(names):
        raise ParameterError(
            f"controllers need names of their own, got {', '.join(names)}; rename a policy's files"
        )
    return found


def _policy(path: str) -> Entrant:
    """Return a policy of Control as it steers, one of OneShot as a constant."""
    card = read_card(path)
    controller = PolicyController(path) if card.regime == "Control" else ConstantController(PolicyAgent(path))
    training = card.evaluations + card.start_evaluations
    return Entrant(stem_of(path).name, controller, training, "agent", f"published policy of {card.regime}")


def card_schedule(suite: str) -> Schedule:
    """Return the schedule that the card of a suite's world found best on train maps."""
    found = find_schedule(suite)
    if found is None:
        raise ParameterError(f"no card tells of schedules on {suite}; leave {SCHEDULE!r} out")
    return found


def find_schedule(suite: str) -> Schedule | None:
    """Return the schedule that the card of a suite's world found best on train maps, None where no card tells."""
    worlds = [world for world, its in WORLDS.items() if its == suite]
    card = load_card(worlds[0]) if worlds else None
    if not card or not card["dynamic"]:
        return None
    names = parameter_names(load_suite(suite, "train").rules[0])
    return next(one for one in family() if one.label(names) == card["dynamic"]["schedule"])


def _hashes(arguments: Arguments, policies: Sequence[str]) -> dict[str, str]:
    folder = arguments.artefacts or arguments.out / "trained"
    found = {path.name: provenance.file_hash(path) for path in sorted(folder.glob("*.json"))}
    return found | policy_hashes(policies)


def policy_hashes(policies: Sequence[str]) -> dict[str, str]:
    """Return the hashes of policies' files, by names that no other file of a ledger has."""
    files = [beside(stem_of(path), suffix) for path in policies for suffix in (".json", ".safetensors")]
    return {f"policy {file.name}": provenance.file_hash(file) for file in files}


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
    """Return the table: mean gaps in per cent, intervals over maps and seeds, differences paired by map."""
    gaps = {entrant.name: gaps_of(entrant, items, arguments.seeds, ledger) for entrant in entrants}
    lines = [
        f"{arguments.suite}, {arguments.split}: {len(items)} maps, {arguments.seeds} runs each; gaps in per cent.",
        "",
        f"| controller | mean gap | 95 % interval | solved | minus {arguments.against} | training |",
        "|:--|--:|--:|--:|--:|--:|",
    ]
    for entrant in sorted(entrants, key=lambda one: float(gaps[one.name].mean())):
        own = gaps[entrant.name]
        low, high = cluster_interval(own)
        training = "see the card" if entrant.training is None else f"{entrant.training:,}"
        cells = (
            f"`{entrant.name}`",
            f"{100 * own.mean():.2f}",
            f"{100 * low:.2f} to {100 * high:.2f}",
            f"{100 * (own < 1).mean():.0f} %",
            "–" if entrant.name == arguments.against else _difference(own, gaps[arguments.against]),
            training,
        )
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def _difference(own: NDArray[np.float64], static: NDArray[np.float64]) -> str:
    found = paired_difference(own, static)
    return f"{100 * found.mean:+.2f} [{100 * found.low:+.2f}, {100 * found.high:+.2f}]"


def script() -> None:
    """Run the command line."""
    print(race(parse(Arguments, None, "python -m experiments.control")))


if __name__ == "__main__":
    main(script)
