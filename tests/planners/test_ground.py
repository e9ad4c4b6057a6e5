"""Layouts hold what they are asked for, keep little, and copy no world that is alone."""

import numpy as np
import pytest
from conftest import random_scenario

from antgym.planners import ground
from antgym.planners.colony import plan, plan_many
from antgym.planners.ground import Layouts


@pytest.fixture
def worlds():
    return [random_scenario(seed, size=6 + seed % 3, blocked=0.2).world for seed in range(6)]


@pytest.fixture
def layouts():
    return Layouts(lambda world: world.bits, np.uint8)


def assert_holds(laid_out, worlds):
    flat, begins = laid_out
    assert not flat.flags.writeable
    for world, begin in zip(worlds, begins.tolist(), strict=True):
        assert flat[begin : begin + len(world.bits)].tolist() == world.bits.tolist()


def test_every_layout_holds_each_world_where_it_says(layouts, worlds):
    for picked in ([0, 1, 1], [2, 0], [3], [5, 4, 0, 2], [1, 2], []):
        asked = [worlds[i] for i in picked]
        assert_holds(layouts.of(asked), asked)


def test_worlds_that_lie_there_already_are_not_copied_again(layouts, worlds):
    first, _ = layouts.of(worlds)
    assert layouts.of(worlds[2:4])[0] is first
    assert layouts.of(worlds[::-1])[0] is first


def test_a_world_alone_is_used_where_it_lies_and_not_kept(layouts, worlds):
    first, _ = layouts.of(worlds[:3])
    assert np.shares_memory(layouts.of([worlds[4]] * 5)[0], worlds[4].bits)
    assert layouts.of(worlds[:2])[0] is first


def test_what_is_kept_has_a_bound(layouts, worlds, monkeypatch):
    monkeypatch.setattr(ground, "MOST_KEPT", sum(len(world.bits) for world in worlds[:3]))
    first, _ = layouts.of(worlds[:3])
    second, _ = layouts.of(worlds[3:5])
    assert len(second) == sum(len(world.bits) for world in worlds[3:5])  # the old ones are given up
    assert_holds(layouts.of(worlds), worlds)
    assert layouts.of(worlds[3:5])[0] is second  # what is too large is not kept
    assert layouts.of(worlds[:3])[0] is not first


def test_plans_do_not_depend_on_what_was_laid_out_before():
    scenarios = [random_scenario(seed, size=7, blocked=0.15) for seed in range(8)]
    for rules in ("liu2020", "zhang_apf"):
        arguments = {"rules": rules, "ants": 4, "iterations": 5}
        alone = [plan(s, (1, 2, 0.9, 50), seed=i, **arguments).length for i, s in enumerate(scenarios)]
        for picked in ([3, 1], [0, 1, 2, 3], [7, 6, 5, 4, 3, 2, 1, 0]):
            together = plan_many(
                [scenarios[i] for i in picked], [(1, 2, 0.9, 50)] * len(picked), seeds=picked, **arguments
            )
            assert together.lengths.tolist() == [alone[i] for i in picked]
