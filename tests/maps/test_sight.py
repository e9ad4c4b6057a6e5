"""Sight: lines between cells against a slow twin in fractions, under every corner rule."""

import numpy as np
import pytest
import scenarios
from hypothesis import given, settings
from hypothesis import strategies as st
from reference import lines

from antgym.maps.motion import MOTIONS, Motion, move_table
from antgym.maps.sight import sees
from antgym.maps.world import GridWorld


def rule_of(motion):
    return "cut" if motion.layered else motion.corners


@st.composite
def pairs(draw):
    """A world under some motion and two free cells in it."""
    scenario = draw(scenarios.scenarios(max_side=9))
    return scenario.world, scenario.motion, scenario.start, scenario.goal


@settings(deadline=None)
@given(pairs())
def test_a_line_is_clear_where_the_slow_twin_says_so(pair):
    world, motion, here, there = pair
    expected = lines.keeps_corners(world, rule_of(motion), here, there)
    assert sees(world, motion, here, there) == sees(world, motion, there, here) == expected


@pytest.mark.parametrize("motion", [motion for motion in MOTIONS if motion.check_segments], ids=str)
def test_a_move_of_the_motion_is_a_line_that_is_clear(motion):
    """In random cells: what a motion's table lets pass, sight does, and nothing else of it."""
    rng, table = np.random.default_rng(0), move_table(motion)
    here = np.array([3, 3, 3 if motion.layered or motion.name == "grid26" else 0])
    for _ in range(200):
        free = rng.random((7, 7, 7 if here[2] else 1)) < 0.6
        free[tuple(here)] = True
        for step, required, either in zip(table.steps, table.required, table.either, strict=True):
            legal = free[tuple((here + required).T)].all() and free[tuple((here + either).T)].any()
            if free[tuple(here + step)]:
                assert sees(GridWorld(free), motion, here, here + step) == legal


def test_a_line_through_a_corner_follows_the_corner_rule():
    one, both = np.ones((2, 2), bool), np.eye(2, dtype=bool)
    one[0, 1] = False
    seen = {
        rule: [
            sees(GridWorld(free), Motion("grid8", corners=rule), (0, 0, 0), (1, 1, 0)) for free in (one, both)
        ]
        for rule in ("both", "one", "cut")
    }
    assert seen == {"both": [False, False], "one": [True, False], "cut": [True, True]}
