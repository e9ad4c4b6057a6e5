"""What every generated scenario keeps to, and that the families are as varied as they claim."""

import importlib.util
import math

import numpy as np
import pytest
from conftest import random_grid, random_scenario
from hypothesis import given, settings
from hypothesis import strategies as st

from antgym.errors import MapError, ScenarioError
from antgym.maps.formats.elevation import HeightField, jacksboro
from antgym.maps.generators import FAMILIES, RARELY, random_arrival, terrain_windows
from antgym.maps.generators.draws import unobstructed
from antgym.maps.motion import MOTIONS, Motion, move_table
from antgym.maps.moves import legal_moves
from antgym.maps.world import GridWorld, Scenario

SEEDS = st.integers(0, 2**32 - 1)
FLAT = ("rooms", "mazes", "clutter", "warehouse")
LAYERED = tuple(family for family in FAMILIES if family not in FLAT)


def drawn(seed, size=15, family="mountains"):
    return FAMILIES[family](np.random.default_rng(seed), size)


def rolling_hills(rows, columns):
    i, j = np.mgrid[0:rows, 0:columns]
    return HeightField(np.sin(i / 9.0) + np.cos(j / 7.0), (10.0, 14.0), "data/hills.asc")


@settings(max_examples=60, deadline=None)
@given(seed=SEEDS, size=st.integers(8, 24), family=st.sampled_from(LAYERED))
def test_layered_families_lead_from_the_first_to_the_last_layer_of_a_cube(seed, size, family):
    scenario = drawn(seed, size, family)
    assert (scenario.world.shape, scenario.world.cell) == ((size,) * 3, (15.0,) * 3)
    assert (scenario.motion, scenario.name) == (Motion("layered"), family)
    assert (scenario.start[0], scenario.goal[0]) == (0, size - 1)
    assert scenario.optimum >= scenario.straight_line
    assert random_arrival(scenario) >= RARELY


@settings(max_examples=60, deadline=None)
@given(seed=SEEDS, size=st.integers(8, 61), family=st.sampled_from(FLAT))
def test_flat_families_lead_across_half_the_world_at_least(seed, size, family):
    scenario = drawn(seed, size, family)
    assert (scenario.world.shape, scenario.world.cell) == ((size, size, 1), (0.1,) * 3)
    assert (scenario.motion, scenario.name) == (Motion("grid8"), family)
    assert math.dist(scenario.start, scenario.goal) >= size / 2
    assert scenario.optimum >= scenario.straight_line * (1 - 1e-12)


@settings(max_examples=25, deadline=None)
@given(seed=SEEDS, size=st.integers(8, 19))
def test_mountains_stand_on_solid_ground_and_so_do_start_and_goal(seed, size):
    scenario = drawn(seed, size)
    free = scenario.world.free.astype(bool)
    assert (free[:, :, 1:] >= free[:, :, :-1]).all()
    for x, y, z in (scenario.start, scenario.goal):
        assert z == 0 or not free[x, y, z - 1]


@settings(max_examples=30, deadline=None)
@given(seed=SEEDS, family=st.sampled_from(sorted(FAMILIES)))
def test_the_generator_state_alone_decides_the_scenario(seed, family):
    assert drawn(seed, family=family).digest == drawn(seed, family=family).digest
    assert drawn(seed, family=family).digest != drawn(seed + 1, family=family).digest


@pytest.mark.parametrize("family", FAMILIES)
def test_families_reach_the_largest_size(family):
    assert drawn(5, 61, family).optimum > 0


def test_mountains_range_from_open_to_ceiling_high():
    scenarios = [drawn(seed) for seed in range(40)]
    full = np.array([np.mean(~s.world.free.any(axis=2)) for s in scenarios])
    detours = np.array([s.optimum / s.straight_line for s in scenarios])
    arrivals = np.array([random_arrival(s) for s in scenarios])
    assert (full == 0).sum() >= 4
    assert (full > 0.1).sum() >= 4
    assert 8 <= (detours > 1.2).sum() <= 36
    assert 8 <= (arrivals < 0.3).sum() <= 36


@pytest.mark.parametrize("family", FAMILIES)
def test_families_need_room(family):
    with pytest.raises(MapError, match=f"{family} has at least 8 cells a side, got size=7"):
        drawn(0, 7, family)


def arrival_by_recursion(scenario, cell):
    if cell == scenario.goal:
        return 1.0
    legal = legal_moves(scenario, np.array([cell]))[0]
    steps = move_table(scenario.motion).steps[legal].tolist()
    onward = 0.0
    for step in steps:  # added one by one, which sum() does not do in every Python
        onward += arrival_by_recursion(scenario, tuple(np.add(cell, step).tolist()))
    return onward / max(len(steps), 1)


@settings(max_examples=20, deadline=None)
@given(seed=SEEDS, blocked=st.floats(0.2, 0.7), check_segments=st.booleans())
def test_random_arrival_is_to_the_bit_the_sum_over_all_walks(seed, blocked, check_segments):
    scenario = random_scenario(seed, size=5, blocked=blocked, check_segments=check_segments)
    assert random_arrival(scenario) == arrival_by_recursion(scenario, scenario.start)


