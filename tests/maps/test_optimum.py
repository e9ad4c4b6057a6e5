"""The exact optimum: to the bit what Dijkstra by the book finds, under every motion and corner rule."""

import json
import os
import subprocess
import sys
from itertools import pairwise, permutations
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from reference import paths

from antgym.errors import ScenarioError
from antgym.maps import optimum
from antgym.maps.generators import random_arrival
from antgym.maps.motion import CORNERS, REACH, Motion
from antgym.maps.optimum import shortest_path
from antgym.maps.world import GridWorld, Scenario

GRIDS = [Motion(name, corners=corners) for name in CORNERS if name != "layered" for corners in CORNERS[name]]
MOTIONS = [Motion(), Motion(check_segments=False), *GRIDS]
edges = st.one_of(st.just((1.0, 1.0, 1.0)), st.tuples(*[st.floats(0.01, 100)] * 3))


@st.composite
def scenarios(draw, motions=tuple(MOTIONS)):
    """A small random world and two free cells in it; a path may or may not exist."""
    motion = draw(st.sampled_from(motions))
    flat = motion.name in ("grid4", "grid8")
    shape = (draw(st.integers(2, 7)), draw(st.integers(1, 7)), 1 if flat else draw(st.integers(1, 5)))
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    free = rng.random(shape) >= draw(st.sampled_from([0.0, 0.1, 0.3, 0.5]))
    start, goal = (tuple(rng.integers(0, n) for n in shape) for _ in range(2))
    if motion.layered or start == goal:
        start = (0, *start[1:])
        near = np.clip(goal[1:], np.subtract(start[1:], REACH), np.add(start[1:], REACH))
        goal = (shape[0] - 1, *near.tolist())
    free[start] = free[goal] = True
    return Scenario(GridWorld(free, draw(edges)), start, goal, motion)


def optimum_of(scenario):
    try:
        return scenario.optimum
    except ScenarioError:
        return np.inf


def turned(scenario, axes):
    """The same question in a world whose axes are exchanged."""
    world, order = scenario.world, list(axes)
    ends = (tuple(cell[axis] for axis in order) for cell in (scenario.start, scenario.goal))
    cell = tuple(world.cell[axis] for axis in order)
    return Scenario(GridWorld(world.free.transpose(order), cell), *ends, scenario.motion)


@settings(deadline=None, max_examples=300)
@given(scenario=scenarios())
def test_the_optimum_is_to_the_bit_what_dijkstra_by_the_book_finds(scenario):
    assert optimum_of(scenario) == paths.shortest(scenario)


@pytest.mark.parametrize("motion", GRIDS)
@pytest.mark.parametrize("seed", range(2))
def test_many_paths_of_one_length_are_told_apart_by_their_last_bit(motion, seed):
    """In open worlds sums of the same moves in another order differ by rounding; the smallest counts."""
    rng = np.random.default_rng(seed)
    free = rng.random((9, 8, 7) if motion.name == "grid26" else (30, 30, 1)) >= 0.05
    start, goal = (0, 0, 0), (8, 7, 4) if motion.name == "grid26" else (29, 17, 0)
    free[start] = free[goal] = True
    scenario = Scenario(GridWorld(free, tuple(rng.uniform(0.5, 2, 3))), start, goal, motion)
    assert scenario.optimum == paths.shortest(scenario)
    assert paths.length_along(scenario, shortest_path(scenario)) == scenario.optimum


@settings(deadline=None)
@given(scenario=scenarios())
def test_the_shortest_path_is_legal_and_as_long_as_the_optimum_says(scenario):
    if optimum_of(scenario) == np.inf:
        with pytest.raises(ScenarioError, match="no path leads"):
            shortest_path(scenario)
        return
    path = shortest_path(scenario)
    assert [tuple(path[0]), tuple(path[-1])] == [scenario.start, scenario.goal]
    assert paths.length_along(scenario, path) == scenario.optimum


@settings(deadline=None)
@given(scenario=scenarios(motions=tuple(GRIDS)))
def test_the_way_back_is_as_long_on_a_grid(scenario):
    back = Scenario(scenario.world, scenario.goal, scenario.start, scenario.motion)
    assert optimum_of(back) == pytest.approx(optimum_of(scenario), rel=1e-12)


@settings(deadline=None)
@given(scenario=scenarios(motions=tuple(MOTIONS[:2])))
def test_the_way_back_through_mirrored_layers_is_as_long(scenario):
    mirrored = GridWorld(scenario.world.free[::-1], scenario.world.cell)
    (xs, *start), (xg, *goal) = scenario.start, scenario.goal
    last = scenario.world.shape[0] - 1
    back = Scenario(mirrored, (last - xg, *goal), (last - xs, *start), scenario.motion)
    assert optimum_of(back) == pytest.approx(optimum_of(scenario), rel=1e-12)


