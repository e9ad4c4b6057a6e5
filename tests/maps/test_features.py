"""Features: bounded on any world, blind to units and to the optimum, and right on worlds drawn by hand."""

import time

import numpy as np
import pytest
from hypothesis import given, settings
from scenarios import GRIDS, drawn, grids, scenarios

from antgym.maps import optimum
from antgym.maps.features import FEATURES, describe, feature_table
from antgym.maps.motion import CORNERS, Motion
from antgym.maps.world import GridWorld, Scenario

NAMES = [feature.name for feature in FEATURES]
ALONG_LINE = ("blocked_on_line", "blocked_near_line", "clearance_on_line", "walls_on_line")
MAY_ROUND = [name for name in NAMES if name.startswith(("greedy", "sight")) or name in ALONG_LINE]
"""Greedy ants may break their ties the other way in a mirror, and straight lines round the other way."""


def named(scenario):
    return dict(zip(NAMES, describe(scenario).tolist(), strict=True))


def without_rounding(scenario):
    return {name: value for name, value in named(scenario).items() if name not in MAY_ROUND}


def mirrored(scenario, axis):
    """The same question in a mirror across an axis."""
    last = scenario.world.shape[axis] - 1
    ends = [
        tuple(last - c if i == axis else c for i, c in enumerate(end))
        for end in (scenario.start, scenario.goal)
    ]
    return Scenario(
        GridWorld(np.flip(scenario.world.free, axis), scenario.world.cell), *ends, scenario.motion
    )


@settings(deadline=None)
@given(scenario=scenarios())
def test_features_are_finite_and_within_their_bounds(scenario):
    values = describe(scenario)
    assert values.dtype == np.float32
    assert values.shape == (len(FEATURES),)
    for value, feature in zip(values, FEATURES, strict=True):
        assert feature.low <= value <= feature.high, feature.name


@settings(deadline=None, max_examples=20)
@given(scenario=scenarios())
def test_features_need_neither_the_optimum_nor_a_path(scenario):
    with pytest.MonkeyPatch.context() as patch:
        for name in ("shortest_length", "shortest_path", "_sweep", "_search"):
            patch.setattr(optimum, name, lambda *_: pytest.fail("searched for a path"))
        patch.setattr(Scenario, "optimum", property(lambda _: pytest.fail("asked for the optimum")))
        describe(scenario)


@settings(deadline=None, max_examples=40)
@given(scenario=scenarios())
def test_features_do_not_depend_on_the_unit_of_length(scenario):
    edges = tuple(4 * edge for edge in scenario.world.cell)
    world = GridWorld(scenario.world.free, edges)
    assert (
        describe(scenario) == describe(Scenario(world, scenario.start, scenario.goal, scenario.motion))
    ).all()


@settings(deadline=None, max_examples=40)
@given(scenario=scenarios(max_side=5))
def test_features_do_not_change_in_the_mirror(scenario):
    assert without_rounding(scenario) == pytest.approx(without_rounding(mirrored(scenario, 1)), abs=1e-6)


@settings(deadline=None, max_examples=40)
@given(scenario=grids(max_side=5))
def test_the_way_back_on_a_grid_swaps_start_and_goal(scenario):
    there = without_rounding(scenario)
    back = without_rounding(Scenario(scenario.world, scenario.goal, scenario.start, scenario.motion))
    for one, other in (
        ("ahead_of_start", "ahead_of_goal"),
        ("behind_start", "behind_goal"),
        ("ways_out", "ways_in"),
    ):
        assert (there[one], there[other]) == pytest.approx((back[other], back[one]))
    assert there["offset_z"] == -back["offset_z"]
    same = ("moves", "blocked_in_reach", "narrowest_layer", "surface", "roughness", "offset_x")
    assert [there[name] for name in same] == pytest.approx([back[name] for name in same])


@settings(deadline=None, max_examples=40)
@given(scenario=grids(max_side=5))
def test_the_mirror_across_x_changes_nothing_on_a_grid(scenario):
    assert without_rounding(scenario) == pytest.approx(without_rounding(mirrored(scenario, 0)), abs=1e-6)


