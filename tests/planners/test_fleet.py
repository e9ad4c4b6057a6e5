"""Fleets: robots that never meet, by an independent checker; conflicts and schedules against slow twins."""

from dataclasses import replace
from itertools import combinations, pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.ndimage import label

from antgym import GridWorld, Motion, Scenario
from antgym.errors import ParameterError, ScenarioError
from antgym.maps.generators import FAMILIES
from antgym.maps.motion import move_table
from antgym.maps.moves import legal_moves
from antgym.maps.readers import read_map
from antgym.planners.fleet import plan_fleet
from antgym.planners.schedules import schedule
from antgym.planners.timed import TimedPath, conflicts, meeting, nearest_approach

SETTING = (1.0, 2.0, 0.9, 300.0)
HALF = np.sqrt(0.5) - 1e-6  # cells: two that turn after each other keep that far


def line(*points, speed=1.0):
    return TimedPath.even(np.array(points, dtype=float), speed)


@st.composite
def timed_paths(draw, most=5):
    """A path over whole points with waits, at speeds of its own."""
    rng = np.random.default_rng(draw(st.integers(0, 10**6)))
    points = rng.integers(0, 5, (draw(st.integers(1, most)), 2)).astype(float)
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    lasts = np.where(steps == 0, rng.integers(0, 3, len(steps)), steps / rng.choice([0.5, 1, 2], len(steps)))
    return TimedPath(points, np.concatenate([[0.0], np.cumsum(lasts)]))


def dense_distances(one, other, count=4001):
    times = np.linspace(0, max(one.arrival, other.arrival) + 1, count)
    return times, np.linalg.norm(one.at(times) - other.at(times), axis=1)


def check(plan, scenarios, apart, speeds):
    """What must hold of a fleet, looked at without anything that planned it."""
    assert plan.length >= sum(scenario.optimum for scenario in scenarios) - 1e-9
    for path, scenario, speed in zip(plan.paths, scenarios, speeds, strict=True):
        cells = np.round(path.points / scenario.world.cell - 0.5).astype(int)
        assert (tuple(cells[0]), tuple(cells[-1])) == (scenario.start, scenario.goal)
        for (here, there), (begin, end) in zip(pairwise(cells), pairwise(path.times), strict=True):
            if (here == there).all():
                assert end > begin
                continue
            move = (move_table(scenario.motion).steps == there - here).all(axis=1)
            assert (legal_moves(scenario, here[None])[0] & move).any()
            step = np.linalg.norm((there - here) * scenario.world.cell)
            assert end - begin == pytest.approx(step / speed)
    for one, other in combinations(plan.paths, 2):
        assert dense_distances(one, other)[1].min() >= apart - 1e-6


@settings(deadline=None)
@given(timed_paths(), timed_paths(), st.sampled_from([0.3, 0.7, 1.5]))
def test_conflicts_are_where_dense_times_find_them(one, other, apart):
    times, distances = dense_distances(one, other)
    found, slack = meeting(one, other, apart), 2 * 4 * (times[1] - times[0])
    assert nearest_approach(one, other) == pytest.approx(distances.min(), abs=slack)
    if found is None:
        assert distances.min() >= apart - 1e-9
    else:
        assert np.linalg.norm(one.at(found) - other.at(found)) <= apart + 1e-9
        assert (distances[times < found] >= apart - 1e-9).all()
        assert nearest_approach(one, other) < apart


CASES = {
    "vertex": (line((0, 1), (2, 1)), line((1, 0), (1, 2)), True),
    "swap": (line((0, 0), (1, 0)), line((1, 0), (0, 0)), True),
    "into one that stands": (line((0, 0), (3, 0)), line((3, 0)), True),
    "overtaken": (line((0, 0), (9, 0), speed=2), line((1, 0), (9, 0)), True),
    "one behind the other": (line((0, 0), (9, 0)), line((1, 0), (10, 0)), False),
    "a turn behind the other": (line((0, 0), (1, 0), (2, 0)), line((1, 0), (1, 1), (1, 2)), False),
    "before the other": (line((0, 1), (2, 1)), line((1, -3), (1, 3)), False),
}


@pytest.mark.parametrize(("one", "other", "meet"), CASES.values(), ids=CASES)
def test_what_counts_as_a_conflict(one, other, meet):
    assert bool(conflicts([one, other], HALF)) == bool(conflicts([other, one], HALF)) == meet


def test_conflicts_come_by_time_with_their_place():
    found = conflicts([line((0, 0), (9, 0)), line((8, 0)), line((4, 0))], 0.5)
    assert [(c.first, c.second) for c in found] == [(0, 2), (0, 1)]
    assert found[0].time == pytest.approx(3.5)
    assert found[0].place == pytest.approx((3.5, 0))


