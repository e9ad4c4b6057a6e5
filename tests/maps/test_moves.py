"""Moves: legal as the motion rules say, within reach as far as they lead, and greed as a slow walker has it."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from scenarios import CELLS, GRIDS, drawn, grids, layered, scenarios

from antgym.maps.motion import REACH, Motion, move_table
from antgym.maps.moves import PATIENCE, fewest_moves, greedy_walk, legal_moves, within_reach
from antgym.maps.optimum import shortest_path
from antgym.maps.world import GridWorld, Scenario


@settings(deadline=None, max_examples=40)
@given(scenario=layered(max_side=5))
def test_legal_moves_are_those_of_the_definition(scenario):
    table, (_, ny, nz) = move_table(scenario.motion), scenario.world.shape
    cells = np.argwhere(scenario.world.free[: scenario.goal[0]])
    cells = cells[cells[:, 0] >= scenario.start[0]]
    for cell, legal in zip(cells, legal_moves(scenario, cells), strict=True):
        for k in range(len(table.steps)):
            crossed = [tuple((cell + part[k]).tolist()) for part in (table.before, table.after, table.steps)]
            inside = all(0 <= y < ny and 0 <= z < nz for _, y, z in crossed)
            left = np.abs(np.subtract(scenario.goal, crossed[2]))
            in_reach = left[1:].max() <= REACH * left[0]
            assert legal[k] == (inside and in_reach and all(scenario.world.free[c] for c in crossed))


def may_pass(scenario, cell, step):
    """Whether a grid allows a step, by its corner rule in words: cells of the box it spans, looked at one by one."""
    free = {tuple(c) for c in np.argwhere(scenario.world.free).tolist()}
    box = {
        tuple(int(c + on * d) for c, on, d in zip(cell, corner, step, strict=True))
        for corner in np.ndindex(2, 2, 2)
    }
    end = tuple(int(c + d) for c, d in zip(cell, step, strict=True))
    sides = box - {end, tuple(cell.tolist())}
    rule = {"both": all, "one": any, "cut": lambda _: True}[scenario.motion.corners]
    return end in free and (not sides or rule([side in free for side in sides]))


@settings(deadline=None, max_examples=60)
@given(scenario=grids(max_side=4))
def test_legal_moves_of_a_grid_keep_its_corner_rule(scenario):
    cells, steps = np.argwhere(scenario.world.free), move_table(scenario.motion).steps
    for cell, legal in zip(cells, legal_moves(scenario, cells), strict=True):
        assert legal.tolist() == [may_pass(scenario, cell, step) for step in steps]


def test_reach_is_a_double_cone_with_its_tips_at_start_and_goal():
    reach = within_reach(Scenario(GridWorld(np.ones((7, 9, 9))), (1, 4, 0), (5, 8, 0)))
    assert reach.sum(axis=(1, 2)).tolist() == [1, 15, 25, 9, 1]
    assert np.argwhere(reach[0]).tolist() == [[4, 0]]
    assert np.argwhere(reach[-1]).tolist() == [[8, 0]]


def test_the_reach_of_a_grid_is_an_ellipse_round_start_and_goal():
    reach = within_reach(Scenario(GridWorld(np.ones((11, 9))), (3, 4), (7, 4), Motion("grid8")))[:, :, 0]
    assert "".join("#" if cell else "." for cell in reach[:, 4]) == "..#######.."
    assert "".join("#" if cell else "." for cell in reach[5]) == "..#####.."


@settings(deadline=None, max_examples=40)
@given(scenario=grids())
def test_start_and_goal_of_a_grid_are_within_reach(scenario):
    reach = within_reach(scenario)
    assert reach.shape == scenario.world.shape
    assert reach[scenario.start]
    assert reach[scenario.goal]


@settings(deadline=None, max_examples=40)
@given(scenario=scenarios())
def test_an_open_world_is_crossed_in_the_fewest_moves(scenario):
    world = GridWorld(np.ones(scenario.world.shape), CELLS[0])
    empty = Scenario(world, scenario.start, scenario.goal, scenario.motion)
    assert len(shortest_path(empty)) - 1 == fewest_moves(empty)


def slow_walk(scenario):
    """The same greedy ant, one comparison at a time: the cells it goes to."""
    table, path = move_table(scenario.motion), [scenario.start]
    centre = scenario.world.centre
    most = scenario.layers if scenario.motion.layered else PATIENCE * fewest_moves(scenario)
    while path[-1] != scenario.goal and len(path) <= most:
        best, to = math.inf, None
        legal = legal_moves(scenario, np.array([path[-1]]))[0]
        for step in table.steps[legal]:
            cell = tuple(np.add(path[-1], step).tolist())
            way = math.dist(centre(cell), centre(path[-1])) + math.dist(centre(cell), centre(scenario.goal))
            if cell not in path and way < best * (1 - 1e-12):
                best, to = way, cell
        if to is None:
            break
        path.append(to)
    return path


@settings(deadline=None, max_examples=60)
@given(scenario=scenarios())
def test_a_greedy_ant_goes_where_a_slow_one_goes(scenario):
    """In cubes: in boxes of odd shapes two moves can be equally good up to the last bit."""
    scenario = Scenario(GridWorld(scenario.world.free), scenario.start, scenario.goal, scenario.motion)
    walk, path = greedy_walk(scenario), scenario.world.centre(slow_walk(scenario))
    assert walk.arrived == (math.dist(path[-1], scenario.world.centre(scenario.goal)) == 0)
    assert walk.length == pytest.approx(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())


@settings(deadline=None, max_examples=40)
@given(scenario=scenarios())
def test_a_greedy_ant_that_arrives_is_no_shorter_than_the_optimum(scenario):
    walk = greedy_walk(scenario)
    assert 0 <= walk.progress <= 1
    if walk.arrived:
        assert walk.progress == 1
        assert walk.length >= scenario.optimum


def test_a_greedy_ant_on_a_grid_is_caught_by_a_pocket():
    pocket = ["S......", "..###..", "..#.#..", "..###..", "......G"]
    walk = greedy_walk(drawn(pocket, Motion("grid8")))
    assert walk.arrived
    trap = ["....#..", "S...#.G", "....#..", "#####.."]
    walk = greedy_walk(drawn(trap, Motion("grid8")))
    assert not walk.arrived
    assert walk.progress == pytest.approx(3 / 6)


@pytest.mark.parametrize("motion", GRIDS, ids=str)
def test_a_greedy_ant_gives_up_in_time(motion):
    free = np.ones((40, 40, 1))
    free[20, 1:39] = 0  # no gap but at the rims, and it may not go back
    scenario = Scenario(GridWorld(free), (18, 20, 0), (22, 20, 0), motion)
    walk = greedy_walk(scenario)
    longest = np.sqrt(3) * 15 * PATIENCE * fewest_moves(scenario)
    assert not walk.arrived
    assert walk.length <= longest
