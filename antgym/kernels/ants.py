"""The ant kernel: one colony for every rule and motion, over visited nodes only.

Why it looks as it does (each measured in ``experiments/speed.py``):

* A node's choice probabilities do not change when all its pheromone shrinks by one factor, so evaporation is one
  global ``scale`` and deposits are divided by it; nothing ever sweeps the world.
* A node that an ant reaches gets a row of 32 slots (26 moves at most and padding), found through a hash table once
  and through its parent's ``child`` link from then on. Memory grows with visited nodes.
* Only edges that received a deposit get a new power; a row's prefix sums are rebuilt at its next visit.
* Weights are 2^(α·log2 τ + β·log2 η − peak), ``peak`` being the row's largest exponent when it was last built: η^β
  with exponents near 84 stays in range, and an edge that outgrows its row by 2^60 makes the row be built again.
* Slots are summed lane by lane (slot = 8·depth + lane, the order is lane-major): any order draws from the same
  distribution, and this one is three vector additions.

Ants of the layered motion cannot come back: they walk in ``_march``, all of them layer by layer. Ants that could come
back, or step back, keep a tabu list and walk in :mod:`antgym.kernels.roaming`. Both stop where buffers run short and
go on in larger ones.
"""

import numpy as np

from antgym.kernels import inlined, inner, kernel
from antgym.kernels.floats import log2
from antgym.kernels.layout import (
    BEST,
    BEST_DEPTH,
    CLEAN,
    DEAD_END,
    DEEPEST,
    DONE,
    DRAWN,
    EITHER,
    FOLD_BELOW,
    HIGH,
    LOW,
    MADE,
    MORE_CELLS,
    MOST_REQUIRED,
    PACE,
    REQUIRED,
    ROWS,
    SCALE,
    STEP,
    UNVISITED,
    WANTS,
    WIDTH,
    History,
)
from antgym.kernels.nodes import node, pick, refresh
from antgym.kernels.pheromone import deposit, fold, put_back
from antgym.kernels.rng import draw, high_uniform, low_uniform
from antgym.kernels.roaming import has_room, measure, roam

_F = np.float32
NEVER_FADES = 1e-9  # least evaporation that the limits are computed with


