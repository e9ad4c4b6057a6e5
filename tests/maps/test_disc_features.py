"""Features and charts of disc worlds: bounded, blind to units and to the optimum, and right on worlds made by hand."""

import math
import pickle
import time

import numpy as np
import pytest
from discs import among, disc_scenarios, scattered
from hypothesis import given, settings

from antgym.maps.disc_chart import blocks_of
from antgym.maps.disc_features import DISC_FEATURES, describe_discs
from antgym.maps.discs import DiscWorld
from antgym.maps.features import FEATURES
from antgym.maps.occupancy import occupancy, picture_shape
from antgym.maps.world import Scenario

NAMES = [feature.name for feature in DISC_FEATURES]
LEVEL = {"start": (1.0, 5.0), "goal": (9.0, 5.0)}


def named(scenario):
    return dict(zip(NAMES, describe_discs(scenario).tolist(), strict=True))


@settings(deadline=None, max_examples=40)
@given(scenario=disc_scenarios())
def test_features_are_finite_and_within_their_bounds(scenario):
    values = scenario.descriptors
    assert (values.dtype, values.shape) == (np.float32, (len(DISC_FEATURES),))
    for value, feature in zip(values, DISC_FEATURES, strict=True):
        assert feature.low <= value <= feature.high, feature.name


@pytest.mark.parametrize("seed", range(10))
def test_features_need_no_optimum(seed, monkeypatch):
    monkeypatch.setattr(Scenario, "optimum", property(lambda _: pytest.fail("asked for the optimum")))
    describe_discs(scattered(seed))


@pytest.mark.parametrize("seed", range(10))
def test_features_do_not_depend_on_the_unit_of_length(seed):
    scenario = scattered(seed, robot_radius=0.25, safe_distance=0.5)
    world, ends = scenario.world, (scenario.start, scenario.goal)
    large = DiscWorld(world.discs * 4, np.multiply(world.bounds, 4), robot_radius=1.0, safe_distance=2.0)
    scaled = Scenario(large, *(tuple(4 * value for value in end) for end in ends))
    assert describe_discs(scaled) == pytest.approx(describe_discs(scenario), abs=1e-6)


def test_an_open_world_holds_nothing():
    values = named(among())
    none = (
        "discs",
        "radius",
        "blocked",
        "blocked_on_line",
        "walls_on_line",
        "largest_wall",
        "aside",
        "tight",
    )
    assert [values[name] for name in none] == [0.0] * len(none)
    all_of_it = ("sight_from_start", "sight_from_goal", "narrowest_layer", "clearance", "clearance_on_line")
    assert [values[name] for name in all_of_it] == [1.0] * len(all_of_it)


def test_what_stands_on_the_line_is_measured_exactly():
    values = named(among((3.0, 5.0, 1.0), (4.0, 5.0, 1.0), (7.0, 5.0, 0.5), (5.0, 9.0, 0.9), **LEVEL))
    assert values["blocked_on_line"] == pytest.approx(4 / 8)
    assert values["walls_on_line"] == pytest.approx(2 / 10), "two discs that overlap are one wall"
    assert values["sight_from_start"] == pytest.approx(1 / 8)
    assert values["sight_from_goal"] == pytest.approx(1.5 / 8)
    assert values["obstacles"] == pytest.approx(math.log10(1 + 3) / 2)


def test_a_wall_tells_how_far_aside_its_gap_is():
    wall = [(5.0, y, 0.3) for y in np.arange(0.0, 8.1, 0.4)]
    values = named(among(*wall, **LEVEL))
    assert values["aside"] == pytest.approx((8.3 - 5) / 8, abs=0.03)
    assert values["narrowest_way"] == pytest.approx(1.7 / 10, abs=0.03)
    assert values["largest_wall"] == pytest.approx(0.83, abs=0.03)
    other = named(among(*wall, *((7.0, 10 - y, 0.3) for _, y, _ in wall), **LEVEL))
    assert other["swing"] == pytest.approx(2 * values["swing"], abs=0.05), (
        "the second gap lies on the other side"
    )


def test_a_robot_grows_what_it_may_not_touch():
    thin, thick = (named(scattered(3, largest=0.5, robot_radius=radius)) for radius in (0.0, 0.3))
    assert thick["blocked"] > thin["blocked"]
    assert thick["radius"] == pytest.approx(thin["radius"] + 0.3)


def test_every_feature_has_a_name_of_its_own_and_shares_those_of_grids():
    assert len(set(NAMES)) == len(NAMES)
    assert len(set(NAMES) & {feature.name for feature in FEATURES}) > 10


def test_many_discs_take_milliseconds_and_bounded_memory():
    rng = np.random.default_rng(0)
    discs = np.column_stack([rng.uniform(1, 9, (2000, 2)), np.full(2000, 0.02)])
    scenario = among(*discs.tolist())
    begun = time.process_time()
    describe_discs(scenario)
    assert time.process_time() - begun < 2


@pytest.mark.parametrize("flat", [None, True, False])
def test_a_chart_shows_covered_shares_and_both_ends(flat):
    scenario = among((5.0, 5.0, 2.0))
    picture = occupancy(scenario, flat)
    assert (picture.dtype, picture.shape) == (np.float32, picture_shape(flat is not False))
    assert picture[0].mean() == pytest.approx(math.pi * 4 / 100, abs=0.01)
    assert 0 <= picture.min() <= picture.max() <= 1
    side = picture.shape[1]
    for channel, end in zip(picture[1:], (scenario.start, scenario.goal), strict=True):
        marked = {tuple(at[:2]) for at in np.argwhere(channel).tolist()}
        assert marked == {tuple(blocks_of(scenario.world, end, side, side).tolist())}


def test_a_chart_is_drawn_once_read_only_and_pickled():
    chart = scattered(1).chart
    assert chart() is chart(True)
    assert not chart().flags.writeable
    assert (pickle.loads(pickle.dumps(chart))() == chart()).all()


def test_an_end_on_the_border_lies_in_the_last_block():
    assert blocks_of(among().world, (10.0, 10.0), 32, 32).tolist() == [31, 31]
