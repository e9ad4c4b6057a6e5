"""Generators: seeded families of scenarios, and scenarios cut from real terrain.

A family is a function of a random generator and a size; the same generator state gives the same scenario.
Worlds without a path are redrawn, so every scenario has an optimum.
"""

from collections.abc import Callable, Sequence
from itertools import chain, product, zip_longest
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from antgym.errors import MapError, ScenarioError
from antgym.maps.features import legal_moves, within_reach
from antgym.maps.motion import REACH, move_table
from antgym.maps.readers import HeightField
from antgym.maps.shaping import block_max, voxelise
from antgym.maps.world import Cell, GridWorld, Scenario

Heights = NDArray[np.float64]

EDGE = 15.0  # mm, liu2020
SMALLEST = 8
MAX_DRAWS = 1000
NEARLY_STRAIGHT, KEPT = 1.06, 0.5
RARELY = 1e-3
SAMPLES_PER_CELL = 4


def mountains(rng: np.random.Generator, size: int = 21) -> Scenario:
    """Draw mountains in the manner of liu2020: from open hills to ceiling-high ridges with passes.

    The surface is a sum of smooth peaks. Over it stand *walls*, ridges across the straight line from start
    to goal, each with one or two passes, and *spurs*, short ridges along the way without one. They cut the
    ground into valleys, some of them blind: an ant that walks into one dies there. Two numbers, uniform in
    [0, 1] and kept over redraws, set the character: ``ruggedness`` how many ridges there are and how high,
    ``alignment`` how often a pass lies on the straight line, where a greedy ant finds it, and not
    elsewhere, where it must be looked for. The start lies on the surface in the first layer, the goal on
    the surface in the last, each at a random y.

    A world is redrawn if no path leads to the goal; if fewer than one in a thousand ants that walk at random
    would arrive, since no parameters solve such a world at a modest effort; and, with probability 1/2, if the
    shortest path is less than 6 % longer than the straight line.

    Args:
        rng: source of all randomness.
        size: cells along x, y and z, at least 8; cells are cubes of 15 mm.

    Raises:
        MapError: if the size is below 8.
    """
    if size < SMALLEST:
        raise MapError(f"mountains need a box of at least {SMALLEST} cells a side, got size={size}")
    ruggedness, alignment = rng.random(2)
    for _ in range(MAX_DRAWS):
        ends = rng.integers(size, size=2)
        heights = _relief(rng, size, (ends + 0.5) / size, ruggedness, alignment)
        world = voxelise(heights * size * EDGE, size, (EDGE, EDGE, EDGE))
        scenario = _between(world, int(ends[0]), int(ends[1]), "mountains")
        if scenario is not None and _worthwhile(scenario, rng):
            return scenario
    raise MapError(f"{MAX_DRAWS} draws gave no worthwhile mountains of size {size}; try another seed or size")


FAMILIES: dict[str, Callable[[np.random.Generator, int], Scenario]] = {"mountains": mountains}


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


def _worthwhile(scenario: Scenario, rng: np.random.Generator) -> bool:
    straight = scenario.optimum < NEARLY_STRAIGHT * scenario.straight_line
    return not (straight and rng.random() >= KEPT) and random_arrival(scenario) >= RARELY


def _relief(
    rng: np.random.Generator, size: int, ends: NDArray[np.float64], ruggedness: float, alignment: float
) -> Heights:
    """Draw (size, size) heights, 1 being the ceiling, between ends at the given y in [0, 1]."""
    x, y = np.meshgrid(*[(np.arange(size) + 0.5) / size] * 2, indexing="ij")
    hills = np.zeros((size, size))
    for _ in range(3 + rng.poisson(4)):
        hills += _peak(rng, x, y) * (0.5 + ruggedness)
    ridges = []
    for _ in range(rng.binomial(4, 0.1 + 0.6 * ruggedness)):
        ridges.append(_wall(rng, x, y, ends, ruggedness, alignment))
    for _ in range(rng.poisson(2.5 * ruggedness)):
        ridges.append(_spur(rng, x, y))
    return np.maximum.reduce([hills, *ridges])


def _peak(rng: np.random.Generator, x: Heights, y: Heights) -> Heights:
    (px, py), width = rng.random(2), rng.uniform(0.05, 0.14)
    return rng.uniform(0.1, 0.7) * np.exp(-((x - px) ** 2 + (y - py) ** 2) / (2 * width**2))


def _wall(
    rng: np.random.Generator,
    x: Heights,
    y: Heights,
    ends: NDArray[np.float64],
    ruggedness: float,
    alignment: float,
) -> Heights:
    angle = np.radians(rng.uniform(-50, 50))
    px = rng.uniform(0.15, 0.85)
    py = ends[0] + px * (ends[1] - ends[0])  # the straight line crosses the wall here
    across = (x - px) * np.cos(angle) - (y - py) * np.sin(angle)
    along = (x - px) * np.sin(angle) + (y - py) * np.cos(angle)
    crest = np.full_like(x, rng.uniform(0.5 + 0.5 * ruggedness, 1.0 + ruggedness))
    for _ in range(rng.integers(1, 3)):
        on_line = rng.random() < alignment
        place = rng.normal(0, 0.03) if on_line else (rng.random() - py) / np.cos(angle)
        width, floor = rng.uniform(0.06, 0.12), rng.uniform(0.0, 0.6)
        crest *= 1 - (1 - floor) * np.exp(-(((along - place) / width) ** 4))
    return crest * _profile(rng, across)


