"""One draw: a transfer graph is fitted on five maps, every method tunes the sixth, fresh runs judge what it found."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from agents.fitting import trials_needed
from agents.graph import TransferGraph
from agents.laplacian import transfers
from antgym.maps.world import Scenario
from antgym.planners.plans import Plans
from antgym.tuning.agent import tune
from antgym.tuning.problem import TuningProblem
from antgym.tuning.session import Session
from experiments.artefacts import derived_seed
from experiments.provenance import facts
from experiments.tables.draws import draw
from experiments.tables.liu2020.methods import METHODS, RANDOM, RUNS, Method, Trained, build

Values = NDArray[np.float64]
MAPS, SIDE = 6, 21
DETOUR = 1.3  # of the optimum over the straight line; the paper's 148.66 mm over nine layers is 1.10
ANTS, ITERATIONS = 20, 50  # not in the paper
SEARCH, FEWEST = 100, 8  # trials for each source's own set, and the fewest that a share leaves


@dataclass(frozen=True)
class Arguments:
    """Replay liu2020: five source maps, a transfer graph, eleven methods that tune a sixth map, and that 20 times.

    Finished draws are kept, so the same command goes on where it was stopped, and with more draws it adds to them.
    """

    out: Path = Path("out/tables")
    """Folder of liu2020.md, liu2020.json and liu2020.png; finished draws lie in its liu2020, one file each."""
    rules: Literal["liu2020", "liu2020-paper"] = "liu2020"
    """The sound rules, or the rules as printed."""
    draws: int = 20
    """Draws of six maps, each with source sets of its own; Tables 1-3 show the first, Table 4 all, from two on."""
    share: float = 1.0
    """Share of the paper's evaluations to spend, for a quick look: above 0, 1 at most."""
    seed: int = 0
    """Root seed of agents and planner; the maps stay."""


class Answer(NamedTuple):
    """What a method arrived at, and what fresh runs say of it.

    Attributes:
        method: its label.
        values: (4,) α, β, ρ and Q.
        evaluations: of the target.
        before: evaluations of other maps that it needs first; the three transfers, copy and mean share one fit.
        seconds: wall time on the target.
        lengths: (RUNS,) of the fresh runs; None where there was no path.
        gaps: (RUNS,) of the same runs.
        notes: the agent's own.
        curve: (ITERATIONS,) mean shortest length so far of the fresh runs; None while one of them has none.
        steps: evaluation, length: every new shortest length that the search met.
    """

    method: str
    values: tuple[float, ...]
    evaluations: int
    before: int
    seconds: float
    lengths: tuple[float | None, ...]
    gaps: tuple[float, ...]
    notes: tuple[str, ...]
    curve: tuple[float | None, ...]
    steps: tuple[tuple[int, float], ...]


class Draw(NamedTuple):
    """What all methods arrived at on one six of maps; all of it but seconds and machine follows from the arguments.

    Attributes:
        number: 1 for the first.
        maps: (MAPS,) digests, the target's last.
        optimum: exact length on the target.
        transfers: (5, 5) transfers (9) between the sources, row to column.
        to_target: (5,) transfers of the sources' sets to the target, against the random set's.
        fitting_evaluations: trials that fitting the graph spent on the sources.
        fitting_seconds: wall time of that.
        machine: what the seconds were measured on.
        answers: one per method, in their order.
    """

    number: int
    maps: tuple[str, ...]
    optimum: float
    transfers: tuple[tuple[float, ...], ...]
    to_target: tuple[float, ...]
    fitting_evaluations: int
    fitting_seconds: float
    machine: str
    answers: tuple[Answer, ...]


class Ground(NamedTuple):
    """What all methods of a draw meet.

    Attributes:
        target: what they tune.
        graph: what the sources taught.
        trained: what was trained elsewhere.
        share: of the paper's evaluations.
        seed: of every agent, so that the random set is one: method 1, and the reference of (11) and of Table 2.
    """

    target: TuningProblem
    graph: TransferGraph
    trained: Trained
    share: float
    seed: int


