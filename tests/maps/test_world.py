"""Worlds and scenarios: what cannot be planned is named at the border, and what can never changes."""

import ast
import copy
import pickle

import numpy as np
import pytest

from antgym.errors import MapError, ScenarioError
from antgym.maps.motion import Motion
from antgym.maps.optimum import shortest_path
from antgym.maps.world import GridWorld, Scenario

ENDS = (0, 1, 1), (3, 1, 1)


def box(blocked=(), shape=(4, 5, 3), cell=(15.0, 15.0, 15.0)):
    """A free box with some cells blocked; a None blocks everything along its axis."""
    free = np.ones(shape, np.uint8)
    for cells in blocked:
        free[tuple(slice(None) if i is None else i for i in cells)] = 0
    return GridWorld(free, cell)


@pytest.mark.parametrize(
    ("free", "message"),
    [
        (np.ones(3), r"got shape \(3,\)"),
        (np.ones((3, 3, 3, 1)), r"got shape \(3, 3, 3, 1\)"),
        (np.ones((3, 0)), r"got shape \(3, 0\)"),
        (np.full((2, 2), 255, np.uint8), "only 0 .blocked. and 1 .free."),
        (np.ones((3, 0, 3)), r"got shape \(3, 0, 3\)"),
        (np.full((2, 2, 2), 2), "only 0 .blocked. and 1 .free."),
        (np.full((2, 2, 2), np.nan), "only 0 .blocked. and 1 .free."),
        (np.full((2, 2, 2), 0.5), "threshold it first"),
    ],
)
def test_what_is_no_grid_is_refused(free, message):
    with pytest.raises(MapError, match=message):
        GridWorld(free)


@pytest.mark.parametrize(
    "cell", [(1, 1), (1, 0, 1), (1, -1, 1), (1, 1, np.nan), (1, 1, np.inf), (1, 1, 1, 1)]
)
def test_a_cell_without_three_positive_edges_is_refused(cell):
    with pytest.raises(MapError, match="cell edges must be three positive numbers"):
        GridWorld(np.ones((2, 2, 2)), cell)


@pytest.mark.parametrize("kind", [bool, np.uint8, int, float])
def test_zeros_and_ones_of_any_kind_make_the_same_world(kind):
    free = np.random.default_rng(0).random((3, 4, 5)) < 0.5
    world = GridWorld(free.astype(kind))
    assert world.free.dtype == np.uint8
    assert (world.free == free).all()
    assert world.free_count == free.sum()


def test_a_world_is_a_copy_that_nobody_can_write_to():
    free = np.ones((3, 3, 3), np.uint8)
    world = GridWorld(free)
    free[:] = 0
    assert world.free.all()
    for array in (world.free, world.storage):
        with pytest.raises(ValueError, match="read-only"):
            array[0, 0, 0] = 1


def test_storage_is_the_world_within_blocked_borders():
    world = box()
    assert world.storage.shape == (8, 9, 7)
    assert world.storage.sum() == world.free.sum()
    assert np.shares_memory(world.storage, world.free)


def test_a_flat_world_is_one_cell_high():
    free = np.random.default_rng(0).random((4, 5)) < 0.5
    flat, high = GridWorld(free), GridWorld(free[:, :, None])
    assert flat.shape == (4, 5, 1)
    assert (flat.storage == high.storage).all()


def test_cells_of_a_flat_world_need_no_height():
    world = GridWorld(np.ones((4, 5)))
    scenario = Scenario(world, (0, 1), (3, 1))
    assert (scenario.start, scenario.goal) == ((0, 1, 0), (3, 1, 0))
    assert scenario.digest == Scenario(world, (0, 1, 0), (3, 1, 0)).digest


def test_centres_lie_half_a_cell_from_the_corner():
    assert box(cell=(10.0, 4.0, 2.0)).centre([(0, 0, 0), (1, 2, 3)]).tolist() == [[5, 2, 1], [15, 10, 7]]


