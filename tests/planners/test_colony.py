"""The colony as an object: paused, advanced with others, pickled, its buffers handed on."""

import pickle

import numpy as np
import pytest
from colonies import world_of
from conftest import random_grid, random_scenario
from hypothesis import given, settings
from hypothesis import strategies as st

from antgym.errors import ParameterError
from antgym.kernels.layout import MORE_ROWS, WANTS
from antgym.maps.motion import Motion
from antgym.planners import buffers
from antgym.planners import colony as colonies
from antgym.planners.colony import Colony, advance_together, plan
from antgym.planners.rules import PAPERS


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
        ({"iterations": [1]}, "1 numbers of iterations for 2 different runs"),
        ({"parameters": [(1, 1, 0.5, 1), (1, 1, 0, 1)]}, "rho = 0"),
        ({"twice": True}, "for 1 different runs"),
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


def test_a_colony_that_ran_out_of_room_cannot_be_asked_for_half_a_block(monkeypatch, valley):
    colony = Colony(valley, ants=5, iterations=10)
    colony.advance((1, 1, 0.9, 50), 2)
    monkeypatch.setattr(buffers, "MOST_ROWS", 1)
    monkeypatch.setattr(
        colonies, "walk_block", lambda *_: 3
    )  # as if rows had run out in the fourth iteration
    colony._buffers.trail.status[WANTS] = MORE_ROWS
    with pytest.raises(ParameterError, match="may visit over"):
        colony.advance((1, 1, 0.9, 50), 8)
    with pytest.raises(ParameterError, match="lost them to an error"):
        colony.result()


@pytest.mark.parametrize("name", ["liu2020", "zhang_apf", "wei2018", "ant_colony_system"])
def test_pheromone_shows_where_ants_left_some(name, valley, room):
    """What edges begin with does not count, however uneven it is."""
    scenario = world_of(name, valley, room)
    rules = PAPERS[name]
    colony = Colony(scenario, rules=rules, ants=10, iterations=40)
    setting = rules.ranges.space(scenario.straight_line).default
    assert colony.pheromone()[1].max(initial=0.0) == 0.0
    colony.advance(setting, 1)
    colony.advance(setting, 39)
    cells, strength = colony.pheromone()
    assert strength.max() == 1.0
    assert strength.min() >= 0.0
    best = {tuple(cell) for cell in colony.result().path[1:].tolist()}
    on_path = np.array([tuple(cell) in best for cell in cells.tolist()])
    assert strength[on_path].mean() > 2 * strength[~on_path].mean()
