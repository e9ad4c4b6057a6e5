"""The bee kernel: one hive for every rule, over paths of way-points among discs.

Why it looks as it does (``experiments/speed.py`` measures it):

* A bee moves one coordinate of one way-point, so two segments change; what the others add up to is kept per source.
* A candidate whose length alone, with what is known of the untouched segments, costs as much as its source already is
  never held against the discs: all further costs only add. Many candidates end there. The decision is the same, for
  rounding is monotone.
* The discs are looked at four at a time, without a branch.

Numbers in parentheses are equations of wu2018.
"""

import numpy as np

from antgym.kernels import inlined, inner, kernel
from antgym.kernels.hive import BEST_GAP, BEST_LENGTH, BEST_VALUE, DONE, DRAWN, GAP, HITS, LENGTH, MADE
from antgym.kernels.layout import History
from antgym.kernels.rng import draw, unit
from antgym.kernels.scouts import coordinate, draw_path, scout
from antgym.kernels.segments import add_up, clearance, cost, distance, least, measure

DRAWS = 4  # random numbers that a bee may take


@kernel
def fly_range(discs, flights, comb, history, offsets, paths, lengths, made, first, last):
    """Fly runs ``first`` to ``last``.

    Args:
        discs: the worlds.
        flights: (B,) records of FLIGHT.
        comb: buffer, as large as the largest of these runs needs it.
        history: arrays over all cycles of all runs; run i owns ``offsets[i]`` onwards.
        offsets: (B,) int64.
        paths: (B, 2, p + 2) float64 to receive the best paths.
        lengths: (B,) float64 to receive their lengths, inf where one touches a disc.
        made: (B,) int64 to receive the candidates that were evaluated.
        first: first run.
        last: end of the range.
    """
    for i in range(first, last):
        run = flights[i]
        begin(run, discs, comb)
        at = offsets[i]
        mine = History(history.best[at:], history.mean[at:], history.arrived[at:])
        advance(run, discs, comb, mine, run.cycles)
        lengths[i] = best_length(comb)
        made[i] = comb.status[MADE]
        for axis in range(2):
            for j in range(run.points + 2):
                paths[i, axis, j] = comb.best[axis, j]


@kernel
def fly_block(discs, flights, comb, history, until):
    """Fly a paused run, the only one of ``flights``, on until so many cycles are done; the rest as in fly_range."""
    advance(flights[0], discs, comb, history, until)


@kernel
def begin(run, discs, comb):
    """Forget the last run and draw the first sources, by (7)."""
    comb.status[:] = 0
    comb.levels[:] = np.inf
    for s in range(run.sources):
        comb.place[s, 0, 0] = run.start_x
        comb.place[s, 1, 0] = run.start_y
        comb.place[s, 0, run.points + 1] = run.goal_x
        comb.place[s, 1, run.points + 1] = run.goal_y
        draw_path(run, comb, s)
        measure(run, discs, comb, s)
    _memorise(run, comb)


@inner
def advance(run, discs, comb, history, until):
    """Fly cycles until ``until`` of them are done."""
    status = comb.status
    while status[DONE] < until:
        left = (run.cycles - status[DONE] - 1) / run.cycles
        xi = run.xi_min + left * (run.xi_max - run.xi_min)  # (12)
        _forage(run, discs, comb, xi)
        _memorise(run, comb)
        _write(run, comb, history, status[DONE])
        scout(run, discs, comb, xi)
        status[DONE] += 1


@inlined
def best_length(comb):
    """Return the length of the best path so far, inf where it touches a disc."""
    return comb.levels[BEST_LENGTH] if comb.levels[BEST_GAP] > 0.0 else np.inf


