"""Rows of visited nodes: opened at the first visit, weighed, summed and drawn from."""

import numpy as np

from antgym.kernels import inlined, inner, kernel
from antgym.kernels.floats import exp2, log2_wide
from antgym.kernels.layout import (
    BLOCKED,
    CLEAN,
    DEAD_END,
    FLOOR,
    HIGH,
    LANES,
    LOW,
    ROW_STALE,
    ROWS,
    SCALE,
    SUMS_STALE,
    UNVISITED,
    WIDTH,
)
from antgym.kernels.senses import census, sense

_ZERO = np.float32(0.0)
_HASH, _HASH_SHIFT = np.uint64(0x9E3779B97F4A7C15), np.uint64(32)


@inlined
def node(ground, run, moves, nodes, trail, cell):
    """Return the row of a cell, opening it on the first visit."""
    mask = nodes.table.shape[0] - 1
    place = home(cell) & mask
    while nodes.table[place] != 0:
        row = np.int64(nodes.table[place]) - 1
        if nodes.cell[row] == cell:
            return row
        place = (place + 1) & mask
    row = trail.status[ROWS]
    trail.status[ROWS] = row + 1
    nodes.table[place] = row + 1
    nodes.cell[row], nodes.place[row], nodes.mark[row] = cell, place, 0
    unvisited = trail.levels[UNVISITED]
    for k in range(WIDTH):
        nodes.tau[row, k] = unvisited
        nodes.child[row, k] = -1
    nodes.state[row] = DEAD_END
    if sense(ground, run, moves, nodes.eta, row, cell):
        nodes.scratch[0] = log2_wide(within(trail.levels, unvisited) if run.limits else unvisited)
        weigh(run, nodes, row, WIDTH)
        nodes.state[row] = SUMS_STALE
    if run.linked or run.censused:
        _introduce(ground, run, moves, nodes, trail, row)
    return row


@inlined
def home(cell):
    """Return where a cell's search in the hash table begins, before masking."""
    return np.int64((np.uint64(cell) * _HASH) >> _HASH_SHIFT)


@kernel
def rehash(nodes, count):
    """Enter the first ``count`` rows into an empty hash table."""
    mask = nodes.table.shape[0] - 1
    for row in range(count):
        place = home(nodes.cell[row]) & mask
        while nodes.table[place] != 0:
            place = (place + 1) & mask
        nodes.table[place] = row + 1
        nodes.place[row] = place


@inner
def _introduce(ground, run, moves, nodes, trail, row):
    """Make a new row and the rows around it known to each other, and count its moves."""
    cell = nodes.cell[row]
    nodes.point[row] = trail.levels[UNVISITED]
    for word in range(nodes.seen.shape[1]):
        nodes.seen[row, word] = 0
    for k in range(run.slots):
        if nodes.eta[row, k] > BLOCKED:
            nodes.child[row, k] = _row_of(nodes, cell + moves.end[k])
        parent = _row_of(nodes, cell - moves.end[k])
        if parent >= 0:
            nodes.child[parent, k] = row
    if run.censused:
        nodes.degree[row], nodes.nearest[row] = census(ground, run, moves, cell)
    if run.by_degree:  # wei2018 (12): length over the mean length, times the degree of the end
        for k in range(run.slots):
            if nodes.eta[row, k] > BLOCKED:
                degree, _ = census(ground, run, moves, cell + moves.end[k])
                nodes.tau[row, k] *= max(degree, 1) * moves.length[k] / run.mean_move
        if nodes.state[row] != DEAD_END:
            nodes.state[row] = ROW_STALE
    if run.on_nodes and nodes.state[row] != DEAD_END:
        nodes.state[row] = ROW_STALE


@inlined
def _row_of(nodes, cell):
    """Return the row of a cell, -1 where there is none."""
    mask = nodes.table.shape[0] - 1
    place = home(cell) & mask
    while nodes.table[place] != 0:
        if nodes.cell[nodes.table[place] - 1] == cell:
            return np.int64(nodes.table[place]) - 1
        place = (place + 1) & mask
    return np.int64(-1)


