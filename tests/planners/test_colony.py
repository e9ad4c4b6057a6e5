"""The colony against its slow twin, its textbook relative and the exact optimum."""

import gc
import json
import os
import pickle
import subprocess
import sys
import weakref
from pathlib import Path

import numpy as np
import pytest
import reference
import reference_paths
from conftest import random_grid, random_scenario
from hypothesis import given, settings
from hypothesis import strategies as st

from antgym.errors import MapError, ParameterError, ScenarioError
from antgym.maps.motion import CORNERS, Motion
from antgym.maps.optimum import shortest_path
from antgym.maps.world import GridWorld, Scenario
from antgym.planners.colony import Colony, advance_together, plan, plan_many
from antgym.planners.rules import PAPERS, TARGETS, TRAPS, Rules

RULES = [
    *PAPERS.values(),
    Rules(target="current", w1=2, w2=1, q0=0.5),
    Rules(trap="lookahead", w1=1, w2=0),
    PAPERS["max_min"]._replace(q0=0.3, elite=2.0, ranked=1),
    PAPERS["ant_colony_system"]._replace(trap="lookahead", greedy="plain"),
]
PARAMETERS = st.tuples(
    st.floats(0.0, 5.0), st.floats(0.0, 10.0), st.floats(0.01, 1.0), st.floats(-6, 6).map(lambda e: 10.0**e)
)


def assert_twins(scenario, parameters, **settings):
    fast, slow = plan(scenario, parameters, **settings), reference.plan(scenario, parameters, **settings)
    assert fast.length == slow.length
    assert fast.path.tolist() == [list(cell) for cell in slow.path]
    assert fast.best.tolist() == slow.best
    assert fast.arrived.tolist() == slow.arrived
    assert fast.mean.tolist() == slow.mean
    assert fast.moves == slow.moves


GRIDS = [Motion(name, corners=corners) for name in CORNERS if name != "layered" for corners in CORNERS[name]]
CELLS = [(15.0, 10.0, 7.5), (0.1, 0.7, 334.503)]  # the second is nothing float32 can hold


@st.composite
def any_rules(draw):
    """Any rules that find_rules() takes, published or not."""
    flag, share = st.booleans(), st.sampled_from([0.0, 0.3])
    rules = Rules(
        target=draw(st.sampled_from(TARGETS)),
        w1=draw(st.sampled_from([0.0, 1.0, 4.0])),
        w2=draw(st.sampled_from([0.0, 2.0])),
        z2=draw(st.sampled_from([0.0, 1.5])),
        z3=draw(st.sampled_from([0.0, 0.7])),
        clearance=draw(st.sampled_from([(0.5, 2.5), (1.0, 1.8)])),
        q0=draw(st.sampled_from([0.0, 0.6])),
        greedy=draw(st.sampled_from(["weighted", "plain"])),
        ranked=draw(st.sampled_from([0, 1, 2, 4])),
        elite=draw(st.sampled_from([0.0, 2.0])),
        deposit=draw(st.sampled_from(["length", "edge"])),
        selective=draw(flag),
        local=draw(share),
        local_to=draw(st.sampled_from([0.0, 1.0])),
        pheromone_on=draw(st.sampled_from(["edge", "node"])),
        trap=draw(st.sampled_from(TRAPS)),
    )
    rules = rules._replace(clipped=rules.target == "current" and draw(flag))
    if rules.local == 0 and rules.pheromone_on == "edge" and draw(flag):
        rules = rules._replace(initial="degree")
    return rules._replace(**draw(st.sampled_from([{}, {"limits": True}, {"best_only": True}])))


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 2**64 - 1),
    parameters=PARAMETERS,
    rules=st.one_of(st.sampled_from(RULES), any_rules()),
    check=st.booleans(),
    blocked=st.floats(0, 0.6),
    cell=st.sampled_from(CELLS),
)
def test_colony_walks_the_same_ants_as_the_twin(seed, parameters, rules, check, blocked, cell):
    scenario = random_scenario(seed % 1000, size=5, blocked=blocked, check_segments=check, cell=cell)
    assert_twins(scenario, parameters, rules=rules, ants=4, iterations=6, seed=seed)


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 2**64 - 1),
    parameters=PARAMETERS,
    rules=st.one_of(st.sampled_from(RULES), any_rules()),
    motion=st.sampled_from(GRIDS),
    blocked=st.floats(0, 0.5),
    cell=st.sampled_from(CELLS),
)
def test_ants_roam_a_grid_as_the_twin_does(seed, parameters, rules, motion, blocked, cell):
    size = 3 if motion.name == "grid26" else 6
    scenario = random_grid(seed % 1000, motion, size, blocked, cell)
    assert_twins(scenario, parameters, rules=rules, ants=4, iterations=5, seed=seed)


