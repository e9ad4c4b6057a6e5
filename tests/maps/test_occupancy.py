"""Occupancy: the right shape for every world, exact shares, and marks where start and goal are."""

import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scenarios import scenarios

from antgym.maps.motion import Motion
from antgym.maps.occupancy import CHANNELS, FLAT, SOLID, Chart, occupancy, picture_shape
from antgym.maps.world import GridWorld, Scenario


def empty(shape, start, goal):
    return Scenario(GridWorld(np.ones(shape)), start, goal, Motion("grid26"))


def shares(free, blocks):
    """Blocked shares by cutting every cell so small that it fits into the blocks, one axis after the other."""
    fine = ~np.asarray(free, bool)
    for axis, count in enumerate(blocks):
        fine = fine.repeat(count, axis)
    fine = fine.reshape([n for count, cells in zip(blocks, free.shape, strict=True) for n in (count, cells)])
    return fine.mean(axis=(1, 3, 5))


@settings(deadline=None, max_examples=40)
@given(scenario=scenarios(), flat=st.sampled_from([None, True, False]))
def test_a_picture_is_of_fixed_shape_and_between_0_and_1(scenario, flat):
    picture = occupancy(scenario, flat)
    shown_flat = scenario.world.shape[2] == 1 if flat is None else flat
    assert picture.shape == picture_shape(shown_flat) == (3, *((32, 32) if shown_flat else (16, 16, 16)))
    assert picture.dtype == np.float32
    assert picture.min() >= 0
    assert picture.max() <= 1


@pytest.mark.parametrize("shape", [(16, 16, 16), (17, 21, 40), (61, 16, 33)])
def test_blocks_hold_their_blocked_share_by_exact_area(shape):
    free = np.random.default_rng(0).random(shape) < 0.6
    free[0, 0, 0] = free[-1, -1, -1] = True
    scenario = Scenario(GridWorld(free), (0, 0, 0), tuple(n - 1 for n in shape), Motion("grid26"))
    assert occupancy(scenario)[0] == pytest.approx(shares(free, SOLID), abs=1e-6)
    assert occupancy(scenario)[0].mean() == pytest.approx(1 - free.mean(), abs=1e-6)
    if min(shape[:2]) >= FLAT[0]:
        assert occupancy(scenario, flat=True)[0] == pytest.approx(shares(free, FLAT)[:, :, 0], abs=1e-6)


def test_a_small_world_is_magnified_without_blur():
    free = np.random.default_rng(1).random((4, 8, 16)) < 0.5
    free[0, 0, 0] = free[3, 7, 15] = True
    picture = occupancy(Scenario(GridWorld(free), (0, 0, 0), (3, 7, 15), Motion("grid26")))
    assert (picture[0] == (~free).repeat(4, 0).repeat(2, 1)).all()
    assert np.argwhere(picture[1]).tolist() == [[x, y, 0] for x in range(4) for y in range(2)]


def test_a_world_of_odd_size_is_magnified_by_the_nearest_cell():
    free = np.ones((5, 1))
    free[2] = 0
    blocked = occupancy(Scenario(GridWorld(free), (1, 0), (0, 0), Motion("grid4")))[0]
    assert set(np.unique(blocked)) == {0, 1}
    centres = (np.arange(32) + 0.5) / 32 * 5
    assert (blocked == (centres.astype(int) == 2)[:, None]).all()


def test_start_and_goal_are_marked_in_channels_of_their_own():
    picture = occupancy(empty((64, 64, 64), (0, 8, 63), (63, 4, 30)))
    assert CHANNELS == ("blocked", "start", "goal")
    assert np.argwhere(picture[1]).tolist() == [[0, 2, 15]]
    assert np.argwhere(picture[2]).tolist() == [[15, 1, 7]]
    assert picture[1:].max() == 1


def test_a_flat_world_in_3d_is_its_level_at_every_height():
    free = np.random.default_rng(2).random((20, 30)) < 0.7
    free[0, 0] = free[19, 29] = True
    picture = occupancy(Scenario(GridWorld(free), (0, 0), (19, 29), Motion("grid8")), flat=False)
    assert (picture == picture[..., :1]).all()
    assert picture[0, ..., 0] == pytest.approx(shares(free[..., None], (16, 16, 1))[..., 0], abs=1e-6)
    assert np.argwhere(picture[2]).tolist() == [[15, 15, z] for z in range(16)]


def test_a_solid_world_in_2d_is_seen_from_above_and_marks_tell_heights():
    free = np.ones((32, 32, 10))
    free[4, 7, :3] = 0
    scenario = Scenario(GridWorld(free), (0, 0, 0), (31, 31, 4), Motion("grid26"))
    blocked, start, goal = occupancy(scenario, flat=True)
    assert blocked[4, 7] == pytest.approx(0.3)
    assert blocked.sum() == pytest.approx(0.3)
    assert (start[0, 0], goal[31, 31]) == pytest.approx((0.1, 0.5))
    assert np.count_nonzero(start) == np.count_nonzero(goal) == 1


def test_a_picture_may_be_drawn_on():
    scenario = empty((5, 5, 5), (0, 0, 0), (4, 4, 4))
    occupancy(scenario)[:] = 1
    assert not occupancy(scenario)[0].any()


def test_a_chart_draws_each_picture_once_and_read_only():
    chart = empty((5, 5, 1), (0, 0, 0), (4, 4, 0)).chart
    assert chart() is chart(True)
    assert chart(False) is chart(False)
    assert chart(False) is not chart(True)
    with pytest.raises(ValueError, match="read-only"):
        chart()[0] = 1


def test_a_chart_survives_pickling_read_only():
    chart = empty((5, 5, 5), (0, 0, 0), (4, 4, 4)).chart
    drawn, again = chart(), pickle.loads(pickle.dumps(chart))
    assert isinstance(again, Chart)
    assert (again() == drawn).all()
    assert not again().flags.writeable
