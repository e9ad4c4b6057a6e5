"""The bees against their slow twin, bit for bit, and compiled against interpreted."""

from importlib import import_module

import numpy as np
from discs import among, disc_scenarios, scattered
from hives import BEE_PARAMETERS, any_bee_rules
from hypothesis import given, settings
from hypothesis import strategies as st
from interpreted import run_script
from reference import bees as twin

from antgym.planners.bee_rules import BEE_PAPERS
from antgym.planners.hive import Hive
from antgym.planners.planning import plan, plan_many


def assert_twins(fast, slow):
    assert fast.length == slow.length
    assert fast.path.tolist() == [list(point) for point in slow.path]
    assert fast.best.tolist() == slow.best
    assert fast.arrived.tolist() == slow.arrived
    assert fast.mean.tolist() == slow.mean
    assert fast.moves == slow.moves


@settings(max_examples=60, deadline=None)
@given(
    scenario=disc_scenarios(most=6),
    rules=st.one_of(st.sampled_from(list(BEE_PAPERS.values())), any_bee_rules()),
    parameters=BEE_PARAMETERS,
    ants=st.integers(4, 9),
    seed=st.integers(0, 2**64 - 1),
)
def test_the_hive_flies_the_same_bees_as_the_twin(scenario, rules, parameters, ants, seed):
    settings = {"rules": rules, "ants": ants, "iterations": 12, "seed": seed}
    parameters = parameters[: 4 if rules.tabu else 3]
    assert_twins(plan(scenario, parameters, **settings), twin.plan(scenario, parameters, **settings))


@settings(max_examples=20, deadline=None)
@given(
    blocks=st.lists(st.tuples(BEE_PARAMETERS, st.integers(1, 6)), min_size=1, max_size=4),
    rules=any_bee_rules(),
    seed=st.integers(0, 100),
)
def test_under_parameters_that_change_a_hive_still_flies_as_the_twin(blocks, rules, seed):
    scenario, rules = scattered(seed, 4), rules._replace(tabu=2)
    hive = Hive(scenario, rules=rules, ants=6, iterations=sum(count for _, count in blocks), seed=seed)
    for parameters, count in blocks:
        hive.advance(parameters, count)
    assert_twins(hive.result(), twin.plan_in_blocks(scenario, blocks, rules=rules, ants=6, seed=seed))


def test_a_long_run_of_every_paper_is_the_twins():
    """Long enough for scouts, a full tabu list and redraws."""
    scenario = scattered(3, 6, safe_distance=0.3)
    for name, published in BEE_PAPERS.items():
        rules = published._replace(points=4, tabu=min(published.tabu, 3))
        parameters = (3.0, 0.9, 0.3, 9.0)[: 4 if rules.tabu else 3]
        settings = {"rules": rules, "ants": 6, "iterations": 80, "seed": 5}
        fast = plan(scenario, parameters, **settings)
        assert fast.moves > 3 + 6 * 80, f"{name}: no scout ever flew"
        assert_twins(fast, twin.plan(scenario, parameters, **settings))


SCRIPT = """
import json, sys
sys.path[:0] = [{tests!r}]
from discs import among, scattered
from antgym.planners.bee_rules import BEE_PAPERS
from antgym.planners.hive import Hive
from antgym.planners.planning import plan
worlds = [scattered(5, 7, safe_distance=0.4), scattered(2, 3, robot_radius=0.1), among()]
out = []
for i, rules in enumerate(BEE_PAPERS.values()):
    scenario, setting = worlds[i % 3], (4.0, 0.8, 0.3, 6.0)[: 4 if rules.tabu else 3]
    effort = {{"rules": rules, "ants": 7, "iterations": 25, "seed": 2**63 + 11}}
    p, hive = plan(scenario, setting, **effort), Hive(scenario, **effort)
    hive.advance(setting, 10)
    hive.advance((9.0, *setting[1:]), 15)
    for found in (p, hive.result()):
        numbers = [found.length, *found.path.ravel(), *found.mean, *found.best]
        out.append([float(x).hex() for x in numbers] + [found.moves])
print(json.dumps(out))
"""


def test_interpreted_and_compiled_bees_give_the_same_bits():
    assert run_script(SCRIPT, NUMBA_DISABLE_JIT="1") == run_script(SCRIPT, NUMBA_DISABLE_JIT="0")


def test_bee_kernels_compile_once():
    """A second signature would mean that some caller hands over another dtype, and a second compilation."""
    names = list(BEE_PAPERS)
    scenarios = [scattered(i, i) for i in range(len(names) - 1)] + [among()]
    plan_many(
        scenarios, [(9, 1, 1, 1)] * len(names), rules=names, ants=6, iterations=5, seeds=range(len(names))
    )
    hive = Hive(scenarios[0], ants=np.int64(6), iterations=5)
    hive.advance((9, 1, 1, 1), 2)
    hive.advance((9, 1, 1, 1), 3)
    counts = {
        f"{module}.{name}": len(function.signatures)
        for module in ("bees", "scouts", "segments")
        for name, function in vars(import_module(f"antgym.kernels.{module}")).items()
        if hasattr(function, "signatures") and not function.targetoptions.get("forceinline")
    }
    assert {name: count for name, count in counts.items() if count > 1} == {}
    assert counts["bees.fly_range"] == counts["bees.fly_block"] == 1