@pytest.mark.parametrize(
    "parameters", [(3, 2, 1e-9, 1e9), (0.01, 0.5, 1e-6, 1e-6), (50, 50, 0.01, 1e6), (5, 1, 0.5, 1e12)]
)
def test_twins_agree_where_scale_folds_and_rows_outgrow_their_peak(parameters):
    assert_twins(
        random_scenario(3, size=5, blocked=0.1), parameters, rules=RULES[2], ants=5, iterations=40, seed=9
    )


SCRIPT = """
import json, sys
sys.path[:0] = [{tests!r}]
from conftest import random_grid, random_scenario
from antgym.maps.world import GridWorld, Scenario
from antgym.planners.colony import plan
from antgym.planners.rules import PAPERS
out = []
for name, rules in PAPERS.items():
    p = plan(random_scenario(5, size=6), (1.2, 2.5, 0.7, 50.0), rules=rules, ants=6, iterations=8, seed=2**63 + 11)
    out.append([p.length.hex(), p.path.tolist(), [x.hex() for x in p.mean.tolist()], p.moves])
print(json.dumps(out))
"""


def run_script(**environment):
    script = SCRIPT.format(tests=str(Path(__file__).parents[1]))
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", script],
        check=False,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_interpreted_and_compiled_kernels_give_the_same_bits():
    assert run_script(NUMBA_DISABLE_JIT="1") == run_script(NUMBA_DISABLE_JIT="0")


@pytest.fixture
def room():
    """A flat 7 x 7 world with a pocket between start and goal: an ant that walks into it and may not step back dies."""
    rows = [".......", ".###...", "...#.#.", ".#.#.#.", "...#.#.", ".###...", "......."]
    free = np.array([[c == "." for c in row] for row in rows]).T
    return Scenario(GridWorld(free), (0, 3), (6, 3), Motion("grid8"), name="room")


def world_of(name, valley, room):
    """The world that a paper's rules were made for."""
    return room if name.startswith(("zhang2011", "wei2018")) else valley


@pytest.mark.parametrize("name", PAPERS)
@pytest.mark.slow
def test_mean_length_agrees_with_the_textbook_colony_over_a_thousand_seeds(valley, room, name):
    """A slightly wrong polynomial shifts the mean by sigmas while every single plan looks fine."""
    scenario, rules = world_of(name, valley, room), PAPERS[name]
    beta = 3.0 / max(rules.w1 + rules.z2 + rules.z3, 1.0)
    parameters, effort = (1.0, beta, 0.7, 60.0), {"ants": 3, "iterations": 3}
    fast = plan_many([scenario] * 8000, [parameters] * 8000, rules=name, **effort, seeds=range(8000)).lengths
    slow = np.array(
        [reference.textbook(scenario, parameters, rules=name, **effort, seed=s) for s in range(1000)]
    )
    fast, slow = (
        np.minimum(lengths, 3 * scenario.optimum) for lengths in (fast, slow)
    )  # no path counts as this
    error = np.hypot(fast.std() / np.sqrt(len(fast)), slow.std() / np.sqrt(len(slow)))
    assert error > 0
    assert abs(fast.mean() - slow.mean()) < 3 * error


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
    assert reference_paths.length_along(scenario, found.path) == found.length


def test_best_so_far_never_rises_and_ends_at_the_length(valley):
    found = plan(valley, (1, 2, 0.9, 50), iterations=30)
    assert (np.diff(found.best) <= 0).all()
    assert found.best[-1] == found.length