def earliest_in_ticks(points, others, apart, tick=0.25, most=120):
    """The earliest arrival at whole ticks, by breadth first over point and tick; looks at dense times only."""
    steps = [round(float(np.linalg.norm(b - a)) / tick) for a, b in pairwise(points)]

    def clear(a, b, tick_of, count):
        share = np.linspace(0, 1, 8 * count + 1)[:, None]
        times = (tick_of + share[:, 0] * count) * tick
        return all(
            np.linalg.norm(a + share * (b - a) - other.at(times), axis=1).min() >= apart for other in others
        )

    here = {(0, 0)} if clear(points[0], points[0], 0, 1) else set()
    seen = set(here)
    for now in range(most):
        for i, at in sorted(place for place in seen if place[1] == now):
            if i == len(points) - 1 and clear(points[i], points[i], now, most):
                return at * tick
            if clear(points[i], points[i], now, 1):
                seen.add((i, now + 1))
            if i < len(points) - 1 and clear(points[i], points[i + 1], now, steps[i]):
                seen.add((i + 1, now + steps[i]))
    return None


@settings(deadline=None, max_examples=60)
@given(st.integers(0, 10**6), st.integers(1, 3))
def test_a_schedule_meets_nobody_and_no_other_arrives_before(seed, count):
    rng = np.random.default_rng(seed)
    walk = [rng.integers(0, 4, 2)]
    while len(walk) < 6:
        walk.append(walk[-1] + rng.permutation([(0, 1), (1, 0), (0, -1), (-1, 0)])[0])
    points = np.array(walk, dtype=float)
    others = [
        line(
            *np.cumsum([rng.integers(0, 4, 2), *rng.integers(-1, 2, (6, 2))], axis=0),
            speed=rng.choice([1, 2]),
        )
        for _ in range(count)
    ]
    others = [o for o in others if (np.diff(o.times) > 0).all()]
    apart = 0.65
    found, ticks = schedule(points, 1.0, others, apart), earliest_in_ticks(points, others, apart)
    if found is None:
        assert ticks is None
        return
    assert (found.points[[0, -1]] == points[[0, -1]]).all()
    assert found.arrival >= TimedPath.even(points, 1.0).arrival - 1e-9
    for other in others:
        assert nearest_approach(found, other) >= apart - 1e-8
    if ticks is not None:
        assert found.arrival <= ticks + 1e-6


def test_a_robot_waits_until_the_way_is_free():
    """Another crosses at time 2, where this one would be at that time."""
    other = line((2, -2), (2, 2))
    found = schedule(np.array([(0.0, 0), (1, 0), (2, 0), (3, 0)]), 1.0, [other], 0.7)
    assert found.arrival == pytest.approx(3 + 0.7 * 2**0.5, abs=1e-6)
    assert found.length == 3
    assert nearest_approach(found, other) == pytest.approx(0.7)


def test_there_is_no_schedule_past_one_that_stands_on_the_way():
    assert schedule(np.array([(0.0, 0), (1, 0), (2, 0)]), 1.0, [line((1, 0))], 0.7) is None


def corridor(motion="grid4"):
    """Two robots that must change ends of a corridor with one niche."""
    free = np.array([list("........."), list("####.####")]) == "."
    world = GridWorld(free.T, (1.0, 1.0, 1.0))
    return [Scenario(world, (x, 0), (8 - x, 0), Motion(motion)) for x in (0, 8)]


def test_where_no_order_leads_past_the_status_says_so():
    """No robot's own path leads into the niche, and none can wait there: prioritised planning cannot do that."""
    plan = plan_fleet(corridor(), SETTING, apart=0.7, seed=1)
    assert not plan.solved
    assert plan.status.startswith("robot ")
    assert (plan.paths, plan.makespan, plan.length_gap) == ((), np.inf, np.inf)


def crossing(speeds=(1.0, 1.0)):
    world = GridWorld(np.ones((9, 9)), (1.0, 1.0, 1.0))
    return [Scenario(world, *ends, Motion("grid8")) for ends in (((0, 4), (8, 4)), ((4, 0), (4, 8)))], speeds


