"""Segments: how long each is, how far it stays from the discs, and what the path that they make costs."""

import numpy as np

from antgym.kernels import formula, inlined, inner
from antgym.kernels.hive import GAP, HITS, LANES, LENGTH, MADE

TINY = 1e-300  # a segment whose squared length is below it is a point: the reciprocal must stay finite


@inlined
def distance(ax, ay, bx, by):
    """Return the length of a segment."""
    return np.sqrt((bx - ax) * (bx - ax) + (by - ay) * (by - ay))


@inlined
def least(a, b):
    """Return the smaller of two numbers."""
    return a if a < b else b


@inlined
def clearance(x, y, radius, ax, ay, bx, by, gaps):
    """Return how far a segment stays from the nearest disc, negative where it cuts one; ``gaps`` is scratch.

    One loop without a branch and one over its results: a minimum kept on the way would not be vectorised.
    """
    dx, dy = bx - ax, by - ay
    square = dx * dx + dy * dy
    inverse = 1.0 / square if square > TINY else 0.0
    for i in range(x.shape[0]):
        ux, uy = x[i] - ax, y[i] - ay
        t = (ux * dx + uy * dy) * inverse
        t = 0.0 if t < 0.0 else t
        t = 1.0 if t > 1.0 else t
        ex, ey = ux - t * dx, uy - t * dy
        gaps[i] = np.sqrt(ex * ex + ey * ey) - radius[i]
    first = second = third = fourth = np.inf
    for i in range(0, x.shape[0], LANES):
        first, second = least(gaps[i], first), least(gaps[i + 1], second)
        third, fourth = least(gaps[i + 2], third), least(gaps[i + 3], fourth)
    return least(least(first, second), least(third, fourth))


@formula
def cost(run, length, gap, hits):
    """Return f of a path: its length, smallest clearance and number of segments that touch a disc.

    Sound: (4) without the aim, over the straight line; every part only adds. As printed: (6) names fit itself, and the
    larger root of that equation is taken; where it has none, which takes an aim below 0, the real part of its roots; at
    contact, where it is undefined, its limit at clearance 0.
    """
    if not run.printed:
        shortfall = run.safe - gap if gap < run.safe else 0.0
        return run.per_length * length + (run.per_shortfall * shortfall + run.per_hit * hits)
    way = run.weight * length
    if gap > run.safe:
        return way + (1.0 - run.weight) * run.aim
    d = gap if gap > 0.0 else 0.0
    both = way + (1.0 - run.weight) * (run.safe + 1.0) * run.aim
    b = d * way - 1.0
    inside = b * b + 4.0 * d * both
    root = np.sqrt(inside) if inside > 0.0 else 0.0
    # the same number twice, without the cancellation that small d or small b would bring
    return (b + root) / (2.0 * d) if b > 0.0 or inside <= 0.0 else 2.0 * both / (root - b)


@inner
def measure(run, discs, comb, s):
    """Measure a whole path."""
    x, y, radius = (
        discs.x[run.first : run.last],
        discs.y[run.first : run.last],
        discs.radius[run.first : run.last],
    )
    for j in range(run.points + 1):
        ax, ay, bx, by = (
            comb.place[s, 0, j],
            comb.place[s, 1, j],
            comb.place[s, 0, j + 1],
            comb.place[s, 1, j + 1],
        )
        comb.length[s, j] = distance(ax, ay, bx, by)
        comb.gap[s, j] = clearance(x, y, radius, ax, ay, bx, by, comb.gaps)
    comb.tries[s] = 0
    comb.status[MADE] += 1
    add_up(run, comb, s)


@inner
def add_up(run, comb, s):
    """Add up the segments of a source from the start on and from the goal back, and its cost."""
    before, after, last = comb.before, comb.after, run.points + 1
    before[s, LENGTH, 0], before[s, GAP, 0], before[s, HITS, 0] = 0.0, np.inf, 0.0
    after[s, LENGTH, last], after[s, GAP, last], after[s, HITS, last] = 0.0, np.inf, 0.0
    for j in range(last):
        gap = comb.gap[s, j]
        before[s, LENGTH, j + 1] = before[s, LENGTH, j] + comb.length[s, j]
        before[s, GAP, j + 1] = least(before[s, GAP, j], gap)
        before[s, HITS, j + 1] = before[s, HITS, j] + (1.0 if gap <= 0.0 else 0.0)
    for j in range(last - 1, -1, -1):
        gap = comb.gap[s, j]
        after[s, LENGTH, j] = after[s, LENGTH, j + 1] + comb.length[s, j]
        after[s, GAP, j] = least(after[s, GAP, j + 1], gap)
        after[s, HITS, j] = after[s, HITS, j + 1] + (1.0 if gap <= 0.0 else 0.0)
    comb.value[s] = cost(run, before[s, LENGTH, last], before[s, GAP, last], before[s, HITS, last])
