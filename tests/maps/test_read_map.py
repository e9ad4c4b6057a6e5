"""The one entry point: every map beside a developer's checkout is read; options, ends and places of any map."""

import subprocess
import sys

import numpy as np
import pytest

pytest.importorskip("yaml")
pytest.importorskip("PIL")

import antgym
from antgym.errors import AntgymError, MapError, MissingExtraError, ScenarioError
from antgym.maps.formats.pictures import encoded
from antgym.maps.map import Frame, Map
from antgym.maps.motion import Motion
from antgym.maps.readers import KINDS, read_map, read_scenarios, suffix_of
from antgym.maps.world import GridWorld

OPTIONS = {"dem": {"fill": 0.0}}
NO_MAPS = {"house_places.json", "README.md"}  # and tables, scenario files, the robot


def map_files(folder):
    for path in sorted(folder.rglob("*")):
        if (
            path.is_file()
            and path.parent.name != "robot"
            and path.name not in NO_MAPS
            and suffix_of(path) in KINDS
        ):
            yield path


def test_every_map_file_beside_the_checkout_is_read(shared_data):
    kinds = {}
    for path in map_files(shared_data):
        options = OPTIONS.get(path.parent.name, {})
        if path.suffix == ".npz":
            options = {**options, "pixel": 85.0}  # in degrees
        map_ = read_map(path, **options)
        assert 0 < map_.world.free_count < map_.world.size or path.name == "empty-16-16.map", path
        kinds.setdefault(map_.kind, []).append(path.name)
    assert {kind: len(names) for kind, names in kinds.items()} == {
        "MovingAI map": 20,
        "OctoMap": 2,
        "ROS 2 map": 5,
        "elevation": 4,
        "picture": 8,
        "scene": 6,
        "voxel map": 2,
    }


def test_every_scenario_file_beside_the_checkout_is_read(shared_data):
    files = [path for path in sorted(shared_data.rglob("*scen")) if path.suffix in (".scen", ".3dscen")]
    checks = [shared_data / folder / "checks.csv" for folder in ("movingai2d", "mapf")]
    flat = sum(len(path.read_text().splitlines()) - 1 for path in checks)
    assert sum(len(read_scenarios(path)) for path in files) == flat + 400


@pytest.fixture
def room(tmp_path):
    """A yaml map of 4 x 3 cells of half a metre, one of them blocked."""
    levels = np.full((3, 4), 254, np.uint8)
    levels[2, 1] = 0
    (tmp_path / "room.pgm").write_bytes(encoded(levels, "PPM"))
    (tmp_path / "room.yaml").write_text(
        "image: room.pgm\nresolution: 0.5\norigin: [-1, -1, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n"
    )
    return tmp_path / "room.yaml"


def test_the_public_name_reads(room):
    assert antgym.read_map(str(room)).world.shape == (4, 3, 1)


def test_a_robot_of_some_radius_finds_less_room(room):
    assert [read_map(room, radius=r).world.free_count for r in (0, 0.25, 0.3, 0.8)] == [11, 11, 8, 1]


def test_options_that_a_kind_does_not_know_are_refused_with_those_that_it_does(room, tmp_path):
    with pytest.raises(MapError, match=r"a \.yaml file has no option 'fill'; did you mean 'ros'"):
        read_map(room, fill=1.0)
    (tmp_path / "a.map").write_text("type octile\nheight 1\nwidth 1\nmap\n.\n")
    with pytest.raises(MapError, match=r"a \.map file has no option 'cell'; it takes none"):
        read_map(tmp_path / "a.map", cell=1.0)
    assert read_map(tmp_path / "a.map", cell=None).world.size == 1


@pytest.mark.parametrize("name", ["a.tiff", "a", "a.map.txt2", "a.gz"])
def test_unknown_kinds_name_those_that_are_known(tmp_path, name):
    with pytest.raises(MapError, match=r"unknown kind of map file .*; did you mean"):
        read_map(tmp_path / name)
    with pytest.raises(MapError, match=r"unknown kind of scenario file"):
        read_scenarios(tmp_path / name)


@pytest.mark.parametrize("suffix", KINDS)
def test_files_that_are_not_there_and_folders_are_refused(tmp_path, suffix):
    (tmp_path / f"folder{suffix}").mkdir()
    for name in ("none", "folder"):
        with pytest.raises(AntgymError, match=rf"{name}\{suffix}.*: no such file"):
            read_map(tmp_path / f"{name}{suffix}")


@pytest.mark.parametrize(("suffix", "library"), [(".yaml", "PyYAML"), (".png", "Pillow")])
def test_without_its_library_the_remedy_is_named(room, tmp_path, monkeypatch, suffix, library):
    (tmp_path / "room.png").write_bytes(encoded(np.zeros((2, 2), np.uint8)))
    monkeypatch.setitem(sys.modules, {"PyYAML": "yaml", "Pillow": "PIL"}[library], None)
    with pytest.raises(MissingExtraError, match=rf"{library} is not installed.*antgym\[maps\]"):
        read_map(room.with_suffix(suffix))


def test_readers_import_no_library_before_they_need_it():
    script = "import antgym.maps.readers, sys; print([n for n in ('PIL', 'yaml', 'matplotlib') if n in sys.modules])"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_a_picture_with_a_relief_is_an_elevation(tmp_path):
    (tmp_path / "hill.png").write_bytes(encoded(np.array([[0, 255, 0]], np.uint8)))
    map_ = read_map(tmp_path / "hill.png", relief=(100.0, 200.0), pixel=50.0, levels=3)
    assert map_.heights.tolist() == [[100], [200], [100]]
    assert map_.world.free[:, 0].tolist() == [[1, 1, 1], [0, 0, 1], [1, 1, 1]]
    assert map_.motion.layered


def flat(free, **frame):
    return Map(GridWorld(np.array(free), (0.5, 0.5, 0.5)), Motion("grid8"), Frame(**frame), "made", "made")


def test_places_are_cells_or_coordinates_and_whatever_is_meant_is_told():
    map_ = flat(np.ones((4, 3)), origin=(-1.0, -1.0, 0.0), unit="m")
    assert map_.end((3, 2), "start") == (3, 2, 0)
    assert map_.end((0.75, 0.25), "start", "map") == (3, 2, 0)
    for numbers, unit, message in (
        ((0.75, 0.25), "cells", "cells have whole indices; are these coordinates"),
        ((4, 0), "cells", r"outside the map: 4 x 3 cells, counted from 0; x -1 to 1, y -1 to 0.5 m"),
        ((1.5, 0), "map", "outside the map"),
        ((float("nan"), 0), "map", "is not a point"),
        ((1,), "map", "got 1 numbers"),
    ):
        with pytest.raises(ScenarioError, match=message):
            map_.end(numbers, "start", unit)


def test_coordinates_find_their_cells_on_whatever_side_rounding_falls():
    map_ = flat(np.ones((50, 1)), origin=(0.1, 0.0, 0.0))
    borders = 0.1 + 0.5 * np.arange(50)
    assert [map_.cell((x, 0.0, 0.0))[0] for x in borders] == list(range(50))