@kernel
def plan_range(
    ground,
    runs,
    tables,
    moves,
    nodes,
    trail,
    history,
    offsets,
    cells,
    spans,
    lengths,
    made,
    origin,
    first,
    last,
    resume,
):
    """Plan runs ``first`` to ``last``; return the index of one that needs larger buffers, else ``last``.

    What it needs stands in ``trail.status[WANTS]``.

    Args:
        ground: the worlds.
        runs: (B,) records of RUN.
        tables: (t, PARTS, 32, 3) int64 move tables.
        moves: buffer.
        nodes: buffer; its rows need not suffice.
        trail: buffer; its depth need not suffice.
        history: arrays over all iterations of all runs; run i owns ``offsets[i]`` onwards.
        offsets: (B,) int64.
        cells: int64, receives the best paths one behind the other, goals excluded; need not suffice.
        spans: (B, 2) int64, receives where in ``cells`` run i's path begins and ends.
        lengths: (B,) float64 to receive the shortest length, inf where no ant arrived.
        made: (B,) int64 to receive the moves that ants made.
        origin: the run whose path lies first in ``cells``.
        first: first run.
        last: end of the range.
        resume: run ``first`` is half done in the buffers, and paths up to it lie in ``cells``.
    """
    for i in range(first, last):
        run = runs[i]
        if not (resume and i == first):
            begin(run, tables, moves, nodes, trail)
            spans[i, 0] = spans[i - 1, 1] if i > origin else 0
        at = offsets[i]
        mine = History(history.best[at:], history.mean[at:], history.arrived[at:])
        if advance(ground, run, moves, nodes, trail, mine, run.iterations) < run.iterations:
            return i
        depth = trail.status[BEST_DEPTH]
        spans[i, 1] = spans[i, 0] + depth
        if spans[i, 1] > cells.shape[0]:
            trail.status[WANTS] = MORE_CELLS
            return i
        lengths[i] = trail.levels[BEST]
        made[i] = trail.status[MADE]
        for d in range(depth):
            cells[spans[i, 0] + d] = nodes.cell[trail.best_edge[d] // WIDTH]
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
    for k in range(run.slots):
        for part in range(MOST_REQUIRED):
            moves.required[part, k] = _offset(run, table, REQUIRED + part, k)
        for part in range(EITHER):
            moves.either[part, k] = _offset(run, table, REQUIRED + MOST_REQUIRED + part, k)
        moves.end[k] = _offset(run, table, STEP, k)
        dx, dy, dz = table[STEP, k, 0], table[STEP, k, 1], table[STEP, k, 2]
        moves.dy[k] = dy
        moves.dz[k] = dz
        x, y, z = run.cell_x * dx, run.cell_y * dy, run.cell_z * dz  # as step_lengths() has them
        moves.length[k] = np.sqrt(x * x + y * y + z * z)
        moves.step[k] = _F(moves.length[k])
        moves.ahead[k] = _F(dx)
        moves.along_y[k] = _F(y)
        moves.along_z[k] = _F(z)
        moves.level[k] = log2(_F(abs(dz) + 1))


@inlined
def _offset(run, table, part, k):
    """Return the place of a cell of a move table relative to the cell that the move leaves."""
    return table[part, k, 0] * run.stride_x + table[part, k, 1] * run.stride_y + table[part, k, 2]


@inner
def advance(ground, run, moves, nodes, trail, history, until):
    """Walk iterations until ``until`` of them are done or the buffers may not suffice for the next step.

    Returns:
        The number of iterations done in total; less than ``until`` asks for what ``trail.status[WANTS]`` says.
    """
    status, levels = trail.status, trail.levels
    while status[DONE] < until:
        if status[ROWS] == 0:
            start = run.origin + run.start_x * run.stride_x + run.start_y * run.stride_y + run.start_z
            node(ground, run, moves, nodes, trail, start)
        if run.roams:
            if not roam(ground, run, moves, nodes, trail):
                return status[DONE]
            measure(run, moves, trail)
        elif not _march(ground, run, moves, nodes, trail):
            return status[DONE]
        _remember(run, trail, history)
        if not run.best_only:
            levels[SCALE] *= run.rho
            if levels[SCALE] < FOLD_BELOW:
                fold(run, nodes, trail)
        deposit(run, moves, nodes, trail)
        status[DONE] += 1
        status[PACE] = 0
    return status[DONE]


@inner
def _march(ground, run, moves, nodes, trail):
    """Take all ants of one iteration to the goal, or to where they die, layer by layer: their draws overlap.

    Returns:
        Whether they are there; else the buffers ran short.
    """
    status, ants, key, q0 = trail.status, run.ants, run.key, run.q0
    made, drawn = 0, status[DRAWN]
    if status[PACE] == 0:
        status[DEEPEST] = run.layers
        for a in range(ants):
            trail.row[a] = 0
            trail.length[a] = 0.0
            trail.depth[a] = run.layers
    for layer in range(status[PACE], run.layers):
        if not has_room(run, nodes, trail, ants, run.layers):
            status[PACE], status[DRAWN] = layer, drawn
            status[MADE] += made
            return False
        first = np.uint64(drawn)
        for a in range(ants):
            row = trail.row[a]
            if row < 0:
                continue
            if nodes.state[row] != CLEAN:
                if nodes.state[row] == DEAD_END:
                    trail.row[a], trail.depth[a] = -1, layer
                    continue
                refresh(run, nodes, trail, row)
            bits = draw(key, first + np.uint64(a))
            is_greedy = low_uniform(bits) < q0
            slot = np.int64(nodes.greedy[row]) if is_greedy else pick(nodes.sums, row, high_uniform(bits))
            child = np.int64(nodes.child[row, slot])
            if child < 0:
                child = node(ground, run, moves, nodes, trail, nodes.cell[row] + moves.end[slot])
                nodes.child[row, slot] = child
            if run.local > 0.0:
                put_back(run, nodes, trail, row, slot)
            trail.edge[layer * ants + a] = row * WIDTH + slot
            trail.length[a] += moves.length[slot]
            trail.row[a] = child
            made += 1
        drawn += ants
    status[DRAWN] = drawn
    status[MADE] += made
    return True


@inner
def _remember(run, trail, history):
    """Keep the shortest path so far and the iteration's statistics."""
    status, levels, done = trail.status, trail.levels, trail.status[DONE]
    total, arrived = 0.0, 0
    for a in range(run.ants):
        if trail.row[a] < 0:
            continue
        total += trail.length[a]
        arrived += 1
        if trail.length[a] < levels[BEST]:
            levels[BEST] = trail.length[a]
            status[BEST_DEPTH] = trail.depth[a]
            for depth in range(trail.depth[a]):
                trail.best_edge[depth] = trail.edge[depth * run.ants + a]
    if run.limits and levels[BEST] < np.inf:  # Stützle & Hoos 2000, (11), and a fixed ratio
        levels[HIGH] = run.deposit / (max(1.0 - run.rho, NEVER_FADES) * levels[BEST])
        levels[LOW] = levels[HIGH] / (2.0 * status[BEST_DEPTH])
    history.best[done] = levels[BEST]
    history.mean[done] = total / arrived if arrived > 0 else np.inf
    history.arrived[done] = arrived
