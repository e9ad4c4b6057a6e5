"""Features of a run on the way: what whoever steers it sees after every block, environments and policies alike."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from antgym.maps.features import Feature
from antgym.planners.diagnosis import Diagnosis
from antgym.planners.parameters import BeeParameters, ColonyParameters
from antgym.tuning.features import task_table
from antgym.tuning.observation import shown_cost
from antgym.tuning.open_trial import OpenTrial
from antgym.tuning.problem import Task

DEFAULT = 0.5  # of every parameter

RUN_FEATURES: tuple[Feature, ...] = (
    Feature("done", 0.0, 1.0, "share of the iterations that are walked"),
    Feature(
        "cost",
        0.0,
        1.0,
        "log10 of the shortest length so far over the straight line, 1 at most and before any",
    ),
    Feature("progress", 0.0, 1.0, "that length over the first one that a block ended with; 1 before any"),
    Feature("gained", 0.0, 1.0, "share by which the last block shortened it; 1 for the first path"),
    Feature(
        "spread",
        0.0,
        1.0,
        "mean length in the last iteration over the shortest so far, minus 1; 1 where no ant arrived, or no source is "
        "clear of discs",
    ),
    Feature("stagnation", 0.0, 1.0, "iterations since the shortest length last fell, over all iterations"),
    Feature(
        "arrived", 0.0, 1.0, "share of the last block's ants that arrived, or of its sources that are clear"
    ),
    Feature(
        "branching",
        0.0,
        1.0,
        "how many moves pheromone leaves open to the last iteration's ants: the (Σ τ)² / Σ τ² effective ones, from 0, "
        "one, to 1, all; of bees, the mean standard deviation of their sources' coordinates over that of random ones; "
        "1 at first",
    ),
    Feature(
        "distinct",
        0.0,
        1.0,
        "share of different walks among the ants of the last iteration, or of different sources; 1 at first",
    ),
)


def control_table(discs: bool, names: Sequence[str]) -> tuple[Feature, ...]:
    """Return the table of what is shown of a run on a grid or among discs, under parameters of some names."""
    setting = [
        Feature(name, 0.0, 1.0, f"{name} in the last block, over its range; 0.5, the default, at first")
        for name in names
    ]
    return (*task_table(discs), *RUN_FEATURES, *setting)


CONTROL_FEATURES = control_table(False, ColonyParameters._fields)
DISC_CONTROL_FEATURES = control_table(True, BeeParameters._fields)
"""Of rules with a tabu list; without one, the last is not there."""


def observe_run(task: Task, trial: OpenTrial) -> NDArray[np.float32]:
    """Return the observation of a trial under way, float32, see :func:`control_table`."""
    setting = trial.units[-1] if trial.units else (DEFAULT,) * len(task.space)
    run = run_features(trial.colony.diagnosis(), trial.straight_line)
    return np.concatenate([task.features, np.array((*run, *setting), dtype=np.float32)])


def run_features(run: Diagnosis, straight_line: float) -> tuple[float, ...]:
    """Return the len(RUN_FEATURES) features of a run, ``straight_line`` being the distance from start to goal."""
    unsolved, nobody = run.best == np.inf, run.mean == np.inf
    return (
        run.done,
        1.0 if unsolved else shown_cost(run.best / straight_line),
        1.0 if unsolved else min(run.best / run.first, 1.0),
        run.gained,
        1.0 if nobody else min(max(run.mean / run.best - 1.0, 0.0), 1.0),
        run.stagnation,
        run.arrived,
        run.branching,
        run.distinct,
    )
