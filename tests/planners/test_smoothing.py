"""Smoothing: never through a blocked cell, never longer, and the shortest that the path's own cells allow."""

from itertools import combinations, pairwise

import numpy as np
import pytest
import scenarios
from discs import among
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from reference import lines

import antgym
from antgym import GridWorld, Motion, Scenario, load_suite, plan, smooth
from antgym.errors import AntgymError, ParameterError, ScenarioError
from antgym.maps.motion import move_table
from antgym.maps.moves import legal_moves
from antgym.maps.optimum import shortest_path

METHODS = ("shortcut", "spline")


@st.composite
def walks(draw, most=12):
    """A scenario under any motion, and a walk of legal moves in it that may wind and cross itself."""
    scenario = draw(scenarios.scenarios(max_side=8).filter(lambda s: s.motion.check_segments))
    steps, rng = move_table(scenario.motion).steps, np.random.default_rng(draw(st.integers(0, 10**6)))
    path = [np.array(scenario.start)]
    for _ in range(min(most, scenario.layers) if scenario.motion.layered else most):
        legal = np.flatnonzero(legal_moves(scenario, path[-1][None])[0])
        if not len(legal):
            break
        path.append(path[-1] + steps[rng.choice(legal)])
    assume(len(path) > 1 and any((cell != path[0]).any() for cell in path))
    return scenario, np.array(path)


def length(points):
    return np.linalg.norm(np.diff(points, axis=0), axis=1).sum()


@settings(deadline=None)
@given(walks(), st.sampled_from(METHODS))
def test_a_smoothed_path_enters_no_blocked_cell_and_is_not_longer(walk, method):
    scenario, path = walk
    found = smooth(path, scenario, method)
    in_cells = found.points / scenario.world.cell
    assert not lines.enters(scenario.world, in_cells)
    assert in_cells[[0, -1]] == pytest.approx(path[[0, -1]] + 0.5)
    assert found.length == pytest.approx(length(found.points))
    assert found.before == pytest.approx(length(path * scenario.world.cell))
    assert found.length <= found.before * (1 + 1e-12)


@settings(deadline=None)
@given(walks())
def test_the_lines_of_a_shortcut_keep_the_corner_rule(walk):
    scenario, path = walk
    rule = "cut" if scenario.motion.layered else scenario.motion.corners
    cells = np.round(smooth(path, scenario, "shortcut").points / scenario.world.cell - 0.5).astype(int)
    assert all(lines.keeps_corners(scenario.world, rule, *ends) for ends in pairwise(cells.tolist()))


@settings(deadline=None, max_examples=50)
@given(walks(most=7))
def test_no_other_choice_of_the_path_s_cells_is_shorter(walk):
    scenario, path = walk
    rule = "cut" if scenario.motion.layered else scenario.motion.corners
    path = path[np.append(True, (np.diff(path, axis=0) != 0).any(axis=1))]
    last, shortest = len(path) - 1, np.inf
    pairs = combinations(range(last + 1), 2)
    clear = {
        (i, j): lines.keeps_corners(scenario.world, rule, path[i], path[j])
        for i, j in pairs
        if (path[i] != path[j]).any()
    }
    for count in range(last):
        for kept in combinations(range(1, last), count):
            chosen = [0, *kept, last]
            if all(clear.get(pair, True) for pair in pairwise(chosen)):
                shortest = min(shortest, length(path[chosen] * scenario.world.cell))
    assert smooth(path, scenario, "shortcut").length == pytest.approx(shortest)


@settings(deadline=None)
@given(walks())
def test_the_curve_itself_enters_no_blocked_cell_and_is_smooth(walk):
    scenario, path = walk
    curve = smooth(path, scenario).curve
    at = np.linspace(0, 1, 5001)
    in_cells = curve(at) / scenario.world.cell
    cells = np.floor(in_cells).astype(int)
    deep = (np.abs(in_cells - cells - 0.5) < 0.5 - 1e-9).all(axis=1)
    assert scenario.world.free[tuple(cells[deep].T)].all()
    inner, step = curve.t[4:-4], 1e-7
    for order, slack in ((0, 1e-3), (1, 1e-2), (2, 1e-1)):
        scale = np.abs(curve(at, order)).max() + 1e-9
        assert curve(inner - step, order) == pytest.approx(curve(inner + step, order), abs=slack * scale)


@settings(deadline=None, max_examples=20)
@given(walks())
def test_the_points_of_a_spline_lie_on_it(walk):
    scenario, path = walk
    found = smooth(path, scenario)
    near = found.curve(np.linspace(0, 1, 20001))
    off = [np.linalg.norm(near - point, axis=1).min() for point in found.points]
    assert max(off) <= length(near) / 1000


