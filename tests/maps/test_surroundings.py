"""Surroundings: counts by corner sums against cells counted one by one."""

from itertools import product

import numpy as np
from hypothesis import given, settings
from scenarios import drawn, scenarios

from antgym.maps.motion import Motion
from antgym.maps.surroundings import ASIDE, FARTHEST, LINE_SAMPLES, SAMPLE, Surroundings
from antgym.maps.world import GridWorld, Scenario


def cells_of(around):
    return np.array(list(np.ndindex(around.free.shape)))


def near(around, cell, radius):
    """The cells of a cube that lie inside the usable part."""
    spans = [
        range(max(c - radius, 0), min(c + radius + 1, n))
        for c, n in zip(cell, around.free.shape, strict=True)
    ]
    return list(product(*spans))


@settings(deadline=None, max_examples=40)
@given(scenario=scenarios(max_side=5))
def test_the_blocked_share_of_a_cube_is_that_of_its_cells_inside(scenario):
    around = Surroundings(scenario)
    for radius in (0, 1, 3):
        shares = around.blocked_share(cells_of(around), radius)
        for cell, share in zip(cells_of(around), shares, strict=True):
            assert share == np.mean([not around.free[c] for c in near(around, cell, radius)])


@settings(deadline=None, max_examples=40)
@given(scenario=scenarios(max_side=6))
def test_clearance_is_the_distance_to_the_nearest_blocked_cell(scenario):
    around = Surroundings(scenario)
    blocked = np.argwhere(~around.free)
    for cell, clearance in zip(cells_of(around), around.clearance(cells_of(around)), strict=True):
        away = np.abs(blocked - cell).max(axis=1)
        assert clearance == min(away, default=FARTHEST)


def test_clearance_ends_where_nobody_looks_farther():
    free = np.ones((40, 1))
    free[0] = 0
    around = Surroundings(Scenario(GridWorld(free), (1, 0), (39, 0), Motion("grid4")))
    cells = np.array([(x, 0, 0) for x in range(40)])
    assert around.clearance(cells).tolist() == [*range(FARTHEST), *[FARTHEST] * (40 - FARTHEST)]


@settings(deadline=None, max_examples=40)
@given(scenario=scenarios(max_side=6))
def test_a_place_is_squeezed_between_what_is_blocked_on_both_sides(scenario):
    around, cells = Surroundings(scenario), np.argwhere(scenario.world.free)
    cells = cells[
        (around.first <= cells).all(axis=1) & (cells < around.first + around.free.shape).all(axis=1)
    ]

    def is_blocked(cell):
        inside = all(0 <= c < n for c, n in zip(cell, scenario.world.shape, strict=True))
        return not inside or not scenario.world.free[tuple(cell)]

    axes = [a for a in range(scenario.motion.layered, 3) if around.free.shape[a] > 1]
    for cell, squeezed in zip(cells, around.squeezed(cells - around.first), strict=True):
        ways = [sign * np.eye(3, dtype=int)[axis] for axis in axes for sign in (-1, 1)]
        beside = [any(is_blocked(cell + far * way) for far in range(1, ASIDE + 1)) for way in ways]
        assert squeezed == any(beside[i] and beside[i + 1] for i in range(0, len(beside), 2))


@settings(deadline=None, max_examples=40)
@given(scenario=scenarios())
def test_the_sample_holds_every_free_cell_within_reach_but_the_goal_where_they_are_few(scenario):
    around = Surroundings(scenario)
    expected = {tuple(c) for c in np.argwhere(around.free & around.reach).tolist()} - {
        tuple(around.goal.tolist())
    }
    if len(expected) <= SAMPLE:
        assert {tuple(c) for c in around.sample.tolist()} == expected
    assert 1 <= len(around.sample) <= SAMPLE


@settings(deadline=None, max_examples=40)
@given(scenario=scenarios())
def test_the_straight_line_leads_from_start_to_goal_without_a_gap(scenario):
    around = Surroundings(scenario)
    line = around.line
    assert (line[0] + around.first).tolist() == list(scenario.start)
    assert (line[-1] + around.first).tolist() == list(scenario.goal)
    assert np.abs(np.diff(line, axis=0)).max() <= 1
    assert np.abs(np.diff(line[::LINE_SAMPLES], axis=0)).max() <= 1


def test_under_the_layered_motion_only_layers_from_start_to_goal_count():
    picture = ["#####", "..S..", ".....", "..G..", "#####"]
    assert Surroundings(drawn(picture)).free.all()
    grid = Surroundings(drawn(picture, Motion("grid4")))
    assert (~grid.free).sum() == 10
    assert grid.first.tolist() == [0, 0, 0]