def test_much_effort_finds_the_optimum(valley):
    found = plan(valley, (1, 5, 0.9, 100), rules=Rules(w1=1, w2=0, q0=0.0), ants=50, iterations=200)
    assert found.length == valley.optimum


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


def test_a_large_visit_grows_the_buffers_and_changes_nothing():
    scenario = random_scenario(1, size=24, blocked=0.0)
    found = plan(scenario, (0, 0, 0.9, 50), ants=100, iterations=40)
    colony = Colony(scenario, ants=100, iterations=40)
    colony.advance((0, 0, 0.9, 50), 40)
    assert colony.result().mean.tolist() == found.mean.tolist()


@given(
    blocks=st.lists(st.integers(1, 9), min_size=1, max_size=6),
    seed=st.integers(0, 50),
    name=st.sampled_from(list(PAPERS)),
    motion=st.sampled_from([Motion(), Motion("grid8"), Motion("grid26")]),
)
@settings(max_examples=40, deadline=None)
def test_a_colony_paused_anywhere_is_the_plan_of_one_block(blocks, seed, name, motion):
    scenario = random_scenario(seed, size=7, blocked=0.2) if motion.layered else random_grid(seed, motion, 6)
    parameters, settings = (
        (1.1, 2.0, 0.8, 30),
        {"rules": name, "ants": 6, "iterations": sum(blocks), "seed": seed},
    )
    whole, colony = plan(scenario, parameters, **settings), Colony(scenario, **settings)
    for block in blocks:
        colony.advance(parameters, block)
    paused = colony.result()
    assert (paused.length, paused.mean.tolist(), paused.moves) == (
        whole.length,
        whole.mean.tolist(),
        whole.moves,
    )
    assert paused.path.tolist() == whole.path.tolist()


def test_a_colony_may_not_walk_more_than_it_was_given(valley):
    colony = Colony(valley, iterations=5)
    colony.advance((1, 1, 0.5, 10), 5)
    with pytest.raises(ParameterError, match="0 left"):
        colony.advance((1, 1, 0.5, 10), 1)


def test_colonies_advanced_together_walk_as_each_alone(monkeypatch):
    scenarios = [random_scenario(seed, size=5 + seed % 3, blocked=0.2) for seed in range(7)]
    values = np.random.default_rng(0).uniform([0.1, 0.1, 0.1, 1], [3, 5, 0.95, 100], (3, 7, 4))

    def colonies():
        return [Colony(s, ants=5, iterations=12, seed=i) for i, s in enumerate(scenarios)]

    alone = colonies()
    for block in values:
        for colony, parameters in zip(alone, block, strict=True):
            colony.advance(parameters, 4)
    for threads in "12":
        monkeypatch.setenv("ANTGYM_THREADS", threads)
        together = colonies()
        for block in values:
            advance_together(together, block, [4] * 7)
        assert [c.diagnosis() for c in together] == [c.diagnosis() for c in alone]
        assert [c.result().path.tolist() for c in together] == [c.result().path.tolist() for c in alone]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"iterations": [1, 6]}, "this colony has 5 left"),
        ({"iterations": [1]}, "1 numbers of iterations for 2 different colonies"),
        ({"parameters": [(1, 1, 0.5, 1), (1, 1, 0, 1)]}, "rho = 0"),
        ({"twice": True}, "for 1 different colonies"),
    ],
)
def test_where_one_colony_cannot_be_advanced_none_is(valley, changes, message):
    one, other = (Colony(valley, ants=2, iterations=5) for _ in range(2))
    arguments = {"parameters": [(1, 1, 0.5, 1)] * 2, "iterations": [1, 1], **changes}
    colonies = [one, one if arguments.pop("twice", False) else other]
    with pytest.raises(ParameterError, match=message):
        advance_together(colonies, **arguments)
    assert (one.done, other.done) == (0, 0)


