"""The hives of wu2018: those that it compares, sound and as printed, and one with or without each of its ideas."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antgym.maps.discs import DiscScenario, path_length
from antgym.planners.bee_rules import BEE_PAPERS, BeeRules
from antgym.planners.parameters import BeeParameters
from antgym.planners.planning import plan_many

BEES, CYCLES, SEEDS = 40, 1000, 10
STEADY = 0.01  # of the last length: the best path is steady once it stays that close
PATIENT = 12.0  # times the published limit: sources × dimensions, as Karaboga has it
Values = NDArray[np.float64]


class Hive(NamedTuple):
    """Rules, and the parameters they are flown with in a world so wide."""

    label: str
    rules: BeeRules
    parameters: BeeParameters


class Outcome(NamedTuple):
    """What one hive did, (worlds, seeds) each.

    Attributes:
        steady: cycles until the best path without a collision stays within 1 % of the last one; all of them where
            there is none.
        length: of the best path, whether it touches a disc or not, in cm.
        gap: over the exact optimum, 1 at most and where the best path touches a disc.
        touching: share of the sources that touch a disc, over all cycles.
        collided: whether the best path does, in the end.
    """

    steady: Values
    length: Values
    gap: Values
    touching: Values
    collided: Values


def hives(width: float) -> list[Hive]:
    """Return the hives that are compared: the paper's two, the two as printed, then the ablation."""
    found = {
        name: BEE_PAPERS[name] for name in ("wu2018", "wu2018-basic", "wu2018-paper", "wu2018-basic-paper")
    }
    published = {
        name: BeeParameters(*rules.space(BEES, width).default.tolist()) for name, rules in found.items()
    }
    tabu, plain = found["wu2018"], found["wu2018-basic"]
    ours, theirs = published["wu2018"], published["wu2018-basic"]
    widest = tabu.space(BEES, width).decode([0.5, 0.5, 0.5, 1.0])[0, 3]
    return [
        *(Hive(name, rules, published[name]) for name, rules in found.items()),
        Hive("ABC with the falling ξ alone", tabu._replace(tabu=0), ours),
        Hive("ABC with the tabu list alone", tabu, ours._replace(xi_max=1.0, xi_min=1.0)),
        Hive("TS-ABC with the widest tabu radius", tabu, ours._replace(tabu_radius=float(widest))),
        Hive("TS-ABC that is patient", tabu, ours._replace(limit=PATIENT * ours.limit)),
        Hive("ABC that is patient", plain, theirs._replace(limit=PATIENT * theirs.limit)),
    ]


def fly(hive: Hive, scenarios: list[DiscScenario], seed: int, advance: Callable[[int], Any]) -> Outcome:
    """Fly a hive SEEDS times in every world; ``advance`` hears of every world."""
    parts = []
    keys = np.random.SeedSequence(seed).generate_state(len(scenarios) * SEEDS, np.uint64).reshape(-1, SEEDS)
    for scenario, seeds in zip(scenarios, keys, strict=True):
        plans = plan_many(
            [scenario] * SEEDS,
            [hive.parameters] * SEEDS,
            rules=hive.rules,
            ants=BEES,
            iterations=CYCLES,
            seeds=seeds,
        )
        found = [plans.plan(i) for i in range(SEEDS)]
        gaps = np.minimum(plans.lengths / scenario.optimum - 1, 1)
        lengths, arrived = [path_length(plan.path) for plan in found], [plan.arrived for plan in found]
        touching = 1 - np.mean(arrived, axis=1) / (BEES // 2)
        steady = [_steady(plan.best) for plan in found]
        parts.append((steady, lengths, gaps, touching, np.isinf(plans.lengths)))
        advance(1)
    return Outcome(*(np.array(column, dtype=np.float64) for column in zip(*parts, strict=True)))


def _steady(best: Values) -> int:
    """Return after how many cycles a history of best lengths is within STEADY of its end, and stays there."""
    if np.isinf(best[-1]):
        return len(best)
    away = np.flatnonzero(np.abs(best / best[-1] - 1) > STEADY)
    return int(away[-1]) + 2 if len(away) else 1
