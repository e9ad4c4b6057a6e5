"""Pheromone: what ants leave behind, and how it fades."""

import numpy as np

from antgym.kernels import inlined, inner
from antgym.kernels.floats import exp2, log2_wide
from antgym.kernels.layout import (
    BEST,
    BEST_DEPTH,
    DEEPEST,
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


@inner
def deposit(run, moves, nodes, trail):
    """Let ants deposit on their edges (liu2020 (3)), and the best path so far its own, then renew powers."""
    ants, due = run.ants, 0
    weigh_ants(run, trail)
    for a in range(ants):
        if trail.share[a] > 0.0:
            length = 1.0 if run.per_edge else trail.length[a]
            trail.share[a] = trail.share[a] * run.deposit / length / trail.levels[SCALE]
    for depth in range(trail.status[DEEPEST]):
        for a in range(ants):
            if trail.share[a] > 0.0 and depth < trail.depth[a]:
                edge = np.int64(trail.edge[depth * ants + a])
                due = add(run, moves, nodes, trail, edge, trail.share[a], due)
    if run.elite > 0.0 and trail.levels[BEST] < np.inf:
        length = 1.0 if run.per_edge else trail.levels[BEST]
        amount = run.elite * run.deposit / length / trail.levels[SCALE]
        for depth in range(trail.status[BEST_DEPTH]):
            due = add(run, moves, nodes, trail, np.int64(trail.best_edge[depth]), amount, due)
    for i in range(due):
        row, slot = np.int64(trail.due[i]) >> SHIFT, np.int64(trail.due[i]) & (WIDTH - 1)
        nodes.mark[row] = 0
        trail.wide[i] = nodes.tau[row, slot]
    renew(run, nodes, trail, due)
    if run.limits:  # what rests on a limit grows against what fades: no row keeps its weights
        forget_weights(nodes, trail)


@inlined
def weigh_ants(run, trail):
    """Write the weight of every ant's deposit: 1 for all that may, or by rank; the earlier ant on a tie."""
    most = _midway(run, trail) if run.selective else np.inf
    for a in range(run.ants):
        may = run.ranked == 0 and trail.row[a] >= 0 and trail.length[a] <= most
        trail.share[a] = 1.0 if may else 0.0
    for weight in range(run.ranked - 1, 0, -1):
        best = -1
        for a in range(run.ants):
            shorter = best < 0 or trail.length[a] < trail.length[best]
            if trail.row[a] >= 0 and trail.share[a] == 0.0 and shorter and trail.length[a] <= most:
                best = a
        if best < 0:
            break
        trail.share[best] = np.float64(weight)


@inlined
def _midway(run, trail):
    """Return the length midway between the iteration's shortest and longest path (wei2018 (13))."""
    shortest, longest = np.inf, 0.0
    for a in range(run.ants):
        if trail.row[a] >= 0:
            shortest, longest = min(shortest, trail.length[a]), max(longest, trail.length[a])
    return (shortest + longest) / 2.0


@inlined
def add(run, moves, nodes, trail, edge, amount, due):
    """Add a deposit, in units of the scale, to one edge; return how many edges are due for a new power."""
    row, slot = edge >> SHIFT, edge & (WIDTH - 1)
    if run.per_edge:
        amount *= _edge_share(moves, nodes, row, slot)
    if run.on_nodes:
        child = nodes.child[row, slot]
        nodes.point[child] = _grown(run, trail.levels, nodes.point[child], amount)
        return due
    nodes.tau[row, slot] = _grown(run, trail.levels, nodes.tau[row, slot], amount)
    if run.best_only:
        nodes.state[row] = ROW_STALE  # the greedy edge may have lost
    bit = np.int64(1) << slot
    if nodes.mark[row] & bit:
        return due
    nodes.mark[row] |= bit
    trail.due[due] = edge
    return due + 1


@inlined
def _edge_share(moves, nodes, row, slot):
    """Return ε / d: 1 / d, less where a shorter edge ends at the busier of its two ends (wei2018 (15), (16))."""
    child = nodes.child[row, slot]
    nearest = nodes.nearest[child] if nodes.degree[child] >= nodes.degree[row] else nodes.nearest[row]
    return nearest / (moves.length[slot] * moves.length[slot])


@inlined
def _grown(run, levels, tau, amount):
    """Return pheromone, in units of the scale, after a deposit."""
    if run.best_only:
        return max(run.rho * tau + (1.0 - run.rho) * amount, FLOOR)
    if run.limits:
        return (
            min(max(tau * levels[SCALE], levels[LOW]) + amount * levels[SCALE], levels[HIGH]) / levels[SCALE]
        )
    return tau + amount


@inlined
def put_back(run, nodes, trail, row, slot):
    """Let a passing ant take pheromone a step towards ``local_to``: the initial value in ACS, 0 in zhang_apf (1)."""
    if run.on_nodes:
        child = nodes.child[row, slot]
        nodes.point[child] = _passed(run, trail.levels, nodes.point[child])
    else:
        nodes.tau[row, slot] = _passed(run, trail.levels, nodes.tau[row, slot])
        nodes.state[row] = ROW_STALE


@inlined
def _passed(run, levels, tau):
    """Return pheromone, in units of the scale, after an ant passed by."""
    if run.limits:
        tau = min(max(tau * levels[SCALE], levels[LOW]), levels[HIGH]) / levels[SCALE]
    return max((1.0 - run.local) * tau + run.local * run.local_to / levels[SCALE], FLOOR)


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


@inner
def fold(run, nodes, trail):
    """Multiply the scale into the pheromone before it leaves the floating range; rare."""
    levels = trail.levels
    levels[UNVISITED] = max(levels[UNVISITED] * levels[SCALE], FLOOR)
    for row in range(trail.status[ROWS]):
        if run.linked:
            nodes.point[row] = max(nodes.point[row] * levels[SCALE], FLOOR)
        for slot in range(WIDTH):
            nodes.tau[row, slot] = max(nodes.tau[row, slot] * levels[SCALE], FLOOR)
    levels[SCALE] = 1.0
    forget_weights(nodes, trail)
