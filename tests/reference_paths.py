"""Slow, obvious twin of the exact optimum: Dijkstra over a dictionary of cells, every move checked by the book."""

import heapq
from itertools import pairwise

import numpy as np
import reference


def successors(scenario, cell):
    """All (end, length) of the legal moves from a cell."""
    for step in reference.steps_of(scenario.motion):
        if reference.legal(scenario, cell, step):
            yield reference.end_of(cell, step), reference.length_of(step, scenario.world.cell)


def shortest(scenario):
    """Exact shortest length: the smallest of all sums, each added up from the start on; inf where there is none."""
    final, queue = {}, [(0.0, scenario.start)]
    while queue:
        total, cell = heapq.heappop(queue)
        if cell in final:
            continue
        final[cell] = total
        for end, length in successors(scenario, cell):
            heapq.heappush(queue, (total + length, end))
    return final.get(scenario.goal, np.inf)


def length_along(scenario, path):
    """The sum along a path of cells, from the start on; inf if it makes a move that the motion does not have."""
    total = 0.0
    cells = [tuple(cell) for cell in path.tolist()]
    for cell, end in pairwise(cells):
        total += dict(successors(scenario, cell)).get(end, np.inf)
    return total
