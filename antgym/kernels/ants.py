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

from typing import NamedTuple

import numpy as np

from antgym.kernels import inlined, kernel
from antgym.kernels.floats import exp2, log2, log2_wide
from antgym.kernels.rng import draw, high_uniform, low_uniform

WIDTH, LANES, SHIFT = 32, 8, 5
CLEAN, SUMS_STALE, ROW_STALE, DEAD_END = np.uint8(0), np.uint8(1), np.uint8(2), np.uint8(3)
_F = np.float32
BLOCKED = _F(-1e30)  # log2 η of a slot that is no legal move
_ZERO, _ONE = _F(0.0), _F(1.0)
OUTGROWN = _F(60.0)
FOLD_BELOW, FLOOR = 2.0**-500, 2.0**-1000  # of the global scale, and of any pheromone
_HASH, _HASH_SHIFT = np.uint64(0x9E3779B97F4A7C15), np.uint64(32)

# slots of Trail.status and Trail.levels
ROWS, DONE, MADE, STATUS_SIZE = 0, 1, 2, 3
SCALE, UNVISITED, BEST, LEVEL_SIZE = 0, 1, 2, 3

RUN = np.dtype(
    [
        ("origin", np.int64),  # where this world begins in the flat ``free`` array; cells are indices into it
        ("stride_x", np.int64),
        ("stride_y", np.int64),
        ("start_x", np.int64),
        ("start_y", np.int64),
        ("start_z", np.int64),
        ("goal_y", np.int64),
        ("goal_z", np.int64),
        ("layers", np.int64),
        ("reach", np.int64),  # cells that y and z may change per layer
        ("table", np.int64),  # which of the move tables
        ("ants", np.int64),
        ("iterations", np.int64),
        ("key", np.uint64),  # of the random numbers
        ("cell_x", np.float64),
        ("cell_y", np.float64),
        ("cell_z", np.float64),
        # D = 1 / (step_share · step + distance_share · distance to the anchor)
        ("step_share", np.float32),
        ("distance_share", np.float32),
        ("w1", np.float32),
        ("w2", np.float32),
        ("q0", np.float32),
        ("alpha", np.float32),
        ("beta", np.float32),
        ("rho", np.float64),
        ("deposit", np.float64),  # Q / initial pheromone
        ("to_goal", np.bool_),  # the anchor is the goal, not the start
        ("plain", np.bool_),  # the greedy move ignores alpha and beta
    ],
    align=True,
)
"""One planner run: scenario, rule, parameters and effort, as the kernels read it."""


class Moves(NamedTuple):
    """The move table of one run, padded to 32 slots."""

    dy: np.ndarray  # (32,) int64
    dz: np.ndarray
    crossed: np.ndarray  # (3, 32) int64 cell offsets: before the layer boundary, behind it, the end
    along_y: np.ndarray  # (32,) float32 world units
    along_z: np.ndarray
    step: np.ndarray  # (32,) float32 length
    level: np.ndarray  # (32,) float32 log2(|dz| + 1)
    length: np.ndarray  # (32,) float64


class Nodes(NamedTuple):
    """Visited nodes, one row each."""

    cell: np.ndarray  # (rows,) int64
    place: np.ndarray  # (rows,) int64 where in ``table``
    eta: np.ndarray  # (rows, 32) float32 log2 of the heuristic
    tau: np.ndarray  # (rows, 32) float64 pheromone / (initial pheromone · scale)
    weight: np.ndarray  # (rows, 32) float32
    sums: np.ndarray  # (rows, 32) float32 prefix sums, lane-major
    child: np.ndarray  # (rows, 32) int32 row behind a move, -1 unknown
    mark: np.ndarray  # (rows,) int64 bit per slot: deposit received, power not renewed
    peak: np.ndarray  # (rows,) float32
    top: np.ndarray  # (rows,) float32 score of the greedy slot
    greedy: np.ndarray  # (rows,) int32
    state: np.ndarray  # (rows,) uint8
    table: np.ndarray  # (power of two,) int32 hash table: row + 1, 0 = empty
    scratch: np.ndarray  # (2, 32) float32


class Trail(NamedTuple):
    """Where the ants of one iteration are and went, and what the run remembers."""

    row: np.ndarray  # (ants,) int64, -1 = died
    length: np.ndarray  # (ants,) float64
    edge: np.ndarray  # (layers · ants,) int32: row · 32 + slot
    best_edge: np.ndarray  # (layers,) int32
    due: np.ndarray  # (layers · ants,) int32 edges that wait for a new power
    wide: np.ndarray  # (layers · ants,) float64 their pheromone
    narrow: np.ndarray  # (layers · ants,) float32 its logarithm
    weight: np.ndarray  # (layers · ants,) float32 their power
    status: np.ndarray  # (STATUS_SIZE,) int64
    levels: np.ndarray  # (LEVEL_SIZE,) float64


class History(NamedTuple):
    """What a run leaves per iteration."""

    best: np.ndarray  # float64 shortest so far, inf before any
    mean: np.ndarray  # float64 mean over the ants that arrived, inf if none
    arrived: np.ndarray  # int64 ants that arrived


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
def rehash(nodes, count):
    """Enter the first ``count`` rows into an empty hash table."""
    mask = nodes.table.shape[0] - 1
    for row in range(count):
        place = _home(nodes.cell[row]) & mask
        while nodes.table[place] != 0:
            place = (place + 1) & mask
        nodes.table[place] = row + 1
        nodes.place[row] = place


