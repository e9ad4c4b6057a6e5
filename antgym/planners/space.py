"""Parameter spaces: the unit cube agents search, mapped to natural values with the default in the middle."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antgym.errors import ParameterError, nearest

Floats = NDArray[np.float64]
_SCALES: dict[str, tuple[Callable[[Floats], Floats], Callable[[Floats], Floats]]] = {
    "linear": (lambda x: x, lambda t: t),
    "log": (np.log, np.exp),
    "logit": (lambda x: np.log(x / (1 - x)), lambda t: 1 / (1 + np.exp(-t))),
}


class Parameter(NamedTuple):
    """One dimension of a space; ``scale`` is ``"linear"``, ``"log"`` or ``"logit"``."""

    name: str
    low: float
    default: float
    high: float
    scale: str = "linear"
    meaning: str = ""


@dataclass(frozen=True)
class ParameterSpace:
    """An ordered set of parameters.

    The map from the unit interval to natural values is monotone and, on the parameter's scale, linear in two
    pieces: 0 is the low end, 1/2 the published default, 1 the high end.

    Raises:
        ParameterError: if a parameter has no room (low < default < high is required), an unknown scale, or bounds
            its scale cannot take.
    """

    parameters: tuple[Parameter, ...]

    def __post_init__(self) -> None:
        for p in self.parameters:
            if p.scale not in _SCALES:
                raise ParameterError(
                    f"{p.name}: unknown scale {p.scale!r}; {nearest(p.scale, tuple(_SCALES))}"
                )
            if not -np.inf < p.low < p.default < p.high < np.inf:
                raise ParameterError(
                    f"{p.name}: needs finite low < default < high, got {p.low}, {p.default}, {p.high}"
                )
            if (p.scale != "linear" and p.low <= 0) or (p.scale == "logit" and p.high >= 1):
                raise ParameterError(f"{p.name}: bounds {p.low}, {p.high} do not fit the {p.scale} scale")

    def __len__(self) -> int:
        return len(self.parameters)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Parameter names in order."""
        return tuple(p.name for p in self.parameters)

    @cached_property
    def _values(self) -> Floats:
        """Low, default and high, (3, d)."""
        return np.array([(p.low, p.default, p.high) for p in self.parameters]).T

    @cached_property
    def _knots(self) -> Floats:
        """The same on each parameter's scale, (3, d)."""
        return np.stack([_knots(p) for p in self.parameters], axis=1)

    @cached_property
    def _frame(self) -> Floats:
        """Knots and values, (2, 3, d)."""
        return np.stack([self._knots, self._values])

    @cached_property
    def _scales(self) -> tuple[str, ...]:
        return tuple(p.scale for p in self.parameters)

    @cached_property
    def _columns(self) -> dict[str, NDArray[np.intp]]:
        """The columns of each scale in use."""
        scales = np.array(self._scales)
        return {scale: np.flatnonzero(scales == scale) for scale in dict.fromkeys(self._scales)}

    @property
    def default(self) -> Floats:
        """Natural default values, (d,)."""
        return np.array([p.default for p in self.parameters])

    def check(self, units: ArrayLike) -> Floats:
        """Return settings as a (k, d) float64 array; ParameterError unless all lie in [0, 1]."""
        array = np.atleast_2d(np.asarray(units, dtype=np.float64))
        if array.ndim != 2 or array.shape[1] != len(self):
            raise ParameterError(
                f"settings must have shape (k, {len(self)}) for {self.names}, got {array.shape}"
            )
        if not ((array >= 0) & (array <= 1)).all():
            row, column = np.argwhere(~((array >= 0) & (array <= 1)))[0]
            raise ParameterError(
                f"setting {row}: {self.names[column]} = {array[row, column]} lies outside the unit interval [0, 1]; "
                "clip it, or encode natural values with space.encode()"
            )
        return array

    def decode(self, units: ArrayLike) -> Floats:
        """Map (k, d) settings in [0, 1] to natural values, (k, d) float64."""
        return _decoded(self.check(units), self._frame, self._columns)

    def encode(self, naturals: ArrayLike) -> Floats:
        """Map natural values (k, d) to [0, 1]; ParameterError naming a value outside its range."""
        array = np.atleast_2d(np.asarray(naturals, dtype=np.float64))
        if array.ndim != 2 or array.shape[1] != len(self):
            raise ParameterError(f"need {len(self)} values {self.names} a row, got shape {array.shape}")
        return np.stack([_encode(p, array[:, i]) for i, p in enumerate(self.parameters)], axis=1)

    def mean(self, units: ArrayLike, weights: ArrayLike) -> Floats:
        """Return the weighted mean of settings, (d,) in [0, 1], taken on each parameter's own scale.

        Args:
            units: (k, d) settings in [0, 1].
            weights: (k,), not negative, adding up to 1.
        """
        scaled, naturals = np.asarray(weights) @ self._to_scale(self.decode(units)), np.empty(len(self))
        for scale, columns in self._columns.items():
            naturals[columns] = _SCALES[scale][1](scaled[columns])
        return self.encode(np.clip(naturals, self._values[0], self._values[2]))[0]

    def _to_scale(self, naturals: Floats) -> Floats:
        scaled = np.empty_like(naturals)
        for scale, columns in self._columns.items():
            scaled[:, columns] = _SCALES[scale][0](naturals[:, columns])
        return scaled

    def sample(self, rng: np.random.Generator, count: int) -> Floats:
        """Return (count, d) settings drawn uniformly from the unit cube."""
        return rng.random((count, len(self)))

    def to_markdown(self) -> str:
        """Return the table that docstrings and the README show."""
        rows = [
            "| num | parameter | low | default | high | scale | meaning |",
            "|---|---|---|---|---|---|---|",
        ]
        for i, p in enumerate(self.parameters):
            rows.append(
                f"| {i} | {p.name} | {p.low:g} | {p.default:g} | {p.high:g} | {p.scale} | {p.meaning} |"
            )
        return "\n".join(rows)


