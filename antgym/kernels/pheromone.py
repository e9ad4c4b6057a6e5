"""Pheromone: what ants leave behind, and how it fades."""

import numpy as np

from antgym.kernels import inlined, kernel
from antgym.kernels.floats import exp2, log2_wide
from antgym.kernels.layout import FLOOR, OUTGROWN, ROW_STALE, ROWS, SCALE, SHIFT, SUMS_STALE, UNVISITED, WIDTH
from antgym.kernels.nodes import forget_weights


@kernel
def deposit(run, nodes, trail):
    """Let every ant that arrived add Q / length to its edges (liu2020 (3), summed over ants), then renew powers."""
    ants, due = run.ants, 0
    for a in range(ants):
        trail.length[a] = run.deposit / trail.length[a] / trail.levels[SCALE] if trail.row[a] >= 0 else 0.0
    for layer in range(run.layers):
        for a in range(ants):
            if trail.row[a] >= 0:
                edge = np.int64(trail.edge[layer * ants + a])
                row, slot = edge >> SHIFT, edge & (WIDTH - 1)
                nodes.tau[row, slot] += trail.length[a]
                bit = np.int64(1) << slot
                if nodes.mark[row] & bit == 0:
                    nodes.mark[row] |= bit
                    trail.due[due] = edge
                    due += 1
    for i in range(due):
        row, slot = np.int64(trail.due[i]) >> SHIFT, np.int64(trail.due[i]) & (WIDTH - 1)
        nodes.mark[row] = 0
        trail.wide[i] = nodes.tau[row, slot]
    renew(run, nodes, trail, due)


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
