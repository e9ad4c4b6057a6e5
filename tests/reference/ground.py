"""What a scenario and its rules allow, cell by cell: moves, clearance, degrees."""

from functools import lru_cache
from itertools import product
from types import SimpleNamespace

import numpy as np

from antgym.maps.motion import REACH

F = np.float32
LAYERED = [(1, dy, dz) for dy in range(-2, 3) for dz in range(-2, 3)]
AROUND = [step for step in product((-1, 0, 1), repeat=3) if any(step)]


def steps_of(motion):
    """The moves of a motion, in the kernel's order: straight ones first."""
    if motion.layered:
        return LAYERED
    axes, most = {"grid4": (2, 1), "grid8": (2, 2), "grid26": (3, 3)}[motion.name]
    steps = [s for s in AROUND if not any(s[axes:]) and sum(map(abs, s)) <= most]
    return sorted(steps, key=lambda step: sum(map(abs, step)))


def end_of(cell, step):
    return tuple(c + s for c, s in zip(cell, step, strict=True))


def free(scenario, cell):
    inside = all(0 <= i < n for i, n in zip(cell, scenario.world.shape, strict=True))
    return inside and bool(scenario.world.free[cell])


def crossed(step):
    """Cells that the segment to ``step`` passes, found by walking along it in small steps."""
    cells = set()
    for t in np.linspace(0, 1, 4001)[1:-1]:
        point = np.array([0.5, 0.5, 0.5]) + t * np.array(step)
        if np.abs(point - np.round(point)).min() > 1e-9:  # not on a boundary
            cells.add(tuple(np.floor(point).astype(int).tolist()))
    return cells


CROSSED = {step: crossed(step) for step in LAYERED}


def legal(scenario, cell, step):
    """Whether a move is one the scenario's motion allows, by the book."""
    end = end_of(cell, step)
    if not scenario.motion.layered:
        box = {end_of(cell, part) for part in product(*((0, d) for d in step))}
        sides = [free(scenario, side) for side in box - {cell, end}]
        rule = {"both": all, "one": any, "cut": lambda sides: True}[scenario.motion.corners]
        return free(scenario, end) and (not sides or rule(sides))
    left = scenario.goal[0] - end[0]
    if max(abs(scenario.goal[1] - end[1]), abs(scenario.goal[2] - end[2])) > REACH * left:
        return False
    cells = [end]
    if scenario.motion.check_segments and max(abs(step[1]), abs(step[2])) == REACH:
        cells += [end_of(cell, part) for part in CROSSED[step]]
    return all(free(scenario, c) for c in cells)


@lru_cache(maxsize=1 << 16)
def clearance(scenario, cell):
    """Distance to the nearest blocked cell, by looking at all of them."""
    blocked, distance = np.argwhere(scenario.world.free == 0), np.float64(np.inf)
    if len(blocked):
        x, y, z = ((blocked - np.array(cell)) * np.array(scenario.world.cell)).T
        distance = np.sqrt(x * x + y * y + z * z).min()
    return F(distance)


def allowed(scenario, rules, cell, step):
    """Whether the rules let an ant make a move: legal, clear of obstacles, and in layers not into a dead end."""

    def possible(cell, step):
        if not legal(scenario, cell, step):
            return False
        least = F(rules.clearance[0] * min(scenario.world.cell))
        return rules.z3 == 0 or clearance(scenario, end_of(cell, step)) > least

    end = end_of(cell, step)
    if not possible(cell, step):
        return False
    if rules.trap != "lookahead" or not scenario.motion.layered or end[0] == scenario.goal[0]:
        return True
    return any(possible(end, following) for following in LAYERED)


@lru_cache(maxsize=1 << 16)
def degree(scenario, rules, cell):
    """How many moves lead on from a cell, and the length of the shortest."""
    blind = rules._replace(trap="die")
    lengths = [
        length_of(s, scenario.world.cell)
        for s in steps_of(scenario.motion)
        if allowed(scenario, blind, cell, s)
    ]
    return len(lengths), min(lengths, default=np.inf)


def mean_move(scenario):
    """Mean length of all moves between free cells, layered goals aside, by going through them."""
    steps, cells = steps_of(scenario.motion), [tuple(c) for c in np.argwhere(scenario.world.free).tolist()]
    loose = SimpleNamespace(world=scenario.world, motion=scenario.motion, goal=(10**6, 0, 0))
    counts = [sum(legal(loose, cell, step) for cell in cells) for step in steps]
    lengths = [length_of(step, scenario.world.cell) for step in steps]
    return (np.array(counts) * np.array(lengths)).sum() / sum(counts)


def length_of(step, cell_size):
    x, y, z = (np.float64(edge) * s for edge, s in zip(cell_size, step, strict=True))
    return np.sqrt(x * x + y * y + z * z)
