"""Exact shortest paths: dynamic programming over rolling layers for the layered motion, A* for grids.

Both return the smallest of all sums that add a path's moves from the start on, one addition a move: rounding is
monotone, so cell by cell a larger sum never becomes the smaller one. Beside them, how often a walk at random arrives.
"""

import numpy as np

from antgym.kernels import inlined, kernel
from antgym.kernels.bits import is_free

SIZE, BEGUN = 0, 1  # slots of a search's state
RANK, SUM, CELL = 0, 1, 2  # columns of a heap


@kernel
def layered_distances(bits, strides, required, steps, lengths, start, goal, reach, planes, moves):
    """Return the shortest length from start to goal, inf where there is no path.

    Lengths are added from the start on, one addition a move, as the ants add theirs; rounding is monotone, so
    no ant's sum can fall below the result by even one bit.

    Args:
        bits: flat uint8, a bit a cell, 1 = free, blocked borders of ``reach`` cells around y and z.
        strides: (3,) int64 of ``bits`` along x, y, z, in cells.
        required: (k, r) int64: for each move the offsets into ``bits`` of the cells that it needs free.
        steps: (k, 3) int64, cells moved.
        lengths: (k,) float64, length of each move.
        start: (3,) int64 cell in storage indices.
        goal: (3,) int64 cell in storage indices.
        reach: cells that y and z may change per layer.
        planes: (2, sy, sz) float64, scratch: distances to this layer and to the next.
        moves: (layers, sy, sz) uint8 to receive the last move into each cell, or (0, 0, 0) for lengths alone.
    """
    _, sy, sz = planes.shape
    layers = goal[0] - start[0]
    here, there = planes[0], planes[1]
    here[:, :] = np.inf
    here[start[1], start[2]] = 0.0
    for layer in range(layers):
        there[:, :] = np.inf
        x = start[0] + layer
        left = reach * (layers - layer - 1)
        spread = reach * layer
        for y in range(max(reach, start[1] - spread), min(sy - reach, start[1] + spread + 1)):
            for z in range(max(reach, start[2] - spread), min(sz - reach, start[2] + spread + 1)):
                if here[y, z] == np.inf:
                    continue
                cell = x * strides[0] + y * strides[1] + z
                for k in range(lengths.shape[0]):
                    yn, zn = y + steps[k, 1], z + steps[k, 2]
                    if abs(yn - goal[1]) > left or abs(zn - goal[2]) > left:
                        continue
                    total = here[y, z] + lengths[k]
                    if total < there[yn, zn] and _all_free(bits, required, k, cell):
                        there[yn, zn] = total
                        if moves.shape[0] > 0:
                            moves[layer, yn, zn] = k
        here, there = there, here
    return here[goal[1], goal[2]]


@kernel
def layered_arrival(bits, strides, required, steps, start, goal, reach, planes):
    """Return the probability that an ant that takes every legal move equally often arrives.

    Layers are swept from the goal back: the chance of a cell is the mean over its legal moves, added in their order.

    Args:
        bits: flat uint8, a bit a cell, 1 = free, blocked borders of ``reach`` cells around y and z.
        strides: (3,) int64 of ``bits`` along x, y, z, in cells.
        required: (k, r) int64: for each move the offsets into ``bits`` of the cells that it needs free.
        steps: (k, 3) int64, cells moved.
        start: (3,) int64 cell in storage indices.
        goal: (3,) int64 cell in storage indices.
        reach: cells that y and z may change per layer.
        planes: (2, sy, sz) float64, scratch: the chances of this layer and of the next.
    """
    _, sy, sz = planes.shape
    layers = goal[0] - start[0]
    here, there = planes[0], planes[1]
    there[:, :] = 0.0
    there[goal[1], goal[2]] = 1.0
    for layer in range(layers - 1, -1, -1):
        here[:, :] = 0.0
        left, spread = reach * (layers - layer), reach * layer
        lowest_y, lowest_z = max(start[1] - spread, goal[1] - left), max(start[2] - spread, goal[2] - left)
        highest_y, highest_z = min(start[1] + spread, goal[1] + left), min(start[2] + spread, goal[2] + left)
        for y in range(max(reach, lowest_y), min(sy - reach - 1, highest_y) + 1):
            for z in range(max(reach, lowest_z), min(sz - reach - 1, highest_z) + 1):
                cell = (start[0] + layer) * strides[0] + y * strides[1] + z
                if is_free(bits, cell):
                    here[y, z] = _mean_onward(bits, required, steps, cell, y, z, goal, left - reach, there)
        here, there = there, here
    return there[start[1], start[2]]


@inlined
def _mean_onward(bits, required, steps, cell, y, z, goal, left, there):
    """Return the mean over the legal moves from a cell of what they lead to, 0 where there is none."""
    total, legal = 0.0, 0
    for k in range(steps.shape[0]):
        yn, zn = y + steps[k, 1], z + steps[k, 2]
        keeps = abs(yn - goal[1]) <= left and abs(zn - goal[2]) <= left
        if keeps and _all_free(bits, required, k, cell):
            total += there[yn, zn]
            legal += 1
    return total / max(legal, 1)


