"""Infos: facts of several environments side by side, and how Gymnasium wants them, alone and in a batch."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Columns = dict[str, Any]
"""Facts by name, one value an environment: a list of plain ones, an array of numbers, or columns again."""


def row(columns: Columns, index: int) -> dict[str, Any]:
    """Return the plain facts of one environment."""
    return {
        name: row(values, index)
        if isinstance(values, dict)
        else values.item(index)
        if isinstance(values, np.ndarray)
        else values[index]
        for name, values in columns.items()
    }


def some(columns: Columns, indices: NDArray[np.intp]) -> Columns:
    """Return the facts of some of the environments."""
    return {
        name: some(values, indices)
        if isinstance(values, dict)
        else values[indices]
        if isinstance(values, np.ndarray)
        else [values[i] for i in indices]
        for name, values in columns.items()
    }


def gathered(count: int, parts: Sequence[tuple[NDArray[np.intp], Columns]]) -> dict[str, Any]:
    """Return the facts of some slots as arrays over all of a batch, each beside its mask.

    Args:
        count: of the slots of the batch.
        parts: slots, and the facts of each of them; no two parts say the same of a slot.
    """
    batch: dict[str, Any] = {}
    nested: dict[str, list[tuple[NDArray[np.intp], Columns]]] = {}
    for slots, columns in parts:
        for name, values in columns.items() if len(slots) else ():
            mask = batch.setdefault(f"_{name}", np.zeros(count, bool))
            mask[slots] = True
            if isinstance(values, dict):
                nested.setdefault(name, []).append((slots, values))
            else:
                _fill(batch.setdefault(name, _blank(count, values)), slots, values)
    return batch | {name: gathered(count, own) for name, own in nested.items()}


def _blank(count: int, values: Any) -> NDArray[Any]:
    kind = values.dtype if isinstance(values, np.ndarray) else type(values[0])
    plain = kind in (int, float, bool)
    return np.zeros(count, kind) if plain else np.full(count, None, object)


def _fill(column: NDArray[Any], slots: NDArray[np.intp], values: Any) -> None:
    if isinstance(values, list) and column.dtype == object:  # what has a length would be taken apart
        for slot, value in zip(slots.tolist(), values, strict=True):
            column[slot] = value
    else:
        column[slots] = values
