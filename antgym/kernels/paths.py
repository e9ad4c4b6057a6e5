"""Exact shortest paths under the layered motion, by dynamic programming over rolling layers."""

import numpy as np

from antgym.kernels import kernel


@kernel
def layered_distances(storage, offsets, lengths, start, goal, reach, planes, moves):
    """Return the shortest length from start to goal, inf where there is no path.

    Lengths are added from the start on, one addition a move, as the ants add theirs; rounding is monotone, so
    no ant's sum can fall below the result by even one bit.

    Args:
        storage: (nx, sy, sz) uint8, 1 = free, blocked borders of ``reach`` cells around y and z.
        offsets: (k, 3, 3) int64: for each move the cell crossed before the layer boundary, behind it, and the
            end cell, relative to the current cell.
        lengths: (k,) float64, length of each move.
        start: (3,) int64 cell in storage indices.
        goal: (3,) int64 cell in storage indices.
        reach: cells that y and z may change per layer.
        planes: (2, sy, sz) float64, scratch: distances to this layer and to the next.
        moves: (layers, sy, sz) uint8 to receive the last move into each cell, or (0, 0, 0) for lengths alone.
    """
    _, sy, sz = storage.shape
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
                for k in range(lengths.shape[0]):
                    yn, zn = y + offsets[k, 2, 1], z + offsets[k, 2, 2]
                    if abs(yn - goal[1]) > left or abs(zn - goal[2]) > left:
                        continue
                    total = here[y, z] + lengths[k]
                    if total < there[yn, zn] and _legal(storage, offsets, k, x, y, z):
                        there[yn, zn] = total
                        if moves.shape[0] > 0:
                            moves[layer, yn, zn] = k
        here, there = there, here
    return here[goal[1], goal[2]]


@kernel
def _legal(storage, offsets, k, x, y, z):
    """Whether move k from a free cell ends in a free cell and crosses none that is blocked."""
    for part in range(3):
        dx, dy, dz = offsets[k, part, 0], offsets[k, part, 1], offsets[k, part, 2]
        if storage[x + dx, y + dy, z + dz] == 0:
            return False
    return True
