"""What holds for every walk: valid paths, never below the optimum, no surprise from threads, buffers or traps."""

import gc
import weakref

import numpy as np
import pytest
from colonies import PARAMETERS, any_rules
from conftest import random_grid, random_scenario
from hypothesis import given, settings
from hypothesis import strategies as st
from reference import paths
from scenarios import GRIDS

from antgym.errors import MapError, ParameterError, ScenarioError
from antgym.kernels.layout import MORE_ROWS, WANTS
from antgym.maps.motion import Motion
from antgym.maps.optimum import shortest_path
from antgym.maps.world import GridWorld, Scenario
from antgym.planners import batch, buffers
from antgym.planners import colony as colonies
from antgym.planners.colony import Colony, plan, plan_many
from antgym.planners.rules import PAPERS, TRAPS, Rules


@given(
    seed=st.integers(0, 10_000),
    parameters=PARAMETERS,
    motion=st.sampled_from([Motion(), *GRIDS]),
    rules=any_rules(),
)
@settings(max_examples=120, deadline=None)
def test_paths_are_valid_and_never_shorter_than_the_optimum(seed, parameters, motion, rules):
    cell = (0.1, 0.3, 334.503) if seed % 2 else (15.0, 15.0, 15.0)
    if motion.layered:
        scenario = random_scenario(seed, size=8, blocked=0.4, cell=cell)
    else:
        scenario = random_grid(seed, motion, 5 if motion.name == "grid26" else 9, 0.2, cell)
    found = plan(scenario, parameters, rules=rules, ants=5, iterations=5, seed=seed)
    if not found.solved:
        assert found.path.shape == (0, 3)
        return
    assert found.length >= scenario.optimum
    cells = [tuple(cell) for cell in found.path.tolist()]
    assert (cells[0], cells[-1]) == (scenario.start, scenario.goal)
    assert len(set(cells)) == len(cells)  # no cell twice, nor any that an ant stepped back from
    assert paths.length_along(scenario, found.path) == found.length


def test_best_so_far_never_rises_and_ends_at_the_length(valley):
    found = plan(valley, (1, 2, 0.9, 50), iterations=30)
    assert (np.diff(found.best) <= 0).all()
    assert found.best[-1] == found.length


@given(power=st.integers(-20, 20), seed=st.integers(0, 99))
@settings(max_examples=20, deadline=None)
def test_scaling_initial_pheromone_and_deposit_together_changes_nothing(power, seed):
    """Only κ = Q / (L · τ₀) acts (liu2020 (2), (3))."""
    scenario, c = random_scenario(seed, size=6, blocked=0.2), 2.0**power
    one = plan(scenario, (1.3, 0.8, 0.6, 40), rules=Rules(), iterations=15, seed=seed)
    other = plan(
        scenario, (1.3, 0.8, 0.6, 40 * c), rules=Rules(initial_pheromone=c), iterations=15, seed=seed
    )
    assert one.mean.tolist() == other.mean.tolist()


def test_batch_order_and_threads_change_nothing(monkeypatch):
    scenarios = [random_scenario(seed, size=5 + seed % 4, blocked=0.2) for seed in range(20)]
    scenarios += [random_grid(seed, GRIDS[seed % 6], size=4 + seed % 3) for seed in range(10)]
    values = np.random.default_rng(0).uniform([0.1, 0.1, 0.1, 1], [3, 5, 0.95, 100], (30, 4))
    arguments = {
        "rules": [list(PAPERS)[i % len(PAPERS)] for i in range(30)],
        "ants": list(range(1, 31)),
    }
    monkeypatch.setenv("ANTGYM_THREADS", "1")
    alone = plan_many(
        scenarios, values, **arguments, iterations=[3 + i % 9 for i in range(30)], seeds=range(30)
    )
    monkeypatch.setenv("ANTGYM_THREADS", "2")
    order = np.random.default_rng(1).permutation(30)
    mixed = plan_many(
        [scenarios[i] for i in order],
        values[order],
        rules=[arguments["rules"][i] for i in order],
        ants=[arguments["ants"][i] for i in order],
        iterations=[3 + i % 9 for i in order.tolist()],
        seeds=order,
    )
    assert mixed.lengths.tolist() == alone.lengths[order].tolist()
    assert [mixed.plan(k).path.tolist() for k in range(30)] == [
        alone.plan(i).path.tolist() for i in order.tolist()
    ]


