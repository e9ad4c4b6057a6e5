"""Ants that could come back to a cell: each keeps a tabu list of where it has been, step back or look ahead.

An ant never enters a cell twice in one iteration. The tabu list is a bit per ant in the row of every cell, so it is
asked by the rows around, which know each other (``linked``). A move is drawn from the row's kept sums and drawn again
while it leads to a cell of the tabu list: that is exact, and where few cells are taken one draw does. After TRIES
draws the moves that are still open are weighed by themselves, which also finds out that there is none.
"""

import numpy as np

from antgym.kernels import inlined, inner
from antgym.kernels.floats import exp2
from antgym.kernels.layout import (
    ACTIVE,
    BLOCKED,
    CLEAN,
    DEAD_END,
    DEEPEST,
    DRAWN,
    LOOKAHEAD,
    MADE,
    MORE_DEPTH,
    MORE_ROWS,
    PACE,
    RETREAT,
    ROWS,
    SHIFT,
    WANTS,
    WIDTH,
)
from antgym.kernels.nodes import add_up, node, pick, read_pheromone, refresh
from antgym.kernels.pheromone import put_back
from antgym.kernels.rng import GOLDEN, draw, high_uniform, low_uniform, mix

_F = np.float32
_ZERO, _ONE64 = _F(0.0), np.uint64(1)
TRIES = 4
TRAPPED = np.int64(-1)


@inner
def roam(ground, run, moves, nodes, trail):
    """Take all ants of one iteration to the goal, or to where they die, one step each in turn.

    Returns:
        Whether they are there; else the buffers ran short.
    """
    status, ants = trail.status, run.ants
    if status[PACE] == 0:
        _gather(run, nodes, trail)
    goal = run.origin + run.goal_x * run.stride_x + run.goal_y * run.stride_y + run.goal_z
    opened = ants * (run.slots if run.trap == LOOKAHEAD else 1)  # rows that one step of all ants may open
    while status[ACTIVE] > 0:
        if not has_room(run, nodes, trail, opened, status[DEEPEST] + 1):
            return False
        still = 0
        for i in range(status[ACTIVE]):
            a = trail.active[i]
            bits = draw(run.key, np.uint64(status[DRAWN] + a))
            if _step(ground, run, moves, nodes, trail, goal, a, bits):
                trail.active[still] = a
                still += 1
        status[ACTIVE] = still
        status[DRAWN] += ants
        status[PACE] += 1
    return True


@inlined
def has_room(run, nodes, trail, rows, depth):
    """Whether the buffers hold so many more rows, and paths of so many moves; else say what they want."""
    if min(trail.status[ROWS] + rows, run.cells) > nodes.cell.shape[0]:
        trail.status[WANTS] = MORE_ROWS
        return False
    if depth > trail.best_edge.shape[0] or depth * run.ants > trail.edge.shape[0]:
        trail.status[WANTS] = MORE_DEPTH
        return False
    return True


@inner
def _gather(run, nodes, trail):
    """Put all ants at the start with nothing on their tabu lists but it."""
    for row in range(trail.status[ROWS]):
        for word in range(nodes.seen.shape[1]):
            nodes.seen[row, word] = 0
    for a in range(run.ants):
        trail.row[a], trail.depth[a], trail.active[a] = 0, 0, a
        _mark(nodes, 0, a)
    trail.status[ACTIVE] = run.ants
    trail.status[DEEPEST] = 0


@inlined
def _step(ground, run, moves, nodes, trail, goal, a, bits):
    """Take one ant a step on, or back where it may; return whether it is still on its way."""
    row, depth, ants = trail.row[a], trail.depth[a], run.ants
    slot = _choose(ground, run, moves, nodes, trail, goal, row, a, bits)
    if slot == TRAPPED:
        if run.trap == RETREAT and depth > 0:
            trail.row[a] = np.int64(trail.edge[(depth - 1) * ants + a]) >> SHIFT
            trail.depth[a] = depth - 1
            return True
        trail.row[a] = -1
        return False
    child = np.int64(nodes.child[row, slot])
    if child < 0:
        child = node(ground, run, moves, nodes, trail, nodes.cell[row] + moves.end[slot])
    if run.local > 0.0:
        put_back(run, nodes, trail, row, slot)
    trail.edge[depth * ants + a] = row * WIDTH + slot
    trail.depth[a] = depth + 1
    trail.status[DEEPEST] = max(trail.status[DEEPEST], depth + 1)
    trail.status[MADE] += 1
    trail.row[a] = child
    _mark(nodes, child, a)
    return nodes.cell[child] != goal


