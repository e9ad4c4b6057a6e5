"""The ant kernel: one colony, every layered rule, walked layer by layer over visited nodes only.

Why it looks as it does (each measured in ``experiments/speed.py``):

* A node's choice probabilities do not change when all its pheromone shrinks by one factor, so evaporation is one
  global ``scale`` and deposits are divided by it; nothing ever sweeps the world.
* A node that an ant reaches gets a row of 32 slots (25 moves and padding), found through a hash table once and
  through its parent's ``child`` link from then on. Memory grows with visited nodes.
* Only edges that received a deposit get a new power; a row's prefix sums are rebuilt at its next visit.
* Weights are 2^(α·log2 τ + β·log2 η − peak), ``peak`` being the row's largest exponent when it was last built: η^β
  with exponents near 84 stays in range, and an edge that outgrows its row by 2^60 makes the row be built again.
* Slots are summed lane by lane (slot = 8·depth + lane, the order is lane-major): any order draws from the same
  distribution, and this one is three vector additions.
"""

import numpy as np

from antgym.kernels import kernel
from antgym.kernels.floats import log2
from antgym.kernels.layout import (
    BEST,
    CLEAN,
    DEAD_END,
    DONE,
    FOLD_BELOW,
    HIGH,
    LOW,
    MADE,
    ROWS,
    SCALE,
    UNVISITED,
    WIDTH,
    History,
)
from antgym.kernels.nodes import node, pick, refresh
from antgym.kernels.pheromone import deposit, fold, put_back
from antgym.kernels.rng import draw, high_uniform, low_uniform

_F = np.float32
NEVER_FADES = 1e-9  # least evaporation that the limits are computed with


