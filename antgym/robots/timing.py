"""Timing: how fast a path may be travelled, from rest to rest, and when each of its points is passed."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def fastest(points: Floats, limits: Floats, acceleration: float) -> Floats:
    """Return the speed at every point of a polyline: the highest that starts and ends at rest and keeps all limits.

    Between points the speed changes at a constant rate, so a path without limits of its own is a trapeze: it speeds
    up, cruises, slows down. Where the path turns, its velocity may change by no more than the acceleration does over
    the half of either step beside the point: a corner is taken as the arc that the steps resolve.

    Args:
        points: (n, d) world units, n ≥ 3, no two the same in a row.
        limits: (n - 1,) fastest on every step, world units per second.
        acceleration: along the path, and across it where it turns, world units per second².
    """
    along = np.diff(points, axis=0)
    steps = np.linalg.norm(along, axis=1)
    turned = np.linalg.norm(np.diff(along / steps[:, None], axis=0), axis=1)
    around = (steps[:-1] + steps[1:]) / 2
    turning = np.sqrt(acceleration * around / np.maximum(turned, np.finfo(float).tiny))
    speeds = np.zeros(len(points))
    speeds[1:-1] = np.minimum(turning, np.minimum(limits[:-1], limits[1:]))
    for order in (range(1, len(points)), range(len(points) - 2, -1, -1)):
        gain, before = 2 * acceleration * steps, 0.0
        for i in order:
            step = i - 1 if order.step == 1 else i
            before = speeds[i] = min(speeds[i], float(np.sqrt(before * before + gain[step])))
    return speeds


def arrivals(points: Floats, speeds: Floats) -> Floats:
    """Return the (n,) seconds at which points are passed, the first at 0, at a constant acceleration on every step."""
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    return np.concatenate([[0.0], np.cumsum(2 * steps / (speeds[:-1] + speeds[1:]))])
