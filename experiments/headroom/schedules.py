"""Dynamic headroom: what changing the parameters within a run could add to the best static setting."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from agents.steering import Schedule
from antgym.envs.control import BLOCKS, LEAST_ITERATIONS
from antgym.maps.suites import SuiteItem
from antgym.maps.world import Scenario
from antgym.planners.swarms import start
from antgym.planners.threads import run_ranges
from antgym.tuning.problem import TuningProblem
from experiments.headroom.measures import headroom
from experiments.headroom.pool import SCORE, Advance

Floats = NDArray[np.float64]
FACTORS = (0.25, 0.5, 2.0, 4.0)
SWITCHES = (2, 5, 8)  # blocks before the change
RUNS = 8


def family() -> list[Schedule]:
    """Return the static setting and all schedules that change one of the two once, up or down."""
    static = Schedule((1.0, 1.0), (1.0, 1.0), BLOCKS)
    ramps = [(1.0, factor) for factor in FACTORS] + [(factor, 1.0) for factor in FACTORS]
    changes = [((1.0, 1.0), ramp) for ramp in ramps] + [(ramp, (1.0, 1.0)) for ramp in ramps]
    return [static, *(Schedule(a, b, switch) for a, b in changes for switch in SWITCHES)]


def steerable(one: TuningProblem | SuiteItem) -> bool:
    """Whether a problem is one run, long enough that the control regime does not lengthen it."""
    return isinstance(one.scenario, Scenario) and one.iterations >= LEAST_ITERATIONS


def schedule_runs(train: int, test: int) -> int:
    """Return how many planner runs :func:`dynamic` takes on so many problems that are long enough."""
    return 0 if min(train, test) < 2 else RUNS * (train * len(family()) + test * 2)


def dynamic(
    train: list[TuningProblem], test: list[TuningProblem], static: Floats, maps: int, advance: Advance
) -> dict[str, Any] | None:
    """Return what the best schedule of the family, chosen on train, saves on test over the static setting.

    Only steerable problems count; None where there are too few.
    """
    chosen = [[p for p in split if steerable(p)][:maps] for split in (train, test)]
    if min(map(len, chosen)) < 2:
        return None
    schedules = family()
    learned = _gaps(chosen[0], schedules, static, advance).mean(axis=(0, 2))
    best = schedules[int(learned.argmin())]
    scored = _gaps(chosen[1], [schedules[0], best], static, advance).mean(axis=2)
    value, low, high = headroom(scored[:, 0], scored[:, 1])
    return {
        "schedule": best.label(train[0].space.names),
        "headroom": [round(v, 4) for v in (value, low, high)],
        "static gap": round(float(scored[:, 0].mean()), 4),
        "maps": len(chosen[1]),
    }


def _gaps(
    problems: list[TuningProblem], schedules: list[Schedule], static: Floats, advance: Advance
) -> Floats:
    """Return (maps, schedules, RUNS) gaps."""
    lengths = np.empty((len(problems), len(schedules), RUNS))
    jobs = list(np.ndindex(len(problems), len(schedules)))

    def work(first: int, last: int) -> None:
        for i, j in jobs[first:last]:
            seeds = problems[i].seeds(SCORE, 10_000 + j * RUNS, RUNS)
            lengths[i, j] = [_run(problems[i], schedules[j], static, int(seed)) for seed in seeds]
            advance(RUNS)

    run_ranges(work, len(jobs))
    return np.array(
        [p.gap(rows.ravel()).reshape(rows.shape) for p, rows in zip(problems, lengths, strict=True)]
    )


def _run(problem: TuningProblem, schedule: Schedule, static: Floats, seed: int) -> float:
    swarm = start(
        problem.scenario, rules=problem.rules, ants=problem.ants, iterations=problem.iterations, seed=seed
    )
    space = problem.space
    values, low, high = space.decode([static, np.zeros(len(space)), np.ones(len(space))])
    switch = problem.iterations * schedule.switch // BLOCKS
    for part, iterations in enumerate((switch, problem.iterations - switch)):
        factors = np.ones(len(space))
        factors[:2] = schedule.first[part], schedule.second[part]
        if iterations:
            swarm.advance(np.clip(values * factors, low, high), iterations)
    return swarm.result().length