def check_together(spaces: Sequence[ParameterSpace], units: Sequence[ArrayLike]) -> list[Floats]:
    """Return what the ``check`` of each space makes of its own (k, d) settings."""
    arrays = [np.asarray(each, dtype=np.float64) for each in units]
    widths, shapes = {len(space.parameters) for space in spaces}, {array.shape[1:] for array in arrays}
    if len(widths) == 1 and shapes == {tuple(widths)}:
        values = np.concatenate(arrays)
        if ((values >= 0) & (values <= 1)).all():
            return arrays
    return [space.check(array) for space, array in zip(spaces, arrays, strict=True)]


def decode_together(spaces: Sequence[ParameterSpace], units: Floats) -> Floats:
    """Return what each space makes of its own row of (k, d) checked settings, (k, d) natural values."""
    first = spaces[0]
    if all(space is first for space in spaces):
        return _decoded(units, first._frame, first._columns)
    if any(space._scales != first._scales for space in spaces):
        return np.concatenate([space.decode(unit) for space, unit in zip(spaces, units, strict=True)])
    frames = np.concatenate([space._frame for space in spaces]).reshape(len(spaces), *first._frame.shape)
    return _decoded(units, frames.transpose(1, 2, 0, 3), first._columns)


def named_values(space: ParameterSpace, values: Sequence[float]) -> dict[str, float]:
    """Return {name: value} as plain floats."""
    return {name: float(value) for name, value in zip(space.names, values, strict=True)}


def _decoded(array: Floats, frame: Floats, columns: dict[str, NDArray[np.intp]]) -> Floats:
    """Map (k, d) settings to natural values within a frame, (2, 3, d) or (2, 3, k, d)."""
    knots, values = frame
    upper = array >= 0.5
    share = 2 * array - upper  # of the way from one knot to the next
    low, default, high = knots
    begin, end = np.where(upper, default, low), np.where(upper, high, default)
    scaled = begin + share * (end - begin)
    natural = np.empty_like(scaled)
    for scale, some in columns.items():
        natural[:, some] = _SCALES[scale][1](scaled.take(some, axis=1))
    # whatever exp(log(x)) rounds to, the three knots are exact and no value passes one
    low, default, high = values
    begin, end = np.where(upper, default, low), np.where(upper, high, default)
    natural = np.minimum(np.maximum(natural, begin), end)
    return np.where(share == 0, begin, np.where(share == 1, end, natural))


def _knots(p: Parameter) -> Floats:
    return _SCALES[p.scale][0](np.array([p.low, p.default, p.high]))


def _encode(p: Parameter, naturals: Floats) -> Floats:
    outside = ~((naturals >= p.low) & (naturals <= p.high))
    if outside.any():
        raise ParameterError(
            f"{p.name} = {naturals[outside][0]:g} lies outside its range [{p.low:g}, {p.high:g}]"
        )
    return np.interp(_SCALES[p.scale][0](naturals), _knots(p), [0.0, 0.5, 1.0])
