"""Naive ants: how far a map's heuristic alone leads a few ants that find no pheromone but the first.

Whether the heuristic leads past dead ends, or into them, says more about the setting that a map wants than its
obstacles do: on the 1,600 train maps of open-v0, each left out in turn, what a multi-task Gaussian process chose lost
12.0 % to the map's best of 64 settings without these features and 8.6 % with them (13.1 %: the best setting by rules).
Five groups of sixteen walk once each; 9 × 200 ants told no more.

They are part of a task's description, as the walk of the single greedy ant is: the same for every agent, whatever the
seed of the problem. Nothing is learnt from one walk to the next, so that they are no trial; a trial of the median
task lets 400 ants walk.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from antgym.maps.features import Feature
from antgym.maps.fleet import Fleet, robots_of
from antgym.maps.world import Scenario
from antgym.planners.planning import AnyRules, plan_many
from antgym.planners.swarms import space_of

WEIGHTS = (0.05, 0.3, 0.5, 0.7, 0.95)  # of the heuristic, in the unit interval of β's range
NAIVE_ANTS = 16  # that walk under each
FARTHEST_DETOUR = 10.0  # straight lines, from which on a path counts as that long; as if none had arrived

NAIVE_FEATURES = (
    *(
        Feature(
            f"naive_arrive_{i + 1}",
            0.0,
            1.0,
            f"{NAIVE_ANTS} ants without pheromone, the heuristic weighted by {weight:g} of its range: log2 of 1 + "
            f"those that arrive, over log2 of {1 + NAIVE_ANTS}",
        )
        for i, weight in enumerate(WEIGHTS)
    ),
    *(
        Feature(
            f"naive_detour_{i + 1}",
            0.0,
            1.0,
            "log10 of their mean length in straight lines; 1 where none arrives",
        )
        for i in range(len(WEIGHTS))
    ),
)


def naive_features(scenario: Scenario[Any, Any] | Fleet, rules: AnyRules) -> NDArray[np.float64]:
    """Return the values of ``NAIVE_FEATURES``, always alike for a scenario and rules; of a fleet, its robots' mean."""
    return np.mean([_walks(robot, rules) for robot in robots_of(scenario)], axis=0)


def _walks(scenario: Scenario[Any, Any], rules: AnyRules) -> NDArray[np.float64]:
    units = np.full((len(WEIGHTS), 4), 0.5)
    units[:, 1] = WEIGHTS
    plans = plan_many(
        [scenario] * len(WEIGHTS),
        space_of(rules, scenario, NAIVE_ANTS).decode(units),
        rules=rules,
        ants=NAIVE_ANTS,
        iterations=1,
        seeds=np.arange(len(WEIGHTS)),
    )
    walks = [plans.plan(i) for i in range(len(WEIGHTS))]
    arrived = np.array([walk.arrived[0] for walk in walks])
    lengths = np.array([walk.mean[0] for walk in walks]) / scenario.straight_line
    detours = np.log10(np.clip(lengths, 1.0, FARTHEST_DETOUR)) / np.log10(FARTHEST_DETOUR)
    return np.concatenate([np.log2(1 + arrived) / np.log2(1 + NAIVE_ANTS), detours])