def six_maps(number: int = 1) -> list[Scenario]:
    """Return the maps of a draw, from hashed seeds: the first of each seed whose detour is like the paper's."""
    first = MAPS * (number - 1) + 1
    return draw("liu2020", MAPS, "mountains", SIDE, lambda s: s.optimum <= DETOUR * s.straight_line, first)


def play(number: int, arguments: Arguments, trained: Trained, advance: Callable[[int], None]) -> Draw:
    """Play one draw; ``advance`` is called with 1 after every method."""
    maps = six_maps(number)
    *sources, target = [
        TuningProblem(scenario, arguments.rules, ANTS, ITERATIONS, _seed("runs", i, arguments))
        for i, scenario in enumerate(maps, start=MAPS * (number - 1) + 1)
    ]
    begun = time.perf_counter()
    graph = _fit(sources, arguments.share, _seed("graph", number, arguments))
    fitting = time.perf_counter() - begun
    ground = Ground(target, graph, trained, arguments.share, _seed("agent", number, arguments))
    answers = []
    for method in METHODS:
        answers.append(solve(method, ground))
        advance(1)
    return Draw(
        number,
        tuple(scenario.digest for scenario in maps),
        target.scenario.optimum,
        tuple(tuple(row) for row in transfers(graph.table).tolist()),
        _to_target(ground, next(a for a in answers if a.method == RANDOM.label)),
        graph.evaluations,
        round(fitting, 6),
        "{cpu}, {threads} planner threads".format_map(facts()),
        tuple(answers),
    )


def solve(method: Method, ground: Ground) -> Answer:
    """Let a method tune the target, then run its answer on fresh seeds."""
    agent, before = build(method, ground.graph, ground.trained, ground.share)
    target = ground.target
    session = Session(target, method.budget(ground.share))
    begun = time.perf_counter()
    unit, trials = tune(agent, session, seed=ground.seed)
    seconds = time.perf_counter() - begun
    plans = target.fresh(unit, RUNS)
    assert isinstance(plans, Plans)  # of one robot each
    histories = np.array([plans.plan(i).best for i in range(RUNS)])
    return Answer(
        method.label,
        tuple(target.space.decode(unit)[0].tolist()),
        len(trials),
        before,
        round(seconds, 6),
        _found(plans.lengths),
        tuple(target.gap(plans.lengths).tolist()),
        tuple(getattr(agent, "notes", ())),
        _found(histories.mean(axis=0)),
        _steps(np.array(session.lengths)),
    )


def _seed(purpose: str, number: int, arguments: Arguments) -> int:
    return derived_seed("liu2020", purpose, number, arguments.seed)


def _fit(sources: list[TuningProblem], share: float, seed: int) -> TransferGraph:
    search = max(FEWEST, int(SEARCH * share))
    needed = trials_needed(len(sources), search, RUNS)
    sessions = [Session(problem, needed) for problem in sources]
    names = [f"map{i}" for i in range(1, MAPS)]
    return TransferGraph.fit(sessions, names=names, search=search, repeats=RUNS, seed=seed)


def _to_target(ground: Ground, reference: Answer) -> tuple[float, ...]:
    """Return 1 - cost of every source's set / cost of the random one, by fresh runs on the target, (5,)."""
    target = ground.target
    lengths = np.array([np.inf if length is None else length for length in reference.lengths])
    base = target.cost(lengths).mean()
    costs = [target.cost(target.fresh(unit, RUNS).lengths).mean() for unit in ground.graph.settings]
    return tuple(float(1 - cost / base) for cost in costs)


def _steps(lengths: Values) -> tuple[tuple[int, float], ...]:
    shortest = np.minimum.accumulate(np.append(np.inf, lengths))
    new = np.flatnonzero(shortest[1:] < shortest[:-1])
    return tuple((int(i) + 1, float(lengths[i])) for i in new)


def _found(lengths: Values) -> tuple[float | None, ...]:
    return tuple(length if np.isfinite(length) else None for length in lengths.tolist())
