"""Disc worlds for the tests, and slow, independent ways to look at them."""

import heapq
import math

import numpy as np
import shapely
from hypothesis import strategies as st

from antgym.errors import ScenarioError
from antgym.maps.discs import DiscWorld
from antgym.maps.world import Scenario

BOUNDS = (0.0, 10.0, 0.0, 10.0)
START, GOAL = (0.5, 0.5), (9.5, 9.5)


def among(*discs, bounds=BOUNDS, start=START, goal=GOAL, **distances):
    """A scenario past discs given as (x, y, radius)."""
    return Scenario(DiscWorld(discs, bounds, **distances), start, goal)


def scattered(seed, count=8, largest=1.5, **distances):
    """Discs anywhere clear of start and goal; a path may or may not exist."""
    rng = np.random.default_rng(seed)
    discs = []
    while len(discs) < count:
        disc = (*rng.uniform(0, 10, 2).tolist(), rng.uniform(0.1, largest))
        if min(math.dist(disc[:2], end) for end in (START, GOAL)) > disc[2] + 0.3:
            discs.append(disc)
    return among(*discs, **distances)


def solvable(scenario):
    try:
        return scenario.optimum > 0
    except ScenarioError:
        return False


@st.composite
def disc_scenarios(draw, most=8):
    """Solvable scenarios of up to ``most`` discs, with or without a robot and a distance to keep."""
    seeds = st.integers(0, 10**6)
    distances = {
        "robot_radius": draw(st.sampled_from([0.0, 0.2])),
        "safe_distance": draw(st.sampled_from([0.0, 0.4])),
    }
    count = draw(st.integers(0, most))
    return draw(seeds.map(lambda seed: scattered(seed, count, **distances)).filter(solvable))


def shapely_clearance(scenario, path):
    """How far a path stays from all discs, robot included, as shapely measures it."""
    discs = scenario.world.discs
    gaps = shapely.distance(shapely.linestrings(path), shapely.points(discs[:, :2])) - discs[:, 2]
    return float(gaps.min(initial=np.inf)) - scenario.world.robot_radius


def polygon_length(scenario, corners=48):
    """The shortest path over the corners of polygons around the discs: never too short, and nearly the optimum."""
    grown = scenario.world.grown
    x_min, x_max, y_min, y_max = scenario.world.bounds
    turns = np.arange(corners) * 2 * np.pi / corners
    ring = np.stack([np.cos(turns), np.sin(turns)], axis=1) / np.cos(np.pi / corners)
    points = [scenario.start, scenario.goal, *(p for x, y, r in grown for p in (ring * r + (x, y)).tolist())]
    points = np.array([p for p in points if x_min <= p[0] <= x_max and y_min <= p[1] <= y_max])
    apart = np.hypot(*(points[:, None, :2] - grown[None, :, :2]).transpose(2, 0, 1))
    points = points[(apart >= grown[:, 2] - 1e-9).all(axis=1)]
    lengths = np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1))
    lines = shapely.linestrings(np.stack(np.broadcast_arrays(points[:, None], points[None]), axis=2))
    free = np.ones(lengths.shape, bool)
    for x, y, radius in grown.tolist():
        free &= shapely.distance(lines, shapely.Point(x, y)) >= radius - 1e-9
    best, heap = {}, [(0.0, 0)]
    while heap:
        total, at = heapq.heappop(heap)
        if at in best:
            continue
        best[at] = total
        if at == 1:
            return total
        for to in np.flatnonzero(free[at]).tolist():
            if to not in best:
                heapq.heappush(heap, (total + lengths[at, to], to))
    return math.inf