@pytest.mark.parametrize(
    ("start", "goal", "message"),
    [
        ((0, 1, 2), (3, 1, 1), r"start \(0, 1, 2\) is blocked; the nearest free cell is \(0, 1, 1\)"),
        ((0, 1, 1), (3, 4, 1), r"goal \(3, 4, 1\) is blocked; the nearest free cell is \(3, 3, 1\)"),
        ((0, 1, 1), (4, 1, 1), r"goal \(4, 1, 1\) lies outside the world of \(4, 5, 3\) cells"),
        ((0, -1, 1), (3, 1, 1), r"start \(0, -1, 1\) lies outside"),
        ((0, 1), (3, 1, 1), r"start \(0, 1\) lies outside"),
        ((2, 1, 1), (2, 1, 1), r"start and goal are the same cell \(2, 1, 1\)"),
        ((2, 1, 1), (2, 2, 1), r"goal \(2, 2, 1\) must lie in a later layer than start \(2, 1, 1\)"),
        ((3, 1, 1), (0, 1, 1), "swap them or rotate the world"),
        ((0, 0, 1), (1, 4, 1), r"out of reach of start \(0, 0, 1\): 1 layers allow 2 cells"),
    ],
)
def test_a_start_or_goal_that_cannot_be_used_is_named(start, goal, message):
    world = box(blocked=[(0, None, 2), (1, 1, 2), (3, 4, None), (2, 4, 1)])
    with pytest.raises(ScenarioError, match=message):
        Scenario(world, start, goal)


@pytest.mark.parametrize("name", ["grid4", "grid8"])
def test_a_flat_motion_in_a_high_world_is_named(name):
    with pytest.raises(
        ScenarioError, match=rf"the {name} motion needs a world one cell high, got \(4, 5, 3\)"
    ):
        Scenario(box(), *ENDS, Motion(name))


@pytest.mark.parametrize("motion", [Motion("grid8"), Motion("grid26")])
def test_a_grid_leads_anywhere_but_to_its_start(motion):
    world = GridWorld(np.ones((4, 9)))
    assert Scenario(world, (3, 8), (0, 0), motion).optimum == pytest.approx(15 * (3 * np.sqrt(2) + 5))
    assert Scenario(world, (3, 8), (3, 0), motion).optimum == pytest.approx(15 * 8)
    with pytest.raises(ScenarioError, match="start and goal are the same cell"):
        Scenario(world, (3, 8), (3, 8), motion)


def test_only_layered_paths_have_a_number_of_layers():
    with pytest.raises(ScenarioError, match="the grid26 motion has no layers"):
        _ = Scenario(box(), *ENDS, Motion("grid26")).layers


def test_a_world_without_a_free_cell_is_named():
    with pytest.raises(ScenarioError, match="so is every cell of the world"):
        Scenario(box(blocked=[(None, None, None)]), *ENDS)


@pytest.mark.parametrize("ask", [lambda s: s.optimum, shortest_path])
def test_a_scenario_without_a_path_is_named(ask):
    scenario = Scenario(box(blocked=[(2, None, None)]), *ENDS, name="walled in")
    with pytest.raises(
        ScenarioError, match=r"no path leads from \(0, 1, 1\) to \(3, 1, 1\) in scenario 'walled in'"
    ):
        ask(scenario)


def test_a_scenario_knows_its_layers_and_straight_line():
    scenario = Scenario(box(cell=(3.0, 4.0, 5.0)), (1, 0, 1), (3, 3, 1))
    assert scenario.layers == 2
    assert scenario.straight_line == pytest.approx(np.hypot(6, 12))


def test_cells_become_plain_integers():
    scenario = Scenario(box(), np.array(ENDS[0]), np.array(ENDS[1]))
    assert (scenario.start, scenario.goal) == ENDS
    assert {type(i) for i in scenario.start + scenario.goal} == {int}


def test_the_digest_changes_with_every_ingredient():
    worlds = [
        box(),
        box(blocked=[(1, 2, 2)]),
        box(cell=(15.0, 15.0, 15.1)),
        box(shape=(4, 3, 5)),
        box(shape=(5, 5, 3)),
    ]
    scenarios = [Scenario(world, *ENDS) for world in worlds]
    scenarios += [
        Scenario(box(), (0, 1, 0), ENDS[1]),
        Scenario(box(), ENDS[0], (3, 2, 1)),
        Scenario(box(), *ENDS, Motion(check_segments=False)),
        Scenario(box(), *ENDS, Motion("grid26")),
        Scenario(box(), *ENDS, Motion("grid26", corners="cut")),
    ]
    assert len({scenario.digest for scenario in scenarios}) == len(scenarios)


