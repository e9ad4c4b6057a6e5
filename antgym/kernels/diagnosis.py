"""Diagnosis: how a colony stands between two blocks of iterations, for those who steer it.

Only what the ants of the last iteration went through is looked at: rows that nobody visits any more would drown what
happens now, and looking at all of them would cost as much as walking.
"""

import numpy as np

from antgym.kernels import inlined, inner, kernel
from antgym.kernels.ants import advance
from antgym.kernels.layout import (
    ARRIVED,
    BEST,
    BLOCKED,
    BRANCHING,
    DEEPEST,
    DISTINCT,
    DONE,
    GAINED,
    MEAN,
    SHIFT,
    SHORTEST,
    STAGNATION,
    UNVISITED,
)
from antgym.kernels.nodes import forget_weights, within

LOOKED_AT = 32  # ants of the last iteration, at most


@kernel
def walk_block(ground, runs, moves, nodes, trail, history, since, until, stale, report):
    """Walk a paused colony on and, once it is there, report how it stands: one call from Python for both.

    Args:
        ground: the world.
        runs: (1,) record of RUN.
        moves: buffer.
        nodes: buffer.
        trail: buffer.
        history: arrays over the iterations of the run.
        since: iterations that were done before this block.
        until: iterations to have done in the end.
        stale: whether alpha or beta changed since rows were weighed.
        report: (REPORT_SIZE,) float64, written when ``until`` is reached.

    Returns:
        The number of iterations done; less than ``until`` asks for what ``trail.status[WANTS]`` says.
    """
    if stale:
        forget_weights(nodes, trail)
    done = advance(ground, runs[0], moves, nodes, trail, history, until)
    if done == until:
        diagnose(runs[0], nodes, trail, history, since, report)
    return done


@inner
def diagnose(run, nodes, trail, history, since, report):
    """Write the report on a colony that has walked at least one iteration since ``since``."""
    done, best = trail.status[DONE], trail.levels[BEST]
    before = history.best[since - 1] if since > 0 else np.inf
    last = done - 1
    while last > 0 and history.best[last - 1] == best:
        last -= 1
    arrived = 0
    for i in range(since, done):
        arrived += history.arrived[i]
    report[SHORTEST] = best
    report[GAINED] = 0.0 if best == before else 1.0 if before == np.inf else (before - best) / before
    report[MEAN] = history.mean[done - 1]
    report[STAGNATION] = done if best == np.inf else done - 1 - last
    report[ARRIVED] = arrived / (run.ants * (done - since))
    report[BRANCHING] = _branching(run, nodes, trail)
    report[DISTINCT] = _distinct(run, trail)


@inlined
def _branching(run, nodes, trail):
    """Return how open the choices were that ants of the last iteration made, 1 where there was none to make.

    A node of n > 1 legal moves has (Σ τ)² / Σ τ² effective ones (the exponential of Rényi's entropy of order 2), shown
    as their share beyond the first: 1 where pheromone favours none, 0 where one move has it all. The λ-branching
    factor would call a node closed however little its moves differ.
    """
    total, choices, latest, share = 0.0, 0, np.int64(-1), 0.0
    for depth in range(trail.status[DEEPEST]):
        for a in range(min(run.ants, LOOKED_AT)):
            if depth >= trail.depth[a]:
                continue
            row = np.int64(trail.edge[depth * run.ants + a]) >> SHIFT
            if row != latest:  # ants that agree walk side by side
                latest, share = row, _openness(run, nodes, trail, row)
            if share >= 0.0:
                total += share
                choices += 1
    return total / choices if choices > 0 else 1.0


@inlined
def _openness(run, nodes, trail, row):
    """Return the share of effective moves beyond the first of a row; -1 where there is nothing to choose."""
    high, legal = 0.0, 0
    for k in range(run.slots):
        if nodes.eta[row, k] > BLOCKED:
            high = max(high, _pheromone(run, nodes, trail, row, k))
            legal += 1
    if legal < 2:
        return -1.0
    total, squares = 0.0, 0.0
    for k in range(run.slots):
        if nodes.eta[row, k] > BLOCKED:
            part = _pheromone(run, nodes, trail, row, k) / high
            total += part
            squares += part * part
    return (total * total / squares - 1.0) / (legal - 1)


@inlined
def _pheromone(run, nodes, trail, row, k):
    """Return the pheromone that a move sees, up to a factor that all moves of a row share."""
    tau = nodes.tau[row, k]
    if run.on_nodes:
        child = np.int64(nodes.child[row, k])
        tau = nodes.point[child] if child >= 0 else trail.levels[UNVISITED]
    return within(trail.levels, tau) if run.limits else tau


@inlined
def _distinct(run, trail):
    """Return the share of different walks among ants of the last iteration, those that died included."""
    looked_at, distinct = min(run.ants, LOOKED_AT), 0
    for a in range(looked_at):
        fresh = True
        for b in range(a):
            if _same_walk(run, trail, a, b):
                fresh = False
                break
        distinct += fresh
    return distinct / looked_at


@inlined
def _same_walk(run, trail, a, b):
    """Whether two ants made the same moves."""
    depth = trail.depth[a] if trail.depth[a] == trail.depth[b] else np.int64(-1)
    while depth > 0 and trail.edge[(depth - 1) * run.ants + a] == trail.edge[(depth - 1) * run.ants + b]:
        depth -= 1
    return depth == 0
