"""What an agent sees, as a vector or with a map beside it: one function each for environments and policies."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from antgym.tuning.features import TASK_FEATURES
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
    units, paid, best = np.zeros((1, window, d)), np.zeros((1, window)), ((0.0,) * d, 0.0)
    for i, trial in enumerate(reversed(trials[-window:])):
        units[0, i], paid[0, i] = trial.unit, trial.cost
    if trials:
        best = incumbent(trials)
    left = np.array([(task.budget - len(trials)) / task.budget])
    return observe_together(task.features[None], left, np.array([best[0]]), np.array([best[1]]), units, paid)[
        0
    ]


def observe_together(
    features: NDArray[np.float32],
    left: NDArray[np.float64],
    best_units: NDArray[np.float64],
    best_costs: NDArray[np.float64],
    units: NDArray[np.float64],
    costs: NDArray[np.float64],
) -> NDArray[np.float32]:
    """Return what :func:`observe` shows of n tasks in one array, (n, m).

    Args:
        features: (n, len(TASK_FEATURES)), of the tasks.
        left: (n,) shares of their budgets.
        best_units: (n, d), the incumbents' settings; 0 before the first trial, as all that follows.
        best_costs: (n,), their mean costs.
        units: (n, window, d), settings of the last trials, latest first.
        costs: (n, window), and what they cost.
    """
    count, (_, window, d) = len(features), units.shape
    history = np.empty((count, window, d + 2))
    history[:, :, :d], history[:, :, d], history[:, :, d + 1] = units, _shown_costs(costs), costs > 0
    parts = (
        features,
        left[:, None],
        best_units,
        _shown_costs(best_costs)[:, None],
        history.reshape(count, -1),
    )
    return np.concatenate(parts, axis=1, dtype=np.float32, casting="same_kind")


def observe_with_map(
    task: Task, trials: Sequence[Trial] = (), *, window: int = 0, flat: bool | None = None
) -> dict[str, NDArray[np.float32]]:
    """Return ``{"features": observe(...), "map": task.map(flat)}``, copies both."""
    return {"features": observe(task, trials, window=window), "map": task.map(flat).copy()}


def bounds(dimension: int, *, window: int = 0) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return (low, high) of :func:`observe` for a space of ``dimension`` parameters."""
    low, high = [f.low for f in TASK_FEATURES], [f.high for f in TASK_FEATURES]
    if window:
        extra = 1 + dimension + 1 + window * (dimension + 2)
        low, high = low + [0.0] * extra, high + [1.0] * extra
    return np.array(low, dtype=np.float32), np.array(high, dtype=np.float32)


def shown_cost(cost: float) -> float:
    """Return log(cost) / log(COST_CAP) within [0, 1], as costs are shown."""
    return float(min(max(np.log(cost) / _LOG_CAP, 0.0), 1.0))


def _shown_costs(costs: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return :func:`shown_cost` of every cost, 0 where there is none."""
    return np.minimum(np.maximum(np.log(np.where(costs > 0, costs, 1.0)) / _LOG_CAP, 0.0), 1.0)
