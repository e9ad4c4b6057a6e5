"""MovingAI maps and scenario files: classes of terrain, versions, line ends, and what is refused by line."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from antgym.errors import MapError, ScenarioError
from antgym.maps.formats.movingai import (
    map_bytes,
    read_movingai,
    read_rows,
    read_terrain,
    scen_bytes,
)
from antgym.maps.motion import Motion
from antgym.maps.world import GridWorld, Scenario

MAP = "type octile\nheight 3\nwidth 4\nmap\n..GS\n@TWW\nb.OW\n"
HEADER = "version 1\n"
ROW = "0\tmaps/dao/field.map\t4\t3\t0\t0\t3\t0\t3.0\n"


@pytest.fixture
def write(tmp_path):
    def write_file(text, name="field.map"):
        path = tmp_path / name
        path.write_bytes(text.encode() if isinstance(text, str) else text)
        return path

    return write_file


def test_x_counts_columns_and_y_rows_from_the_top(write):
    world = read_movingai(write(MAP)).world
    assert world.free[:, :, 0].T.tolist() == [[1, 1, 1, 1], [0, 0, 0, 0], [1, 1, 0, 0]]


def test_line_ends_of_windows_and_a_header_in_either_order_are_read(write):
    windows = MAP.replace("height 3\nwidth 4", "width 4\nheight 3").replace("\n", "\r\n") + "\r\n"
    assert (read_movingai(write(windows)).world.free == read_movingai(write(MAP)).world.free).all()


def test_one_walks_within_a_class_of_terrain(write):
    terrain = read_terrain(write(MAP))
    assert [int(terrain.walkable(letter).free_count) for letter in ".GSBWT@O"] == [6, 6, 6, 6, 3, 1, 2, 2]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", r"field\.map:0: ''; a MovingAI map begins"),
        (MAP.replace("octile", "tile"), r"field\.map:1: 'type tile'"),
        (MAP.replace("width 4", "depth 4"), r"field\.map:3: 'depth 4'"),
        (MAP.replace("width 4", "height 4"), r"field\.map:3: 'height 4'"),
        (MAP.replace("height 3", "height x"), r"field\.map:2: height: 'x' must be a whole number"),
        (MAP.replace("height 3", "height 0"), r"field\.map:2: height: '0'"),
        (MAP.replace("height 3", "height 1000000000"), r"from 1 to 65,536"),
        (MAP.replace("height 3", "height 65536").replace("width 4", "width 65536"), r"65,536 x 65,536 cells"),
        (MAP.replace("@TWW", "@TW"), r"field\.map:6: 3 letters in a row, the header promises 4"),
        (MAP.replace("@TWW", "@TWß"), r"field\.map:6: unknown letter 'ß' in column 3"),
        (MAP.replace("b.OW\n", ""), r"ends after 2 of the 3 rows"),
        (MAP + "....\n", r"field\.map:8: more than the 3 rows"),
    ],
)
def test_bad_maps_are_refused_by_line(write, text, message):
    with pytest.raises(MapError, match=message):
        read_movingai(write(text))


def test_rows_of_every_version_are_read_and_their_map_is_found_by_its_base_name(write):
    write(MAP)
    for text in (HEADER + ROW, "version 1.0\n" + ROW.replace("\t", " "), "0 field.map 0 0 3 0 3.0\n"):
        rows = read_rows(write(text, "a.scen"))
        assert [(row.start, row.goal, row.length, row.bucket) for row in rows] == [((0, 0), (3, 0), 3.0, 0)]
        assert rows.scenario(0).optimum == 3.0
        assert rows.map_path.name == "field.map"


def test_a_map_that_was_renamed_is_found_by_the_name_of_its_scenario_file(write):
    write(MAP, "mine.map")
    assert read_rows(write(HEADER + ROW, "mine.map.scen")).scenario(0).optimum == 3.0


def test_a_row_walks_within_the_class_that_it_starts_on(write):
    write(MAP)
    rows = read_rows(write(HEADER + ROW.replace("0\t0\t3\t0", "2\t1\t3\t2"), "a.scen"))
    assert rows.scenario(0).world.free_count == 3
    assert rows.scenario(0, Motion("grid8", corners="one")).optimum == pytest.approx(2**0.5)


@pytest.mark.parametrize(
    ("row", "message"),
    [
        (ROW.replace("\t3.0", ""), r"a\.scen:2: 8 fields in a row"),
        (ROW.replace("\t3.0", "\tnan"), r"a\.scen:2: 'nan' is not a number"),
        (ROW.replace("\t3.0", "\t-1"), r"a\.scen:2: a length of -1.0 is negative"),
        (ROW.replace("3\t0\t3.0", "3\t-1\t3.0"), r"a\.scen:2: '-1' must be a whole number"),
        (ROW + ROW.replace("field", "other"), r"a\.scen:3: a second map, 'maps/dao/other.map'"),
        ("\n", r"a\.scen: no rows"),
    ],
)
def test_bad_rows_are_refused_by_line(write, row, message):
    with pytest.raises(MapError, match=message):
        read_rows(write(HEADER + row, "a.scen"))


@pytest.mark.parametrize(
    ("ends", "message"),
    [
        ("0\t0\t0\t0", r"a\.scen:2: start and goal are the same cell"),
        ("0\t0\t3\t1", r"a\.scen:2: goal \(3, 1, 0\) is blocked"),
        ("0\t0\t9\t0", r"a\.scen:2: goal \(9, 0, 0\) lies outside"),
        ("9\t0\t0\t0", r"a\.scen:2: start \(9, 0\) lies outside"),
    ],
)
def test_rows_that_cannot_be_planned_are_kept_and_refused_when_asked_for(write, ends, message):
    write(MAP)
    rows = read_rows(write(HEADER + ROW.replace("0\t0\t3\t0", ends), "a.scen"))
    assert len(rows) == 1
    with pytest.raises(ScenarioError, match=message):
        rows.scenario(0)


def test_a_row_for_a_map_of_another_size_is_refused(write):
    write(MAP)
    rows = read_rows(write(HEADER + ROW.replace("4\t3\t0", "8\t6\t0"), "a.scen"))
    with pytest.raises(ScenarioError, match=r"a map of \(8, 6\) cells is expected.* has \(4, 3\)"):
        rows.scenario(0)


@settings(deadline=None)
@given(
    cells=st.integers(1, 9).flatmap(
        lambda n: st.lists(st.lists(st.booleans(), min_size=n, max_size=n), min_size=1)
    )
)
def test_what_is_written_is_read_as_an_equal_world(tmp_path_factory, cells):
    world = GridWorld(np.array(cells), (1.0, 1.0, 1.0))
    path = tmp_path_factory.mktemp("maps") / "world.map"
    path.write_bytes(map_bytes(world))
    again = read_movingai(path).world
    assert (again.shape, again.cell, again.bits.tolist()) == (world.shape, world.cell, world.bits.tolist())


def test_scenarios_are_written_with_their_optimum_in_cells(write, tmp_path):
    world = GridWorld(np.ones((5, 4)), (2.0, 2.0, 2.0))
    ways = [Scenario(world, (0, 0), (4, 3), Motion(name)) for name in ("grid4", "grid8")]
    (tmp_path / "w.map").write_bytes(map_bytes(world))
    rows = read_rows(write(scen_bytes(ways, "w.map"), "w.map.scen"))
    assert [row.length for row in rows] == [pytest.approx(1 + 3 * 2**0.5)] * 2
    assert rows.scenario(1).optimum == pytest.approx(rows[1].length)


def test_worlds_that_are_not_flat_or_not_square_are_not_written():
    with pytest.raises(MapError, match=r"write a \.3dmap"):
        map_bytes(GridWorld(np.ones((2, 2, 2)), (1.0, 1.0, 1.0)))
    with pytest.raises(MapError, match="cells of equal edges"):
        map_bytes(GridWorld(np.ones((2, 2)), (1.0, 2.0, 1.0)))


@pytest.mark.parametrize("name", ["x" * 3000, "a\0b", "..", "/"])
def test_names_that_no_map_can_have_are_no_map(write, name):
    rows = read_rows(write(HEADER + ROW.replace("maps/dao/field.map", name), "gone.scen"))
    with pytest.raises(MapError, match="no such file"):
        rows.scenario(0)
