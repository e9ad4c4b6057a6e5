"""Slow, obvious twin of the exact optimum: Dijkstra over a dictionary of cells, every move checked by the book."""

import heapq
from itertools import pairwise

import numpy as np

from reference.ground import LAYERED, end_of, legal, length_of, steps_of


def successors(scenario, cell):
    """All (end, length) of the legal moves from a cell."""
    for step in steps_of(scenario.motion):
        if legal(scenario, cell, step):
            yield end_of(cell, step), length_of(step, scenario.world.cell)


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


def shortest_by_layers(scenario):
    """Exact shortest length by recursion over all cells reached, layer by layer."""
    reached = {scenario.start: 0.0}
    for _ in range(scenario.layers):
        following = {}
        for cell, total in reached.items():
            for step in LAYERED:
                if legal(scenario, cell, step):
                    end = end_of(cell, step)
                    length = total + np.linalg.norm(np.array(step) * scenario.world.cell)
                    following[end] = min(following.get(end, np.inf), length)
        reached = following
    return reached.get(scenario.goal, np.inf)