@given(seed=SEEDS)
@settings(deadline=None)
def test_random_ants_arrive_exactly_where_a_path_exists(seed):
    scenario = random_scenario(seed, size=6, blocked=0.55)
    try:
        solvable = scenario.optimum > 0
    except ScenarioError:
        solvable = False
    assert (random_arrival(scenario) > 0) == solvable


@pytest.mark.parametrize("motion", [motion for motion in MOTIONS if not motion.layered])
def test_where_ants_may_come_back_nothing_is_said_of_how_many_arrive(motion):
    with pytest.raises(ScenarioError, match=f"the {motion.name} motion has no layers"):
        random_arrival(random_grid(0, motion))


def test_random_ants_cannot_get_lost_in_an_open_world():
    assert random_arrival(Scenario(GridWorld(np.ones((9, 7, 5))), (2, 0, 0), (8, 6, 1))) == pytest.approx(1.0)


@settings(max_examples=60, deadline=None)
@given(seed=SEEDS, motion=st.sampled_from(MOTIONS))
def test_where_nothing_is_blocked_no_path_leaves_the_box_between_its_ends(seed, motion):
    rng = np.random.default_rng(seed)
    shape = (9, 8, 1 if motion.name in ("grid4", "grid8") else 7)
    start, goal = (tuple(rng.integers(0, n) for n in shape) for _ in range(2))
    if motion.layered or start == goal:
        start, goal = (0, *start[1:]), (8, *goal[1:])
    empty = Scenario(GridWorld(np.ones(shape), (3.0, 2.0, 1.0)), start, goal, motion)
    assert unobstructed(empty) == pytest.approx(empty.optimum, rel=1e-14)


def test_windows_do_not_overlap_and_are_stretched_from_floor_to_ceiling():
    field = rolling_hills(110, 64)
    scenarios = terrain_windows(field, size=8)
    assert [s.name for s in scenarios] == [f"hills-r{i}c{j}-0" for i in range(3) for j in range(2)]
    assert all(s.world.cell == pytest.approx((48.0, 48.0, 48.0)) for s in scenarios)
    last = field.heights[64:96, 32:64].reshape(8, 4, 8, 4).max(axis=(1, 3))
    scaled = (last - field.heights[64:96, 32:64].min()) / np.ptp(field.heights[64:96, 32:64]) * 8
    topmost = 8 - scenarios[-1].world.free.sum(axis=2)
    assert (topmost == np.ceil(scaled - 1e-9)).all()
    assert topmost.max() == 8


def test_windows_turn_counter_clockwise_and_take_turns():
    i, j = np.mgrid[0:32, 0:64]
    two_peaks = np.exp(-((i - 20) ** 2 + (j % 32 - 9) ** 2) / 30)
    scenarios = terrain_windows(HeightField(two_peaks, (1, 1), "peaks"), size=8, rotations=(0, 90))
    assert [s.name for s in scenarios] == [f"peaks-r0c{j}-{turn}" for turn in (0, 90) for j in (0, 1)]
    assert (scenarios[2].world.free == np.rot90(scenarios[0].world.free)).all()


def test_windows_start_and_end_in_the_lowest_connected_columns_of_the_middle_third():
    scenario = terrain_windows(rolling_hills(32, 32), size=8)[0]
    heights = 8 - scenario.world.free.sum(axis=2, dtype=int)
    for x, y, z in (scenario.start, scenario.goal):
        assert 2 <= y <= 5
        assert z == heights[x, y] == heights[x, 2:6].min()


def test_flat_and_incomplete_windows_are_skipped():
    heights = np.array(rolling_hills(32, 96).heights)
    heights[:, :32] = 4.0
    heights[5, 70] = np.nan
    assert [s.name for s in terrain_windows(HeightField(heights, (1, 1), "x"), size=8)] == ["x-r0c1-0"]


def test_fewer_windows_come_first_things_first():
    field = rolling_hills(64, 64)
    few, all_of_them = (terrain_windows(field, 8, (0, 180), count) for count in (3, None))
    assert [s.digest for s in few] == [s.digest for s in all_of_them[:3]]
    assert len({s.name.split("-")[1] for s in few}) == 3


@pytest.mark.parametrize(
    ("size", "rotations", "message"),
    [
        (21, (0,), r"\(64, 64\) samples hold no window of 21.*2 to 16"),
        (1, (0,), "2 to 16"),
        (8, (45,), "multiples of 90"),
    ],
)
def test_windows_that_cannot_be_cut_are_refused(size, rotations, message):
    with pytest.raises(MapError, match=message):
        terrain_windows(rolling_hills(64, 64), size, rotations)


@pytest.mark.skipif(importlib.util.find_spec("matplotlib") is None, reason="matplotlib is absent")
def test_the_real_terrain_gives_sixteen_windows_each_way():
    names = [s.name for s in terrain_windows(jacksboro(), rotations=(0, 90, 180, 270))]
    assert names[:16] == [f"jacksboro-r{i}c{j}-0" for i in range(4) for j in range(4)]
    assert len(names) == 64
