"""What a board costs before anything of it is run: planner runs, core hours, and hours on some numbers of cores.

Work is what its runs take one after the other: planner runs, at what one is measured to take here on each map, and what
agents think meanwhile, as a ledger says that was timed. Units of a sweep wait for nobody, so that many cores take the
work divided by their number, but no less than the longest unit, which with ``--unit 1`` is the longest run; training
comes first, and takes what it takes.
"""

import time
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from agents.fitting import trials_needed
from antgym.console import progress
from antgym.envs.scenarios import find_items
from antgym.errors import LedgerError
from antgym.maps.suites import SuiteItem
from antgym.tuning.ledger import TIMING
from antgym.tuning.lines import read_fields
from antgym.tuning.problem import TRIAL, TuningProblem
from experiments import contest, leaderboard
from experiments.artefact_files import files_needed
from experiments.artefacts import REPEATS, problem
from experiments.presets import Preset
from experiments.tables.sheet import table
from experiments.tracks import Job, Round, agents_in, read_key

CORES = (1, 100, 10_000)
MEASURED = 8  # settings that a run is timed with on every map
PASSES = 2  # of which the quicker counts: whatever else the machine does only makes it slower
TRAIN_MAPS = 16  # on which a run of training is timed
PATIENCE = 2.0  # seconds before a bar is shown

Clock = Mapping[tuple[str, int], float]
"""Seconds of a planner run, by the name of its map and its iterations."""
Thought = Mapping[tuple[str, int], float]
"""Seconds that an agent thinks in a run, by its name and budget."""


class Share(NamedTuple):
    """What the rounds of a track at one budget cost; seconds of one core."""

    name: str
    runs: int
    trials: int
    judging: int
    planner: float
    thinking: float
    longest: float


class Training(NamedTuple):
    """What a file of trained agents takes: planner runs at most, and their seconds of one core."""

    name: str
    runs: int
    seconds: float


def shares(rounds: Sequence[Round], fresh: int, clock: Clock, thought: Thought) -> list[Share]:
    """Return what rounds cost; a run that two of them share is counted in the first, and a round left without any out.

    Args:
        rounds: of a board.
        fresh: runs that judge a recommendation.
        clock: of their maps.
        thought: what agents think; who is not among them thinks nothing.
    """
    seen: set[str] = set()
    found = []
    for played in rounds:
        jobs = [job for job in played.jobs if job.key not in seen]
        if not jobs:
            continue
        seen.update(job.key for job in jobs)
        trials = [_trials(job) for job in jobs]
        judging = [fresh if isinstance(job, contest.Job) else 0 for job in jobs]
        seconds = [clock[job.item.name, job.item.iterations] for job in jobs]
        planner = [sum(counts) * each for *counts, each in zip(trials, judging, seconds, strict=True)]
        thinking = [_thought(job, thought) for job in jobs]
        longest = max(map(sum, zip(planner, thinking, strict=True)))
        name = f"track {played.track}, trials per map: {played.budget:,}"
        counts = len(jobs), sum(trials), sum(judging)
        found.append(Share(name, *counts, sum(planner), sum(thinking), longest))
    return found


def _trials(job: Job) -> int:
    return job.budget if isinstance(job, contest.Job) else 1


def _thought(job: Job, thought: Thought) -> float:
    """Return what an agent thinks in a run: as timed at the nearest budget, in proportion to the trials."""
    budget = _trials(job)
    timed = [other for name, other in thought if name == job.entrant.name]
    if not timed:
        return 0.0
    near = min(timed, key=lambda other: abs(other - budget))
    return thought[job.entrant.name, near] * (budget / near if budget and near else 1.0)


def read_thought(folder: Path) -> Thought:
    """Return the mean seconds that agents thought in a ledger's runs; LedgerError where it has none."""
    found: dict[tuple[str, int], list[float]] = defaultdict(list)
    names = agents_in(folder)
    for line in read_fields(folder / TIMING, "run"):
        if "tuner" in line:  # else it is the exact planner's
            key = read_key(line["run"], names)
            if key.budget is not None:
                found[key.agent, key.budget].append(line["tuner"])
    if not found:
        raise LedgerError(
            f"--timed {folder}: there are no seconds of agents in {TIMING}; name a board that was played"
        )
    return {key: float(np.mean(seconds)) for key, seconds in found.items()}


