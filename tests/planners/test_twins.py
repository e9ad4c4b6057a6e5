"""The ants against their slow twin, bit for bit, against the textbook in the mean, and compiled against interpreted."""

import pkgutil
from importlib import import_module

import numpy as np
import pytest
from colonies import CELLS, PARAMETERS, RULES, any_rules, world_of
from conftest import random_grid, random_scenario
from hypothesis import given, settings
from hypothesis import strategies as st
from interpreted import run_script
from reference import remembered, textbook, twin
from scenarios import GRIDS

from antgym import kernels
from antgym.maps.generators import random_arrival
from antgym.maps.motion import Motion
from antgym.maps.world import GridWorld, Scenario
from antgym.planners.colony import Colony, plan, plan_many
from antgym.planners.rules import PAPERS


def assert_twins(scenario, parameters, **settings):
    fast, slow = plan(scenario, parameters, **settings), twin.plan(scenario, parameters, **settings)
    assert fast.length == slow.length
    assert fast.path.tolist() == [list(cell) for cell in slow.path]
    assert fast.best.tolist() == slow.best
    assert fast.arrived.tolist() == slow.arrived
    assert fast.mean.tolist() == slow.mean
    assert fast.moves == slow.moves


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
from scenarios import GRIDS
from antgym.planners.colony import Colony, plan
from antgym.planners.rules import PAPERS, TRAPS
worlds = [random_scenario(5, size=5), *(random_grid(2, motion, 4) for motion in GRIDS)]
out = []
for i, rules in enumerate(PAPERS.values()):
    for j in (0, 1 + i % len(GRIDS)):
        rules = rules._replace(trap=TRAPS[(i + j) % 3])
        effort = {{"rules": rules, "ants": 5, "iterations": 5, "seed": 2**63 + 11}}
        p, colony = plan(worlds[j], (1.2, 2.5, 0.7, 50.0), **effort), Colony(worlds[j], **effort)
        colony.advance((0.5, 1.5, 0.8, 20.0), 2)
        colony.advance((1.2, 2.5, 0.7, 50.0), 3)
        out.append([p.length.hex(), p.path.tolist(), [x.hex() for x in p.mean.tolist()], p.moves])
        out.append([x.hex() for x in colony.diagnosis()])
    out.append(worlds[j].optimum.hex() if p.solved else "none")
print(json.dumps(out))
"""


def test_interpreted_and_compiled_kernels_give_the_same_bits():
    assert run_script(SCRIPT, NUMBA_DISABLE_JIT="1") == run_script(SCRIPT, NUMBA_DISABLE_JIT="0")


@pytest.mark.parametrize("name", PAPERS)
@pytest.mark.slow
def test_mean_length_agrees_with_the_textbook_colony_over_a_thousand_seeds(valley, room, name):
    """A slightly wrong polynomial shifts the mean by sigmas while every single plan looks fine."""
    scenario, rules = world_of(name, valley, room), PAPERS[name]
    beta = 3.0 / max(rules.w1 + rules.z2 + rules.z3, 1.0)
    parameters, effort = (1.0, beta, 0.7, 60.0), {"ants": 3, "iterations": 3}
    known = remembered.get(
        name, scenario, lambda seed: textbook.textbook(scenario, parameters, rules=name, **effort, seed=seed)
    )
    fast = plan_many([scenario] * 4000, [parameters] * 4000, rules=name, **effort, seeds=range(4000)).lengths
    fast = np.minimum(fast, 3 * scenario.optimum)  # no path counts as this
    error = np.hypot(fast.std() / np.sqrt(len(fast)), known.deviation / np.sqrt(remembered.SEEDS))
    assert error > 0
    assert abs(fast.mean() - known.mean) < 3 * error


def test_kernels_compile_once():
    """A second signature would mean that some caller hands over another dtype, and a second compilation."""
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
    random_arrival(random_scenario(0))
    Colony(grids[0]).advance((1, 1, 0.5, 1), 2)
    modules = [
        import_module(f"{kernels.__name__}.{each.name}") for each in pkgutil.iter_modules(kernels.__path__)
    ]
    compiled = {
        f"{function.__module__}.{function.__name__}": len(function.signatures)
        for module in modules
        for function in vars(module).values()
        # what is inlined is compiled anew for every constant it is called with
        if hasattr(function, "signatures") and not function.targetoptions.get("forceinline")
    }
    assert {name: count for name, count in compiled.items() if count > 1} == {}
    entries = (
        "ants.plan_range",
        "ants.begin",
        "diagnosis.walk_block",
        "paths.layered_arrival",
        "paths.layered_distances",
        "paths.grid_search",
    )
    assert [compiled[f"antgym.kernels.{entry}"] for entry in entries] == [1] * 6
