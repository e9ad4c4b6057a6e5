"""Scenario files of flat maps and of voxels: versions, how their map is found, and what is refused by line."""

import gzip

import numpy as np
import pytest

from antgym.errors import MapError, ScenarioError
from antgym.maps.formats.movingai import map_bytes
from antgym.maps.formats.rows import read_rows, read_voxel_rows, scen_bytes, voxel_scen_bytes
from antgym.maps.formats.voxels import voxel_bytes
from antgym.maps.motion import Motion
from antgym.maps.world import GridWorld, Scenario

MAP = "type octile\nheight 3\nwidth 4\nmap\n..GS\n@TWW\nb.OW\n"
HEADER = "version 1\n"
ROW = "0\tmaps/dao/field.map\t4\t3\t0\t0\t3\t0\t3.0\n"
UNIT = (1.0, 1.0, 1.0)


@pytest.fixture
def write(tmp_path):
    def write_file(text, name="field.map"):
        path = tmp_path / name
        path.write_bytes(text.encode() if isinstance(text, str) else text)
        return path

    return write_file


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


def test_scenarios_are_written_with_their_optimum_in_cells(write, tmp_path):
    world = GridWorld(np.ones((5, 4)), (2.0, 2.0, 2.0))
    ways = [Scenario(world, (0, 0), (4, 3), Motion(name)) for name in ("grid4", "grid8")]
    (tmp_path / "w.map").write_bytes(map_bytes(world))
    rows = read_rows(write(scen_bytes(ways, "w.map"), "w.map.scen"))
    assert [row.length for row in rows] == [pytest.approx(1 + 3 * 2**0.5)] * 2
    assert rows.scenario(1).optimum == pytest.approx(rows[1].length)


@pytest.mark.parametrize("name", ["x" * 3000, "a\0b", "..", "/"])
def test_names_that_no_map_can_have_are_no_map(write, name):
    rows = read_rows(write(HEADER + ROW.replace("maps/dao/field.map", name), "gone.scen"))
    with pytest.raises(MapError, match="no such file"):
        rows.scenario(0)


def test_rows_on_voxels_are_written_and_read(tmp_path):
    world = GridWorld(np.ones((4, 5, 6)), UNIT)
    scenario = Scenario(world, (0, 0, 0), (3, 4, 5), Motion("grid26"))
    (tmp_path / "w.3dmap.gz").write_bytes(gzip.compress(voxel_bytes(world)))
    (tmp_path / "w.3dmap.3dscen").write_bytes(voxel_scen_bytes([scenario], "w.3dmap"))
    rows = read_voxel_rows(tmp_path / "w.3dmap.3dscen")
    assert rows[0].length == pytest.approx(scenario.optimum)
    assert rows.scenario(0).digest == scenario.digest


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("version 2\n", r":1: 'version 2'; a \.3dscen begins with: version 1"),
        ("version 1\n\n", r":2: the name of the map is missing"),
        ("version 1\na.3dmap\n", r"no rows"),
        ("version 1\na.3dmap\n0 0 0 1 1 1 1.7\n", r":3: 7 fields"),
        ("version 1\na.3dmap\n0 0 0 1 1 1 inf 1\n", r":3: 'inf' is not a number"),
    ],
)
def test_bad_rows_on_voxels_are_refused_by_line(tmp_path, text, message):
    (tmp_path / "a.3dscen").write_text(text)
    with pytest.raises(MapError, match=message):
        read_voxel_rows(tmp_path / "a.3dscen")