OBSTACLES = tuple(
    name for name in NAMES if name.startswith(("blocked", "column", "ahead", "behind", "walls"))
)
OBSTACLES += ("dead_ends", "full_columns", "roughness", "covered", "surface", "tight")
FREE = ("greedy_arrives", "greedy_progress", "narrowest_layer", "sight_from_start", "sight_from_goal")
FREE += ("clearance", "clearance_on_line")


def test_an_open_world_holds_no_obstacle_and_no_dead_end():
    values = named(Scenario(GridWorld(np.ones((21, 20, 20))), (0, 10, 3), (20, 10, 3)))
    sizes = ("moves", "cells_y", "cells_z", "offset_y", "offset_z")
    assert [values[name] for name in (*sizes, *OBSTACLES)] == [0.0] * (len(sizes) + len(OBSTACLES))
    assert [values[name] for name in FREE] == [1.0] * len(FREE)
    assert values["greedy_detour"] == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize("motion", GRIDS, ids=str)
def test_an_open_grid_holds_no_obstacle_and_no_dead_end(motion):
    values = named(Scenario(GridWorld(np.ones((20, 20, 1))), (2, 10, 0), (18, 10, 0), motion))
    assert [values[name] for name in OBSTACLES] == [0.0] * len(OBSTACLES)
    assert [values[name] for name in FREE] == [1.0] * len(FREE)
    assert values["greedy_detour"] == 0
    assert values["branching"] < 1  # cells at the border have fewer moves
    assert (values["layered"], values["flat"]) == (0, 1)


def test_a_blind_valley_stops_the_greedy_ant_but_not_the_path():
    trap = drawn(["...S......", ".....#....", ".....#....", ".....#....", "#####.....", "...G......"])
    open_end = drawn(["...S......", "..........", "..........", "..........", "#####.....", "...G......"])
    assert (named(trap)["greedy_arrives"], named(trap)["greedy_detour"]) == (0, 1)
    assert named(trap)["greedy_progress"] == pytest.approx(3 / 5)
    assert named(trap)["dead_ends"] > named(open_end)["dead_ends"]


def test_obstacles_are_measured_where_they_stand():
    values = named(drawn(["..S..", "####.", ".....", "..G.."]))
    assert values["blocked"] == pytest.approx(4 / 20)
    assert values["narrowest_layer"] == pytest.approx(1 / 5)
    assert values["full_columns"] == pytest.approx(4 / 20)
    assert 0 < values["blocked_on_line"] < 0.5


def test_columns_are_as_high_as_their_topmost_blocked_cell():
    free = np.ones((3, 2, 4))
    free[1, 1, 2] = 0
    values = named(Scenario(GridWorld(free), (0, 0, 0), (2, 0, 0)))
    assert values["column_max"] == pytest.approx(3 / 4)
    assert values["column_mean"] == pytest.approx(3 / 4 / 6)
    assert values["roughness"] == pytest.approx(3 * 0.75 / 7)


def test_a_free_cell_under_a_blocked_one_is_covered():
    free = np.ones((3, 2, 4))
    free[1, 1, 2] = 0
    assert named(Scenario(GridWorld(free), (0, 0, 0), (2, 0, 0)))["covered"] == pytest.approx(2 / 23)


def test_a_motion_is_told_by_its_flags_and_no_two_are_alike():
    """But for the corner rules of grid4, which has no diagonals."""
    motions = [m for m in (*GRIDS, Motion(), Motion(check_segments=False)) if m.name != "grid4"]
    motions.append(Motion("grid4"))
    free = np.ones((5, 5, 1))
    seen = [named(Scenario(GridWorld(free), (0, 2, 0), (4, 2, 0), motion)) for motion in motions]
    flags = {tuple(values[name] for name in ("layered", "move_count", "side_cells")) for values in seen}
    assert len(flags) == len(motions)
    assert [values["layered"] for values in seen] == [float(motion.layered) for motion in motions]


