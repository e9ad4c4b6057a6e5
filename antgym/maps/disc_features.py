"""Disc features: what can be seen of a scenario among discs before anything is planned.

None needs the optimum, a shortest path or anything derived from one; lengths enter only as ratios, so the unit does not
matter. What a grid has too keeps its name. Two fields of sampled clearances serve most of it: one over the bounds, one
of lines across the straight line, which tell how far aside a path must go, and how much room there is.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antgym.maps.discs import DiscScenario, DiscWorld
from antgym.maps.features import Feature

RASTER = 48  # samples a side, over the bounds
SLICES, ACROSS = 40, 81  # lines across the straight line, and samples of each, an odd number: one lies on it
CHUNK = 256  # discs looked at together, so that memory is bounded
NEAR, TIGHT, OPEN = 0.1, 0.02, 0.25  # of the straight line, of the width, of the width
Floats = NDArray[np.float64]

DISC_FEATURES: tuple[Feature, ...] = (
    Feature("reach", 0.0, 1.0, "straight line over the longest there is in the bounds"),
    Feature("stretch_y", -1.0, 1.0, "log2 of the bounds' side along y over that along x, / 3"),
    Feature("offset_x", 0.0, 1.0, "distance from start to goal along x, over the straight line"),
    Feature("discs", 0.0, 1.0, "log10 of 1 + the discs, / 3"),
    Feature("radius", 0.0, 1.0, "mean radius, the robot's included, over a tenth of the width"),
    Feature("radius_sd", 0.0, 1.0, "standard deviation of the radii over their mean"),
    Feature("safe", 0.0, 1.0, "D_safe over a tenth of the width"),
    Feature("blocked", 0.0, 1.0, "share of the bounds that discs cover"),
    Feature(
        "blocked_near_line", 0.0, 1.0, f"the same at most {NEAR:g} straight lines from the straight line"
    ),
    Feature("blocked_on_line", 0.0, 1.0, "covered share of the straight line from start to goal"),
    Feature("walls_on_line", 0.0, 1.0, "obstacles that the straight line crosses, / 10"),
    Feature("sight_from_start", 0.0, 1.0, "share of the straight line up to its first disc"),
    Feature("sight_from_goal", 0.0, 1.0, "the same from the goal"),
    Feature("narrowest_layer", 0.0, 1.0, "free share of the line across where it is smallest"),
    Feature(
        "narrowest_way", 0.0, 1.0, "widest free stretch of a line across where it is smallest, / the width"
    ),
    Feature("nearest_way", 0.0, 1.0, "width of the free stretch nearest to the straight line, likewise"),
    Feature(
        "aside", 0.0, 1.0, "how far from the straight line the nearest free place across it is at worst, / it"
    ),
    Feature("swing", 0.0, 1.0, "between the farthest such places on either side, / the straight line"),
    Feature("largest_wall", 0.0, 1.0, "longest side of the largest obstacle, over the width"),
    Feature("obstacles", 0.0, 1.0, "log10 of 1 + the obstacles that discs form together, / 2"),
    Feature("tight", 0.0, 1.0, f"share of the free places with a disc within {TIGHT:g} widths"),
    Feature(
        "clearance", 0.0, 1.0, f"mean distance of the free places to the nearest disc, / {OPEN:g} widths"
    ),
    Feature("clearance_on_line", 0.0, 1.0, "the same along the straight line, 0 within discs"),
    Feature("ahead_of_start", 0.0, 1.0, "covered share of the quarter of the lines across next to it"),
    Feature("ahead_of_goal", 0.0, 1.0, "the same at the goal"),
)
_LOW, _HIGH = (np.array([feature[bound] for feature in DISC_FEATURES]) for bound in (1, 2))


class _Fields(NamedTuple):
    """Clearances from the nearest disc, negative within one, inf where there is none, and the straight line."""

    bounds: Floats  # (RASTER, RASTER)
    across: Floats  # (SLICES, ACROSS); -inf out of bounds
    offsets: Floats  # (ACROSS,) of the latter from the straight line
    straight: float


def describe_discs(scenario: DiscScenario) -> NDArray[np.float32]:
    """Return the (len(DISC_FEATURES),) float32 descriptor of a scenario among discs, each entry within its bounds."""
    fields = _fields(scenario)
    values = {
        **_sizes(scenario),
        **_covered(scenario, fields),
        **_ways(scenario, fields),
        **_line(scenario, fields),
    }
    return np.clip([values[feature.name] for feature in DISC_FEATURES], _LOW, _HIGH).astype(np.float32)


def clearances_at(world: DiscWorld, points: Floats) -> Floats:
    """Return how far (n, 2) points are from the nearest disc, (n,): negative within one, inf where there is none."""
    nearest, grown = np.full(len(points), np.inf), world.grown
    for first in range(0, len(grown), CHUNK):
        x, y, radius = grown[first : first + CHUNK].T
        gaps = np.hypot(points[:, :1] - x, points[:, 1:] - y) - radius
        nearest = np.minimum(nearest, gaps.min(axis=1))
    return nearest


def raster(world: DiscWorld, columns: int, rows: int) -> Floats:
    """Return clearances at the centres of equal blocks of the bounds, (columns, rows): x first."""
    x_min, x_max, y_min, y_max = world.bounds
    x = x_min + (np.arange(columns) + 0.5) / columns * (x_max - x_min)
    y = y_min + (np.arange(rows) + 0.5) / rows * (y_max - y_min)
    points = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    return clearances_at(world, points).reshape(columns, rows)


def _fields(scenario: DiscScenario) -> _Fields:
    world, straight = scenario.world, scenario.straight_line
    start, goal = np.array(scenario.start), np.array(scenario.goal)
    along = (goal - start) / straight
    side = np.array([-along[1], along[0]])
    offsets = np.linspace(-straight, straight, ACROSS)
    places = (np.arange(SLICES) + 0.5) / SLICES * straight
    points = (start + places[:, None, None] * along + offsets[:, None] * side).reshape(-1, 2)
    x_min, x_max, y_min, y_max = world.bounds
    inside = (points >= (x_min, y_min)).all(axis=1) & (points <= (x_max, y_max)).all(axis=1)
    gaps = np.where(inside, clearances_at(world, points), -np.inf)
    return _Fields(raster(world, RASTER, RASTER), gaps.reshape(SLICES, ACROSS), offsets, straight)


def _sizes(scenario: DiscScenario) -> dict[str, float]:
    world, straight = scenario.world, scenario.straight_line
    x_min, x_max, y_min, y_max = world.bounds
    radii = world.grown[:, 2] if len(world.discs) else np.zeros(1)
    mean = float(radii.mean())
    return {
        "reach": straight / float(np.hypot(x_max - x_min, y_max - y_min)),
        "stretch_y": float(np.log2((y_max - y_min) / (x_max - x_min))) / 3,
        "offset_x": abs(scenario.goal[0] - scenario.start[0]) / straight,
        "discs": float(np.log10(1 + len(world.discs))) / 3,
        "radius": 10 * mean / world.width,
        "radius_sd": float(radii.std()) / mean if mean else 0.0,
        "safe": 10 * world.safe_distance / world.width,
    }


def _covered(scenario: DiscScenario, fields: _Fields) -> dict[str, float]:
    """Return what the two fields say of covered shares and of room."""
    from scipy.ndimage import find_objects, label

    width, blocked = scenario.world.width, fields.bounds <= 0
    free = fields.bounds[~blocked]
    inside, near = (
        np.isfinite(fields.across) | (fields.across > 0),
        np.abs(fields.offsets) <= NEAR * fields.straight,
    )
    within = inside & (fields.across <= 0)
    labels, count = label(blocked, np.ones((3, 3)))
    extents = [max(s.stop - s.start for s in found) for found in find_objects(labels)]
    quarter = SLICES // 4
    return {
        "blocked": blocked.mean(),
        "blocked_near_line": within[:, near].sum() / max(inside[:, near].sum(), 1),
        "largest_wall": max(extents, default=0) / RASTER,
        "obstacles": np.log10(1 + count) / 2,
        "tight": (free < TIGHT * width).mean() if len(free) else 1.0,
        "clearance": np.minimum(free / (OPEN * width), 1.0).mean() if len(free) else 0.0,
        "ahead_of_start": within[:quarter].sum() / max(inside[:quarter].sum(), 1),
        "ahead_of_goal": within[-quarter:].sum() / max(inside[-quarter:].sum(), 1),
    }


def _ways(scenario: DiscScenario, fields: _Fields) -> dict[str, float]:
    """Return how far aside a path must go, and through what: every path crosses every line across."""
    spacing = fields.offsets[1] - fields.offsets[0]
    inside = np.isfinite(fields.across) | (fields.across > 0)
    shares, widest, nearest, places = [], [], [], [0.0]
    for row, known in zip(fields.across > 0, inside, strict=True):
        edges = np.flatnonzero(np.diff(np.concatenate([[False], row, [False]])))
        shares.append(row.sum() / max(known.sum(), 1))
        if not len(edges):
            continue
        first, last = edges[::2], edges[1::2] - 1  # of every free stretch
        lengths = (last - first + 1) * spacing
        way = np.maximum(np.maximum(fields.offsets[first], -fields.offsets[last]), 0.0)
        chosen = int(way.argmin())
        widest.append(lengths.max())
        nearest.append(lengths[chosen])
        places.append(way[chosen] if fields.offsets[first[chosen]] > 0 else -way[chosen])
    width = scenario.world.width
    return {
        "narrowest_layer": min(shares),
        "narrowest_way": min(widest, default=0.0) / width,
        "nearest_way": min(nearest, default=0.0) / width,
        "aside": max(map(abs, places)) / fields.straight,
        "swing": (max(places) - min(places)) / fields.straight,
    }


def _line(scenario: DiscScenario, fields: _Fields) -> dict[str, float]:
    """Return what the straight line meets, exactly: each disc covers a stretch of it, or none."""
    start, straight = np.array(scenario.start), fields.straight
    along = (np.array(scenario.goal) - start) / straight
    x, y, radius = scenario.world.grown.T
    middle = (x - start[0]) * along[0] + (y - start[1]) * along[1]
    apart = (x - start[0]) * along[1] - (y - start[1]) * along[0]
    half = np.sqrt(np.maximum(radius**2 - apart**2, 0.0))
    low, high = np.maximum(middle - half, 0.0), np.minimum(middle + half, straight)
    covered, reached, walls = 0.0, 0.0, 0
    crossed = sorted(
        (a, b) for a, b, h in zip(low.tolist(), high.tolist(), half.tolist(), strict=True) if h and a < b
    )
    for a, b in crossed:
        walls += a > reached or not walls
        covered += max(b - max(a, reached), 0.0)
        reached = max(reached, b)
    room = np.clip(fields.across[:, ACROSS // 2] / (OPEN * scenario.world.width), 0.0, 1.0)
    return {
        "blocked_on_line": covered / straight,
        "walls_on_line": walls / 10,
        "sight_from_start": crossed[0][0] / straight if crossed else 1.0,
        "sight_from_goal": 1.0 - reached / straight if crossed else 1.0,
        "clearance_on_line": float(room.mean()),
    }