@inner
def _forage(run, discs, comb, xi):
    """Send the employed bees to one source each, then the onlookers to sources in proportion to quality (10)."""
    x, y, radius = (
        discs.x[run.first : run.last],
        discs.y[run.first : run.last],
        discs.radius[run.first : run.last],
    )
    place, before, after, key = comb.place, comb.before, comb.after, run.key
    drawn, total = comb.status[DRAWN], 0.0
    for bee in range(run.sources + run.onlookers):
        first = np.uint64(drawn)
        drawn += DRAWS
        s = bee
        if bee >= run.sources:
            if bee == run.sources:
                total = _qualities(run, comb)
            s = _roulette(comb, unit(draw(key, first + np.uint64(1))) * total)
        axis, w, other = coordinate(run, s, draw(key, first))
        here = place[s, axis, w]
        share = xi if run.away else xi * (2.0 * unit(draw(key, first + np.uint64(2))) - 1.0)
        moved = here + share * (here - place[other, axis, w])  # (9), (11)
        if run.pull > 0.0:  # Zhu & Kwong 2010, (6)
            moved += run.pull * unit(draw(key, first + np.uint64(3))) * (comb.best[axis, w] - here)
        low, high = (run.x_min, run.x_max) if axis == 0 else (run.y_min, run.y_max)
        moved = low if moved < low else (high if moved > high else moved)
        px = moved if axis == 0 else place[s, 0, w]
        py = moved if axis == 1 else place[s, 1, w]
        ax, ay, bx, by = place[s, 0, w - 1], place[s, 1, w - 1], place[s, 0, w + 1], place[s, 1, w + 1]
        there, onward = distance(ax, ay, px, py), distance(px, py, bx, by)
        length = (before[s, LENGTH, w - 1] + after[s, LENGTH, w + 1]) + (there + onward)
        gap = least(before[s, GAP, w - 1], after[s, GAP, w + 1])
        hits = before[s, HITS, w - 1] + after[s, HITS, w + 1]
        comb.tries[s] += 1
        if not run.printed and cost(run, length, gap, hits) >= comb.value[s]:
            continue
        one = clearance(x, y, radius, ax, ay, px, py, comb.gaps)
        two = clearance(x, y, radius, px, py, bx, by, comb.gaps)
        gap = least(gap, least(one, two))
        hits += (1.0 if one <= 0.0 else 0.0) + (1.0 if two <= 0.0 else 0.0)
        if cost(run, length, gap, hits) < comb.value[s]:
            place[s, axis, w] = moved
            comb.length[s, w - 1], comb.length[s, w] = there, onward
            comb.gap[s, w - 1], comb.gap[s, w] = one, two
            comb.tries[s] = 0
            add_up(run, comb, s)
    comb.status[DRAWN] = drawn
    comb.status[MADE] += run.sources + run.onlookers


@inlined
def _qualities(run, comb):
    """Sum up the qualities (8) of all sources; return the total."""
    total = 0.0
    for s in range(run.sources):
        f = comb.value[s]
        total += 1.0 / (1.0 + f) if f >= 0.0 else 1.0 - f
        comb.sums[s] = total
    return total


@inlined
def _roulette(comb, mark):
    """Return the first source whose prefix sum lies above a mark, which is less than the last one."""
    s = 0
    while comb.sums[s] <= mark:
        s += 1
    return s


@inner
def _memorise(run, comb):
    """Keep the path of the least f so far, the earlier on a tie."""
    for s in range(run.sources):
        if comb.value[s] < comb.levels[BEST_VALUE]:
            comb.levels[BEST_VALUE] = comb.value[s]
            comb.levels[BEST_LENGTH] = comb.before[s, LENGTH, run.points + 1]
            comb.levels[BEST_GAP] = comb.before[s, GAP, run.points + 1]
            for axis in range(2):
                for j in range(run.points + 2):
                    comb.best[axis, j] = comb.place[s, axis, j]


@inner
def _write(run, comb, history, done):
    """Write the history of a cycle."""
    total, clear = 0.0, 0
    for s in range(run.sources):
        if comb.before[s, GAP, run.points + 1] > 0.0:
            total += comb.before[s, LENGTH, run.points + 1]
            clear += 1
    history.best[done] = best_length(comb)
    history.mean[done] = total / clear if clear > 0 else np.inf
    history.arrived[done] = clear