def test_the_digest_does_not_change_with_the_name_or_the_array_given():
    one = Scenario(box(), *ENDS, name="one")
    other = Scenario(
        GridWorld(np.asfortranarray(np.ones((4, 5, 3))), (15, 15, 15)), *map(np.array, ENDS), name="other"
    )
    assert one.digest == other.digest


def test_another_motion_is_another_question():
    scenario = Scenario(box(), *ENDS)
    loose = scenario.with_motion(Motion(check_segments=False))
    assert loose.motion != scenario.motion
    assert loose.digest != scenario.digest
    assert scenario.with_motion(scenario.motion).digest == scenario.digest


def test_descriptors_are_read_only():
    with pytest.raises(ValueError, match="read-only"):
        Scenario(box(), *ENDS).descriptors[0] = 1


@pytest.mark.parametrize("duplicate", [copy.deepcopy, lambda scenario: pickle.loads(pickle.dumps(scenario))])
def test_a_copy_is_the_same_question_and_read_only_too(duplicate):
    """A writable copy would also make the kernels compile for a second type of array."""
    scenario = Scenario(box(blocked=[(1, 2, 2)]), *ENDS, name="a")
    _ = scenario.optimum, scenario.descriptors
    again = duplicate(scenario)
    assert (again.digest, again.name, again.optimum) == (scenario.digest, "a", scenario.optimum)
    arrays = (again.world.free, again.world.storage, again.descriptors)
    assert not any(array.flags.writeable for array in arrays)
    assert np.shares_memory(again.world.free, again.world.storage)


@pytest.mark.parametrize("start", [(0, 1.9, 2), ("0", 1, 2), None])
def test_a_cell_that_is_no_whole_indices_is_refused(start):
    with pytest.raises(ScenarioError, match=r"start = .*whole indices"):
        Scenario(GridWorld(np.ones((4, 4, 4), bool)), start, (3, 1, 1))


@pytest.mark.parametrize("shape", [(1, 1, 1), (8, 3, 5), (9, 7, 1), (17, 5, 4)])
def test_planes_are_those_of_the_world(shape):
    world = GridWorld(np.random.default_rng(3).random(shape) < 0.5)
    for first in range(shape[0] + 1):
        for last in range(first, shape[0] + 1):
            assert world.planes(first, last).tolist() == world.free[first:last].tolist()


def test_a_large_world_is_hashed_pickled_and_refused_without_being_unpacked():
    """A cube of 512 cells a side is 17 MB of bits, and 138 MB unpacked."""
    free = np.ones((40, 40, 40), bool)
    free[:30] = False
    free[0, 0, 0] = True
    scenario = Scenario(GridWorld(free), (0, 0, 0), (39, 20, 20))
    assert len(pickle.dumps(scenario)) < 1.5 * len(scenario.world.bits) + 1000
    assert pickle.loads(pickle.dumps(scenario)).digest == scenario.digest
    with pytest.raises(ScenarioError, match=r"nearest free cell is \(30, 20, 20\)"):
        Scenario(scenario.world, (20, 20, 20), (39, 20, 20))
    assert "storage" not in vars(scenario.world)


@pytest.mark.parametrize("seed", range(30))
def test_the_nearest_free_cell_is_the_nearest(seed):
    rng = np.random.default_rng(seed)
    free = rng.random((9, 6, 7)) < 0.03
    free[tuple(rng.integers(0, free.shape))] = True
    blocked = tuple(rng.permutation(np.argwhere(~free))[0].tolist())
    with pytest.raises(ScenarioError, match="nearest free cell is") as caught:
        Scenario(GridWorld(free), blocked, (8, 0, 0))
    near = ast.literal_eval(str(caught.value).rsplit("is ", 1)[1])
    steps = np.abs(np.argwhere(free) - blocked).sum(axis=1)
    assert free[near]
    assert np.abs(np.subtract(near, blocked)).sum() == steps.min()
