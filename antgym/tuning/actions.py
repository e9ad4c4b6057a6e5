"""What actions ask for: settings, or changes of one; one function each for environments and policies."""

from collections.abc import Callable, Mapping, Sequence
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antgym.tuning.features import shown_rules

GRID = 2.0**24
CHANGES = (-0.25, -0.125, 0.0, 0.125, 0.25)
"""What a factorised action adds to a parameter in the unit cube: about /4, /2, keep, *2 and *4 for α and β of liu2020.

They are binary fractions, so that a walk over them from a setting of the grid stays on it, and float32 holds it.
"""
KEEP = CHANGES.index(0.0)
Change = Literal["each", "one"]
"""Whether an action changes each parameter, or one of them at most."""
Choice = Callable[[NDArray[np.float32]], NDArray[np.float64]]
"""Maps (n, k) features of tasks to (n, d) settings in the unit cube, as a policy of OneShot does."""
Start = Sequence[float] | Mapping[str, Sequence[float]] | Choice
"""A setting that changes begin from, one for each of some rules (under others the published default), or a choice."""
_DEFAULT = 0.5  # of every parameter


def settings_of(actions: ArrayLike) -> NDArray[np.float64]:
    """Return the settings in the unit cube that actions in [-1, 1] ask for; values outside are clipped.

    Settings lie on a grid of 2^-24, which float32 holds: what an observation shows of one can be proposed again.
    """
    values = np.clip(np.asarray(actions, dtype=np.float64), -1.0, 1.0)
    return np.round((values + 1) * GRID / 2) / GRID


def choices(how: Change, dimension: int) -> tuple[int, ...]:
    """Return how many values each number of a factorised action can take.

    ``"each"``: one number a parameter, an index into ``CHANGES``. ``"one"``: a single number; 0 keeps everything, the
    others go through the changes that are none of keeping, parameter by parameter.
    """
    return (len(CHANGES),) * dimension if how == "each" else (1 + dimension * (len(CHANGES) - 1),)


def changed(units: ArrayLike, picked: ArrayLike, how: Change) -> NDArray[np.float64]:
    """Return settings after factorised actions, held within the unit cube.

    Args:
        units: (n, d) settings that are changed.
        picked: (n, d) indices into ``CHANGES`` for ``"each"``; (n,) or (n, 1) numbers for ``"one"``, see `choices`.
        how: which of the two.
    """
    before, steps = np.asarray(units, dtype=np.float64), np.array(CHANGES)
    if how == "each":
        return np.clip(before + steps[np.asarray(picked)], 0.0, 1.0)
    numbers, others = np.asarray(picked).reshape(-1), np.delete(steps, KEEP)
    moved, added = before.copy(), np.flatnonzero(numbers)
    which, step = np.divmod(numbers[added] - 1, len(others))
    moved[added, which] += others[step]
    return np.clip(moved, 0.0, 1.0)


def moved(starts: ArrayLike, actions: ArrayLike) -> NDArray[np.float64]:
    """Return the settings of the grid that actions in [-1, 1] move starts to, by half a range at most."""
    reach = np.clip(np.asarray(actions, dtype=np.float64), -1.0, 1.0)
    return settings_of(2 * np.asarray(starts, dtype=np.float64) - 1 + reach)


def starts_of(start: Start | None, features: NDArray[np.float32], dimension: int) -> NDArray[np.float64]:
    """Return the (n, d) settings of the grid that changes begin from on some tasks.

    Args:
        start: one setting, one by rules, a choice, or None for the published default.
        features: (n, k), of the tasks; they show their rules.
        dimension: d.
    """
    if callable(start):
        return settings_of(2 * start(features) - 1)
    units = np.full((len(features), dimension), _DEFAULT)
    for unit, shown in zip(units, features, strict=True):
        found = start.get(shown_rules(shown) or "") if isinstance(start, Mapping) else start
        unit[:] = _DEFAULT if found is None else found
    return settings_of(2 * units - 1)