@kernel
def forget_weights(nodes, trail):
    """Let every row be weighed again at its next visit: alpha or beta changed, the pheromone did not."""
    for row in range(trail.status[ROWS]):
        if nodes.state[row] != DEAD_END:
            nodes.state[row] = ROW_STALE


@kernel
def advance(free, run, moves, nodes, trail, history, until):
    """Walk iterations until ``until`` of them are done or the rows may not suffice for the next one.

    Returns:
        The number of iterations done in total; less than ``until`` asks for more rows.
    """
    status, levels = trail.status, trail.levels
    while status[DONE] < until and status[ROWS] + run.ants * run.layers + 1 <= nodes.cell.shape[0]:
        if status[ROWS] == 0:
            start = run.origin + run.start_x * run.stride_x + run.start_y * run.stride_y + run.start_z
            _node(free, run, moves, nodes, trail, start)
        _walk(free, run, moves, nodes, trail)
        _remember(run, trail, history)
        levels[SCALE] *= run.rho
        if levels[SCALE] < FOLD_BELOW:
            _fold(nodes, trail)
        _deposit(run, nodes, trail)
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
                _refresh(run, nodes, row)
            bits = draw(key, first + np.uint64(layer * ants + a))
            is_greedy = low_uniform(bits) < q0
            slot = np.int64(nodes.greedy[row]) if is_greedy else _pick(nodes.sums, row, high_uniform(bits))
            child = np.int64(nodes.child[row, slot])
            if child < 0:
                child = _node(free, run, moves, nodes, trail, nodes.cell[row] + moves.crossed[2, slot])
                nodes.child[row, slot] = child
            trail.edge[layer * ants + a] = row * WIDTH + slot
            trail.length[a] += moves.length[slot]
            trail.row[a] = child
            made += 1
    status[MADE] += made


@inlined
def _pick(sums, row, uniform):
    """Return the slot whose share of the total holds ``uniform``; always one of positive weight."""
    mark = uniform * sums[row, WIDTH - 1]
    lane = np.int32(0)
    for k in range(WIDTH - LANES, WIDTH - 1):  # the last depth holds the sums up to the end of each lane
        lane = np.int32(lane + np.int32(sums[row, k] <= mark))
    depth = np.int32(sums[row, lane] <= mark) + np.int32(sums[row, lane + LANES] <= mark)
    return np.int64(LANES * (depth + np.int32(sums[row, lane + 2 * LANES] <= mark)) + lane)


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
    history.best[done] = levels[BEST]
    history.mean[done] = total / arrived if arrived > 0 else np.inf
    history.arrived[done] = arrived


@kernel
def _deposit(run, nodes, trail):
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
    _renew(run, nodes, trail, due)


@inlined
def _renew(run, nodes, trail, due):
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
def _fold(nodes, trail):
    """Multiply the scale into the pheromone before it leaves the floating range; rare."""
    levels = trail.levels
    levels[UNVISITED] = max(levels[UNVISITED] * levels[SCALE], FLOOR)
    for row in range(trail.status[ROWS]):
        for slot in range(WIDTH):
            nodes.tau[row, slot] = max(nodes.tau[row, slot] * levels[SCALE], FLOOR)
    levels[SCALE] = 1.0
    forget_weights(nodes, trail)


@inlined
def _refresh(run, nodes, row):
    """Make a row's weights and sums current."""
    if nodes.state[row] == ROW_STALE:
        for k in range(WIDTH):
            nodes.scratch[0, k] = log2_wide(nodes.tau[row, k])
        _weigh(run, nodes, row)
    _sum(nodes.weight, nodes.sums, row)
    nodes.state[row] = CLEAN


@inlined
def _weigh(run, nodes, row):
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
def _sum(weight, sums, row):
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
def _home(cell):
    """Return where a cell's search in the hash table begins, before masking."""
    return np.int64((np.uint64(cell) * _HASH) >> _HASH_SHIFT)


@inlined
def _node(free, run, moves, nodes, trail, cell):
    """Return the row of a cell, opening it on the first visit."""
    mask = nodes.table.shape[0] - 1
    place = _home(cell) & mask
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
    if _sense(free, run, moves, nodes.eta, row, cell):
        nodes.scratch[0] = log2_wide(unvisited)
        _weigh(run, nodes, row)
        nodes.state[row] = SUMS_STALE
    return row


@inlined
def _sense(free, run, moves, eta, row, cell):
    """Write log2 η of every move from a cell, liu2020 (5)-(8); return whether any is legal."""
    x, rest = divmod(cell - run.origin, run.stride_x)
    y, z = divmod(rest, run.stride_y)
    left = run.layers - (x - run.start_x) - 1
    slack, found = run.reach * left, False
    for k in range(WIDTH):
        legal = abs(run.goal_y - y - moves.dy[k]) <= slack and abs(run.goal_z - z - moves.dz[k]) <= slack
        if legal:
            for part in range(3):
                legal = legal and free[cell + moves.crossed[part, k]] != 0
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