def test_what_is_kept_of_a_scenario_goes_with_it(valley):
    """Records are kept by scenario and rules: a second plan is the first, other rules are others, nothing leaks."""
    scenario = Scenario(valley.world, valley.start, valley.goal)
    kept = weakref.ref(scenario)
    first, other, again = (
        plan(scenario, (1, 0.1, 0.9, 50), rules=Rules(q0=q0), ants=5, iterations=3, seed=1).mean.tolist()
        for q0 in (0.0, 0.9, 0.0)
    )
    assert first == again != other
    del scenario
    gc.collect()
    assert kept() is None


def test_another_seed_gives_another_walk(valley):
    means = {tuple(plan(valley, (1, 1, 0.9, 50), seed=seed).mean.tolist()) for seed in range(5)}
    assert len(means) == 5


@pytest.mark.parametrize("rules", PAPERS)
@pytest.mark.parametrize(
    "motion", [Motion(), Motion("grid8"), Motion("grid26")], ids=lambda motion: motion.name
)
def test_buffers_that_grow_from_next_to_nothing_change_nothing(monkeypatch, rules, motion):
    """Rows, depth and room for paths, all of them in the middle of an iteration."""
    scenario = random_scenario(1, size=9, blocked=0.2) if motion.layered else random_grid(1, motion, 7, 0.2)
    effort = {"rules": rules, "ants": 70, "iterations": 6, "seed": 5}
    found = plan(scenario, (0.5, 0.5, 0.9, 50), **effort)
    grown, grow = [], buffers.grown
    for name, value in (("_FIRST_ROWS", 2), ("_RESERVED_ROWS", 2), ("_FIRST_DEPTH", 1)):
        monkeypatch.setattr(buffers, name, value)
    monkeypatch.setattr(batch, "_FIRST_CELLS", 1)
    monkeypatch.setattr(batch, "_WORKSPACE", buffers.Workspace())
    for module in (batch, colonies):
        monkeypatch.setattr(
            module, "grown", lambda old: grown.append(int(old.trail.status[WANTS])) or grow(old)
        )
    monkeypatch.setenv("ANTGYM_THREADS", "1")
    again, colony = plan(scenario, (0.5, 0.5, 0.9, 50), **effort), Colony(scenario, **effort)
    colony.advance((0.5, 0.5, 0.9, 50), 6)
    for each in (again, colony.result()):
        assert each.path.tolist() == found.path.tolist()
        assert each.mean.tolist() == found.mean.tolist()
        assert each.moves == found.moves
    assert grown.count(MORE_ROWS) >= 8
    assert motion.layered or len(set(grown)) == 2


def test_segment_checks_only_remove_paths():
    """A wall with one cell open two cells away: a ±2 move would clip it."""
    free = np.ones((3, 5, 5), bool)
    free[1] = False
    free[1, 3, 2] = True  # reached from (0, 1, 2) by dy = 2, whose segment crosses (0, 2, 2) and (1, 2, 2)
    ends = ((0, 1, 2), (2, 3, 2))
    loose, strict = (
        Scenario(GridWorld(free), *ends, Motion(check_segments=check)) for check in (False, True)
    )
    assert loose.optimum == pytest.approx(15 * (np.sqrt(5) + 1))
    with pytest.raises(ScenarioError, match="no path leads"):
        _ = strict.optimum
    assert plan(loose, (1, 1, 0.5, 1)).solved
    assert not plan(strict, (1, 1, 0.5, 1)).solved


@pytest.mark.parametrize("seed", range(12))
def test_the_optimum_is_what_enumeration_finds(seed):
    scenario = random_scenario(
        seed, size=6, blocked=0.3, check_segments=seed % 2 == 0, cell=(10.0, 12.0, 5.0)
    )
    exact = paths.shortest_by_layers(scenario)
    if not np.isfinite(exact):
        with pytest.raises(ValueError, match="no path leads"):
            _ = scenario.optimum
        return
    assert scenario.optimum == pytest.approx(exact)
    steps = np.diff(scenario.world.centre(shortest_path(scenario)), axis=0)
    assert np.sqrt((steps**2).sum(axis=1)).sum() == pytest.approx(exact)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"parameters": (1, 1, 0, 1)}, "rho = 0"),
        ({"parameters": (-1, 1, 0.5, 1)}, "alpha = -1"),
        ({"parameters": (1, float("nan"), 0.5, 1)}, "beta = nan"),
        ({"parameters": (1, 1, 0.5)}, "parameters are"),
        ({"rules": "liu2021"}, "did you mean 'liu2020'"),
        ({"rules": Rules(target="gaol")}, "did you mean 'goal'"),
        ({"rules": Rules(deposit="edges")}, "did you mean 'edge'"),
        ({"rules": Rules(clearance=(2.0, 1.0))}, "clearance = "),
        ({"rules": Rules(clipped=True)}, "needs target"),
        ({"rules": Rules(initial="degree", local=0.1)}, "neither with a local update"),
        ({"rules": Rules(q0=2.0)}, "q0 = 2"),
        ({"rules": Rules(trap="dye")}, "did you mean 'die'"),
        ({"rules": Rules(ranked=-1)}, "ranked = -1"),
        ({"rules": Rules(limits=True, best_only=True)}, "exclude each other"),
        ({"ants": 0}, "ants = 0"),
        ({"iterations": 2.5}, "iterations = 2.5"),
        ({"seed": -1}, "seed = -1"),
    ],
)
def test_bad_arguments_are_named(valley, arguments, message):
    with pytest.raises(ParameterError, match=message):
        plan(valley, **{"parameters": (1, 1, 0.5, 1), **arguments})


