"""Rules and parameters of bees: published defaults, ranges, and what is refused."""

import numpy as np
import pytest
from conftest import random_scenario
from discs import among

import antgym
from antgym.errors import ParameterError
from antgym.planners.bee_rules import BEE_PAPERS, BeeRules, find_bee_rules
from antgym.planners.parameters import BEE_LIMITS, BeeRanges
from antgym.planners.planning import plan, plan_many
from antgym.planners.rules import PAPERS


def space_of(name, bees=40, width=40.0):
    return BEE_PAPERS[name].space(bees, width)


@pytest.mark.parametrize("name", BEE_PAPERS)
def test_the_middle_of_a_space_is_what_the_paper_publishes(name):
    """wu2018: limit 40 for 20 sources of 12 way-points, ξ from 0.7 to 0.2, radius 1; Karaboga: sources × dimensions.

    With a third of the way-points the limit is a third, and the radius smaller by its root.
    """
    space = space_of(name)
    middle = space.decode(np.full((1, len(space)), 0.5))[0]
    published = {"wu2018": (40, 0.7, 0.2, 1), "wu2018-basic": (40, 1, 1), "abc": (480, 1, 1)}
    few = name.endswith("-4")
    key = name.removesuffix("-paper").removesuffix("-4") if name.startswith("wu") else "abc"
    scaled = np.array(published[key]) / np.array([3, 1, 1, np.sqrt(3)])[: len(middle)] ** few
    assert middle == pytest.approx(scaled, rel=1e-12)
    assert space.names == tuple(BEE_LIMITS)[: len(middle)]


def test_limits_follow_sources_and_dimensions_and_the_radius_the_world():
    assert space_of("abc_standard", bees=20).default[0] == 240
    assert space_of("wu2018", width=80.0).default[3] == pytest.approx(2.0)
    one = BeeRanges().space(41, 3, 10.0)
    assert one is BeeRanges().space(40, 3, 10.0)
    assert "tries in vain" in one.to_markdown()


def test_the_fewest_bees_and_way_points_have_limits_of_one_and_more():
    (low, default, high), *_ = [(p.low, p.default, p.high) for p in BeeRanges().space(4, 1, 10.0).parameters]
    assert 1 <= low < default < high


def test_the_ends_of_every_space_can_be_flown():
    scenario = among((5, 5, 1))
    for name in BEE_PAPERS:
        space = space_of(name, bees=6, width=scenario.world.width)
        for unit in space.decode(np.array([[0.0] * len(space), [1.0] * len(space)])):
            assert plan(scenario, unit, rules=name, ants=6, iterations=20).moves > 120


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"points": 0}, r"points = 0: must be a whole number in \[1, 1000\]"),
        ({"points": 2.5}, "points = 2.5: must be a whole number"),
        ({"tabu": -1}, "tabu = -1"),
        ({"redraws": 10**6}, "redraws = 1000000"),
        ({"pull": np.nan}, "pull = nan: must be a number"),
        ({"hit": -1.0}, "hit = -1.0"),
        ({"weight": 0.0}, r"weight = 0.0: must lie in \(0, 1\]"),
        ({"scout": "newer"}, "unknown scout 'newer'; did you mean 'new'"),
    ],
)
def test_rules_that_cannot_be_flown_are_refused(changes, message):
    with pytest.raises(ParameterError, match=message):
        find_bee_rules(BeeRules(**changes))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"parameters": (0.5, 1, 1, 1)}, r"limit = 0.5 is outside \[1, 1e\+12\]"),
        ({"parameters": (40, np.nan, 1, 1)}, "xi_max = nan is not a number"),
        ({"parameters": (40, 1, -1, 1)}, "xi_min = -1"),
        ({"parameters": (40, 1, 1, np.inf)}, "tabu_radius = inf"),
        ({"parameters": (40, 1, 1)}, r"parameters are \('limit', .* got shape \(1, 3\)"),
        ({"ants": 3}, "ants = 3: a hive has 4 bees at least"),
        ({"ants": 4.5}, "ants = 4.5: whole numbers"),
        ({"iterations": 0}, "iterations = 0"),
        ({"seed": -1}, "seed = -1"),
        ({"rules": "wu2019"}, "unknown rules 'wu2019'; did you mean 'wu2018'"),
        ({"rules": "liu2020"}, "rules 'liu2020' walk a grid, and 'unnamed' lies among discs; .*wu2018"),
        ({"rules": PAPERS["liu2020"]}, "rules of ants walk a grid"),
    ],
)
def test_bad_input_is_refused_in_one_line(arguments, message):
    asked = {"parameters": (40, 0.7, 0.2, 1), "rules": "wu2018", "ants": 8, **arguments}
    with pytest.raises(ParameterError, match=message):
        plan(among((5, 5, 1)), asked.pop("parameters"), **asked)


def test_bees_are_refused_on_a_grid_and_beside_ants():
    grid, discs = random_scenario(0), among((5, 5, 1))
    for rules, said in (("wu2018", "rules 'wu2018' fly among discs"), (BeeRules(), "rules of bees fly")):
        with pytest.raises(ParameterError, match=said):
            plan(grid, (40, 0.7, 0.2, 1), rules=rules)
    with pytest.raises(ParameterError, match="rules of ants and of bees in one call"):
        plan_many([grid, discs], [(1, 1, 1, 1)] * 2, rules=["liu2020", "wu2018"], seeds=[0, 1])


def test_the_public_plan_is_the_one_of_ants_and_of_bees():
    """The same call, the same kind of answer."""
    scenario = antgym.Scenario(antgym.DiscWorld([(5, 5, 1)], (0, 10, 0, 10)), (1, 1), (9, 9))
    found = antgym.plan(scenario, (40, 0.7, 0.2, 1.0), rules="wu2018", ants=40, iterations=800)
    assert found.status == "solved"
    assert scenario.optimum <= found.length < 1.1 * scenario.optimum
    assert found.path.shape == (14, 2)
    assert len(found.best) == 800
    closed = antgym.plan(scenario, (40, 0.7, 0.2, 1.0), rules="wu2018", ants=4, iterations=1)
    assert closed.status in ("solved", "no bee arrived")


def test_no_runs_at_all_are_fine():
    assert len(plan_many([], np.empty((0, 4)), rules="wu2018", seeds=[])) == 0
