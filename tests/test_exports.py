"""Exports: what is written is what was found, and maps are written as the files that their names say."""

import csv
import io
import json
import math

import numpy as np
import pytest

import antgym
from antgym.errors import AntgymError, MapError
from antgym.exports import path_csv, poses, poses_json
from antgym.maps.formats.elevation import HeightField, read_heights
from antgym.maps.ground import over
from antgym.maps.map import Frame, Map
from antgym.maps.motion import Motion
from antgym.maps.world import GridWorld, Scenario

UNIT = (1.0, 1.0, 1.0)


def test_a_path_as_csv_holds_cells_and_points_to_the_last_bit():
    cells, points = np.array([[0, 1, 2], [1, 1, 2]]), np.array([[0.1, 1 / 3, 2e-9], [1, 2, 3]])
    rows = list(csv.DictReader(io.StringIO(path_csv(cells, points).decode())))
    assert [[int(row[k]) for k in "ijk"] for row in rows] == cells.tolist()
    assert [[float(row[k]) for k in "xyz"] for row in rows] == points.tolist()


def test_poses_head_for_the_next_way_point():
    found = json.loads(poses_json(np.array([[0, 0, 0], [1, 0, 0], [1, 2, 0], [0, 2, 0.0]])))
    assert found["header"] == {"frame_id": "map"}
    yaws = [
        2 * math.atan2(p["pose"]["orientation"]["z"], p["pose"]["orientation"]["w"]) for p in found["poses"]
    ]
    assert yaws == pytest.approx([0, math.pi / 2, math.pi, math.pi])
    assert found["poses"][2]["pose"]["position"] == {"x": 1, "y": 2, "z": 0}


@pytest.mark.parametrize("count", [0, 1])
def test_no_path_and_one_point_have_poses_too(count):
    found = poses(np.zeros((count, 3)), "odom")
    assert [pose["header"]["frame_id"] for pose in found["poses"]] == ["odom"] * count


def flat(cell=UNIT, yaw=0.25):
    world = GridWorld(np.random.default_rng(0).random((6, 4)) > 0.3, cell)
    return Map(world, Motion("grid8"), Frame((1.0, -2.0, 0.0), yaw, "m"), "made", "made")


@pytest.mark.parametrize("name", ["a.map", "a.3dmap", "a.yaml", "a.bt"])
def test_a_map_is_written_as_its_name_says_and_read_again_as_an_equal_world(tmp_path, name):
    if name.endswith("yaml"):
        pytest.importorskip("yaml")
        pytest.importorskip("PIL")
    map_ = flat(yaw=0.0 if name.endswith("bt") else 0.25)
    files = antgym.write_map(tmp_path / name, map_)
    again = antgym.read_map(tmp_path / name)
    assert sorted(files) == sorted(tmp_path.iterdir())
    assert (again.world.cell, again.world.bits.tolist()) == (map_.world.cell, map_.world.bits.tolist())
    assert again.frame == map_.frame or not name.endswith(("yaml", "bt"))


def test_an_elevation_is_written_as_its_heights(tmp_path):
    field = HeightField(np.arange(6.0).reshape(2, 3), (2.0, 2.0), "made")
    antgym.write_map(tmp_path / "a.asc", over(field))
    assert read_heights(tmp_path / "a.asc").heights.tolist() == field.heights.tolist()


def test_scenarios_are_written_beside_their_map(tmp_path):
    world = GridWorld(np.ones((4, 4, 2)), UNIT)
    scenario = Scenario(world, (0, 0, 0), (3, 3, 1), Motion("grid26"))
    antgym.write_map(tmp_path / "a.3dmap", world)
    antgym.write_scenarios(tmp_path / "a.3dmap.3dscen", [scenario])
    assert antgym.read_scenarios(tmp_path / "a.3dmap.3dscen").scenario(0).digest == scenario.digest


def test_what_a_file_cannot_hold_is_refused_and_nothing_is_written(tmp_path):
    other = Scenario(flat().world, *np.argwhere(flat().world.free)[[0, -1]].tolist(), Motion("grid8"))
    cases = (
        (lambda: antgym.write_map(tmp_path / "a.stl", flat()), r"unknown kind of map file '\.stl'"),
        (lambda: antgym.write_map(tmp_path / "a.map", flat((1.0, 2.0, 1.0))), "cells of equal edges"),
        (lambda: antgym.write_map(tmp_path / "a.asc", flat()), "only a map of heights"),
        (lambda: antgym.write_scenarios(tmp_path / "a.txt", [other]), "unknown kind of scenario file"),
        (lambda: antgym.write_scenarios(tmp_path / "a.scen", []), "at least one"),
    )
    for write, message in cases:
        with pytest.raises(MapError, match=message):
            write()
    with pytest.raises(AntgymError, match="cannot be written"):
        antgym.write_map("/dev/null/a.map", flat())
    assert list(tmp_path.iterdir()) == []
