"""The hive: paused and pickled, alone and with others, and what its bees never do."""

import pickle

import numpy as np
import pytest
from discs import among, disc_scenarios, scattered, shapely_clearance, solvable
from hives import BEE_PARAMETERS, SOUND, any_bee_rules
from hypothesis import given, settings
from hypothesis import strategies as st

from antgym.errors import ParameterError
from antgym.kernels.segments import cost
from antgym.maps.discs import DiscWorld, path_length
from antgym.maps.generators.discs import DISC_FAMILIES
from antgym.maps.world import Scenario
from antgym.planners.bee_rules import BEE_PAPERS
from antgym.planners.colony import advance_together
from antgym.planners.flights import Flights
from antgym.planners.hive import Hive
from antgym.planners.planning import plan, plan_many


def same(one, other):
    assert (one.length, one.moves) == (other.length, other.moves)
    assert one.path.tolist() == other.path.tolist()
    assert one.mean.tolist() == other.mean.tolist()
    assert one.best.tolist() == other.best.tolist()


@settings(max_examples=40, deadline=None)
@given(
    blocks=st.lists(st.integers(1, 9), min_size=1, max_size=6),
    seed=st.integers(0, 50),
    rules=any_bee_rules(),
    parameters=BEE_PARAMETERS,
)
def test_a_hive_paused_anywhere_is_the_plan_of_one_block(blocks, seed, rules, parameters):
    scenario, rules = scattered(seed), rules._replace(tabu=2)
    settings = {"rules": rules, "ants": 6, "iterations": sum(blocks), "seed": seed}
    hive = Hive(scenario, **settings)
    for block in blocks:
        hive.advance(parameters, block)
    same(hive.result(), plan(scenario, parameters, **settings))


def test_what_a_hive_says_of_itself_is_what_its_result_says():
    hive = Hive(scattered(1), ants=10, iterations=30)
    assert (hive.done, hive.left, hive.moves, hive.best) == (0, 30, 5, np.inf)
    with pytest.raises(ParameterError, match="has not flown yet"):
        _ = hive.parameters
    hive.advance((40, 0.7, 0.2, 1), 20)
    assert (hive.done, hive.left, hive.parameters.limit) == (20, 10, 40)
    assert (hive.best, hive.moves) == (hive.result().length, hive.result().moves)
    assert len(hive.result().best) == 20


def test_a_hive_may_not_fly_more_than_it_was_given():
    hive = Hive(scattered(1), iterations=5)
    hive.advance((40, 0.7, 0.2, 1), 5)
    with pytest.raises(ParameterError, match="this hive has 0 left"):
        hive.advance((40, 0.7, 0.2, 1), 1)


@pytest.mark.parametrize("blocks", [0, 1, 3])
def test_a_pickled_hive_goes_on_like_the_original(blocks):
    hive = Hive(scattered(1), ants=8, iterations=20, seed=3)
    for i in range(blocks):
        hive.advance((10 + i, 0.7, 0.2, 1), 3)
    copy = pickle.loads(pickle.dumps(hive))
    for each in (hive, copy):
        each.advance((5, 0.5, 0.2, 3), 4)
    same(copy.result(), hive.result())


@pytest.mark.parametrize("threads", "12")
def test_hives_advanced_together_fly_as_each_alone(monkeypatch, threads):
    monkeypatch.setenv("ANTGYM_THREADS", threads)
    values = np.random.default_rng(0).uniform([2, 0.5, 0.1, 0], [60, 1.5, 0.4, 9], (3, 7, 4))
    alone, together = ([Hive(scattered(i, i), ants=8, iterations=12, seed=i) for i in range(7)] for _ in "ab")
    for block in values:
        advance_together(together, block, [4] * 7)
        for hive, parameters in zip(alone, block, strict=True):
            hive.advance(parameters, 4)
    for one, other in zip(together, alone, strict=True):
        same(one.result(), other.result())


@pytest.mark.parametrize("threads", "12")
def test_a_batch_is_its_plans_on_any_number_of_threads_and_in_any_order(monkeypatch, threads):
    monkeypatch.setenv("ANTGYM_THREADS", threads)
    count = 12
    scenarios = [scattered(i, i % 9) for i in range(count)]
    rules = [list(BEE_PAPERS)[i % len(BEE_PAPERS)] for i in range(count)]
    effort = [(4 + i, 5 + 2 * i) for i in range(count)]
    plans = plan_many(
        scenarios[::-1],
        [(9, 1, 0.5, 2)] * count,
        rules=rules[::-1],
        ants=[ants for ants, _ in effort[::-1]],
        iterations=[cycles for _, cycles in effort[::-1]],
        seeds=range(count)[::-1],
    )
    for i, (scenario, name, (ants, cycles)) in enumerate(zip(scenarios, rules, effort, strict=True)):
        setting = (9, 1, 0.5, 2)[: 4 if BEE_PAPERS[name].tabu else 3]
        alone = plan(scenario, setting, rules=name, ants=ants, iterations=cycles, seed=i)
        same(plans[count - 1 - i], alone)


