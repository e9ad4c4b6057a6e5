"""Schedules: when a robot moves along its path and where it waits, so that it arrives first and meets nobody.

The path is given, the times are not: at every point the robot may wait. It waits within *safe intervals*, when nobody
else is near that point, and moves when nobody crosses its way; both are intervals of time known in closed form. A sweep
over points and safe intervals finds the earliest arrival there is (safe-interval path planning, Phillips & Likhachev
2011, along a line and in continuous time).
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antgym.maps.fleet import ROUNDING
from antgym.planners.timed import TimedPath, within

Floats = NDArray[np.float64]
Interval = tuple[float, float]


class _Stay(NamedTuple):
    """At one point, in one safe interval: when it is reached first, until when it may last, and what came before."""

    arrival: float
    until: float
    interval: int
    before: "_Stay | None"
    departure: float  # from the point before


class _Segments(NamedTuple):
    """Even motions of all others: m places, velocities, beginnings and durations, inf of those that stand for good."""

    places: Floats
    velocities: Floats
    begins: Floats
    lasts: Floats

    def some(self, which: NDArray[np.intp]) -> "_Segments":
        """Return some of them, one as often as it is named."""
        return _Segments(*(column[which] for column in self))

    @property
    def ways(self) -> Floats:
        """(m, d) from where each begins to where it ends, world units."""
        return self.velocities * np.where(np.isfinite(self.lasts), self.lasts, 0.0)[:, None]


def schedule(points: Floats, speed: float, others: Sequence[TimedPath], apart: float) -> TimedPath | None:
    """Return the timed path over points that arrives first and keeps ``apart`` from all others; None where none does.

    Args:
        points: (n, d) world units, n ≥ 2, no two the same in a row.
        speed: world units per second while it moves.
        others: whose times are fixed.
        apart: smallest distance of centres, world units.
    """
    durations = np.linalg.norm(np.diff(points, axis=0), axis=1) / speed
    segments = _segments(others, points.shape[1])
    safe = [_gaps(near) for near in _near(points, segments, apart - ROUNDING)]
    crossed = _crossings(points, durations, segments, apart - ROUNDING)
    stays = [_Stay(0.0, last, i, None, 0.0) for i, (first, last) in enumerate(safe[0]) if first <= 0 <= last]
    for i, duration in enumerate(durations.tolist()):
        stays = _moved_on(stays, duration, safe[i + 1], crossed[i])
    final = [stay for stay in stays if stay.until == np.inf]
    return _timed(points, min(final, key=lambda stay: stay.arrival)) if final else None


def _moved_on(
    stays: list[_Stay], duration: float, safe: list[Interval], crossed: list[Interval]
) -> list[_Stay]:
    """Return the earliest stay in every safe interval of the next point."""
    found = []
    for i, (first, last) in enumerate(safe):
        reached = []
        for stay in stays:
            departure = _outside(max(stay.arrival, first - duration), crossed)
            if departure < np.inf and departure <= stay.until and departure + duration <= last:
                reached.append(_Stay(departure + duration, last, i, stay, departure))
        if reached:
            found.append(min(reached, key=lambda stay: stay.arrival))
    return found


def _timed(points: Floats, stay: _Stay) -> TimedPath:
    """Return the path whose last stay is given: at every point its arrival and, after a wait, its departure."""
    times, places = [], []
    left, i = stay.arrival, len(points) - 1
    while True:
        times += [left, stay.arrival] if left > stay.arrival else [stay.arrival]
        places += [points[i]] * (2 if left > stay.arrival else 1)
        if stay.before is None:
            return TimedPath(np.array(places[::-1]), np.array(times[::-1]))
        left, stay, i = stay.departure, stay.before, i - 1


def _segments(others: Sequence[TimedPath], dimensions: int) -> _Segments:
    """Return all even motions of others from time 0 on, waits and what comes after the last point included."""
    parts = [_Segments(*(np.empty((0, dimensions)),) * 2, *(np.empty(0),) * 2)]
    for path in others:
        lasts = np.append(np.diff(path.times), np.inf)
        moved = np.vstack([np.diff(path.points, axis=0), np.zeros((1, dimensions))])
        kept = lasts > 0
        velocities = moved[kept] / lasts[kept, None]
        parts.append(_Segments(path.points[kept], velocities, path.times[kept], lasts[kept]))
    return _Segments(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


def _near(points: Floats, segments: _Segments, apart: float) -> list[list[Interval]]:
    """Return when others are near each of n points."""
    rows, others = _neighbours(points, np.zeros_like(points), segments, apart)
    begin, end = within(others.velocities, others.places - points[rows], apart)
    return _intervals(len(points), rows, others, np.maximum(begin, 0), np.minimum(end, others.lasts))


def _crossings(points: Floats, durations: Floats, segments: _Segments, apart: float) -> list[list[Interval]]:
    """Return for each of n moves when it must not begin.

    A move of s ∈ [0, τ] and a motion of u ∈ [0, U] meet where |D + V s - W u| < apart, a convex part of a rectangle;
    t = u - s must not be what it is there. The ends of t lie on the rectangle's sides, or where the relative velocity
    is at right angles to the offset: there the two just touch.
    """
    moves = np.diff(points, axis=0)
    rows, others = _neighbours(points[:-1], moves, segments, apart)
    taus = durations[rows]
    velocity, offset = moves[rows] / taus[:, None], points[rows] - others.places
    low, high = np.full(len(rows), np.inf), np.full(len(rows), -np.inf)
    for begin, end in (
        *_along_motion(velocity, offset, taus, others, apart),
        *_along_move(velocity, offset, taus, others, apart),
        _touching(velocity, offset, taus, others, apart),
    ):
        low, high = np.fmin(low, begin), np.fmax(high, end)
    return _intervals(len(moves), rows, others, low, high)


def _neighbours(
    places: Floats, ways: Floats, segments: _Segments, apart: float
) -> tuple[NDArray[np.intp], _Segments]:
    """Return the k pairs of a line and a segment that are not too far from each other to meet, whatever the times.

    Args:
        places: (n, d), where lines begin.
        ways: (n, d), from there to where they end.
        segments: of others.
        apart: smallest distance.

    Returns:
        (k,) index of the line, rising, and the segments.
    """
    between = (places + ways / 2)[:, None] - (segments.places + segments.ways / 2)
    reach = np.linalg.norm(ways, axis=1)[:, None] / 2 + np.linalg.norm(segments.ways, axis=1) / 2 + apart
    rows, which = np.nonzero((between**2).sum(axis=-1) <= reach**2 + ROUNDING)
    return rows, segments.some(which)


def _along_motion(
    velocity: Floats, offset: Floats, taus: Floats, others: _Segments, apart: float
) -> list[tuple[Floats, Floats]]:
    """Return the (k,) ends of t where s is 0 or τ and u varies; NaN where they do not meet."""
    ends = []
    for s in (np.zeros_like(taus), taus):
        begin, end = within(-others.velocities, offset + s[:, None] * velocity, apart)
        begin, end = np.maximum(begin, 0), np.minimum(end, others.lasts)
        met = begin < end
        ends.append((np.where(met, begin - s, np.nan), np.where(met, end - s, np.nan)))
    return ends


def _along_move(
    velocity: Floats, offset: Floats, taus: Floats, others: _Segments, apart: float
) -> list[tuple[Floats, Floats]]:
    """Return the (k,) ends of t where u is 0 or U and s varies; NaN where they do not meet."""
    ends = []
    lasting = np.isfinite(others.lasts)
    for u in (np.zeros_like(taus), np.where(lasting, others.lasts, 0.0)):
        begin, end = within(velocity, offset - u[:, None] * others.velocities, apart)
        begin, end = np.maximum(begin, 0), np.minimum(end, taus)
        met = begin < end
        # what stands for good forbids all times from then on
        last = np.where(lasting, u - begin, np.inf)
        ends.append((np.where(met, u - end, np.nan), np.where(met, last, np.nan)))
    return ends


def _touching(
    velocity: Floats, offset: Floats, taus: Floats, others: _Segments, apart: float
) -> tuple[Floats, Floats]:
    """Return the (k,) t at which the two just touch somewhere inside the rectangle; NaN where they do not.

    At a given t the offset is D - W t + (V - W) s; its part across V - W is smallest of all s, and grows with t.
    """
    relative = velocity - others.velocities
    square = np.maximum((relative**2).sum(axis=1, keepdims=True), np.finfo(float).tiny)

    def across(vectors: Floats) -> Floats:
        return vectors - (vectors * relative).sum(axis=1, keepdims=True) / square * relative

    ends = []
    for end in within(across(-others.velocities), across(offset), apart):
        finite = np.isfinite(end)
        t = np.where(finite, end, 0.0)
        s = -((offset - others.velocities * t[:, None]) * relative).sum(axis=1) / square[:, 0]
        inside = finite & (s >= 0) & (s <= taus) & (s + t >= 0) & (s + t <= others.lasts)
        ends.append(np.where(inside, t, np.nan))
    return ends[0], ends[1]


def _intervals(
    count: int, rows: NDArray[np.intp], others: _Segments, begins: Floats, ends: Floats
) -> list[list[Interval]]:
    """Return for each of ``count`` rows the intervals that are not empty, counted from when a segment begins."""
    met = begins < ends
    rows, first, last = rows[met], (others.begins + begins)[met], (others.begins + ends)[met]
    bounds = np.searchsorted(rows, np.arange(count + 1)).tolist()
    return [_merged(first[a:b], last[a:b]) for a, b in pairwise(bounds)]


def _merged(begins: Floats, ends: Floats) -> list[Interval]:
    """Return open intervals as few that do not overlap, by time."""
    merged: list[Interval] = []
    for begin, end in sorted(zip(begins.tolist(), ends.tolist(), strict=True)):
        if merged and begin < merged[-1][1]:
            merged[-1] = merged[-1][0], max(merged[-1][1], end)
        else:
            merged.append((begin, end))
    return merged


def _gaps(near: list[Interval]) -> list[Interval]:
    """Return the closed intervals between open ones, from 0 on; the last may have no end."""
    ends = [0.0, *(end for _, end in near)]
    begins = [*(begin for begin, _ in near), np.inf]
    return [(end, begin) for end, begin in zip(ends, begins, strict=True) if end <= begin and end < np.inf]


def _outside(time: float, intervals: list[Interval]) -> float:
    """Return the first time from one on that lies in none of some open intervals that do not overlap."""
    for begin, end in intervals:
        if begin < time < end:
            time = end
    return time
