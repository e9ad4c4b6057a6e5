"""Obstacles, grown by a radius and filled to convex ones, against slow twins."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.ndimage import label

from antgym.errors import MapError
from antgym.maps.obstacles import convex, grown, hull_of
from antgym.maps.world import GridWorld


def blocked_of(world):
    return world.free == 0


def slow_grown(blocked, cell, radius):
    """Every pair of cells: the distance from one's centre to the box of the other."""
    found = blocked.copy()
    for free in np.argwhere(~blocked):
        for wall in np.argwhere(blocked):
            gap = np.maximum(np.abs(free - wall) - 0.5, 0) * cell
            found[tuple(free)] |= (gap**2).sum() < radius**2
    return found


@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 10**6),
    shape=st.tuples(st.integers(1, 7), st.integers(1, 7), st.integers(1, 4)),
    cell=st.sampled_from([(1.0, 1.0, 1.0), (1.0, 2.0, 0.7)]),
    radius=st.floats(0, 4),
)
def test_a_cell_is_blocked_where_a_ball_about_its_centre_reaches_into_an_obstacle(seed, shape, cell, radius):
    blocked = np.random.default_rng(seed).random(shape) < 0.1
    assert (blocked_of(grown(GridWorld(~blocked, cell), radius)) == slow_grown(blocked, cell, radius)).all()


@pytest.mark.parametrize("radius", [-1.0, float("nan"), float("inf")])
def test_a_radius_is_a_number_from_0_up(radius):
    with pytest.raises(MapError, match="radius = "):
        grown(GridWorld(np.ones((2, 2))), radius)


def slow_hull(cells):
    """Every cell whose centre is a convex combination of three set ones, by areas."""
    points = np.argwhere(cells)
    hull = cells.copy()
    for p in np.argwhere(~cells):
        a, b, c = points[:, None, None], points[None, :, None], points[None, None, :]
        one, two, three = (_area(u, v, p) for u, v in ((a, b), (b, c), (c, a)))
        inside = ((one >= 0) & (two >= 0) & (three >= 0)) | ((one <= 0) & (two <= 0) & (three <= 0))
        flat = (one == 0) & (two == 0) & (three == 0)
        within = (np.minimum(np.minimum(a, b), c) <= p).all(-1) & (p <= np.maximum(np.maximum(a, b), c)).all(
            -1
        )
        hull[tuple(p)] = (inside & (~flat | within)).any()
    return hull


def _area(u, v, p):
    return (v - u)[..., 0] * (p - u)[..., 1] - (v - u)[..., 1] * (p - u)[..., 0]


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10**6), shape=st.tuples(st.integers(1, 6), st.integers(1, 6)))
def test_a_hull_holds_every_cell_between_others_and_no_more(seed, shape):
    cells = np.random.default_rng(seed).random(shape) < 0.25
    assume(cells.any())
    assert (hull_of(cells) == slow_hull(cells)).all()


def world_of(lines):
    return GridWorld(np.array([[c != "#" for c in line] for line in lines]).T, (1.0, 1.0, 1.0))


def lines_of(world):
    return ["".join(".#"[1 - c] for c in row) for row in world.free[:, :, 0].T.tolist()]


def test_a_cup_is_filled_and_two_that_touch_then_are_one():
    cup = world_of([".......", ".#...#.", ".#...#.", ".#####.", "......."])
    filled = convex(cup, (0, 0, 0), (6, 4, 0))
    assert lines_of(filled.world) == [".......", ".#####.", ".#####.", ".#####.", "......."]
    assert (filled.cells, filled.left) == (6, 0)


def test_what_would_cover_an_end_or_part_the_ends_is_left_and_counted():
    cup = world_of([".......", ".#...#.", ".#...#.", ".#####.", "......."])
    assert convex(cup, (0, 0, 0), (3, 1, 0))[1:] == (0, 1)
    under_the_plug = ["...#...", "...#...", "#..#..#", "#.....#", "#######"]
    filled = convex(world_of(under_the_plug), (1, 0, 0), (5, 0, 0))
    assert filled.left == 1
    assert lines_of(filled.world) == under_the_plug


@settings(max_examples=80, deadline=None)
@given(seed=st.integers(0, 10**6), side=st.integers(3, 12), share=st.floats(0.02, 0.3))
def test_filled_obstacles_are_convex_but_for_those_left_and_the_ends_stay_joined(seed, side, share):
    free = np.random.default_rng(seed).random((side, side)) >= share
    free[0, 0] = free[-1, -1] = True
    before, _ = label(free)
    assume(before[0, 0] == before[-1, -1])
    world = GridWorld(free, (1.0, 1.0, 1.0))
    filled = convex(world, (0, 0, 0), (side - 1, side - 1, 0))
    after = filled.world.free[:, :, 0]
    parts, _ = label(after)
    assert parts[0, 0] == parts[-1, -1] != 0
    assert not (after & ~free).any(), "nothing that was blocked is free"
    obstacles, count = label(after == 0, np.ones((3, 3)))
    concave = sum(not (hull_of(obstacles == i) == (obstacles == i)).all() for i in range(1, count + 1))
    assert concave == filled.left


def test_worlds_in_space_are_not_filled():
    with pytest.raises(MapError, match="flat worlds alone"):
        convex(GridWorld(np.ones((3, 3, 3))), (0, 0, 0), (2, 2, 2))