def _spur(rng: np.random.Generator, x: Heights, y: Heights) -> Heights:
    angle, half = np.radians(rng.uniform(-20, 20)), rng.uniform(0.1, 0.25)
    px, py = rng.uniform(0.2, 0.8), rng.uniform(0.1, 0.9)
    along = (x - px) * np.cos(angle) + (y - py) * np.sin(angle)
    across = (y - py) * np.cos(angle) - (x - px) * np.sin(angle)
    beyond = np.maximum(np.abs(along) - half, 0)
    return rng.uniform(0.6, 1.4) * _profile(rng, np.hypot(across, beyond))


def _profile(rng: np.random.Generator, distance: Heights) -> Heights:
    """Return the cross-section of a ridge, 1 at its crest."""
    width = 1 / len(distance) + rng.uniform(0.0, 0.04)  # a thinner one would let diagonal moves slip through
    return np.exp(-(distance**2) / (2 * width**2))


def _between(world: GridWorld, first: int, last: int, name: str) -> Scenario | None:
    """Return the scenario between the lowest free cells of two columns, None if one is full or cut off."""
    nx = world.shape[0]
    if not (world.free[0, first].any() and world.free[-1, last].any()):
        return None
    start: Cell = (0, first, int(world.free[0, first].argmax()))
    goal: Cell = (nx - 1, last, int(world.free[-1, last].argmax()))
    scenario = Scenario(world, start, goal, name=name)
    try:
        _ = scenario.optimum
    except ScenarioError:
        return None
    return scenario


def terrain_windows(
    field: HeightField, size: int = 21, rotations: Sequence[int] = (0,), count: int | None = None
) -> tuple[Scenario, ...]:
    """Cut scenarios from real terrain: square windows side by side, four samples a cell, none overlapping.

    A cell is a cube whose edge is four mean horizontal spacings, in the field's unit. The relief of a
    window is stretched until its lowest sample lies on the floor and its highest touches the ceiling: the
    vertical exaggeration is size · edge / relief. A column is as high as its highest sample. Start and goal
    lie on the surface of the first and the last layer, in the middle third of their columns: the pair of
    least summed height between which there is a path. Windows that are flat, hold missing samples or have
    no such pair are skipped.

    Args:
        field: the terrain.
        size: cells along x, y and z.
        rotations: degrees by which each window is turned before its x becomes the way to go: 0, 90, 180, 270,
            counter-clockwise seen from above.
        count: how many scenarios at most; all where None.

    Returns:
        Every window in its first possible rotation, then every one in its second, and so on, named
        ``source-r{row}c{column}-{rotation}`` with row counted along axis 0 of the heights.

    Raises:
        MapError: if the field is smaller than one window or a rotation is no multiple of 90 degrees.
    """
    samples = SAMPLES_PER_CELL * size
    rows, columns = (n // samples for n in field.heights.shape)
    if size < 2 or not rows * columns:
        raise MapError(
            f"{field.source}: {field.heights.shape} samples hold no window of {size} cells a side; "
            f"choose a size from 2 to {min(field.heights.shape) // SAMPLES_PER_CELL}"
        )
    if any(degrees % 90 for degrees in rotations):
        raise MapError(f"windows turn by multiples of 90 degrees, got {tuple(rotations)}")
    turned = []
    for i, j in product(range(rows), range(columns)):
        window = field.heights[i * samples :, j * samples :][:samples, :samples]
        name = f"{Path(field.source).stem}-r{i}c{j}"
        turned.append(_turned(window, rotations, size, SAMPLES_PER_CELL * sum(field.spacing) / 2, name))
    in_turn = chain.from_iterable(zip_longest(*turned))
    return tuple(scenario for scenario in in_turn if scenario is not None)[:count]


def _turned(window: Heights, rotations: Sequence[int], size: int, edge: float, name: str) -> list[Scenario]:
    low, relief = window.min(), np.ptp(window)
    if not 0 < relief < np.inf:  # flat, or not a number where a sample is missing
        return []
    scaled = block_max((window - low) * (size * edge / relief), (size, size))
    scenarios = [_lowest_way(np.rot90(scaled, d // 90), edge, f"{name}-{d}") for d in rotations]
    return [scenario for scenario in scenarios if scenario is not None]


def _lowest_way(heights: Heights, edge: float, name: str) -> Scenario | None:
    size = len(heights)
    world = voxelise(heights, size, (edge, edge, edge))
    middle = range(size // 3, size - size // 3)
    pairs = sorted(
        product(middle, middle), key=lambda pair: float(heights[0, pair[0]] + heights[-1, pair[1]])
    )
    scenarios = (_between(world, first, last, name) for first, last in pairs)
    return next((scenario for scenario in scenarios if scenario is not None), None)
