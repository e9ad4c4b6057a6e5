"""Pheromone: what ants leave behind, and how it fades."""

import numpy as np

from antgym.kernels import inlined, kernel
from antgym.kernels.floats import exp2, log2_wide
from antgym.kernels.layout import (
    BEST,
    FLOOR,
    HIGH,
    LOW,
    OUTGROWN,
    ROW_STALE,
    ROWS,
    SCALE,
    SHIFT,
    SUMS_STALE,
    UNVISITED,
    WIDTH,
)
from antgym.kernels.nodes import forget_weights


@kernel
def deposit(run, nodes, trail):
    """Let ants deposit Q / length on their edges (liu2020 (3)), and the best path so far its own, then renew powers."""
    ants, due = run.ants, 0
    weigh_ants(run, trail)
    for a in range(ants):
        if trail.share[a] > 0.0:
            trail.share[a] = trail.share[a] * run.deposit / trail.length[a] / trail.levels[SCALE]
    for layer in range(run.layers):
        for a in range(ants):
            if trail.share[a] > 0.0:
                due = add(run, nodes, trail, np.int64(trail.edge[layer * ants + a]), trail.share[a], due)
    if run.elite > 0.0 and trail.levels[BEST] < np.inf:
        amount = run.elite * run.deposit / trail.levels[BEST] / trail.levels[SCALE]
        for layer in range(run.layers):
            due = add(run, nodes, trail, np.int64(trail.best_edge[layer]), amount, due)
    for i in range(due):
        row, slot = np.int64(trail.due[i]) >> SHIFT, np.int64(trail.due[i]) & (WIDTH - 1)
        nodes.mark[row] = 0
        trail.wide[i] = nodes.tau[row, slot]
    renew(run, nodes, trail, due)
    if run.limits:
        forget_weights(
            nodes, trail
        )  # what rests on a limit grows against what fades: no row keeps its weights


@inlined
def weigh_ants(run, trail):
    """Write the weight of every ant's deposit: 1 for all that arrived, or by rank; the earlier ant on a tie."""
    for a in range(run.ants):
        trail.share[a] = 1.0 if run.ranked == 0 and trail.row[a] >= 0 else 0.0
    for weight in range(run.ranked - 1, 0, -1):
        best = -1
        for a in range(run.ants):
            shorter = best < 0 or trail.length[a] < trail.length[best]
            if trail.row[a] >= 0 and trail.share[a] == 0.0 and shorter:
                best = a
        if best < 0:
            break
        trail.share[best] = np.float64(weight)


@inlined
def add(run, nodes, trail, edge, amount, due):
    """Add a deposit, in units of the scale, to one edge; return how many edges are due for a new power."""
    row, slot = edge >> SHIFT, edge & (WIDTH - 1)
    levels = trail.levels
    if run.best_only:
        nodes.tau[row, slot] = run.rho * nodes.tau[row, slot] + (1.0 - run.rho) * amount
        nodes.state[row] = ROW_STALE  # the greedy edge may have lost
    elif run.limits:
        kept = max(nodes.tau[row, slot] * levels[SCALE], levels[LOW])
        nodes.tau[row, slot] = min(kept + amount * levels[SCALE], levels[HIGH]) / levels[SCALE]
    else:
        nodes.tau[row, slot] += amount
    bit = np.int64(1) << slot
    if nodes.mark[row] & bit:
        return due
    nodes.mark[row] |= bit
    trail.due[due] = edge
    return due + 1


@inlined
def put_back(run, nodes, trail, row, slot):
    """Let a passing ant take an edge's pheromone a step back to its initial value, 1 (the local update of ACS)."""
    kept = (1.0 - run.local) * nodes.tau[row, slot]
    nodes.tau[row, slot] = kept + run.local / trail.levels[SCALE]
    nodes.state[row] = ROW_STALE


@inlined
def renew(run, nodes, trail, due):
    """Give the edges that are due their new power; the sums of their rows wait for the next visit."""
    alpha, beta, tau, weight = run.alpha, run.beta, trail.narrow, trail.weight
    for i in range(due):
        tau[i] = log2_wide(trail.wide[i])
    for i in range(due):
        row, slot = np.int64(trail.due[i]) >> SHIFT, np.int64(trail.due[i]) & (WIDTH - 1)
        weight[i] = alpha * tau[i] + beta * nodes.eta[row, slot] - nodes.peak[row]
        score = tau[i] + nodes.eta[row, slot] if run.plain else weight[i]
        if weight[i] > OUTGROWN:
            nodes.state[row] = ROW_STALE
        elif nodes.state[row] != ROW_STALE:
            nodes.state[row] = SUMS_STALE
            if score > nodes.top[row] or (score == nodes.top[row] and slot < nodes.greedy[row]):
                nodes.top[row], nodes.greedy[row] = score, slot
    for i in range(due):
        weight[i] = exp2(weight[i])
    for i in range(due):
        row, slot = np.int64(trail.due[i]) >> SHIFT, np.int64(trail.due[i]) & (WIDTH - 1)
        nodes.weight[row, slot] = weight[i]


@kernel
def fold(nodes, trail):
    """Multiply the scale into the pheromone before it leaves the floating range; rare."""
    levels = trail.levels
    levels[UNVISITED] = max(levels[UNVISITED] * levels[SCALE], FLOOR)
    for row in range(trail.status[ROWS]):
        for slot in range(WIDTH):
            nodes.tau[row, slot] = max(nodes.tau[row, slot] * levels[SCALE], FLOOR)
    levels[SCALE] = 1.0
    forget_weights(nodes, trail)