@kernel
def plan_range(
    free, runs, tables, moves, nodes, trail, history, offsets, cells, lengths, made, first, last, resume
):
    """Plan runs ``first`` to ``last``; return the index of one that needs more rows, else ``last``.

    Args:
        free: flat uint8 worlds, one behind the other.
        runs: (B,) records of RUN.
        tables: (t, 3, k, 3) int64 move tables: cells crossed before and behind the boundary, and the steps.
        moves: buffer.
        nodes: buffer; its rows need not suffice.
        trail: buffer, big enough for every run.
        history: arrays over all iterations of all runs; run i owns ``offsets[i, 0]`` onwards.
        offsets: (B, 2) int64, into ``history`` and into ``cells``.
        cells: flat int64, the best path of run i from ``offsets[i, 1]`` on, goal excluded.
        lengths: (B,) float64 to receive the shortest length, inf where no ant arrived.
        made: (B,) int64 to receive the moves that ants made.
        first: first run.
        last: end of the range.
        resume: run ``first`` is half done in the buffers.
    """
    for i in range(first, last):
        run = runs[i]
        if not (resume and i == first):
            begin(run, tables, moves, nodes, trail)
        at = offsets[i, 0]
        mine = History(history.best[at:], history.mean[at:], history.arrived[at:])
        if advance(free, run, moves, nodes, trail, mine, run.iterations) < run.iterations:
            return i
        lengths[i] = trail.levels[BEST]
        made[i] = trail.status[MADE]
        if lengths[i] < np.inf:
            for layer in range(run.layers):
                cells[offsets[i, 1] + layer] = nodes.cell[trail.best_edge[layer] // WIDTH]
    return last


@kernel
def begin(run, tables, moves, nodes, trail):
    """Clear the buffers of the last run and tabulate the moves of this one."""
    for row in range(trail.status[ROWS]):
        nodes.table[nodes.place[row]] = 0
    trail.status[:] = 0
    trail.levels[SCALE] = 1.0
    trail.levels[UNVISITED] = 1.0
    trail.levels[BEST] = np.inf
    trail.levels[LOW] = 0.0
    trail.levels[HIGH] = np.inf
    table = tables[run.table]
    for k in range(table.shape[1]):
        for part in range(3):
            dx, dy, dz = table[part, k, 0], table[part, k, 1], table[part, k, 2]
            moves.crossed[part, k] = dx * run.stride_x + dy * run.stride_y + dz
        moves.dy[k] = dy
        moves.dz[k] = dz
        x, y, z = run.cell_x * dx, run.cell_y * dy, run.cell_z * dz  # as step_lengths() has them
        moves.length[k] = np.sqrt(x * x + y * y + z * z)
        moves.step[k] = _F(moves.length[k])
        moves.along_y[k] = _F(y)
        moves.along_z[k] = _F(z)
        moves.level[k] = log2(_F(abs(dz) + 1))


@kernel
def advance(free, run, moves, nodes, trail, history, until):
    """Walk iterations until ``until`` of them are done or the rows may not suffice for the next one.

    Returns:
        The number of iterations done in total; less than ``until`` asks for more rows.
    """
    status, levels = trail.status, trail.levels
    cells = (run.layers + 1) * run.stride_x  # no more nodes than these can ever be visited
    while (
        status[DONE] < until and min(status[ROWS] + run.ants * run.layers + 1, cells) <= nodes.cell.shape[0]
    ):
        if status[ROWS] == 0:
            start = run.origin + run.start_x * run.stride_x + run.start_y * run.stride_y + run.start_z
            node(free, run, moves, nodes, trail, start)
        _walk(free, run, moves, nodes, trail)
        _remember(run, trail, history)
        if not run.best_only:
            levels[SCALE] *= run.rho
            if levels[SCALE] < FOLD_BELOW:
                fold(nodes, trail)
        deposit(run, nodes, trail)
        status[DONE] += 1
    return status[DONE]


@kernel
def _walk(free, run, moves, nodes, trail):
    """Take all ants of one iteration to the goal, or to where they die, layer by layer: their draws overlap."""
    status, ants, key, q0 = trail.status, run.ants, run.key, run.q0
    first = np.uint64(status[DONE] * run.layers * ants)
    made = 0
    for a in range(ants):
        trail.row[a] = 0
        trail.length[a] = 0.0
    for layer in range(run.layers):
        for a in range(ants):
            row = trail.row[a]
            if row < 0:
                continue
            if nodes.state[row] != CLEAN:
                if nodes.state[row] == DEAD_END:
                    trail.row[a] = -1
                    continue
                refresh(run, nodes, trail, row)
            bits = draw(key, first + np.uint64(layer * ants + a))
            is_greedy = low_uniform(bits) < q0
            slot = np.int64(nodes.greedy[row]) if is_greedy else pick(nodes.sums, row, high_uniform(bits))
            child = np.int64(nodes.child[row, slot])
            if child < 0:
                child = node(free, run, moves, nodes, trail, nodes.cell[row] + moves.crossed[2, slot])
                nodes.child[row, slot] = child
            if run.local > 0.0:
                put_back(run, nodes, trail, row, slot)
            trail.edge[layer * ants + a] = row * WIDTH + slot
            trail.length[a] += moves.length[slot]
            trail.row[a] = child
            made += 1
    status[MADE] += made


@kernel
def _remember(run, trail, history):
    """Keep the shortest path so far and the iteration's statistics."""
    levels, done = trail.levels, trail.status[DONE]
    total, arrived = 0.0, 0
    for a in range(run.ants):
        if trail.row[a] < 0:
            continue
        total += trail.length[a]
        arrived += 1
        if trail.length[a] < levels[BEST]:
            levels[BEST] = trail.length[a]
            for layer in range(run.layers):
                trail.best_edge[layer] = trail.edge[layer * run.ants + a]
    if run.limits and levels[BEST] < np.inf:  # Stützle & Hoos 2000, (11), and a fixed ratio
        levels[HIGH] = run.deposit / (max(1.0 - run.rho, NEVER_FADES) * levels[BEST])
        levels[LOW] = levels[HIGH] / (2.0 * run.layers)
    history.best[done] = levels[BEST]
    history.mean[done] = total / arrived if arrived > 0 else np.inf
    history.arrived[done] = arrived