@pytest.mark.parametrize("rules", ["liu2020", "max_min", "zhang2011"])
def test_a_colony_in_released_buffers_walks_as_in_new_ones(rules):
    motion = Motion("grid8")
    worlds = [random_grid(seed, motion, size, 0.2) for seed, size in ((0, 12), (1, 5), (2, 20))]
    buffers = None
    for i, scenario in enumerate(worlds):
        settings = {"rules": rules, "ants": 5 + 40 * i, "iterations": 6, "seed": i}
        reused, fresh = Colony(scenario, **settings, buffers=buffers), Colony(scenario, **settings)
        for colony in (reused, fresh):
            colony.advance((1, 2, 0.8, 30), 6)
        assert reused.diagnosis() == fresh.diagnosis()
        assert reused.result().mean.tolist() == fresh.result().mean.tolist()
        buffers = reused.release()


def test_a_colony_that_released_its_buffers_walks_no_more(valley):
    colony = Colony(valley, iterations=5)
    colony.advance((1, 1, 0.5, 10), 2)
    colony.release()
    for attempt in (
        colony.result,
        colony.pheromone,
        colony.release,
        lambda: colony.advance((1, 1, 0.5, 1), 1),
    ):
        with pytest.raises(ParameterError, match="has released its buffers"):
            attempt()


@pytest.mark.parametrize("blocks", [0, 1, 3])
def test_a_pickled_colony_goes_on_like_the_original_and_is_small(valley, blocks):
    colony = Colony(valley, rules=PAPERS["max_min"], ants=4, iterations=20, seed=3)
    for i in range(blocks):
        colony.advance((1 + i, 2, 0.8, 30), 3)
    data = pickle.dumps(colony)
    copy = pickle.loads(data)
    for each in (colony, copy):
        each.advance((0.5, 1, 0.5, 3), 4)
    assert copy.diagnosis() == colony.diagnosis()
    assert copy.result().mean.tolist() == colony.result().mean.tolist()
    assert len(data) < 10_000


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
    exact = reference.shortest(scenario)
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


def test_kernels_compile_once():
    """A second signature would mean that some caller hands over another dtype, and a second compilation."""
    from antgym.kernels import ants, diagnosis, paths

    grids = [random_grid(2, motion, 4) for motion in GRIDS]
    plan_many(
        grids, [(1, 1, 0.5, 1)] * len(grids), rules=list(PAPERS)[-len(grids) :], seeds=range(len(grids))
    )
    plan_many([random_scenario(0)], [(1, 1, 0.5, 1)], rules="zhang_apf", seeds=[0])
    plan_many(
        [random_scenario(0), random_scenario(1, size=9)],
        [(1, 1, 0.5, 1)] * 2,
        ants=[2, 3],
        iterations=4,
        seeds=[1, 2],
    )
    for motion in (Motion(), Motion("grid8"), Motion("grid4", corners="cut"), Motion("grid26")):
        _ = Scenario(GridWorld(np.ones((5, 5))), (0, 0), (4, 4), motion).optimum
    Colony(grids[0]).advance((1, 1, 0.5, 1), 2)
    walks = ants.plan_range, ants.begin, ants.advance, diagnosis.walk_block, diagnosis.diagnose
    for compiled in (*walks, paths.layered_distances, paths.grid_search):
        assert len(compiled.signatures) <= 1


EASY = {
    "liu2020-paper": (
        1.0,
        0.02,
        0.97,
        100.0,
    ),  # as printed it pulls to the start: only pheromone finds the goal
    "zhang_apf-original": (1.0, 1.0, 0.95, 1.0),
    "zhang2011": (1.0, 1.0, 0.97, 200.0),
    "zhang2011-basic": (1.0, 1.0, 0.97, 10.0),
    "wei2018": (1.0, 1.0, 0.97, 1.0),
    "wei2018-basic": (1.0, 1.0, 0.97, 1.0),
}


@pytest.mark.parametrize("name", PAPERS)
def test_every_rule_comes_within_a_hundredth_of_the_optimum_given_effort(valley, room, name):
    scenario, rules = world_of(name, valley, room), PAPERS[name]
    # a small Q locks nothing in
    parameters = EASY.get(name, (1.0, 4.0 / max(rules.w1 + rules.z2 + rules.z3, 1.0), 0.95, 10.0))
    found = plan(scenario, parameters, rules=name, ants=100, iterations=300)
    assert scenario.optimum <= found.length <= 1.01 * scenario.optimum


