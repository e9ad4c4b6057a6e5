"""Disc worlds: what they take, what they refuse and how it is said, and that a scenario among discs is a scenario."""

import pickle

import numpy as np
import pytest
import shapely
from discs import BOUNDS, among, disc_scenarios
from hypothesis import given
from hypothesis import strategies as st

from antgym.errors import MapError, ScenarioError
from antgym.maps.discs import DiscWorld, path_length
from antgym.maps.motion import STRAIGHT, Motion
from antgym.maps.world import GridWorld, Scenario


@given(scenario=disc_scenarios(), path=st.lists(st.tuples(*[st.floats(-2, 12)] * 2), min_size=2, max_size=6))
def test_clearances_are_what_shapely_measures(scenario, path):
    world, path = scenario.world, np.round(path, 9)  # of segments of 1e-181 shapely knows no distance
    lines = shapely.linestrings(np.stack([path[:-1], path[1:]], axis=1))
    centres = shapely.points(world.discs[:, :2])
    gaps = shapely.distance(lines[:, None], centres[None]) - world.discs[:, 2] - world.robot_radius
    assert world.clearances(path) == pytest.approx(gaps.min(axis=1, initial=np.inf), abs=1e-9)


def test_a_world_is_frozen_and_keeps_its_own_copy():
    discs = np.array([[5.0, 5.0, 1.0]])
    world = DiscWorld(discs, BOUNDS)
    discs[:] = 0
    assert world.discs.tolist() == [[5.0, 5.0, 1.0]]
    with pytest.raises(ValueError, match="read-only"):
        world.discs[0, 0] = 3
    with pytest.raises(AttributeError):
        world.robot_radius = 3


@pytest.mark.parametrize(
    ("discs", "bounds", "distances", "message"),
    [
        ([[1, 2]], BOUNDS, {}, r"an \(n, 3\) array"),
        ([[1, 2, 3], [1, 2]], BOUNDS, {}, "rows of one length"),
        ([[1, 2, "3"]], BOUNDS, {}, "must be numbers"),
        ([[1, 2, np.nan]], BOUNDS, {}, "must be finite, got nan"),
        ([[1, 2, 0]], BOUNDS, {}, "disc 0: .* radius above 0"),
        ([[1, 1, 1], [1e12, 2, 1]], BOUNDS, {}, "disc 1: .* beyond 1e"),
        ([], (0, 1, 0), {}, "four numbers"),
        ([], (0, 1, 5, 5), {}, "y_min < y_max"),
        ([], (0, np.inf, 0, 5), {}, "must be finite"),
        ([], BOUNDS, {"robot_radius": -1}, "robot_radius = -1"),
        ([], BOUNDS, {"safe_distance": [1, 2]}, "safe_distance = .* one number"),
        ([], BOUNDS, {"robot_radius": None}, "robot_radius must be numbers"),
    ],
)
def test_a_bad_world_is_refused_with_value_and_place(discs, bounds, distances, message):
    with pytest.raises(MapError, match=message):
        DiscWorld(discs, bounds, **distances)


@pytest.mark.parametrize(
    ("start", "goal", "message"),
    [
        ((5, 5.5), (9, 9), r"start \(5, 5.5\) lies 0.7 inside disc 0 .* robot radius 0.2 included"),
        ((1, 1), (5, 6.1), "goal .* lies 0.1 inside disc 0"),
        ((1, 1), (11, 5), "goal .* lies outside the bounds"),
        ((1, 1), (1.0, 1.0), "the same point"),
        ((1, 1, 0), (9, 9), "two numbers"),
        ("ab", (9, 9), "two numbers"),
        ((1, 1), (np.nan, 9), "outside the bounds"),
        ((1, 1), 9, "two numbers"),
    ],
)
def test_a_bad_end_is_refused_with_value_and_place(start, goal, message):
    with pytest.raises(ScenarioError, match=message):
        Scenario(DiscWorld([[5, 5, 1]], BOUNDS, robot_radius=0.2), start, goal)


def test_among_discs_there_is_one_motion_and_on_a_grid_it_is_none():
    assert among().motion == STRAIGHT
    with pytest.raises(ScenarioError, match="leave the motion out"):
        among().with_motion(Motion("grid8"))
    with pytest.raises(ScenarioError, match="name a grid's motion"):
        Scenario(GridWorld(np.ones((5, 5))), (0, 0), (4, 4), STRAIGHT)


def test_what_only_cells_have_is_refused_in_one_line():
    with pytest.raises(ScenarioError, match="lies among discs and has no cells"):
        _ = among().mean_move


def test_the_digest_knows_everything_but_the_name():
    base = among((5, 5, 1))
    others = [
        among((5, 5, 1.1)),
        among((5, 5, 1), start=(0.5, 0.6)),
        among((5, 5, 1), bounds=(0, 10, 0, 11)),
        among((5, 5, 1), robot_radius=0.1),
        among((5, 5, 1), safe_distance=0.1),
    ]
    assert len({base.digest, *(other.digest for other in others)}) == 6
    assert Scenario(base.world, base.start, base.goal, name="other").digest == base.digest


def test_a_pickled_scenario_is_the_same_and_still_frozen():
    scenario = among((5, 5, 1), robot_radius=0.1)
    copy = pickle.loads(pickle.dumps(scenario))
    assert copy.digest == scenario.digest
    assert not copy.world.discs.flags.writeable


def test_a_path_is_as_long_as_its_segments():
    assert path_length([(0, 0), (3, 4), (3, 4), (3, 10)]) == 11.0
