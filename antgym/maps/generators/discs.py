"""Discs: seeded families of scenarios in the plane, from one sparse scatter to corridors between walls of discs.

A family is a function of a random generator and a number of discs. Worlds are 40 × 40 cm with the start low on the
left, or amid rings, and the goal high on the right: wu2018 gives lengths near 50 cm and nothing else. They are drawn
until a path exists; where the straight line is free, half are drawn again, for they teach nothing.
"""

from collections.abc import Callable

import numpy as np

from antgym.errors import MapError, ScenarioError
from antgym.maps.discs import DiscScenario, DiscWorld, Floats, Point
from antgym.maps.world import Scenario

SIDE = 40.0  # cm
START, MIDDLE, GOAL = (4.0, 4.0), (SIDE / 2, SIDE / 2), (36.0, 36.0)
BOUNDS = (0.0, SIDE, 0.0, SIDE)
SAFE = 0.5  # cm, D_safe of the worlds as wu2018 describes them; silent in print
APART = 1.5  # cm, between a disc and an end, at least
MAX_DRAWS = 200
NEARLY_STRAIGHT, KEPT = 1.02, 0.5


def wu2018(rng: np.random.Generator, count: int = 20) -> DiscScenario:
    """Draw the world of wu2018: by default 20 obstacles of 1 to 3 cm, and a clearance to keep.

    Its obstacles are points in print; discs, their radii and the safe distance are ours. Other numbers of discs cover
    as much.
    """
    scale = np.sqrt(20 / max(count, 1))
    return _drawn(rng, count, lambda: _scatter(rng, count, scale, 3.0 * scale), "wu2018", SAFE)


def scatter(rng: np.random.Generator, count: int = 20) -> DiscScenario:
    """Draw discs anywhere that cover, one over another, from a tenth (sparse) to half (dense) of the world."""
    covered = rng.uniform(0.1, 0.5)
    radius = SIDE * np.sqrt(covered / (np.pi * max(count, 1)))
    return _drawn(rng, count, lambda: _scatter(rng, count, 0.5 * radius, 1.4 * radius), "scatter")


def corridors(rng: np.random.Generator, count: int = 20) -> DiscScenario:
    """Draw walls of overlapping discs across the way, one or two, each with a gap somewhere.

    Raises:
        MapError: also if there are fewer than 8 discs: no wall is closed by so few.
    """
    if count < 8:
        raise MapError(f"corridors have at least 8 discs, got {count}")
    walls = int(rng.integers(1, 3)) if count >= 16 else 1
    return _drawn(rng, count, lambda: _walls(rng, count, walls), "corridors")


def rings(rng: np.random.Generator, count: int = 24) -> DiscScenario:
    """Draw rings of overlapping discs around the start in the middle, one or two, each with a gap somewhere.

    Raises:
        MapError: also if there are fewer than 8 discs: no ring is closed by so few.
    """
    if count < 8:
        raise MapError(f"rings have at least 8 discs, got {count}")
    circles = int(rng.integers(1, 3)) if count >= 24 else 1
    return _drawn(rng, count, lambda: _circles(rng, count, circles), "rings", start=MIDDLE)


DISC_FAMILIES: dict[str, Callable[[np.random.Generator, int], DiscScenario]] = {
    family.__name__: family for family in (wu2018, scatter, corridors, rings)
}


def _drawn(
    rng: np.random.Generator,
    count: int,
    sketch: Callable[[], Floats],
    name: str,
    safe: float = 0.0,
    start: Point = START,
) -> DiscScenario:
    """Return the first worthwhile scenario among the discs that ``sketch`` draws."""
    for _ in range(MAX_DRAWS):
        world = DiscWorld(sketch(), BOUNDS, safe_distance=safe)
        try:
            scenario = Scenario(world, start, GOAL, name=name)
            nearly_straight = scenario.optimum < NEARLY_STRAIGHT * scenario.straight_line
        except ScenarioError:
            continue
        if not nearly_straight or count == 0 or rng.random() >= KEPT:
            return scenario
    raise MapError(
        f"{MAX_DRAWS} draws gave no path in {name} with {count} discs; try another seed or fewer discs"
    )


def _scatter(rng: np.random.Generator, count: int, smallest: float, largest: float) -> Floats:
    """Return (count, 3) discs uniform over the world, none too near an end."""
    discs = np.empty((count, 3))
    for i in range(count):
        while True:
            disc = np.array([*rng.uniform(0.0, SIDE, 2), rng.uniform(smallest, largest)])
            if _leaves_room(disc):
                break
        discs[i] = disc
    return discs


def _walls(rng: np.random.Generator, count: int, walls: int) -> Floats:
    """Return (count, 3) discs: walls across the diagonal, each with its gap, and what is left over strewn around."""
    along, across = np.array([1.0, 1.0]) / np.sqrt(2), np.array([-1.0, 1.0]) / np.sqrt(2)
    middle, half = np.array([SIDE / 2, SIDE / 2]), SIDE / np.sqrt(2)
    each, discs = count // walls, []
    places = np.linspace(-0.3, 0.3, walls) if walls > 1 else np.array([rng.uniform(-0.2, 0.2)])
    for place in places * half:
        reach = half - abs(place)  # from the diagonal to the border
        spacing = 2 * reach / (each - 1)
        gap, width = rng.uniform(-0.7, 0.7) * reach, rng.uniform(1.0, 2.5)
        radius = 0.55 * spacing
        for offset in np.linspace(-reach, reach, each):
            aside = offset - gap
            if abs(aside) < radius + width / 2:  # pushed out of the gap, to its rim
                aside = np.copysign(radius + width / 2, aside)
            discs.append([*(middle + place * along + (gap + aside) * across), radius])
    spare = _scatter(rng, count - len(discs), 0.5, 1.5)
    return np.vstack([np.array(discs), spare])


def _circles(rng: np.random.Generator, count: int, circles: int) -> Floats:
    """Return (count, 3) discs: rings around the middle, as many discs in each as its length asks for."""
    radii = rng.uniform(6.0, 9.0) * np.array([1.0, 1.8])[:circles]
    each = np.round(count * radii / radii.sum()).astype(int)
    each[-1] = count - each[:-1].sum()
    discs = []
    for radius, number in zip(radii, each, strict=True):
        gap, width = rng.uniform(0.0, 2 * np.pi), rng.uniform(1.0, 2.5) / radius  # as angles
        spacing = (2 * np.pi - width) / number
        angles = gap + width / 2 + (np.arange(number) + 0.5) * spacing
        # the two at the gap touch it, the others overlap
        size = radius * spacing * np.where(np.isin(np.arange(number), (0, number - 1)), 0.5, 0.55)
        discs.append(
            np.column_stack([MIDDLE + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1), size])
        )
    return np.vstack(discs)


def _leaves_room(disc: Floats) -> bool:
    return all(np.hypot(*(disc[:2] - end)) > disc[2] + APART for end in (START, GOAL))
