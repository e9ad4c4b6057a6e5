"""A colony that is steered: the ants and the diagnosis of its slow twin under any rules, motion and changes."""

import numpy as np
import pytest
from colonies import CELLS, PARAMETERS, RULES, any_rules
from conftest import random_grid, random_scenario
from hypothesis import given, settings
from hypothesis import strategies as st
from reference import diagnosis
from scenarios import GRIDS

from antgym.maps.motion import Motion
from antgym.maps.world import GridWorld, Scenario
from antgym.planners.colony import Colony
from antgym.planners.diagnosis import Diagnosis

BLOCKS = st.lists(st.tuples(PARAMETERS, st.integers(1, 4)), min_size=1, max_size=4)


def reports_of(colony, blocks):
    for parameters, iterations in blocks:
        colony.advance(parameters, iterations)
        yield colony.diagnosis()


def assert_twins(scenario, blocks, **settings):
    history, walk, expected = diagnosis.steer(scenario, blocks, **settings)
    colony = Colony(scenario, **settings, iterations=sum(count for _, count in blocks))
    assert [report._asdict() for report in reports_of(colony, blocks)] == expected
    found = colony.result()
    assert found.best.tolist() == history.best
    assert found.mean.tolist() == history.mean
    assert found.path.tolist()[:-1] == [list(cell) for cell, _ in walk]


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 2**64 - 1),
    blocks=BLOCKS,
    rules=st.one_of(st.sampled_from(RULES), any_rules()),
    motion=st.sampled_from([Motion(), Motion(), *GRIDS]),
    blocked=st.floats(0, 0.5),
    cell=st.sampled_from(CELLS),
)
def test_a_steered_colony_walks_and_reports_as_the_twin_does(seed, blocks, rules, motion, blocked, cell):
    """Bit for bit."""
    if motion.layered:
        scenario = random_scenario(seed % 1000, size=5, blocked=blocked, cell=cell)
    else:
        scenario = random_grid(seed % 1000, motion, 3 if motion.name == "grid26" else 5, blocked, cell)
    assert_twins(scenario, blocks, rules=rules, ants=4, seed=seed)


@pytest.mark.parametrize("rules", ["liu2020", "max_min", "zhang_apf"])
def test_twins_agree_where_there_are_more_ants_than_are_looked_at(rules):
    scenario = random_scenario(2, size=5, blocked=0.2)
    assert_twins(scenario, [((1, 1, 0.9, 50), 2), ((2, 0.5, 0.5, 5), 3)], rules=rules, ants=40, seed=4)


def test_before_the_first_block_there_is_nothing_to_report(valley):
    assert Colony(valley).diagnosis() == Diagnosis()


def test_a_converged_colony_is_closed_and_an_untouched_one_is_open(valley):
    closed, untouched = Colony(valley, iterations=200), Colony(valley, iterations=200)
    closed.advance((2, 5, 0.5, 1e4), 200)
    untouched.advance((1, 0.1, 1.0, 1e-9), 20)
    assert closed.diagnosis().branching < 0.05
    assert closed.diagnosis().distinct <= 0.1
    assert closed.diagnosis().stagnation > 0.9
    assert untouched.diagnosis().branching > 0.99
    assert untouched.diagnosis().distinct > 0.8


def test_where_nobody_arrives_time_since_the_start_counts():
    free = np.ones((5, 3, 3), bool)
    free[2] = False
    colony = Colony(Scenario(GridWorld(free), (0, 1, 1), (4, 1, 1)), ants=3, iterations=8)
    colony.advance((1, 1, 0.9, 1), 4)
    seen = colony.diagnosis()
    assert (seen.best, seen.mean, seen.first) == (np.inf,) * 3
    assert (seen.gained, seen.arrived, seen.stagnation) == (0.0, 0.0, 0.5)


def test_diagnosis_holds_plain_numbers(valley):
    colony = Colony(valley, iterations=5)
    colony.advance((1, 1, 0.9, 1), 5)
    assert {type(value) for value in colony.diagnosis()} == {float}