@inlined
def _choose(ground, run, moves, nodes, trail, goal, row, a, bits):
    """Return an ant's next slot, TRAPPED where every move leads back or nowhere."""
    if nodes.state[row] != CLEAN:
        if nodes.state[row] == DEAD_END:
            return TRAPPED
        refresh(run, nodes, trail, row)
    is_greedy = low_uniform(bits) < run.q0
    if is_greedy:
        slot = np.int64(nodes.greedy[row])
        if is_open(ground, run, moves, nodes, trail, goal, row, slot, a):
            return slot
    else:
        for _ in range(TRIES):
            slot = pick(nodes.sums, row, high_uniform(bits))
            if is_open(ground, run, moves, nodes, trail, goal, row, slot, a):
                return slot
            bits = mix(bits + GOLDEN)
    return _among_open(ground, run, moves, nodes, trail, goal, row, a, is_greedy, high_uniform(bits))


@inner
def _among_open(ground, run, moves, nodes, trail, goal, row, a, is_greedy, uniform):
    """Return the best of the moves still open to an ant, or one drawn among them; TRAPPED where there is none."""
    weight, sums, tau, eta = nodes.spare[0], nodes.spare[1], nodes.scratch, nodes.eta
    for k in range(WIDTH):
        there = eta[row, k] > BLOCKED and is_open(ground, run, moves, nodes, trail, goal, row, k, a)
        weight[0, k] = _ZERO if there else BLOCKED
    read_pheromone(run, nodes, trail, row)
    best, top, peak = TRAPPED, BLOCKED, BLOCKED
    for k in range(run.width):
        if weight[0, k] > BLOCKED:
            weight[0, k] = run.alpha * tau[0, k] + run.beta * eta[row, k]
            score = tau[0, k] + eta[row, k] if run.plain else weight[0, k]
            peak = max(peak, weight[0, k])
            if score > top:
                best, top = np.int64(k), score
    if is_greedy or best == TRAPPED:
        return best
    for k in range(WIDTH):
        weight[0, k] = exp2(weight[0, k] - peak) if weight[0, k] > BLOCKED else _ZERO
    add_up(weight, sums, 0)
    return pick(sums, 0, uniform)


@inlined
def is_open(ground, run, moves, nodes, trail, goal, row, slot, a):
    """Whether a legal move leads to a cell that is not on the ant's tabu list nor, looking ahead, in a dead end."""
    child = np.int64(nodes.child[row, slot])
    if child >= 0 and _is_marked(nodes, child, a):
        return False
    if run.trap != LOOKAHEAD:
        return True
    if child < 0:
        child = node(ground, run, moves, nodes, trail, nodes.cell[row] + moves.end[slot])
    return nodes.cell[child] == goal or _leads_on(run, nodes, child, a)


@inlined
def _leads_on(run, nodes, row, a):
    """Whether a legal move from a row leads to a cell that is not on the ant's tabu list."""
    for k in range(run.slots):
        if nodes.eta[row, k] > BLOCKED:
            child = np.int64(nodes.child[row, k])
            if child < 0 or not _is_marked(nodes, child, a):
                return True
    return False


@inlined
def _mark(nodes, row, a):
    """Put a cell on an ant's tabu list."""
    nodes.seen[row, a >> 6] |= _ONE64 << np.uint64(a & 63)


@inlined
def _is_marked(nodes, row, a):
    """Whether a cell is on an ant's tabu list."""
    return (nodes.seen[row, a >> 6] >> np.uint64(a & 63)) & _ONE64 != 0


@inner
def measure(run, moves, trail):
    """Add up the lengths of the paths from the start on, as the optimum is added up."""
    ants = run.ants
    for a in range(ants):
        trail.length[a] = 0.0
        if trail.row[a] >= 0:
            for depth in range(trail.depth[a]):
                trail.length[a] += moves.length[np.int64(trail.edge[depth * ants + a]) & (WIDTH - 1)]