@given(seed=st.integers(0, 500), motion=st.sampled_from([Motion(), *GRIDS]), ants=st.sampled_from([1, 5, 70]))
@settings(max_examples=60, deadline=None)
def test_no_ant_that_may_step_back_is_lost_where_there_is_a_path(seed, motion, ants):
    scenario = random_scenario(seed, 8, 0.45) if motion.layered else random_grid(seed, motion, 6, 0.35)
    rules = PAPERS["zhang2011"]._replace(trap="retreat")
    arrived = plan(scenario, (1, 1, 0.9, 50), rules=rules, ants=ants, iterations=3, seed=seed).arrived
    assert arrived.tolist() == [ants if np.isfinite(paths.shortest(scenario)) else 0] * 3


def test_where_nobody_is_trapped_the_trap_rules_agree():
    open_world = Scenario(GridWorld(np.ones((9, 1), bool)), (0, 0), (8, 0), Motion("grid8"))
    for scenario in (open_world, random_scenario(3, 7, blocked=0.0)):
        means = [
            plan(
                scenario, (1, 1, 0.9, 50), rules=PAPERS["ant_system"]._replace(trap=trap), seed=1
            ).mean.tolist()
            for trap in TRAPS
        ]
        assert means[0] == means[2]
        assert np.isfinite(means[1]).all()


def test_a_long_winding_way_deepens_the_buffers_and_changes_nothing():
    """A serpentine of 600 moves, far over what buffers begin with; 70 ants need two words of tabu bits."""
    free = np.ones((41, 29), bool)
    for i, x in enumerate(range(1, 41, 2)):
        free[x, 1:] = i % 2 == 1
        free[x, :-1] = i % 2 == 0
        free[x, 0 if i % 2 == 0 else -1] = False
        free[x, -1 if i % 2 == 0 else 0] = True
        free[x, 1:-1] = False
    scenario = Scenario(GridWorld(free), (0, 0), (40, 0), Motion("grid4"))
    effort = {"rules": PAPERS["zhang2011-basic"], "ants": 70, "iterations": 3}
    found = plan(scenario, (1, 1, 0.9, 50), **effort)
    assert found.length == scenario.optimum
    assert len(found.path) > 600
    colony = Colony(scenario, **effort)
    colony.advance((1, 1, 0.9, 50), 3)
    assert colony.result().path.tolist() == found.path.tolist()


def test_ants_keep_away_from_obstacles_where_the_rules_say_so():
    free = np.ones((12, 11), bool)
    free[6, 5] = False
    scenario = Scenario(GridWorld(free), (0, 5), (11, 5), Motion("grid8"))
    wary = PAPERS["zhang_apf"]._replace(clearance=(2.0, 3.0))
    path = plan(scenario, (1, 3, 0.8, 100), rules=wary, ants=20, iterations=20).path
    assert np.linalg.norm(path[:, :2] - np.array([6, 5]), axis=1).min() > 2.0


def test_a_world_too_large_for_its_clearance_is_refused_before_anything_is_planned(monkeypatch, valley):
    monkeypatch.setattr("antgym.maps.world.MOST_CLEARED", 100)
    with pytest.raises(MapError, match=r"729 cells is too large .* at most 100"):
        plan(valley, (1, 1, 0.5, 1), rules="zhang_apf")
    assert plan(valley, (1, 1, 0.5, 1), rules="liu2020").solved


def test_looking_ahead_loses_fewer_ants():
    scenarios = [random_scenario(seed, size=9, blocked=0.45) for seed in range(30)]
    arrived = {}
    for trap in ("die", "lookahead"):
        rules = PAPERS["ant_system"]._replace(trap=trap)
        plans = plan_many(
            scenarios, [(1, 2, 0.9, 50)] * 30, rules=rules, ants=20, iterations=5, seeds=range(30)
        )
        arrived[trap] = sum(int(plans.plan(i).arrived.sum()) for i in range(30))
    assert arrived["lookahead"] > 1.2 * arrived["die"]