@inlined
def _all_free(bits, required, k, cell):
    """Whether all cells are free that move k needs so."""
    free = True
    for r in range(required.shape[1]):
        free = free and is_free(bits, cell + required[k, r])
    return free


@kernel
def grid_search(
    bits, steps, required, either, lengths, spans, scale, strides, start, goal, sums, heap, state
):
    """Search on from where ``state`` says; return True when done, False when the heap needs more room.

    Cells are expanded by estimated length, coarsely rounded to a rank, and within a rank by the way behind them:
    where many paths are equally long, a cell's sum is then nearly always final at its first expansion. One that
    improves later is expanded again, and the search goes on until no estimate can beat the goal's sum by even
    one bit. The estimate is the exact length in an empty world.

    Args:
        bits: flat uint8, a bit a cell, 1 = free; the world's borders are blocked.
        steps: (k, 3) int64, cells moved.
        required: (k, r) int64, offsets into ``bits`` of the cells that a move needs free.
        either: (k, 2) int64, offsets of two cells of which it needs one.
        lengths: (k,) float64, length of each move.
        spans: (8,) float64, way of one cell along the axes whose bits are set in the index.
        scale: ranks per world unit: so few that rounding cannot scatter equal lengths over more than two ranks.
        strides: (3,) int64 of ``bits`` along x, y, z, in cells.
        start: (3,) int64 cell in storage indices.
        goal: (3,) int64 cell in storage indices.
        sums: (n,) float64, zeros at first; receives the shortest sum to every cell reached.
        heap: (capacity, 3) float64: rank, sum and cell of the entries.
        state: (2,) int64, zeros at first.
    """
    first = start[0] * strides[0] + start[1] * strides[1] + start[2]
    last = goal[0] * strides[0] + goal[1] * strides[1] + goal[2]
    if state[BEGUN] == 0:
        state[BEGUN] = 1
        _push(heap, state, 0.0, 0.0, first)
    while state[SIZE] > 0:
        if state[SIZE] + lengths.shape[0] > heap.shape[0]:
            return False
        rank, total, cell = heap[0, RANK], heap[0, SUM], np.int64(heap[0, CELL])
        if sums[last] > 0.0 and rank > _rank(sums[last], scale) + 1.0:
            return True
        _pop(heap, state)
        if total > sums[cell] and cell != first:
            continue
        x, rest = divmod(cell, strides[0])
        y, z = divmod(rest, strides[1])
        for k in range(lengths.shape[0]):
            end = cell + steps[k, 0] * strides[0] + steps[k, 1] * strides[1] + steps[k, 2]
            way = total + lengths[k]
            if not is_free(bits, end) or end == first or (sums[end] > 0.0 and sums[end] <= way):
                continue
            if not _open(bits, required, either, k, cell):
                continue
            sums[end] = way
            left = _empty_way(
                abs(x + steps[k, 0] - goal[0]),
                abs(y + steps[k, 1] - goal[1]),
                abs(z + steps[k, 2] - goal[2]),
                spans,
            )
            _push(heap, state, _rank(way + left, scale), way, end)
    return True


@inlined
def _rank(length, scale):
    """Round a length; the odd shift keeps whole multiples of a move off the boundaries."""
    return np.floor(length * scale + 0.382)


@inlined
def _open(bits, required, either, k, cell):
    """Whether move k from a cell is legal."""
    if not _all_free(bits, required, k, cell):
        return False
    return is_free(bits, cell + either[k, 0]) or is_free(bits, cell + either[k, 1])


@inlined
def _empty_way(x, y, z, spans):
    """Return the shortest length over x, y, z cells in an empty world: diagonals first, by concavity."""
    high, middle, low, a, b = x, y, z, 1, 2
    if high < middle:
        high, middle, a, b = middle, high, b, a
    if middle < low:
        middle, low, b = low, middle, 4
        if high < middle:
            high, middle, a, b = middle, high, b, a
    return (high - middle) * spans[a] + (middle - low) * spans[a | b] + low * spans[7]


@inlined
def _push(heap, state, rank, total, cell):
    """Add an entry to a binary heap ordered by rank, then sum."""
    place = state[SIZE]
    state[SIZE] = place + 1
    while place > 0:
        above = (place - 1) >> 1
        if heap[above, RANK] < rank or (heap[above, RANK] == rank and heap[above, SUM] <= total):
            break
        for column in range(3):
            heap[place, column] = heap[above, column]
        place = above
    heap[place, RANK], heap[place, SUM], heap[place, CELL] = rank, total, cell


@inlined
def _pop(heap, state):
    """Remove the first entry."""
    size = state[SIZE] - 1
    state[SIZE] = size
    rank, total, cell = heap[size, RANK], heap[size, SUM], heap[size, CELL]
    place, below = 0, 1
    while below < size:
        if below + 1 < size and (
            heap[below + 1, RANK] < heap[below, RANK]
            or (heap[below + 1, RANK] == heap[below, RANK] and heap[below + 1, SUM] < heap[below, SUM])
        ):
            below += 1
        if rank < heap[below, RANK] or (rank == heap[below, RANK] and total <= heap[below, SUM]):
            break
        for column in range(3):
            heap[place, column] = heap[below, column]
        place, below = below, 2 * below + 1
    heap[place, RANK], heap[place, SUM], heap[place, CELL] = rank, total, cell
