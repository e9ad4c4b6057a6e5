"""Draws: how every family draws its scenarios, and which of them are worth keeping.

A family sketches worlds from two character numbers until one has a path and is worthwhile. The character is
kept over redraws, so that a hard one is not traded for an easy one that needs fewer of them.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from antgym.errors import MapError, ScenarioError
from antgym.maps.features import legal_moves, within_reach
from antgym.maps.motion import REACH, move_table
from antgym.maps.world import GridWorld, Scenario

EDGE = 15.0  # mm, liu2020: of the cubes that the layered worlds are made of
SMALLEST = 8
MAX_DRAWS = 1000
NEARLY_STRAIGHT, KEPT = 1.06, 0.5
RARELY = 1e-3

Sketch = Callable[[np.random.Generator, int, float, float], Scenario | None]
"""(rng, size, both character numbers) -> a scenario, with or without a path, or None where there is none."""


def straight_line(scenario: Scenario) -> float:
    """Return the Euclidean distance from start to goal, in world units."""
    return scenario.straight_line


def unobstructed(scenario: Scenario) -> float:
    """Return what the optimum would be if nothing were blocked, in world units."""
    world = GridWorld(np.ones_like(scenario.world.free), scenario.world.cell)
    return replace(scenario, world=world).optimum


def redrawn(
    sketch: Sketch,
    family: str,
    rng: np.random.Generator,
    size: int,
    shortest: Callable[[Scenario], float] = unobstructed,
) -> Scenario:
    """Return the first worthwhile scenario; both character numbers, uniform in [0, 1], are drawn once.

    A world is redrawn if no path leads to the goal; with probability 1/2 if the shortest path is less than 6 %
    longer than ``shortest``; and, where the motion is layered, if fewer than one in a thousand ants that walk at
    random would arrive, since no parameters solve such a world at a modest effort.

    Raises:
        MapError: if the size is below 8, or nothing that is drawn is worthwhile.
    """
    if size < SMALLEST:
        raise MapError(f"{family} has at least {SMALLEST} cells a side, got size={size}")
    first, second = rng.random(2).tolist()
    for _ in range(MAX_DRAWS):
        scenario = sketch(rng, size, first, second)
        if scenario is not None and has_path(scenario) and _worthwhile(scenario, rng, shortest):
            return scenario
    raise MapError(
        f"{MAX_DRAWS} draws gave nothing worthwhile of {family} and size={size}; try another seed or size"
    )


def has_path(scenario: Scenario) -> bool:
    """Whether any path leads to the goal."""
    try:
        return scenario.optimum > 0
    except ScenarioError:
        return False


def random_arrival(scenario: Scenario) -> float:
    """Return the exact probability that an ant that takes every legal move equally often arrives."""
    steps = move_table(scenario.motion).steps
    candidates = within_reach(scenario)
    _, ny, nz = scenario.world.shape
    chances = np.zeros((ny + 2 * REACH, nz + 2 * REACH))
    chances[scenario.goal[1] + REACH, scenario.goal[2] + REACH] = 1.0
    for layer in range(scenario.layers - 1, -1, -1):
        x = scenario.start[0] + layer
        y, z = np.nonzero(candidates[layer] & (scenario.world.free[x] != 0))
        legal = legal_moves(scenario, np.stack([np.full_like(y, x), y, z], axis=1))
        y, z = y + REACH, z + REACH
        onward = (legal * chances[y[:, None] + steps[:, 1], z[:, None] + steps[:, 2]]).sum(axis=1)
        chances = np.zeros_like(chances)
        chances[y, z] = onward / np.maximum(legal.sum(axis=1), 1)
    return float(chances[scenario.start[1] + REACH, scenario.start[2] + REACH])


def _worthwhile(scenario: Scenario, rng: np.random.Generator, shortest: Callable[[Scenario], float]) -> bool:
    nearly_straight = scenario.optimum < NEARLY_STRAIGHT * shortest(scenario)
    if nearly_straight and rng.random() >= KEPT:
        return False
    return not scenario.motion.layered or random_arrival(scenario) >= RARELY