@settings(deadline=None)
@given(scenario=scenarios())
def test_exchanged_axes_change_no_optimum(scenario):
    fixed = {"layered": 0, "grid4": 2, "grid8": 2}.get(scenario.motion.name)
    for axes in permutations(range(3)):
        if fixed is None or axes[fixed] == fixed:
            assert optimum_of(turned(scenario, axes)) == pytest.approx(optimum_of(scenario), rel=1e-12)


@settings(deadline=None)
@given(scenario=scenarios(motions=(Motion("grid8"),)))
def test_a_laxer_rule_never_lengthens_the_way(scenario):
    rules = [Motion("grid4"), *(Motion("grid8", corners=corners) for corners in CORNERS["grid8"])]
    lengths = [optimum_of(scenario.with_motion(rule)) for rule in rules]
    assert all(lax <= strict * (1 + 1e-12) for strict, lax in pairwise(lengths))


@settings(deadline=None)
@given(scenario=scenarios(motions=(Motion("grid8"), Motion("grid8", corners="cut"))))
def test_a_flat_world_is_a_voxel_world_one_cell_high(scenario):
    """The plain 26-neighbour motion has the plain 8-neighbour motion within."""
    assert optimum_of(scenario.with_motion(Motion("grid26", corners=scenario.motion.corners))) == optimum_of(
        scenario
    )


@pytest.mark.parametrize("motion", MOTIONS)
def test_a_heap_that_must_grow_finds_the_same(motion, monkeypatch):
    free = np.random.default_rng(5).random((30, 30, 1 if motion.name in ("grid4", "grid8") else 8)) < 0.9
    free[0, 0, 0] = free[-1, -1, 0] = True
    scenarios = [Scenario(GridWorld(free), (0, 0, 0), (29, 29, 0), motion) for _ in range(2)]
    _ = scenarios[0].optimum
    monkeypatch.setattr(optimum, "_HEAP", 2)
    assert scenarios[1].optimum == scenarios[0].optimum


@pytest.mark.parametrize("edge", [1e-9, 1e9])
def test_cells_of_any_proportion_are_searched_exactly(edge):
    free = np.random.default_rng(6).random((9, 9)) < 0.8
    free[0, 0] = free[-1, -1] = True
    scenario = Scenario(GridWorld(free, (edge, 1.0, 1.0)), (0, 0), (8, 8), Motion("grid8"))
    assert scenario.optimum == paths.shortest(scenario)


@pytest.mark.parametrize("motion", GRIDS)
def test_a_wall_leaves_no_path(motion):
    free = np.ones((7, 7, 1), bool)
    free[3] = False
    with pytest.raises(ScenarioError, match=rf"no path leads .* under the {motion.name} motion"):
        _ = Scenario(GridWorld(free), (0, 0), (6, 6), motion).optimum


@pytest.mark.parametrize(
    ("motion", "length"),
    [
        (Motion("grid4"), 20),
        (Motion("grid8"), 6 + 7 * np.sqrt(2)),
        (Motion("grid26"), 6 + 7 * np.sqrt(2)),
    ],
)
def test_an_empty_world_is_crossed_diagonally_first(motion, length):
    world = GridWorld(np.ones((14, 8)), (1, 1, 1))
    assert Scenario(world, (0, 0), (13, 7), motion).optimum == pytest.approx(length, rel=1e-14)


SCRIPT = """
import json
import test_optimum
print(json.dumps([found.hex() for found in test_optimum.found_in_fixed_worlds()]))
"""


def found_in_fixed_worlds():
    """Optima, and of the layered motions how often ants arrive that walk at random."""
    for seed, motion in enumerate(MOTIONS):
        flat = motion.name in ("grid4", "grid8")
        free = np.random.default_rng(seed).random((7, 7, 1 if flat else 3)) < 0.8
        free[0, 0, 0] = free[6, 6, 0] = True
        scenario = Scenario(GridWorld(free, (3.0, 2.0, 1.0)), (0, 0, 0), (6, 6, 0), motion)
        yield optimum_of(scenario)
        if motion.layered:
            yield random_arrival(scenario)


def test_interpreted_kernels_find_the_same_to_the_bit():
    tests = Path(__file__).parents[1]
    paths = os.pathsep.join(map(str, (tests.parent, tests, tests / "maps")))
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1", "PYTHONPATH": paths}
    done = subprocess.run([sys.executable, "-c", SCRIPT], env=environment, capture_output=True, check=True)
    assert json.loads(done.stdout) == [found.hex() for found in found_in_fixed_worlds()]


@pytest.mark.slow
def test_a_world_of_512_cubed_is_swept_in_rolling_planes():
    """Beside the world's bits, 17 MB, the sweep holds two planes of distances, 4 MB."""
    world = GridWorld(np.ones((512, 512, 512), np.uint8), (1, 1, 1))
    scenario = Scenario(world, (0, 3, 500), (511, 500, 7))  # 497 cells along y and 493 along z in 511 moves
    assert scenario.optimum == pytest.approx(493 * np.sqrt(3) + 4 * np.sqrt(2) + 14, rel=1e-12)
