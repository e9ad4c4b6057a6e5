"""Scouts: paths drawn anew, the coordinate that a bee moves, and the list of sources that nobody shall return to."""

import numpy as np

from antgym.kernels import inlined, inner
from antgym.kernels.hive import DRAWN, LISTED, STAMP
from antgym.kernels.rng import below, draw, unit
from antgym.kernels.segments import measure

_HIGH32, _LOW32 = np.uint64(32), np.uint64(0xFFFFFFFF)


@inlined
def coordinate(run, s, bits):
    """Return a random axis and way-point, and another source than s."""
    number = below(bits & _LOW32, 2 * run.points)
    other = below(bits >> _HIGH32, run.sources - 1)
    return number & 1, 1 + (number >> 1), other + (1 if other >= s else 0)


@inner
def scout(run, discs, comb, xi):
    """Abandon the source that was tried most often in vain, one a cycle, if that was ``limit`` times."""
    kept = -1
    if run.elite:
        kept = 0
        for s in range(1, run.sources):
            kept = s if comb.value[s] < comb.value[kept] else kept
    worst = 1 if kept == 0 else 0
    for s in range(run.sources):
        worst = s if s != kept and comb.tries[s] > comb.tries[worst] else worst
    if comb.tries[worst] < run.limit:
        return
    _forbid(run, comb, worst)
    if run.neighbour:
        _draw_step(run, comb, worst, xi)
    else:
        draw_path(run, comb, worst)
        redraws = 0
        while redraws < run.redraws and _is_tabu(run, comb, worst):
            draw_path(run, comb, worst)
            redraws += 1
    measure(run, discs, comb, worst)


@inner
def draw_path(run, comb, s):
    """Draw all way-points of a source uniformly within the bounds, (7)."""
    drawn = np.uint64(comb.status[DRAWN])
    for j in range(1, run.points + 1):
        comb.place[s, 0, j] = run.x_min + (run.x_max - run.x_min) * unit(draw(run.key, drawn))
        comb.place[s, 1, j] = run.y_min + (run.y_max - run.y_min) * unit(draw(run.key, drawn + np.uint64(1)))
        drawn += np.uint64(2)
    comb.status[DRAWN] += 2 * run.points


@inner
def _draw_step(run, comb, s, xi):
    """Move one coordinate of a source, for better or worse, (9)."""
    first = np.uint64(comb.status[DRAWN])
    comb.status[DRAWN] += 2
    axis, w, other = coordinate(run, s, draw(run.key, first))
    here = comb.place[s, axis, w]
    share = xi * (2.0 * unit(draw(run.key, first + np.uint64(1))) - 1.0)
    moved = here + share * (here - comb.place[other, axis, w])
    low, high = (run.x_min, run.x_max) if axis == 0 else (run.y_min, run.y_max)
    comb.place[s, axis, w] = low if moved < low else (high if moved > high else moved)


@inner
def _forbid(run, comb, s):
    """Put a source on the tabu list, in the place of the entry that was listed or hit longest ago."""
    if run.tabu == 0:
        return
    entry = comb.status[LISTED]
    if entry < run.tabu:
        comb.status[LISTED] += 1
    else:
        entry = 0
        for e in range(1, run.tabu):
            entry = e if comb.stamp[e] < comb.stamp[entry] else entry
    for axis in range(2):
        for j in range(run.points + 2):
            comb.tabu[entry, axis, j] = comb.place[s, axis, j]
    comb.status[STAMP] += 1
    comb.stamp[entry] = comb.status[STAMP]


@inner
def _is_tabu(run, comb, s):
    """Whether a source lies within the radius of a tabu entry; the first such entry counts as new."""
    for e in range(comb.status[LISTED]):
        square = 0.0
        for axis in range(2):
            for j in range(1, run.points + 1):
                apart = comb.place[s, axis, j] - comb.tabu[e, axis, j]
                square += apart * apart
        if square < run.radius * run.radius:
            comb.status[STAMP] += 1
            comb.stamp[e] = comb.status[STAMP]
            return True
    return False