@pytest.mark.parametrize("name", PAPERS)
def test_no_rule_is_ever_shorter_than_the_optimum(name):
    if name.startswith(("zhang2011", "wei2018")):
        scenarios = [random_grid(seed, Motion("grid8"), 12, 0.2) for seed in range(130)]
    else:
        scenarios = [random_scenario(seed, size=8, blocked=0.35) for seed in range(100)]
    settings = {"rules": name, "ants": 5, "iterations": 8, "seeds": range(len(scenarios))}
    plans = plan_many(scenarios, [(1.0, 1.0, 0.9, 50.0)] * len(scenarios), **settings)
    solved = np.flatnonzero(np.isfinite(plans.lengths))
    assert len(solved) > 50
    assert all(plans.lengths[i] >= scenarios[i].optimum for i in solved)


OFF = {
    "limits": False,
    "ranked": 0,
    "elite": 0.0,
    "local": 0.0,
    "best_only": False,
    "q0": 0.0,
    "clipped": False,
    "initial": "uniform",
    "deposit": "length",
    "selective": False,
}


@pytest.mark.parametrize(
    ("name", "basic", "changes"),
    [
        ("zhang2011", "zhang2011-basic", {"trap": "die"}),
        ("wei2018", "wei2018-basic", {}),
        ("zhang_apf", "zhang_apf-original", {"z2": 0.0, "z3": 0.0, "w1": 0.0, "ranked": 2, "local": 0.1}),
    ],
)
def test_a_paper_without_its_own_ideas_is_its_baseline(room, valley, name, basic, changes):
    scenario, settings = world_of(name, valley, room), {"ants": 8, "iterations": 25, "seed": 3}
    off = OFF if "apf" not in name else {}
    bare, plain, whole = (
        plan(scenario, (1, 2, 0.8, 40), rules=rules, **settings)
        for rules in (PAPERS[name]._replace(**{**off, **changes}), basic, name)
    )
    assert bare.mean.tolist() == plain.mean.tolist()
    assert whole.mean.tolist() != plain.mean.tolist()


@given(seed=st.integers(0, 500), motion=st.sampled_from([Motion(), *GRIDS]), ants=st.sampled_from([1, 5, 70]))
@settings(max_examples=60, deadline=None)
def test_no_ant_that_may_step_back_is_lost_where_there_is_a_path(seed, motion, ants):
    scenario = random_scenario(seed, 8, 0.45) if motion.layered else random_grid(seed, motion, 6, 0.35)
    rules = PAPERS["zhang2011"]._replace(trap="retreat")
    arrived = plan(scenario, (1, 1, 0.9, 50), rules=rules, ants=ants, iterations=3, seed=seed).arrived
    assert arrived.tolist() == [ants if np.isfinite(reference_paths.shortest(scenario)) else 0] * 3


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


@pytest.mark.parametrize(
    "changes",
    [
        {"elitist": {"elite": 0.0}},
        {"rank_based": {"elite": 0.0, "ranked": 0}},
        {"max_min": {"limits": False, "ranked": 0}},
        {"ant_colony_system": {"q0": 0.0, "local": 0.0, "best_only": False, "elite": 0.0, "ranked": 0}},
    ],
    ids=lambda changes: next(iter(changes)),
)
def test_a_rule_without_its_own_idea_is_the_ant_system(changes):
    (name, fields), scenario = next(iter(changes.items())), random_scenario(4, size=8, blocked=0.2)
    settings = {"ants": 8, "iterations": 25, "seed": 3}
    plain = plan(scenario, (1, 4, 0.8, 40), rules="ant_system", **settings)
    bare = plan(scenario, (1, 4, 0.8, 40), rules=PAPERS[name]._replace(**fields), **settings)
    whole = plan(scenario, (1, 4, 0.8, 40), rules=name, **settings)
    assert bare.mean.tolist() == plain.mean.tolist()
    assert whole.mean.tolist() != plain.mean.tolist()


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