@inlined
def weigh(run, nodes, row, width):
    """Compute the weights of a row's first slots from log2 pheromone in ``scratch[0]``; the rest of them stay.

    The largest exponent becomes the row's peak. ``width`` is a multiple of LANES; slots behind it are no moves.
    """
    eta, weight, tau, alpha, beta = nodes.eta, nodes.weight, nodes.scratch, run.alpha, run.beta
    for k in range(width):
        exponent = alpha * tau[0, k] + beta * eta[row, k]
        weight[row, k] = exponent if eta[row, k] > BLOCKED else BLOCKED
    for lane in range(LANES):
        tau[1, lane] = weight[row, lane]
    for first in range(LANES, width, LANES):
        for lane in range(LANES):
            tau[1, lane] = max(tau[1, lane], weight[row, first + lane])
    peak = tau[1, 0]
    for lane in range(1, LANES):
        peak = max(peak, tau[1, lane])
    greedy, top = 0, BLOCKED
    if run.q0 > _ZERO:
        for k in range(width):
            score = tau[0, k] + eta[row, k] if run.plain else weight[row, k] - peak
            if eta[row, k] > BLOCKED and score > top:
                greedy, top = k, score
    nodes.peak[row], nodes.greedy[row], nodes.top[row] = peak, greedy, top
    for k in range(width):
        weight[row, k] = exp2(weight[row, k] - peak) if eta[row, k] > BLOCKED else _ZERO


@inlined
def within(levels, tau):
    """Return an edge's pheromone, scale included, within the limits of MAX-MIN."""
    return max(min(max(tau * levels[SCALE], levels[LOW]), levels[HIGH]), FLOOR)


@inlined
def refresh(run, nodes, trail, row):
    """Make a row's weights and sums current."""
    if nodes.state[row] == ROW_STALE:
        read_pheromone(run, nodes, trail, row)
        weigh(run, nodes, row, run.width)
    add_up(nodes.weight, nodes.sums, row)
    # pheromone on nodes changes behind a row's back: it is never current for long
    nodes.state[row] = ROW_STALE if run.on_nodes else CLEAN


@inlined
def read_pheromone(run, nodes, trail, row):
    """Write log2 of the pheromone of every move of a row into ``scratch[0]``."""
    if run.on_nodes:
        for k in range(run.width):
            child = nodes.child[row, k]
            nodes.tau[row, k] = nodes.point[child] if child >= 0 else trail.levels[UNVISITED]
    if run.limits:
        for k in range(run.width):
            nodes.scratch[0, k] = log2_wide(within(trail.levels, nodes.tau[row, k]))
    else:
        for k in range(run.width):
            nodes.scratch[0, k] = log2_wide(nodes.tau[row, k])


@inlined
def add_up(weight, sums, row):
    """Write the lane-major prefix sums of a row's weights; the last of them is the total."""
    before = _ZERO
    for lane in range(LANES):
        first = weight[row, lane]
        second = first + weight[row, lane + LANES]
        third = second + weight[row, lane + 2 * LANES]
        sums[row, lane] = before + first
        sums[row, lane + LANES] = before + second
        sums[row, lane + 2 * LANES] = before + third
        before = before + (third + weight[row, lane + 3 * LANES])
        sums[row, lane + 3 * LANES] = before


@inlined
def pick(sums, row, uniform):
    """Return the slot whose share of the total holds ``uniform``; always one of positive weight."""
    mark = uniform * sums[row, WIDTH - 1]
    lane = np.int32(0)
    for k in range(WIDTH - LANES, WIDTH - 1):  # the last depth holds the sums up to the end of each lane
        lane = np.int32(lane + np.int32(sums[row, k] <= mark))
    depth = np.int32(sums[row, lane] <= mark) + np.int32(sums[row, lane + LANES] <= mark)
    return np.int64(LANES * (depth + np.int32(sums[row, lane + 2 * LANES] <= mark)) + lane)


@inner
def forget_weights(nodes, trail):
    """Let every row be weighed again at its next visit: alpha or beta changed, the pheromone did not."""
    for row in range(trail.status[ROWS]):
        if nodes.state[row] != DEAD_END:
            nodes.state[row] = ROW_STALE
