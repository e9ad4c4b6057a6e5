"""Lines among blocked cells, by fractions and one cell after the other: slow, obvious, and exact for centres."""

from fractions import Fraction
from itertools import pairwise, product

import numpy as np


def meets(here, there, cell, closed, shrunk=0):
    """Whether the segment between two points meets a cell, given in cells: its inside, or its faces too."""
    low, high = Fraction(0), Fraction(1)
    for *ends, c in zip(here, there, cell, strict=True):
        a, b = map(Fraction, ends)
        near, far = Fraction(int(c)) + Fraction(shrunk), Fraction(int(c) + 1) - Fraction(shrunk)
        if a == b:
            if not (near <= a <= far if closed else near < a < far):
                return False
            continue
        first, last = sorted(((near - a) / (b - a), (far - a) / (b - a)))
        low, high = max(low, first), min(high, last)
    return low <= high if closed else low < high


def keeps_corners(world, rule, here, there):
    """Whether a segment between centres of cells enters no blocked cell and keeps a corner rule of a grid."""
    ends = [[Fraction(2 * int(c) + 1, 2) for c in end] for end in (here, there)]
    if any(meets(*ends, cell, closed=rule == "both") for cell in blocked_beside(world, here, there)):
        return False
    return rule != "one" or all(beside_one(world, *ends, corner) for corner in corners_on(*ends))


def blocked_beside(world, here, there):
    """The blocked cells of the world that a segment between two points, given in cells, can meet."""
    spans = zip(here, there, world.shape, strict=True)
    near = product(*(range(max(0, int(min(a, b)) - 1), min(n, int(max(a, b)) + 2)) for a, b, n in spans))
    return [cell for cell in near if not world.is_free(cell)]


def corners_on(here, there):
    """The corners of a flat world's cells that lie on a segment between centres."""
    along = [b - a for a, b in zip(here, there, strict=True)]
    xs = sorted((here[0], there[0]))
    for x in range(int(np.ceil(xs[0])), int(np.floor(xs[1])) + 1) if along[0] else ():
        y = here[1] + along[1] * (x - here[0]) / along[0]
        if y.denominator == 1:
            yield x, int(y), along


def beside_one(world, here, there, corner):
    """Whether one of the two cells beside a corner, neither left nor entered there, is free."""
    x, y, along = corner
    falls = along[0] * along[1] < 0
    sides = [(x - 1, y - 1), (x, y)] if falls else [(x - 1, y), (x, y - 1)]
    return any(world.is_free((*side, 0)) for side in sides)


def enters(world, points, depth=1e-9):
    """Whether a polyline, in cells, is anywhere deeper than ``depth`` in a blocked cell."""
    return any(
        meets(*ends, cell, closed=False, shrunk=depth)
        for ends in pairwise(points.tolist())
        for cell in blocked_beside(world, *ends)
    )