@pytest.mark.parametrize("speeds", [(1.0, 1.0), (0.5, 2.0), (2.0, 1.0)])
def test_two_that_cross_are_kept_apart_at_any_speed(speeds):
    scenarios, _ = crossing()
    plan = plan_fleet(scenarios, SETTING, apart=1.2, speeds=speeds, seed=3)
    assert plan.solved
    check(plan, scenarios, 1.2, speeds)
    assert plan.alone == pytest.approx(8 / np.array(speeds))
    assert plan.makespan >= plan.alone.max()
    assert min(plan.makespan_gap, plan.length_gap, plan.time_gap) >= -1e-12


def test_a_fleet_of_one_is_a_plan():
    scenarios, _ = crossing()
    plan = plan_fleet(scenarios[:1], SETTING, apart=1.0, seed=3)
    assert (plan.order, plan.restarts, plan.plans) == ((0,), 0, 1)
    assert plan.paths[0].arrival == pytest.approx(plan.paths[0].length)


def test_the_same_seed_gives_the_same_fleet():
    one, other = (plan_fleet(crossing()[0], SETTING, apart=1.2, seed=5) for _ in range(2))
    assert [p.times.tolist() for p in one.paths] == [p.times.tolist() for p in other.paths]


def robots_in(world, count, rng, motion):
    """Scenarios between free cells of the largest connected part, all starts distinct, and all goals."""
    parts, _ = label(world.free[:, :, 0])
    cells = np.argwhere(parts == np.bincount(parts[parts > 0]).argmax()).tolist()
    while True:
        starts, goals = (rng.permutation(len(cells))[:count] for _ in range(2))
        if (starts != goals).all():
            return [Scenario(world, cells[s], cells[g], motion) for s, g in zip(starts, goals, strict=True)]


def home(seed):
    """Three robots in a generated home."""
    rng = np.random.default_rng(seed)
    world = GridWorld(FAMILIES["rooms"](rng, 21).world.free, (1.0, 1.0, 1.0))
    return robots_in(world, 3, rng, Motion("grid8"))


def solved_in(fleets, apart, speeds):
    """How many fleets are solved; every one that is passes the checker."""
    solved = 0
    for seed, scenarios in enumerate(fleets):
        plan = plan_fleet(scenarios, SETTING, apart=apart, speeds=speeds, seed=seed)
        if plan.solved:
            check(plan, scenarios, apart, speeds)
            solved += 1
    return solved


def test_three_robots_cross_a_home():
    assert solved_in(map(home, range(4)), 0.9, (1.0, 0.7, 1.3)) == 4


@pytest.mark.slow
def test_three_robots_cross_a_hundred_homes():
    assert solved_in(map(home, range(100)), 0.9, (1.0, 0.7, 1.3)) == 100


def instances(data, seeds):
    folder = data / "mapf"
    if not folder.is_dir():
        pytest.skip(f"{folder} is absent")
    world = read_map(folder / "random-32-32-20.map").world
    for seed in seeds:
        yield robots_in(world, 20, np.random.default_rng(seed), Motion("grid4"))


def test_twenty_agents_of_a_benchmark_map_are_kept_apart(shared_data):
    assert solved_in(instances(shared_data, [0]), HALF, (1.0,) * 20) == 1


@pytest.mark.slow
def test_nine_in_ten_draws_of_twenty_agents_are_solved(shared_data):
    assert solved_in(instances(shared_data, range(25)), HALF, (1.0,) * 20) >= 23


BAD = {
    "nothing said of distance": (lambda s: plan_fleet(s, SETTING), ParameterError, "apart is missing"),
    "no robot": (lambda s: plan_fleet([], SETTING, apart=1), ParameterError, "at least one robot"),
    "no distance": (lambda s: plan_fleet(s, SETTING, apart=0), ParameterError, "apart = 0"),
    "too few speeds": (
        lambda s: plan_fleet(s, SETTING, apart=1, speeds=[1.0]),
        ParameterError,
        "1 speeds for 2",
    ),
    "no speed": (lambda s: plan_fleet(s, SETTING, apart=1, speeds=0), ParameterError, "speeds = 0"),
    "restarts": (lambda s: plan_fleet(s, SETTING, apart=1, restarts=-1), ParameterError, "restarts = -1"),
    "two worlds": (
        lambda s: plan_fleet([s[0], replace(s[1], world=GridWorld(np.ones((9, 9))))], SETTING, apart=1),
        ScenarioError,
        "robot 1 moves in another world",
    ),
    "ends too near": (lambda s: plan_fleet([s[0], s[0]], SETTING, apart=1), ScenarioError, "have a start at"),
}


@pytest.mark.parametrize(("call", "kind", "words"), BAD.values(), ids=BAD)
def test_what_cannot_be_used_is_said(call, kind, words):
    with pytest.raises(kind, match=words):
        call(crossing()[0])