@pytest.mark.parametrize(
    ("motion", "moves", "sides"),
    [(("grid4",), 4, 0), (("grid8", "both"), 8, 1), (("grid8", "one"), 8, 0.5), (("grid8", "cut"), 8, 0)],
)
def test_side_cells_are_counted_as_the_corner_rule_has_them(motion, moves, sides):
    name, corners = (*motion, "both")[:2]
    scenario = Scenario(GridWorld(np.ones((4, 4))), (0, 0), (3, 3), Motion(name, corners=corners))
    values = named(scenario)
    assert (values["move_count"], values["side_cells"]) == pytest.approx((moves / 26, sides / 3))
    assert values["moves"] == pytest.approx(np.log10((6 if name == "grid4" else 3) / 20))


def test_every_motion_reads_as_the_same_vector():
    for name in CORNERS:
        scenario = Scenario(GridWorld(np.ones((5, 5, 1))), (0, 2, 0), (4, 2, 0), Motion(name))
        assert describe(scenario).shape == (len(FEATURES),)


def test_a_dead_end_of_a_grid_has_one_way_out_at_most():
    values = named(drawn(["#.#####", "S.....G", "#.#####"], Motion("grid4")))
    alley, cells = 2, 8  # the two blind cells and the start, of all free ones but the goal
    assert values["dead_ends"] == pytest.approx((alley + 1) / cells)


def test_sight_ends_at_the_first_wall_on_the_line():
    values = named(drawn(["S..#..#......G"], Motion("grid8")))
    assert values["walls_on_line"] == pytest.approx(2 / 10)
    assert values["sight_from_start"] == pytest.approx(2.5 / 13, abs=0.02)
    assert values["sight_from_goal"] == pytest.approx(6.5 / 13, abs=0.02)
    assert values["blocked_on_line"] == pytest.approx(2 / 13, abs=0.02)


def test_a_pocket_round_the_goal_is_told_by_the_side_it_opens_to():
    pictures = (
        ["........", "....###.", "S...#.G.", "....###."],
        ["........", "....###.", "S....G#.", "....###."],
    )
    shut, ajar = (named(drawn(picture, Motion("grid8"))) for picture in pictures)
    assert shut["ahead_of_goal"] > ajar["ahead_of_goal"]
    assert shut["behind_goal"] < ajar["behind_goal"]


def test_ways_in_are_fewer_than_ways_out_where_the_goal_is_walled_in():
    values = named(drawn([".......", ".S..#.#", "....#G#", "....###"], Motion("grid8")))
    assert values["ways_in"] == pytest.approx(1 / 8)
    assert values["ways_out"] == 1


def test_narrow_passages_are_squeezed_and_tight():
    alley = named(drawn(["#########", "S.......G", "#########"], Motion("grid4")))
    hall = named(drawn([".........", ".........", "S.......G", ".........", "........."], Motion("grid4")))
    assert (alley["squeezed"], alley["tight"]) == (1, 1)
    assert (hall["squeezed"], hall["tight"]) != (1, 1)
    assert alley["clearance"] == pytest.approx(1 / 4)


@pytest.mark.slow
@pytest.mark.parametrize(("shape", "motion"), [((61,) * 3, "grid26"), ((64, 64, 1), "grid8")])
def test_describing_a_scenario_takes_milliseconds(shape, motion):
    """CPU time: 15 ms where nobody else computes, three times as much on a crowded machine."""
    free = np.random.default_rng(0).random(shape) > 0.25
    ends = (0, 0, 0), tuple(n - 1 for n in shape)
    free[ends[0]] = free[ends[1]] = True
    scenario, seconds = Scenario(GridWorld(free), *ends, Motion(motion)), []
    for _ in range(5):
        begun = time.process_time()
        describe(scenario)
        seconds.append(time.process_time() - begun)
    assert min(seconds) < 0.06


def test_the_table_shows_every_feature_once():
    rows = feature_table().splitlines()[2:]
    assert [row.split(" | ")[1] for row in rows] == NAMES
    assert len(set(NAMES)) == len(NAMES)
