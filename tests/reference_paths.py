"""Slow, obvious twin of the exact optimum: Dijkstra over a dictionary of cells, every move checked by the book."""

import heapq
from itertools import pairwise, product

import numpy as np
import reference

AROUND = [step for step in product((-1, 0, 1), repeat=3) if any(step)]


def successors(scenario, cell):
    """All (end, length) of the legal moves from a cell."""
    steps = reference.STEPS if scenario.motion.layered else AROUND
    for step in steps:
        if allowed(scenario, cell, step):
            end = tuple(c + s for c, s in zip(cell, step, strict=True))
            yield end, reference.length_of(step, scenario.world.cell)


def allowed(scenario, cell, step):
    """Whether the motion has a step, and the world leaves it open."""
    motion, axes = scenario.motion, [axis for axis in range(3) if step[axis]]
    if motion.layered:
        return reference.legal(scenario, cell, step)
    if motion.name != "grid26" and (2 in axes or len(axes) > {"grid4": 1, "grid8": 2}[motion.name]):
        return False
    box = {tuple(np.add(cell, part).tolist()) for part in product(*((0, d) for d in step))}
    end = tuple(np.add(cell, step).tolist())
    sides = [reference.free(scenario, side) for side in box - {cell, end}]
    rule = {"both": all, "one": any, "cut": lambda sides: True}[motion.corners]
    return reference.free(scenario, end) and (not sides or rule(sides))


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