def time_runs(items: Iterable[SuiteItem]) -> dict[tuple[str, int], float]:
    """Return the seconds that a planner run takes on each map, on one thread, over settings of every kind."""
    todo = list(items)
    found = {}
    with progress("timing planner runs", len(todo), after=PATIENCE) as advance:
        for item in todo:
            tuned = problem(item, "costs")
            units = np.clip(qmc.Sobol(len(tuned.space), seed=2).random(MEASURED), 0, 1)
            tuned.run(units[:1], TRIAL, 0)  # compiles, and packs the world
            found[item.name, item.iterations] = min(_seconds(tuned, units) for _ in range(PASSES)) / MEASURED
            advance(1)
    return found


def _seconds(tuned: TuningProblem, units: NDArray[np.float64]) -> float:
    begun = time.process_time()  # of all threads
    tuned.run(units, TRIAL, 0)
    return time.process_time() - begun


def trainings(names: Sequence[str], preset: Preset, each: float, rules: int) -> list[Training]:
    """Return what the files of some agents take, if none is there yet.

    What learning itself takes, of a policy or of nets, is not in it: it is no planner run.

    Args:
        names: of the agents.
        preset: how much is spent.
        each: seconds of a planner run.
        rules: how many the train maps are planned by.
    """
    more = rules - 1  # maps that a race by rules may add, for those that the others lack
    runs = {
        "static.json": preset.race_maps * preset.race_settings,
        "static_by_rules.json": (preset.race_maps + more) * preset.race_settings,
        "graph.json": preset.sources * trials_needed(preset.sources, preset.source_search, REPEATS),
        "experience.json": preset.experience_trials,
        "policy.json": preset.policy_evaluations,
    }
    needed = {*files_needed(names)}
    if "neural.json" in needed:
        needed.add("experience.json")  # to which nets are fitted
    return [Training(name, count, count * each) for name, count in runs.items() if name in needed]


def estimate(arguments: leaderboard.Arguments, timed: Path | None) -> str:
    """Return the arithmetic of a board as Markdown: its shares, its training, its hours on some numbers of cores."""
    plan = leaderboard.plan_board(arguments)
    rounds = leaderboard.untrained_board(arguments, plan)
    items = {(item.name, item.iterations): item for played in rounds for item in played.items}
    clock = time_runs(items.values())
    train = find_items(arguments.suite, "train")
    each = float(np.mean(list(time_runs(train[:TRAIN_MAPS]).values())))
    found = shares(rounds, plan.preset.fresh, clock, read_thought(timed) if timed else {})
    taught = trainings(leaderboard.names_of(arguments), plan.preset, each, len(set(train.rules)))
    parts = [
        f"A planner run takes {1000 * np.mean(list(clock.values())):.2f} ms of one core on these maps "
        f"({1000 * min(clock.values()):.2f} to {1000 * max(clock.values()):.2f}), "
        f"{1000 * each:.2f} ms on train maps.",
        _work(found),
        _training(taught),
        _hours(sum(one.planner + one.thinking for one in found), max(one.longest for one in found), taught),
    ]
    return "\n\n".join(parts)


def _work(found: Sequence[Share]) -> str:
    total = Share(
        "in all",
        runs=sum(share.runs for share in found),
        trials=sum(share.trials for share in found),
        judging=sum(share.judging for share in found),
        planner=sum(share.planner for share in found),
        thinking=sum(share.thinking for share in found),
        longest=max(share.longest for share in found),
    )
    rows = [
        [
            share.name,
            *(f"{count:,}" for count in (share.runs, share.trials, share.judging)),
            *map(duration, (share.planner, share.thinking, share.longest)),
        ]
        for share in (*found, total)
    ]
    return table(["", "runs", "trials at most", "judging runs", "planner", "thinking", "longest run"], rows)


def _training(taught: Sequence[Training]) -> str:
    rows = [[one.name, f"{one.runs:,}", duration(one.seconds)] for one in taught]
    return table(["training, once", "planner runs at most", "planner"], rows)


def _hours(work: float, longest: float, taught: Sequence[Training]) -> str:
    serial = sum(one.seconds for one in taught)
    rows = []
    for cores in CORES:
        board = max(longest, work / cores)
        rows.append([f"{cores:,}", duration(serial), duration(board), duration(serial + board)])
    return table(["cores", "training", "board, --unit 1", "in all"], rows)


def duration(seconds: float) -> str:
    """Return seconds as people read them."""
    for unit, size in (("h", 3600), ("min", 60), ("s", 1)):
        if seconds >= size:
            return f"{seconds / size:.1f} {unit}"
    return f"{1000 * seconds:.0f} ms"
