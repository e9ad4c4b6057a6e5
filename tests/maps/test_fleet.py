"""Fleets as questions: what is said of one is its robots' sum or mean, and their ends leave each other a way."""

import pickle
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from antgym import GridWorld, Motion, Scenario, load_suite
from antgym.errors import ParameterError, ScenarioError
from antgym.maps.fleet import Fleet, robots_of, side_by_side
from antgym.maps.generators import FAMILIES
from antgym.maps.generators.company import in_company
from antgym.maps.occupancy import occupancy
from antgym.maps.optimum import shortest_path


@pytest.fixture
def pair():
    """Two robots that cross on a floor of 9 by 9 cells."""
    world = GridWorld(np.ones((9, 9)), (0.5, 0.5, 0.5))
    ends = ((0, 4), (8, 4)), ((4, 0), (4, 8))
    return Fleet([Scenario(world, *each, Motion("grid8")) for each in ends], 0.4, (1.0, 2.0), "pair")


def test_lengths_add_up_and_descriptions_are_means(pair):
    assert (pair.optimum, pair.straight_line) == (8.0, 8.0)
    assert pair.descriptors == pytest.approx(np.mean([r.descriptors for r in pair.robots], axis=0))
    assert pair.paces.tolist() == [1, 2]
    assert replace(pair, speeds=3.0).paces.tolist() == [3, 3]
    assert robots_of(pair) == pair.robots
    assert robots_of(pair.robots[0]) == (pair.robots[0],)


def test_the_map_shows_the_ends_of_all_robots(pair):
    blocked, starts, goals = occupancy(pair)
    one, other = (occupancy(robot) for robot in pair.robots)
    assert (blocked == one[0]).all()
    assert (starts == np.maximum(one[1], other[1])).all()
    assert (goals == np.maximum(one[2], other[2])).all()


def test_a_digest_is_of_all_that_defines_a_fleet_but_its_name(pair):
    others = (
        replace(pair, apart=0.3),
        replace(pair, speeds=1.0),
        replace(pair, robots=pair.robots[::-1]),
        pair.with_motion(Motion("grid4")),
    )
    assert replace(pair, name="other").digest == pair.digest == pickle.loads(pickle.dumps(pair)).digest
    assert len({pair.digest, *(other.digest for other in others)}) == 5


def test_paths_side_by_side_are_apart_by_a_row_of_nan(pair):
    path = shortest_path(pair)
    assert np.flatnonzero(np.isnan(path).all(axis=1)).tolist() == [9]
    assert path[[0, 8, 10, 18], :2].tolist() == [[0, 4], [8, 4], [4, 0], [4, 8]]
    assert side_by_side([np.zeros((2, 2))]).shape == (2, 2)


BAD = {
    "none": (lambda p: replace(p, robots=()), ParameterError, "at least one robot"),
    "distance": (lambda p: replace(p, apart=float("nan")), ParameterError, "apart = nan"),
    "speeds": (lambda p: replace(p, speeds=(1.0, 1.0, 1.0)), ParameterError, "3 speeds for 2 robots"),
    "standing": (lambda p: replace(p, speeds=(1.0, 0.0)), ParameterError, "must be numbers above 0"),
    "motions": (
        lambda p: replace(p, robots=(p.robots[0], p.robots[1].with_motion(Motion("grid4")))),
        ScenarioError,
        "robot 1 moves in another world",
    ),
    "starts": (
        lambda p: replace(p, robots=(p.robots[0], Scenario(p.world, (0, 4), (4, 8), p.motion))),
        ScenarioError,
        r"robots 0 and 1 have a start at \(0, 4, 0\) and \(0, 4, 0\), nearer than 0.4",
    ),
    "discs": (
        lambda p: Fleet([load_suite("bee-v0", "test")[0].scenario], 0.4),
        ScenarioError,
        "share a grid",
    ),
}


@pytest.mark.parametrize(("make", "kind", "words"), BAD.values(), ids=BAD)
def test_what_is_no_fleet_is_said(pair, make, kind, words):
    with pytest.raises(kind, match=words):
        make(pair)


@settings(deadline=None, max_examples=15)
@given(st.integers(0, 10**6), st.sampled_from(["rooms", "clutter", "warehouse"]), st.integers(2, 5))
def test_robots_that_go_one_after_the_other_always_arrive(seed, family, robots):
    """Each has a path though all others stand at their starts, or at their goals, for good."""
    rng = np.random.default_rng(seed)
    scenario = FAMILIES[family](rng, 15)
    fleet = in_company(rng, scenario, robots, 5.0)
    assume(fleet is not None)
    assert fleet.robots[0] is scenario
    assert len({end for robot in fleet.robots for end in (robot.start, robot.goal)}) == 2 * robots
    for robot in fleet.robots:
        free = fleet.world.free.copy()
        for other in fleet.robots:
            if other is not robot:
                free[other.start] = free[other.goal] = 0
        path = shortest_path(replace(robot, world=GridWorld(free, fleet.world.cell)))
        for other in fleet.robots:
            if other is not robot:
                assert np.linalg.norm(path - np.array(other.start), axis=1).min() >= 1
        assert robot.optimum <= 5 * robot.straight_line


@pytest.mark.parametrize("family", ["clutter", "warehouse"])
def test_most_scenarios_have_room_for_company(family):
    """Else the property above would be of few fleets, or of none."""
    rngs = [np.random.default_rng(seed) for seed in range(10)]
    made = [in_company(rng, FAMILIES[family](rng, 15), 3, 5.0) is not None for rng in rngs]
    assert sum(made) > 5


def test_where_there_is_no_room_for_company_there_is_none():
    free = np.ones((9, 2))
    free[:, 1] = 0
    scenario = Scenario(GridWorld(free), (0, 0), (8, 0), Motion("grid8"))
    assert in_company(np.random.default_rng(0), scenario, 3, 5.0) is None
