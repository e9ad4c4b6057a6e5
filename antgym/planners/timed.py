"""Timed paths: where a robot is when, and when two of them come too near to each other."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antgym.errors import ParameterError

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class TimedPath:
    """Points and when a robot is there; in between it moves evenly, before the first and after the last it stands.

    Attributes:
        points: (n, d) float64 world units, n ≥ 1; two that are the same one behind the other are a wait.
        times: (n,) float64 seconds, rising or equal for equal points; the first is 0.
    """

    points: Floats = field(repr=False)
    times: Floats = field(repr=False)

    @property
    def arrival(self) -> float:
        """Seconds until it stands at its goal for good."""
        return float(self.times[-1])

    @property
    def length(self) -> float:
        """World units that it travels."""
        return float(np.linalg.norm(np.diff(self.points, axis=0), axis=1).sum())

    @property
    def waited(self) -> float:
        """Seconds that it stands on its way, before it arrives."""
        still = (np.diff(self.points, axis=0) == 0).all(axis=1)
        return float(np.diff(self.times)[still].sum())

    @classmethod
    def even(cls, points: Floats, speed: float) -> "TimedPath":
        """Return the path over (n, d) points at one speed, world units per second, without a wait."""
        steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
        return cls(points, np.concatenate([[0.0], np.cumsum(steps / speed)]))

    def at(self, times: Floats | float) -> Floats:
        """Return where it is at times, (..., d)."""
        return np.stack([np.interp(times, self.times, axis) for axis in self.points.T], axis=-1)


class Conflict(NamedTuple):
    """Two robots nearer to each other than they may be.

    Attributes:
        first: index of the one.
        second: index of the other, larger.
        time: when it begins, seconds.
        place: where the first robot then is.
    """

    first: int
    second: int
    time: float
    place: tuple[float, ...]


def conflicts(paths: Sequence[TimedPath], apart: float) -> list[Conflict]:
    """Return the first conflict of every two robots that have one, by time.

    Robots that pass through each other between two points (swap), stand where another passes (vertex), or come too near
    at whatever speeds are found alike: the distance of two even motions is smallest where a quadratic says.

    Args:
        paths: one a robot, in one unit.
        apart: what the distance of their centres must not fall below, world units, > 0.

    Raises:
        ParameterError: if the distance is not above 0.
    """
    if not (np.isfinite(apart) and apart > 0):
        raise ParameterError(f"apart = {apart}: robots keep a distance above 0")
    found = []
    for first, second in combinations(range(len(paths)), 2):
        time = meeting(paths[first], paths[second], apart)
        if time is not None:
            found.append(Conflict(first, second, time, tuple(paths[first].at(time).tolist())))
    return sorted(found, key=lambda conflict: conflict.time)


def nearest_approach(one: TimedPath, other: TimedPath) -> float:
    """Return the smallest distance of two robots over all time, world units."""
    times = np.unique(np.concatenate([one.times, other.times]))
    offset = one.at(times) - other.at(times)
    if len(times) == 1:
        return float(np.linalg.norm(offset[0]))
    along = np.diff(offset, axis=0)
    square = np.maximum((along**2).sum(axis=1), np.finfo(float).tiny)
    share = np.clip(-(offset[:-1] * along).sum(axis=1) / square, 0, 1)
    return float(np.linalg.norm(offset[:-1] + share[:, None] * along, axis=1).min())


def meeting(one: TimedPath, other: TimedPath, apart: float) -> float | None:
    """Return when two robots first come nearer than ``apart``; None where they never do."""
    times = np.unique(np.concatenate([one.times, other.times]))
    offset = one.at(times) - other.at(times)
    if np.linalg.norm(offset[0]) < apart:
        return float(times[0])
    along = np.diff(offset, axis=0)
    begins, ends = within(along, offset[:-1], apart)
    near = np.flatnonzero((begins < 1) & (ends > 0))
    if not len(near):
        return None
    i = near[0]
    return float(times[i] + max(begins[i], 0.0) * (times[i + 1] - times[i]))


def within(along: Floats, offset: Floats, apart: float) -> tuple[Floats, Floats]:
    """Return between which x a line ``offset + x · along`` is nearer to the origin than ``apart``.

    Args:
        along: (..., d).
        offset: (..., d).
        apart: > 0.

    Returns:
        Two (...,) arrays: begin and end, ±inf for a point that is always near, +inf and -inf for one that never is.
    """
    a, b, c = (along**2).sum(axis=-1), (along * offset).sum(axis=-1), (offset**2).sum(axis=-1) - apart * apart
    still = a <= np.finfo(float).tiny
    root = b * b - a * c
    met = np.where(still, c < 0, root > 0)
    half = np.where(still, np.inf, np.sqrt(np.maximum(root, 0)) / np.where(still, 1, a))
    middle = np.where(still, 0.0, -b / np.where(still, 1, a))
    return np.where(met, middle - half, np.inf), np.where(met, middle + half, -np.inf)
