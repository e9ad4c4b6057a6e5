"""What an ant senses of a cell: which moves lead on from it, and the heuristic of each."""

import numpy as np

from antgym.kernels import inlined, inner
from antgym.kernels.bits import is_free
from antgym.kernels.floats import log2
from antgym.kernels.layout import BLOCKED, LOOKAHEAD, WIDTH

_F = np.float32
_ZERO = _F(0.0)


@inlined
def sense(ground, run, moves, eta, row, cell):
    """Write log2 η of every move from a cell; return whether any is legal.

    liu2020 (5)-(8); zhang_apf (4)-(7) with z1 as w1; wei2018 (10), (11) with ``clipped``.
    """
    x, y, z = coordinates(run, cell)
    left = run.goal_x - x - 1  # layers behind the end of a layered move
    found = False
    for k in range(WIDTH):
        legal = k < run.slots and is_legal(ground, run, moves, cell, y, z, left, k)
        if legal and run.trap == LOOKAHEAD and run.layered and left > 0:
            legal = leads_on(
                ground, run, moves, cell + moves.end[k], y + moves.dy[k], z + moves.dz[k], left - 1
            )
        eta[row, k] = _ZERO if legal else BLOCKED
        found = found or legal
    if run.to_goal:
        away_x, away_y, away_z = _F(run.goal_x - x), _F(run.goal_y - y), _F(run.goal_z - z)
    else:
        away_x, away_y, away_z = _F(run.start_x - x), _F(run.start_y - y), _F(run.start_z - z)
    cell_x, away_y, away_z = _F(run.cell_x), away_y * _F(run.cell_y), away_z * _F(run.cell_z)
    step_share, distance_share, w1, w2 = run.step_share, run.distance_share, run.w1, run.w2
    most = _mean_step(run, moves, eta, row) if run.clipped else _F(np.inf)
    for k in range(WIDTH):
        dx, dy, dz = (away_x - moves.ahead[k]) * cell_x, away_y - moves.along_y[k], away_z - moves.along_z[k]
        distance = np.sqrt(dx * dx + dy * dy + dz * dz)
        span = step_share * min(moves.step[k], most) + distance_share * distance
        value = -(w1 * log2(span)) - w2 * moves.level[k]
        eta[row, k] = value if eta[row, k] > BLOCKED else BLOCKED
    if run.z2 > _ZERO or run.z3 > _ZERO:
        _attract_and_repel(ground, run, moves, eta, row, cell)
    return found


@inlined
def _mean_step(run, moves, eta, row):
    """Return the mean length of the moves from a cell (wei2018 (11)), 0 where there is none."""
    total, count = _ZERO, 0
    for k in range(run.slots):
        if eta[row, k] > BLOCKED:
            total += moves.step[k]
            count += 1
    return total / _F(max(count, 1))


@inner
def _attract_and_repel(ground, run, moves, eta, row, cell):
    """Add the attraction of the goal and the repulsion of obstacles to log2 η (zhang_apf (6), (7))."""
    x, y, z = coordinates(run, cell)
    away_x, away_y, away_z = _F(run.goal_x - x), _F(run.goal_y - y), _F(run.goal_z - z)
    cell_x, away_y, away_z = _F(run.cell_x), away_y * _F(run.cell_y), away_z * _F(run.cell_z)
    for k in range(run.slots):
        if eta[row, k] > BLOCKED:
            dx, dy, dz = (
                (away_x - moves.ahead[k]) * cell_x,
                away_y - moves.along_y[k],
                away_z - moves.along_z[k],
            )
            distance = max(_F(np.sqrt(dx * dx + dy * dy + dz * dz)), run.nearest_goal)
            eta[row, k] -= run.z2 * log2(distance)
            if run.z3 > _ZERO:
                clear = ground.clearance[cell + moves.end[k] + run.clear_shift]
                ramp = min((clear - run.ramp_from) / run.ramp_over, _F(1.0))
                eta[row, k] += run.z3 * log2(ramp)


@inlined
def is_legal(ground, run, moves, cell, y, z, left, k):
    """Whether move k is one: its cells are free, a layered goal stays within reach, obstacles are far enough."""
    slack = run.reach * left
    legal = not run.layered or (
        abs(run.goal_y - y - moves.dy[k]) <= slack and abs(run.goal_z - z - moves.dz[k]) <= slack
    )
    if legal:
        for part in range(run.crossed):
            legal = legal and is_free(ground.bits, cell + moves.required[part, k])
        if run.either:
            legal = legal and (
                is_free(ground.bits, cell + moves.either[0, k])
                or is_free(ground.bits, cell + moves.either[1, k])
            )
        if legal and run.z3 > _ZERO:
            legal = ground.clearance[cell + moves.end[k] + run.clear_shift] > run.ramp_from
    return legal


@inner
def leads_on(ground, run, moves, cell, y, z, left):
    """Whether any move leads on from a cell."""
    found = False
    for k in range(run.slots):
        found = found or is_legal(ground, run, moves, cell, y, z, left, k)
    return found


@inner
def census(ground, run, moves, cell):
    """Return how many moves lead on from a cell, and the length of the shortest."""
    x, y, z = coordinates(run, cell)
    degree, nearest = 0, np.inf
    for k in range(run.slots):
        if is_legal(ground, run, moves, cell, y, z, run.goal_x - x - 1, k):
            degree += 1
            nearest = min(nearest, moves.length[k])
    return degree, nearest


@inlined
def coordinates(run, cell):
    """Return x, y, z of a cell, in indices of the world's storage."""
    x, rest = divmod(cell - run.origin, run.stride_x)
    y, z = divmod(rest, run.stride_y)
    return x, y, z