def judge(scenarios, plans):
    """Hold every plan against the exact optimum, and against shapely."""
    solved = 0
    for scenario, found in zip(scenarios, plans, strict=True):
        assert found.path[0].tolist() == list(scenario.start)
        assert found.path[-1].tolist() == list(scenario.goal)
        clear = shapely_clearance(scenario, found.path)
        if found.solved:
            assert clear > -1e-9
            assert found.length == pytest.approx(path_length(found.path), rel=1e-12)
            assert found.length >= scenario.optimum * (1 - 1e-9)
        else:
            assert clear < 1e-9
        solved += found.solved
    return solved


def worlds(count):
    families = list(DISC_FAMILIES.values())
    drawn = [families[i % 3](np.random.default_rng(i), 8 + i % 20) for i in range(count // 2)]
    small = (
        scattered(i, i % 12, robot_radius=0.1 * (i % 3), safe_distance=0.2 * (i % 2)) for i in range(9999)
    )
    solvable_ones = (scenario for scenario in small if solvable(scenario))
    return drawn + [next(solvable_ones) for _ in range(count - len(drawn))]


def test_no_path_is_shorter_than_the_optimum_or_touches_a_disc_it_calls_clear():
    scenarios = worlds(300)
    rules = [list(BEE_PAPERS)[i % len(BEE_PAPERS)] for i in range(len(scenarios))]
    settings = [(100, 1, 0.3, 1)] * len(scenarios)
    plans = plan_many(scenarios, settings, rules=rules, ants=20, iterations=100, seeds=range(len(scenarios)))
    assert judge(scenarios, plans) > 100


@pytest.mark.slow
def test_neither_in_a_thousand_worlds_at_full_effort():
    scenarios = worlds(1000)
    for name in ("wu2018", "abc_standard"):
        settings = [(100, 1, 0.3, 1)] * len(scenarios)
        plans = plan_many(
            scenarios, settings, rules=name, ants=40, iterations=500, seeds=range(len(scenarios))
        )
        assert judge(scenarios, plans) > 700


@settings(max_examples=40, deadline=None)
@given(scenario=disc_scenarios(), rules=any_bee_rules(), parameters=BEE_PARAMETERS, seed=st.integers(0, 99))
def test_sources_stay_in_bounds_and_effort_is_what_was_paid_for(scenario, rules, parameters, seed):
    hive = Hive(scenario, rules=rules._replace(tabu=3), ants=7, iterations=15, seed=seed)
    hive.advance(parameters, 15)
    x_min, x_max, y_min, y_max = scenario.world.bounds
    assert ((hive.sources >= (x_min, y_min)) & (hive.sources <= (x_max, y_max))).all()
    scouts = hive.moves - 3 - 7 * 15
    assert 0 <= scouts <= 15  # one a cycle at most, whatever the limit
    assert hive.result().arrived.max() <= 3


@settings(max_examples=25, deadline=None)
@given(scenario=disc_scenarios(), name=st.sampled_from(SOUND), seed=st.integers(0, 99))
def test_where_no_clearance_is_asked_for_the_best_never_gets_longer(scenario, name, seed):
    bare = DiscWorld(scenario.world.discs, scenario.world.bounds, robot_radius=scenario.world.robot_radius)
    scenario = Scenario(bare, scenario.start, scenario.goal)
    best = plan(
        scenario, (20, 1, 0.5, 1), rules=BEE_PAPERS[name]._replace(tabu=5), iterations=60, seed=seed
    ).best
    assert (best[1:] <= best[:-1]).all()


@pytest.mark.parametrize("name", SOUND)
def test_every_sound_rule_comes_near_the_optimum_of_an_easy_world(name):
    scenario = among((5, 5, 1.5))
    setting = BEE_PAPERS[name].space(40, scenario.world.width).default
    plans = plan_many([scenario] * 9, [setting] * 9, rules=name, ants=40, iterations=1000, seeds=range(9))
    assert np.median(plans.lengths) < 1.03 * scenario.optimum


def test_with_nothing_in_the_way_bees_fly_straight():
    found = plan(among(), (480, 1, 1), rules="abc_standard", ants=40, iterations=3000)
    assert found.length == pytest.approx(among().straight_line, rel=5e-3)


@pytest.mark.parametrize("name", SOUND)
@pytest.mark.parametrize("scale", [0.25, 1024.0])
def test_a_world_in_other_units_is_flown_through_alike(name, scale):
    """Powers of two scale without rounding, so the paths agree to the bit."""
    scenario = scattered(4, 6, safe_distance=0.3, robot_radius=0.1)
    world, (limit, *xis, radius) = scenario.world, (20, 0.8, 0.3, 4)
    scaled = Scenario(
        DiscWorld(
            world.discs * scale,
            np.array(world.bounds) * scale,
            robot_radius=world.robot_radius * scale,
            safe_distance=world.safe_distance * scale,
        ),
        np.array(scenario.start) * scale,
        np.array(scenario.goal) * scale,
    )
    rules = BEE_PAPERS[name]._replace(tabu=4)
    one = plan(scenario, (limit, *xis, radius), rules=rules, ants=10, iterations=60)
    other = plan(scaled, (limit, *xis, radius * scale), rules=rules, ants=10, iterations=60)
    assert (other.path == one.path * scale).all()
    assert other.length == one.length * scale


def test_rules_without_their_feature_are_the_rule_without_it():
    scenario, effort = scattered(2), {"ants": 10, "iterations": 60, "seed": 1}
    standard = plan(scenario, (9, 1, 1), rules="abc_standard", **effort)
    same(plan(scenario, (9, 1, 1), rules=BEE_PAPERS["abc_gbest"]._replace(pull=0.0), **effort), standard)
    same(
        plan(scenario, (9, 1, 1), rules=BEE_PAPERS["wu2018-basic"]._replace(elite=False), **effort), standard
    )
    tabu = BEE_PAPERS["wu2018"]._replace(elite=False)
    same(plan(scenario, (9, 1, 1, 0.0), rules=tabu, **effort), standard)
    assert plan(scenario, (9, 1, 1, 40.0), rules=tabu, **effort).path.tolist() != standard.path.tolist()


def test_a_tabu_radius_that_covers_the_world_ends_all_the_same():
    found = plan(scattered(2), (1, 1, 1, 1e9), rules="wu2018", ants=10, iterations=50)
    assert found.moves == 5 + 10 * 50 + 50


@settings(max_examples=60, deadline=None)
@given(length=st.floats(1, 1e3), gap=st.floats(-1, 3), goal=st.tuples(*[st.floats(1, 9)] * 2))
def test_the_printed_cost_solves_the_equation_that_it_stands_in(length, gap, goal):
    """(4) with (6), which names fit itself; at contact the limit of a clearance of 0."""
    scenario = among(safe_distance=2.0, goal=goal)
    run = Flights.of([scenario], [(9, 1, 1, 1)], "wu2018-paper", 4, 1, [0]).runs[0]
    fit, aim = cost(run, length, gap, 0.0), np.arctan2(goal[1] - 0.5, goal[0] - 0.5)
    p = 1.0 if gap > 2.0 else (2.0 + 1.0) / (max(gap, 0.0) * fit + 1.0)
    assert fit == pytest.approx(0.5 * length + 0.5 * p * aim, rel=1e-9)


@settings(max_examples=60, deadline=None)
@given(length=st.floats(1, 20), gap=st.floats(-1, 3))
def test_where_the_printed_equation_has_no_root_the_cost_is_still_a_number(length, gap):
    """An aim below 0, a goal to the lower left, rewards collisions; the print says so."""
    scenario = among(safe_distance=2.0, start=(9, 9), goal=(1, 1))
    run = Flights.of([scenario], [(9, 1, 1, 1)], "wu2018-paper", 4, 1, [0]).runs[0]
    assert abs(cost(run, length, gap, 0.0)) < 100


def test_as_printed_bees_hardly_mind_collisions():
    scenarios = [DISC_FAMILIES["wu2018"](np.random.default_rng(i), 20) for i in range(20)]
    solved = {}
    for name in ("wu2018", "wu2018-paper", "wu2018-basic", "wu2018-basic-paper"):
        setting = (40, 0.7, 0.2, 1) if BEE_PAPERS[name].tabu else (40, 1, 1)
        effort = {"ants": 40, "iterations": 300, "seeds": range(20)}
        lengths = plan_many(scenarios, [setting] * 20, rules=name, **effort).lengths
        solved[name] = int(np.isfinite(lengths).sum())
    assert min(solved["wu2018"], solved["wu2018-basic"]) >= 19
    assert max(solved["wu2018-paper"], solved["wu2018-basic-paper"]) <= 12


def test_where_every_way_is_closed_no_bee_arrives():
    found = plan(
        among(*[(x, 10 - x, 1.0) for x in range(11)]), (40, 1, 1), rules="abc_standard", iterations=200
    )
    assert (found.solved, found.status, found.length) == (False, "no bee arrived", np.inf)
    assert (found.best == np.inf).all()
    assert (found.mean == np.inf).all()
    assert found.path.shape == (14, 2)  # the one that touches least


def test_two_hundred_discs_and_none_are_both_flown_through():
    for count in (0, 200):
        scenario = DISC_FAMILIES["scatter"](np.random.default_rng(1), count)
        found = plan(scenario, (480, 1, 1), rules="abc_gbest", ants=40, iterations=600)
        assert found.solved
        assert found.length >= scenario.optimum * (1 - 1e-9)
