"""Straight lines from centre to centre of cells: whether they are clear, and the shortest chain of clear ones."""

import numpy as np

from antgym.kernels import inlined, kernel
from antgym.kernels.bits import is_free

NEVER = np.int64(1) << 62
ROUNDING = 1e-12  # relative: ways that differ by less are equally short


@inlined
def _clear(bits, strides, rows, required, either, here, there):
    """Whether a line is clear; see ``clear``.

    It crosses the i-th of n faces along an axis at (2i - 1) / 2n of the way; over one denominator all of them are whole
    numbers, so crossings at one moment, through an edge or a corner of cells, are told apart exactly.
    """
    dx, dy, dz = there[0] - here[0], there[1] - here[1], there[2] - here[2]
    nx, ny, nz = abs(dx), abs(dy), abs(dz)
    sx, sy, sz = np.sign(dx), np.sign(dy), np.sign(dz)
    whole = max(nx, 1) * max(ny, 1) * max(nz, 1)
    wx, wy, wz = whole // max(nx, 1), whole // max(ny, 1), whole // max(nz, 1)
    x, y, z = wx if nx > 0 else NEVER, wy if ny > 0 else NEVER, wz if nz > 0 else NEVER
    cell = here[0] * strides[0] + here[1] * strides[1] + here[2] * strides[2]
    while True:
        now = min(x, y, z)
        if now >= 2 * whole:
            return True
        mx, my, mz = sx if x == now else 0, sy if y == now else 0, sz if z == now else 0
        k = rows[mx + 1, my + 1, mz + 1]
        for j in range(required.shape[1]):
            if not is_free(bits, cell + required[k, j]):
                return False
        if not (is_free(bits, cell + either[k, 0]) or is_free(bits, cell + either[k, 1])):
            return False
        cell += mx * strides[0] + my * strides[1] + mz * strides[2]
        x, y, z = x + 2 * wx * abs(mx), y + 2 * wy * abs(my), z + 2 * wz * abs(mz)


@kernel
def clear(bits, strides, rows, required, either, here, there):
    """Return whether every step of a line between two cells is legal as a move is.

    Args:
        bits: flat uint8, a bit a cell, 1 = free.
        strides: (3,) int64 of ``bits`` along x, y, z, in cells.
        rows: (3, 3, 3) int64: which move each step is, at the step plus one.
        required: (k, r) int64: for each move the offsets of the cells that must all be free.
        either: (k, 2) int64: the offsets of two cells of which one must be.
        here: (3,) int64 cell in storage indices, free.
        there: (3,) int64 cell in storage indices.
    """
    return _clear(bits, strides, rows, required, either, here, there)


@kernel
def shortest_chain(bits, strides, rows, required, either, cells, points, ways, before):
    """Find the shortest polyline of clear lines over some cells of a path; of equally short ones, one of few.

    Args:
        bits: as in ``clear``.
        strides: as in ``clear``.
        rows: as in ``clear``.
        required: as in ``clear``.
        either: as in ``clear``.
        cells: (n, 3) int64 cells in storage indices; the lines between neighbours are clear.
        points: (n, 3) float64, where their centres are in world units.
        ways: (n,) float64 to receive the shortest way from the first cell to each.
        before: (n,) int64 to receive the cell before each on it.
    """
    ways[0], before[0] = 0.0, 0
    for j in range(1, cells.shape[0]):
        ways[j], before[j] = ways[j - 1] + _apart(points, j - 1, j), j - 1
        most = ways[j] * (1.0 + ROUNDING)
        for i in range(j - 1):
            way = ways[i] + _apart(points, i, j)
            if way < most and _clear(bits, strides, rows, required, either, cells[j], cells[i]):
                ways[j], before[j] = way, i
                most = way * (1.0 - ROUNDING)


@inlined
def _apart(points, i, j):
    """Return the distance between two points."""
    x, y, z = points[i, 0] - points[j, 0], points[i, 1] - points[j, 1], points[i, 2] - points[j, 2]
    return np.sqrt(x * x + y * y + z * z)
