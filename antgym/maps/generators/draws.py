"""Draws: how every family draws its scenarios, and which of them are worth keeping.

A family sketches worlds from two character numbers until one has a path and is worthwhile. The character is
kept over redraws, so that a hard one is not traded for an easy one that needs fewer of them.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from antgym.errors import MapError, ScenarioError
from antgym.maps.motion import REACH, move_table
from antgym.maps.world import PAD, GridWorld, Scenario

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
    """Return what the optimum would be if nothing were blocked, in world units.

    Where nothing is, a shortest path stays in the box that start and goal span: no more of the world is searched.
    """
    ends = np.array([scenario.start, scenario.goal])
    start, goal = (tuple(end.tolist()) for end in ends - ends.min(axis=0))
    box = GridWorld(np.ones(np.ptp(ends, axis=0) + 1, np.uint8), scenario.world.cell)
    return replace(scenario, world=box, start=start, goal=goal).optimum


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
    """Return the exact probability that an ant that takes every legal move equally often arrives.

    Raises:
        ScenarioError: if the motion is not layered: an ant that may come back need not end at all.
    """
    from antgym.kernels.paths import layered_arrival

    _ = scenario.layers  # refuses any other motion
    table, strides = move_table(scenario.motion), np.array(scenario.world.strides)
    return float(
        layered_arrival(
            scenario.world.bits,
            strides,
            table.required @ strides,
            table.steps,
            np.asarray(scenario.start) + PAD,
            np.asarray(scenario.goal) + PAD,
            REACH,
            np.empty((2, *scenario.world.padded[1:])),
        )
    )


def _worthwhile(scenario: Scenario, rng: np.random.Generator, shortest: Callable[[Scenario], float]) -> bool:
    nearly_straight = scenario.optimum < NEARLY_STRAIGHT * shortest(scenario)
    if nearly_straight and rng.random() >= KEPT:
        return False
    return not scenario.motion.layered or random_arrival(scenario) >= RARELY
