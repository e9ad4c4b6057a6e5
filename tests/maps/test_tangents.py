"""The exact optimum among discs: by hand, against published values, and against another way to compute it."""

import math

import numpy as np
import pytest
from discs import among, disc_scenarios, polygon_length, scattered, solvable
from hypothesis import given, settings
from hypothesis import strategies as st

from antgym.errors import ScenarioError
from antgym.maps.discs import DiscWorld, path_length
from antgym.maps.optimum import shortest_path
from antgym.maps.scenes import read_discs
from antgym.maps.world import Scenario


def around(half, radius):
    """Length past one disc in the middle of a straight line twice ``half`` long."""
    return 2 * (math.sqrt(half**2 - radius**2) + radius * math.asin(radius / half))


def test_with_nothing_in_the_way_it_is_the_straight_line():
    assert among().optimum == pytest.approx(9 * math.sqrt(2), abs=1e-12)
    assert among((0, 9, 1), (9, 1, 2)).optimum == pytest.approx(9 * math.sqrt(2), abs=1e-12)


@pytest.mark.parametrize("robot_radius", [0.0, 0.5])
def test_past_one_disc_it_is_two_tangents_and_an_arc(robot_radius):
    scenario = among((5, 5, 1), robot_radius=robot_radius)
    half = scenario.straight_line / 2
    assert scenario.optimum == pytest.approx(around(half, 1 + robot_radius), abs=1e-9)


def test_a_wall_of_bounds_closes_the_shorter_side():
    """A disc that reaches over the lower bound can only be passed above, however near the lower side is."""
    ends = {"start": (1, 1), "goal": (9, 1)}
    below = among((5, 1.2, 1.1), bounds=(0, 10, -5, 10), **ends).optimum
    above = among((5, 1.2, 1.1), bounds=(0, 10, 0.5, 10), **ends).optimum
    assert below < above
    assert above == pytest.approx(among((5, 1.2, 1.1), (5, -3, 4), **ends).optimum, abs=1e-9)


def test_overlapping_discs_are_walked_around_together():
    ends = {"start": (0.5, 5), "goal": (9.5, 5)}
    two = among((5, 5.8, 1), (5, 4.2, 1), **ends).optimum
    assert two == pytest.approx(polygon_length(among((5, 5.8, 1), (5, 4.2, 1), **ends), 180), rel=1e-3)
    assert two > among((5, 5.8, 1), **ends).optimum


@pytest.mark.parametrize(("gap", "passes"), [(0.0, False), (-1e-6, False), (1e-6, True)])
def test_discs_that_touch_leave_no_gap(gap, passes):
    ends = {"start": (0.5, 5), "goal": (9.5, 5)}
    optimum = among((5, 6 + gap / 2, 1), (5, 4 - gap / 2, 1), **ends).optimum
    assert (optimum == pytest.approx(9.0, abs=1e-5)) == passes


def test_a_disc_within_another_changes_nothing():
    assert among((5, 5, 2), (5.2, 5, 1)).optimum == pytest.approx(among((5, 5, 2)).optimum, abs=1e-9)
    assert among((5, 5, 2), (5, 5, 2)).optimum == pytest.approx(among((5, 5, 2)).optimum, abs=1e-9)


def test_where_every_way_is_closed_the_error_says_so():
    wall = [(x, 10 - x, 1.0) for x in range(11)]
    with pytest.raises(ScenarioError, match="discs and bounds close every way; take out or shrink"):
        _ = among(*wall).optimum
    assert among(*wall, bounds=(-5, 15, -5, 15)).optimum > 0


def test_too_many_discs_are_refused():
    with pytest.raises(ScenarioError, match="1,001 discs are too many"):
        _ = among(*[(5, 5, 0.1)] * 1001).optimum


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10**6), count=st.integers(1, 6), robot=st.sampled_from([0.0, 0.2]))
def test_it_is_what_polygons_around_the_discs_give(seed, count, robot):
    """They are larger than the discs, so their path is never shorter, and hardly longer."""
    scenario = scattered(seed, count, largest=2.5, robot_radius=robot)
    around_them = polygon_length(scenario)
    if math.isfinite(around_them):
        assert scenario.optimum <= around_them + 1e-9
    if solvable(scenario):
        grown = DiscWorld(scenario.world.discs, scenario.world.bounds, robot_radius=robot + 0.01)
        looser = Scenario(grown, scenario.start, scenario.goal)
        if solvable(looser):
            assert around_them <= looser.optimum + 1e-9


@settings(max_examples=40, deadline=None)
@given(scenario=disc_scenarios(), turn=st.floats(0, 6.28), scale=st.sampled_from([1e-3, 1.0, 1e4]))
def test_mirrored_scaled_or_backwards_it_is_as_long(scenario, turn, scale):
    world = scenario.world
    discs = world.discs[:, [1, 0, 2]] * scale
    other = Scenario(
        DiscWorld(
            discs, np.array(world.bounds)[[2, 3, 0, 1]] * scale, robot_radius=world.robot_radius * scale
        ),
        np.array(scenario.goal)[::-1] * scale,
        np.array(scenario.start)[::-1] * scale,
    )
    assert other.optimum == pytest.approx(scenario.optimum * scale, rel=1e-8)


def test_a_small_world_far_from_the_origin_keeps_its_digits():
    """Coordinates are spaced 1e-10 apart there, a hundredth of what the world's extent forgives at the origin."""
    near = scattered(3, 6)
    world, shift = near.world, np.array([-1e6, 2e6])
    discs = np.column_stack([world.discs[:, :2] / 1000 + shift, world.discs[:, 2] / 1000])
    bounds = np.array(world.bounds) / 1000 + np.repeat(shift, 2)
    start, goal = (np.array(end) / 1000 + shift for end in (near.start, near.goal))
    assert Scenario(DiscWorld(discs, bounds), start, goal).optimum == pytest.approx(
        near.optimum / 1000, rel=1e-6
    )


@settings(max_examples=40, deadline=None)
@given(scenario=disc_scenarios())
def test_the_path_is_as_long_as_the_optimum_says_and_hardly_cuts_a_disc(scenario):
    path = shortest_path(scenario)
    assert tuple(path[0]) == pytest.approx(scenario.start)
    assert tuple(path[-1]) == pytest.approx(scenario.goal)
    assert path_length(path) == pytest.approx(scenario.optimum, rel=1e-4)
    deepest = (scenario.world.grown[:, 2] * (1 - math.cos(math.pi / 360))).max(initial=0.0)
    assert scenario.world.clearances(path).min() >= -deepest - 1e-7


KNOWN = {
    "barn_0": 10.004641823758558,
    "barn_100": 10.005121306704533,
    "barn_200": 10.0,
    "pythonrobotics_rrt": 16.886666504259388,
}
INFLATED = {"barn_0": 10.069628944834314, "barn_100": 10.080801362321456, "barn_200": 10.0007622725507}


@pytest.mark.parametrize("name", KNOWN)
def test_it_is_the_known_length_of_the_scenes(shared_data, name):
    assert read_discs(shared_data / "circles" / f"{name}.json").optimum == pytest.approx(
        KNOWN[name], abs=1e-6
    )


@pytest.mark.parametrize("name", INFLATED)
def test_it_is_the_known_length_for_a_robot_of_twenty_centimetres(shared_data, name):
    scenario = read_discs(shared_data / "circles" / f"{name}.json")
    world = DiscWorld(scenario.world.discs, scenario.world.bounds, robot_radius=0.2)
    inflated = Scenario(world, scenario.start, scenario.goal)
    assert inflated.optimum == pytest.approx(INFLATED[name], abs=1e-6)