def test_a_staircase_becomes_a_line():
    world = GridWorld(np.ones((9, 9)), (2.0, 2.0, 2.0))
    scenario = Scenario(world, (0, 0), (8, 8), Motion("grid4"))
    found = smooth(shortest_path(scenario), scenario, "shortcut")
    assert found.points.tolist() == [[1, 1, 1], [17, 17, 1]]
    assert (found.before, found.length) == pytest.approx((32, 16 * 2**0.5))
    rounded = smooth(shortest_path(scenario), scenario, "spline")
    assert rounded.length == pytest.approx(found.length)


def test_a_pillar_is_passed_as_closely_as_the_corner_rule_allows():
    """Under "both" a line may not touch the pillar's corner, under "cut" it may."""
    picture = ["S....", ".....", "..#..", ".....", "....G"]
    seen = {}
    for rule in ("both", "cut"):
        scenario = scenarios.drawn(picture, Motion("grid8", corners=rule))
        path = np.array([(0, 0, 0), (1, 1, 0), (1, 2, 0), (2, 3, 0), (3, 4, 0), (4, 4, 0)])
        if rule == "both":
            path = np.array([(0, 0, 0), (1, 1, 0), (1, 2, 0), (1, 3, 0), (2, 3, 0), (3, 4, 0), (4, 4, 0)])
        seen[rule] = smooth(path, scenario, "shortcut").length / 15
    assert seen["both"] > seen["cut"] > 4 * 2**0.5


def test_a_colony_s_path_over_mountains_gets_shorter():
    item = load_suite("mountain-v0", "test")[0]
    found = plan(item.scenario, (1.0, 0.2, 0.9, 100.0), ants=20, iterations=40)
    shortcut, spline = (smooth(found.path, item.scenario, method) for method in METHODS)
    assert spline.length < shortcut.length < shortcut.before == pytest.approx(found.length)
    assert (shortcut.curve, shortcut.method) == (None, "shortcut")
    assert len(spline.points) > len(shortcut.points)


def test_a_room_that_leaves_no_space_is_still_rounded():
    """A corridor one cell wide with a bend: the curve stays in the bend's own cell."""
    scenario = scenarios.drawn(["S...#", "###.#", "###.#", "###G#"], Motion("grid8"))
    found = smooth(shortest_path(scenario), scenario)
    assert found.length < found.before
    assert not lines.enters(scenario.world, found.points / 15)
    turns = np.diff(found.points, axis=0)
    turns /= np.linalg.norm(turns, axis=1)[:, None]
    assert (turns[1:] * turns[:-1]).sum(axis=1).min() > 0.9  # no corner is left


PATH = np.array([[0, 0, 0], [1, 1, 0], [2, 2, 0]])
OPEN = Scenario(GridWorld(np.ones((3, 3))), (0, 0), (2, 2), Motion("grid8"))
BAD = {
    "unknown method": (lambda: smooth(PATH, OPEN, "splines"), ParameterError, "did you mean 'spline'"),
    "no path": (lambda: smooth(PATH[:0], OPEN), ParameterError, "at least two"),
    "one cell": (lambda: smooth(PATH[[0, 0]], OPEN), ParameterError, "at least two"),
    "points": (lambda: smooth(PATH + 0.5, OPEN), ParameterError, "integer cells"),
    "flat cells": (lambda: smooth(PATH[:, :2], OPEN), ParameterError, "integer cells"),
    "outside": (
        lambda: smooth(PATH + np.eye(3, dtype=int)[1], OPEN),
        ScenarioError,
        r"cell 2 of the path, \(2, 3, 0\)",
    ),
    "among discs": (lambda: smooth(PATH, among((5, 5, 1))), ParameterError, "among discs"),
}


@pytest.mark.parametrize(("call", "kind", "words"), BAD.values(), ids=BAD)
def test_what_cannot_be_smoothed_is_said(call, kind, words):
    with pytest.raises(kind, match=words) as error:
        call()
    assert isinstance(error.value, AntgymError)


def test_a_path_that_clips_a_blocked_cell_is_refused():
    """Moves of two cells are not looked at in between by liu2020's own motion; smoothing would have to."""
    free = np.ones((2, 3, 1), bool)
    free[0, 1] = free[1, 1] = False
    scenario = Scenario(GridWorld(free), (0, 0), (1, 2), Motion(check_segments=False))
    with pytest.raises(ScenarioError, match=r"between \(0, 0, 0\) and \(1, 2, 0\); .*check_segments"):
        smooth(shortest_path(scenario), scenario)


def test_smooth_is_a_public_name():
    assert antgym.smooth is smooth
