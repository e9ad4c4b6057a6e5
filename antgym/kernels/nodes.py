"""Rows of visited nodes: opened at the first visit, weighed, summed and drawn from."""

import numpy as np

from antgym.kernels import inlined, kernel
from antgym.kernels.floats import exp2, log2, log2_wide
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

_F = np.float32
_ZERO = _F(0.0)
_HASH, _HASH_SHIFT = np.uint64(0x9E3779B97F4A7C15), np.uint64(32)


@inlined
def node(free, run, moves, nodes, trail, cell):
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
    if sense(free, run, moves, nodes.eta, row, cell):
        nodes.scratch[0] = log2_wide(within(trail.levels, unvisited) if run.limits else unvisited)
        weigh(run, nodes, row)
        nodes.state[row] = SUMS_STALE
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


@inlined
def sense(free, run, moves, eta, row, cell):
    """Write log2 η of every move from a cell, liu2020 (5)-(8); return whether any is legal."""
    x, rest = divmod(cell - run.origin, run.stride_x)
    y, z = divmod(rest, run.stride_y)
    left = run.layers - (x - run.start_x) - 1
    found = False
    for k in range(WIDTH):
        legal = is_legal(free, run, moves, cell, y, z, left, k)
        if legal and run.lookahead and left > 0:
            legal = leads_on(
                free, run, moves, cell + moves.crossed[2, k], y + moves.dy[k], z + moves.dz[k], left - 1
            )
        eta[row, k] = _ZERO if legal else BLOCKED
        found = found or legal
    if run.to_goal:
        away_x, away_y, away_z = _F(left), _F(run.goal_y - y), _F(run.goal_z - z)
    else:
        away_x, away_y, away_z = _F(left - run.layers), _F(run.start_y - y), _F(run.start_z - z)
    away_x, away_y, away_z = away_x * _F(run.cell_x), away_y * _F(run.cell_y), away_z * _F(run.cell_z)
    step_share, distance_share, w1, w2 = run.step_share, run.distance_share, run.w1, run.w2
    for k in range(WIDTH):
        dy, dz = away_y - moves.along_y[k], away_z - moves.along_z[k]
        distance = np.sqrt(away_x * away_x + dy * dy + dz * dz)
        span = step_share * moves.step[k] + distance_share * distance
        value = -(w1 * log2(span)) - w2 * moves.level[k]
        eta[row, k] = value if eta[row, k] > BLOCKED else BLOCKED
    return found


@inlined
def is_legal(free, run, moves, cell, y, z, left, k):
    """Whether move k is one: the goal stays within reach of its end, and what it crosses is free."""
    slack = run.reach * left
    legal = abs(run.goal_y - y - moves.dy[k]) <= slack and abs(run.goal_z - z - moves.dz[k]) <= slack
    if legal:
        for part in range(3):
            legal = legal and free[cell + moves.crossed[part, k]] != 0
    return legal


@kernel
def leads_on(free, run, moves, cell, y, z, left):
    """Whether any move leads on from a cell."""
    found = False
    for k in range(WIDTH):
        found = found or is_legal(free, run, moves, cell, y, z, left, k)
    return found


@inlined
def weigh(run, nodes, row):
    """Compute all weights of a row from log2 pheromone in ``scratch[0]``; its largest exponent becomes its peak."""
    eta, weight, tau, alpha, beta = nodes.eta, nodes.weight, nodes.scratch, run.alpha, run.beta
    for k in range(WIDTH):
        exponent = alpha * tau[0, k] + beta * eta[row, k]
        weight[row, k] = exponent if eta[row, k] > BLOCKED else BLOCKED
    for lane in range(LANES):
        tau[1, lane] = max(weight[row, lane], weight[row, lane + LANES])
    for lane in range(LANES):
        tau[1, lane] = max(tau[1, lane], weight[row, lane + 2 * LANES], weight[row, lane + 3 * LANES])
    peak = tau[1, 0]
    for lane in range(1, LANES):
        peak = max(peak, tau[1, lane])
    greedy, top = 0, BLOCKED
    if run.q0 > _ZERO:
        for k in range(WIDTH):
            score = tau[0, k] + eta[row, k] if run.plain else weight[row, k] - peak
            if eta[row, k] > BLOCKED and score > top:
                greedy, top = k, score
    nodes.peak[row], nodes.greedy[row], nodes.top[row] = peak, greedy, top
    for k in range(WIDTH):
        weight[row, k] = exp2(weight[row, k] - peak) if eta[row, k] > BLOCKED else _ZERO


@inlined
def within(levels, tau):
    """Return an edge's pheromone, scale included, within the limits of MAX-MIN."""
    return max(min(max(tau * levels[SCALE], levels[LOW]), levels[HIGH]), FLOOR)


@inlined
def refresh(run, nodes, trail, row):
    """Make a row's weights and sums current."""
    if nodes.state[row] == ROW_STALE:
        if run.limits:
            for k in range(WIDTH):
                nodes.scratch[0, k] = log2_wide(within(trail.levels, nodes.tau[row, k]))
        else:
            for k in range(WIDTH):
                nodes.scratch[0, k] = log2_wide(nodes.tau[row, k])
        weigh(run, nodes, row)
    add_up(nodes.weight, nodes.sums, row)
    nodes.state[row] = CLEAN


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


@kernel
def forget_weights(nodes, trail):
    """Let every row be weighed again at its next visit: alpha or beta changed, the pheromone did not."""
    for row in range(trail.status[ROWS]):
        if nodes.state[row] != DEAD_END:
            nodes.state[row] = ROW_STALE
