"""What an agent sees, as a vector or with a map beside it: one function each for environments and policies."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from antgym.maps.features import Feature
from antgym.tuning.features import TASK_FEATURES, feature_bounds
from antgym.tuning.problem import COST_CAP, Task
from antgym.tuning.session import Trial, incumbent

_LOG_CAP = np.log(COST_CAP)


def observe(task: Task, trials: Sequence[Trial] = (), *, window: int = 0) -> NDArray[np.float32]:
    """Return the observation of a task after some trials, float32.

    Args:
        task: the task.
        trials: what has been paid for so far.
        window: how many of the last trials to show; 0 shows the features alone.

    Returns:
        features; and for ``window`` > 0: the share of the budget left, the incumbent's setting and cost, then
        per trial of the window, latest first: its setting and cost and a 1 (all 0 where there is none yet).
        Costs are shown as log(cost) / log(COST_CAP); see :func:`bounds` for the range of every entry.
    """
    if window == 0:
        return task.features.copy()
    d = len(task.space)
    units, costs = np.zeros((1, 1 + window, d)), np.zeros((1, 1 + window))
    if trials:
        units[0, 0], costs[0, 0] = incumbent(trials)
    for i, trial in enumerate(reversed(trials[-window:]), start=1):
        units[0, i], costs[0, i] = trial.unit, trial.cost
    left = np.array([(task.budget - len(trials)) / task.budget])
    return observe_together(task.features[None], left, units, costs)[0]


def observe_together(
    features: NDArray[np.float32],
    left: NDArray[np.float64],
    units: NDArray[np.float64],
    costs: NDArray[np.float64],
) -> NDArray[np.float32]:
    """Return what :func:`observe` shows of n tasks in one array, (n, m).

    Args:
        features: (n, m), of the tasks; all on grids, or all among discs.
        left: (n,), shares of their budgets.
        units: (n, 1 + window, d), settings: the incumbent's, then those of the last trials, latest first; 0 where
            there is none yet.
        costs: (n, 1 + window), and what they cost, 0 where there is none.
    """
    count, rows, d = units.shape
    shown = np.empty((count, rows, d + 2))
    logs = np.log(np.where(costs > 0, costs, 1.0)) / _LOG_CAP  # as in shown_cost
    shown[..., :d], shown[..., d], shown[..., d + 1] = (
        units,
        np.minimum(np.maximum(logs, 0.0), 1.0),
        costs > 0,
    )
    flat = shown.reshape(count, -1)
    parts = features, left[:, None], flat[:, : d + 1], flat[:, d + 2 :]  # no 1 beside the incumbent
    return np.concatenate(parts, axis=1, dtype=np.float32, casting="same_kind")


def observe_with_map(
    task: Task, trials: Sequence[Trial] = (), *, window: int = 0, flat: bool | None = None
) -> dict[str, NDArray[np.float32]]:
    """Return ``{"features": observe(...), "map": task.map(flat)}``, copies both."""
    return {"features": observe(task, trials, window=window), "map": task.map(flat).copy()}


def bounds(
    dimension: int, *, window: int = 0, features: Sequence[Feature] = TASK_FEATURES
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return (low, high) of :func:`observe` for a space of ``dimension`` parameters and a table of features."""
    extra = 1 + dimension + 1 + window * (dimension + 2) if window else 0
    low, high = feature_bounds(features)
    return np.pad(low, (0, extra)), np.pad(high, (0, extra), constant_values=1.0)


def shown_cost(cost: float) -> float:
    """Return log(cost) / log(COST_CAP) within [0, 1], as costs are shown."""
    return float(min(max(np.log(cost) / _LOG_CAP, 0.0), 1.0))
