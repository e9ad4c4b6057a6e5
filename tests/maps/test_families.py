"""That every family has the character it claims: worlds are built for a reason, and seen to be so."""

from itertools import product

import numpy as np
import pytest
from scipy.ndimage import binary_closing, label

from antgym.maps.generators import FAMILIES
from antgym.maps.generators.draws import has_path
from antgym.maps.generators.solids import bowl, box, cup, nothing
from antgym.maps.motion import Motion, move_table, step_lengths
from antgym.maps.moves import legal_moves
from antgym.maps.world import GridWorld, Scenario

FLAT = ("rooms", "mazes", "clutter", "warehouse")
LAYERED = tuple(family for family in FAMILIES if family not in FLAT)


def many(family, count=40, size=21):
    return [FAMILIES[family](np.random.default_rng([seed, size]), size) for seed in range(count)]


def floor(scenario):
    return scenario.world.free[:, :, 0].astype(bool)


def greed_arrives(scenario):
    """Walk as an ant that always takes the shortest step + distance to the goal."""
    steps, edges = move_table(scenario.motion).steps, np.array(scenario.world.cell)
    lengths = step_lengths(scenario.motion, scenario.world.cell)
    cell, goal = np.array(scenario.start), np.array(scenario.goal)
    while (cell != goal).any():
        legal = legal_moves(scenario, cell[None])[0]
        if not legal.any():
            return False
        left = np.linalg.norm((cell + steps - goal) * edges, axis=1)
        cell = cell + steps[np.where(legal, lengths + left, np.inf).argmin()]
    return True


@pytest.mark.parametrize("family", LAYERED)
def test_greed_dies_in_some_scenarios_of_every_layered_family_and_arrives_in_others(family):
    dead = np.mean([not greed_arrives(scenario) for scenario in many(family)])
    assert 0.2 <= dead <= 0.9


@pytest.mark.parametrize("family", FAMILIES)
def test_scenarios_of_a_family_differ_in_detour_and_density(family):
    scenarios = many(family)
    for values in (
        [s.optimum / s.straight_line for s in scenarios],
        [1 - s.world.free.mean() for s in scenarios],
    ):
        low, high = np.quantile(values, [0.1, 0.9])
        assert high - low > 0.07


def test_most_pockets_are_deadly_for_greed():
    assert np.mean([not greed_arrives(scenario) for scenario in many("pockets")]) >= 0.5


@pytest.mark.parametrize("check_segments", [True, False])
@pytest.mark.parametrize("shape", ["cup", "bowl"])
def test_nothing_gets_out_of_a_pocket_but_by_its_mouth(shape, check_segments):
    blocked = nothing(17)
    if shape == "cup":
        cup(blocked, (3, 3, 4), (13, 14, 13))
    else:
        blocked |= bowl(17, (3.0, 8.2, 7.9), 8.0, 5.0)
    motion = Motion(check_segments=check_segments)
    inside = [(5, y, z) for y, z in np.argwhere(~blocked[5]) if 5 <= y <= 11 and 6 <= z <= 10]
    assert len(inside) == 35
    for start, goal in product(inside, ((16, 8, 8), (16, 0, 0), (16, 16, 8))):
        assert not has_path(Scenario(GridWorld(~blocked), start, goal, motion))
    assert has_path(Scenario(GridWorld(~blocked), (0, 0, 0), (16, 8, 8), motion))


def test_a_cup_at_the_border_keeps_its_whole_inside():
    blocked, full = nothing(9), nothing(9)
    cup(blocked, (2, -1, 0), (6, 5, 9))
    box(full, (2, 0, 0), (6, 5, 9))
    assert not blocked[2:4, 0:3].any()
    assert blocked[4:6, 0:5].all()
    assert blocked[2:6, 3:5].all()
    assert not (blocked & ~full).any()


def test_ridges_are_two_cells_thick_and_reach_the_ceiling_or_nearly():
    for scenario in many("ridges"):
        blocked = scenario.world.free == 0
        padded = np.pad(blocked, ((1, 1), (0, 0), (0, 0)), constant_values=True)
        assert (padded[:-2] | padded[2:])[blocked].all()
        columns = blocked[blocked.any(axis=2)]
        heights = columns.shape[1] - columns[:, ::-1].argmax(axis=1)
        assert np.mean(heights >= 16) > 0.5


def test_trunks_reach_from_floor_to_ceiling():
    scenarios = many("forest")
    assert all((s.world.free == s.world.free[:, :, :1]).all() for s in scenarios)
    assert np.mean([label(~floor(s))[1] for s in scenarios]) > 4


def test_boxes_stand_and_float():
    for scenario in many("boxes"):
        blocked = scenario.world.free == 0
        assert 0.15 <= blocked.mean() <= 0.65
    floating = [(s.world.free[:, :, 1:] < s.world.free[:, :, :-1]).any() for s in many("boxes")]
    assert np.mean(floating) > 0.5


def test_caves_are_mostly_rock_in_few_pieces():
    for scenario in many("caves"):
        assert 0.54 <= 1 - scenario.world.free.mean() <= 0.81


def test_start_and_goal_lie_in_different_rooms():
    """With every gap up to two cells closed, as doors are, no way is left between them."""
    apart = []
    for scenario in many("rooms", size=31):
        blocked = np.pad(~floor(scenario), 3)
        for door in (np.ones((3, 1)), np.ones((1, 3))):
            blocked |= binary_closing(blocked, door)
        parts = label(~blocked[3:-3, 3:-3])[0]
        start, goal = parts[scenario.start[:2]], parts[scenario.goal[:2]]
        if start and goal:  # neither stands in a gap itself
            apart.append(start != goal)
    assert len(apart) >= 20
    assert all(apart)


def graph(free):
    """Return the cells, the sides that two of them share, and the cells that have but one such side."""
    sides = np.zeros(np.add(free.shape, 2), dtype=int)
    for shift, axis in ((1, 0), (-1, 0), (1, 1), (-1, 1)):
        sides += np.roll(np.pad(free, 1), shift, axis)
    degrees = sides[1:-1, 1:-1][free]
    return len(degrees), degrees.sum() // 2, (degrees == 1).sum()


def test_mazes_have_dead_ends_and_some_have_loops():
    narrow = [floor(s) for s in many("mazes", count=60)]
    narrow = [f for f in narrow if not (f[1:, 1:] & f[:-1, 1:] & f[1:, :-1] & f[:-1, :-1]).any()]
    cells, edges, ends = np.array([graph(free) for free in narrow]).T
    loops = edges - cells + 1
    assert len(narrow) >= 20
    assert np.mean(ends > 0) >= 0.8
    assert loops.min() <= 3
    assert loops.max() >= 20
    assert np.ptp(ends) >= 10


def test_clutter_blocks_fifteen_to_forty_percent_in_cells_or_blobs():
    worlds = [~floor(s) for s in many("clutter")]
    shares = np.array([blocked.mean() for blocked in worlds])
    blobs = np.array([blocked.sum() / label(blocked)[1] for blocked in worlds])
    assert 0.14 <= shares.min() <= 0.2
    assert 0.35 <= shares.max() <= 0.41
    assert blobs.max() > 5 * blobs.min()


def test_a_warehouse_is_racks_of_one_length_with_aisles_between_them():
    for scenario in many("warehouse"):
        blocked = ~floor(scenario)
        assert is_racks(blocked) or is_racks(blocked.T)


def is_racks(rows):
    """Whether rows with more than one blocked cell are many and all alike."""
    racks = rows[rows.sum(axis=1) > 1]
    return len(racks) >= 4 and (racks == racks[0]).all()
