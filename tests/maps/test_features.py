"""Features: bounded on any world, blind to units and to the optimum, and right on worlds drawn by hand."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from antgym.maps.features import FEATURES, describe, feature_table, legal_moves, within_reach
from antgym.maps.motion import REACH, Motion, move_table
from antgym.maps.world import GridWorld, Scenario

NAMES = [feature.name for feature in FEATURES]


@st.composite
def scenarios(draw, max_side=7):
    """Boxes of any shape with random cells, start and goal anywhere that the motion allows."""
    shape = (draw(st.integers(2, max_side)), draw(st.integers(1, max_side)), draw(st.integers(1, max_side)))
    rng = np.random.default_rng(draw(st.integers(0, 10**6)))
    first, last = sorted(rng.choice(shape[0], 2, replace=False).tolist())
    start = (first, *(int(rng.integers(n)) for n in shape[1:]))
    reach = REACH * (last - first)
    near = (
        int(np.clip(c + rng.integers(-reach, reach + 1), 0, n - 1))
        for c, n in zip(start[1:], shape[1:], strict=True)
    )
    goal = (last, *near)
    free = rng.random(shape) < draw(st.floats(0.2, 1))
    free[start] = free[goal] = True
    cell = draw(st.sampled_from([(15.0, 15.0, 15.0), (1.0, 0.5, 8.0), (2.0, 300.0, 0.01)]))
    return Scenario(GridWorld(free, cell), start, goal, Motion(check_segments=draw(st.booleans())))


def named(scenario):
    return dict(zip(NAMES, describe(scenario).tolist(), strict=True))


def drawn(layers):
    """A world one cell high from a picture: a line per layer along x, a character per cell along y."""
    free = np.array([[c != "#" for c in line] for line in layers])[:, :, None]
    (first, y0), (last, y1) = (
        next((x, line.index(c)) for x, line in enumerate(layers) if c in line) for c in "SG"
    )
    return Scenario(GridWorld(free), (first, y0, 0), (last, y1, 0))


@settings(deadline=None)
@given(scenario=scenarios())
def test_features_are_finite_and_within_their_bounds(scenario):
    values = describe(scenario)
    assert values.dtype == np.float32
    assert values.shape == (len(FEATURES),)
    for value, feature in zip(values, FEATURES, strict=True):
        assert feature.low <= value <= feature.high, feature.name


def test_features_never_ask_for_the_optimum(valley, monkeypatch):
    monkeypatch.setattr(Scenario, "optimum", property(lambda self: pytest.fail("asked for the optimum")))
    describe(valley)


@settings(deadline=None, max_examples=40)
@given(scenario=scenarios())
def test_features_do_not_depend_on_the_unit_of_length(scenario):
    edges = tuple(4 * edge for edge in scenario.world.cell)
    world = GridWorld(scenario.world.free, edges)
    assert (
        describe(scenario) == describe(Scenario(world, scenario.start, scenario.goal, scenario.motion))
    ).all()


@settings(deadline=None, max_examples=40)
@given(scenario=scenarios(max_side=5))
def test_features_do_not_change_in_the_mirror(scenario):
    """A greedy ant may break its ties the other way there, and a straight line may round the other way."""
    ny = scenario.world.shape[1]
    ends = [(x, ny - 1 - y, z) for x, y, z in (scenario.start, scenario.goal)]
    mirrored = Scenario(GridWorld(scenario.world.free[:, ::-1], scenario.world.cell), *ends, scenario.motion)
    kept = [i for i, name in enumerate(NAMES) if not name.startswith("greedy") and name != "blocked_on_line"]
    assert describe(scenario)[kept] == pytest.approx(describe(mirrored)[kept], abs=1e-6)


@settings(deadline=None, max_examples=40)
@given(scenario=scenarios(max_side=5))
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


def test_reach_is_a_double_cone_with_its_tips_at_start_and_goal():
    reach = within_reach(Scenario(GridWorld(np.ones((7, 9, 9))), (1, 4, 0), (5, 8, 0)))
    assert reach.sum(axis=(1, 2)).tolist() == [1, 15, 25, 9, 1]
    assert np.argwhere(reach[0]).tolist() == [[4, 0]]
    assert np.argwhere(reach[-1]).tolist() == [[8, 0]]


def test_an_open_world_holds_no_obstacle_and_no_dead_end():
    values = named(Scenario(GridWorld(np.ones((21, 20, 20))), (0, 10, 3), (20, 10, 3)))
    zero = (
        "layers",
        "width",
        "height",
        "blocked",
        "blocked_in_reach",
        "blocked_on_line",
        "offset_y",
        "offset_z",
    )
    assert [values[name] for name in (*zero, "dead_ends", "full_columns", "column_max", "roughness")] == [
        0.0
    ] * 12
    assert (values["greedy_arrives"], values["greedy_progress"], values["narrowest_layer"]) == (1, 1, 1)
    assert values["greedy_detour"] == pytest.approx(0, abs=1e-6)


def test_a_blind_valley_stops_the_greedy_ant_but_not_the_path():
    trap = drawn(["...S......", ".....#....", ".....#....", ".....#....", "#####.....", "...G......"])
    open_end = drawn(["...S......", "..........", "..........", "..........", "#####.....", "...G......"])
    assert (named(trap)["greedy_arrives"], named(trap)["greedy_detour"]) == (0, 1)
    assert named(trap)["greedy_progress"] == pytest.approx(3 / 5)
    assert named(trap)["dead_ends"] > named(open_end)["dead_ends"]


def test_obstacles_are_measured_where_they_stand():
    values = named(drawn(["..S..", "####.", ".....", "..G.."]))
    assert values["blocked"] == pytest.approx(4 / 20)
    assert values["narrowest_layer"] == pytest.approx(1 / 5)
    assert values["full_columns"] == pytest.approx(4 / 20)
    assert 0 < values["blocked_on_line"] < 0.5


def test_columns_are_as_high_as_their_topmost_blocked_cell():
    free = np.ones((3, 2, 4))
    free[1, 1, 2] = 0
    values = named(Scenario(GridWorld(free), (0, 0, 0), (2, 0, 0)))
    assert values["column_max"] == pytest.approx(3 / 4)
    assert values["column_mean"] == pytest.approx(3 / 4 / 6)
    assert values["roughness"] == pytest.approx(3 * 0.75 / 7)


def test_the_table_shows_every_feature_once():
    rows = feature_table().splitlines()[2:]
    assert [row.split(" | ")[1] for row in rows] == NAMES
    assert len(set(NAMES)) == len(NAMES)
