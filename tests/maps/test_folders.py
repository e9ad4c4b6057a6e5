"""A folder of map files in the place of a suite, and the places that are drawn on maps that name none."""

import os

import numpy as np
import pytest

from antgym.errors import AntgymError, MapError, ParameterError
from antgym.exports import write_map, write_scenarios
from antgym.maps.folders import load_folder
from antgym.maps.formats.elevation import HeightField
from antgym.maps.ground import over
from antgym.maps.map import Frame, Map
from antgym.maps.motion import Motion
from antgym.maps.pairs import components, drawn
from antgym.maps.world import GridWorld, Scenario

UNIT = (1.0, 1.0, 1.0)


def floor(seed, side=12, blocked=0.2):
    return GridWorld(np.random.default_rng(seed).random((side, side)) >= blocked, UNIT)


def as_map(world, motion="grid8"):
    return Map(world, Motion(motion), Frame(), "made", "made")


@pytest.fixture
def folder(tmp_path):
    """Two maps, one of them with a scenario file, and what is no map."""
    write_map(tmp_path / "one.map", floor(1))
    world = GridWorld(np.ones((9, 9)), UNIT)
    write_map(tmp_path / "two.map", world)
    ways = [Scenario(world, (0, 0), (8, y), Motion("grid8")) for y in range(9)]
    write_scenarios(tmp_path / "two.map.scen", ways)
    (tmp_path / "notes.md").write_text("mine")
    return tmp_path


def test_maps_with_a_scenario_file_give_its_rows_and_others_give_pairs(folder):
    items = load_folder(folder)
    names = [item.name for item in items]
    assert names[:9] == [f"two.map.scen:{line}" for line in range(2, 11)]
    assert names[9:] == [f"one.map#{i}" for i in range(10)]
    assert {(item.rules, item.ants, item.iterations) for item in items} == {("ant_colony_system", 20, 100)}
    assert all(item.scenario.optimum > 0 for item in items)


def test_rows_that_cannot_be_planned_are_passed_over(folder):
    with (folder / "two.map.scen").open("a") as file:
        file.write("0\ttwo.map\t9\t9\t3\t3\t3\t3\t0\n")
    assert len([item for item in load_folder(folder) if ".scen" in item.name]) == 9


def test_many_rows_are_taken_evenly(folder):
    (folder / "suite.toml").write_text("scenarios = 3\n")
    assert [item.name for item in load_folder(folder)][:3] == [f"two.map.scen:{line}" for line in (2, 6, 10)]


def test_settings_hold_for_every_map_and_rules_take_turns(folder):
    (folder / "suite.toml").write_text(
        'rules = ["wei2018", "max_min"]\nants = 5\niterations = 7\nscenarios = 2\n'
    )
    items = load_folder(folder)
    assert [item.rules for item in items] == ["wei2018", "max_min"] * 2
    assert {(item.ants, item.iterations) for item in items} == {(5, 7)}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("ant = 5\n", r"suite\.toml: unknown setting 'ant'; did you mean 'ants'"),
        ("ants = 0\n", r"suite\.toml: ants = 0: needs a whole number"),
        ('ants = "5"\n', r"ants = '5': needs a whole number"),
        ("rules = 5\n", "rules = 5: needs a list of names"),
        ("ants = \n", r"suite\.toml: not TOML .*line 1"),
    ],
)
def test_bad_settings_are_named(folder, text, message):
    (folder / "suite.toml").write_text(text)
    with pytest.raises(ParameterError, match=message):
        load_folder(folder)


def test_the_picture_of_a_yaml_map_is_no_map_of_its_own(tmp_path):
    pytest.importorskip("yaml")
    pytest.importorskip("PIL")
    write_map(tmp_path / "room.yaml", as_map(floor(2)))
    assert {item.name.split("#")[0] for item in load_folder(tmp_path)} == {"room.yaml"}


def test_folders_in_it_are_its_splits(folder):
    (folder / "test").mkdir()
    write_map(folder / "test" / "three.map", floor(3))
    assert {item.name.split("#")[0] for item in load_folder(folder, "test")} == {"three.map"}
    assert len(load_folder(folder)) == 19
    with pytest.raises(ParameterError, match=r"has no folder 'ood'; it has test"):
        load_folder(folder, "ood")


def test_the_same_objects_come_until_a_file_changes(folder):
    first = load_folder(folder)
    assert load_folder(folder) is first
    os.utime(folder / "one.map", ns=(1, 1))
    assert load_folder(folder) is not first


def test_folders_without_maps_and_maps_without_ways_are_refused(tmp_path):
    with pytest.raises(MapError, match=r"holds no map; it needs files that end in \.map"):
        load_folder(tmp_path)
    write_map(tmp_path / "shut.map", GridWorld(np.zeros((4, 4)), UNIT))
    with pytest.raises(MapError, match=r"shut\.map: no two places that are joined"):
        load_folder(tmp_path)
    (tmp_path / "shut.map").write_text("type octile\n")
    with pytest.raises(AntgymError, match=r"shut\.map"):
        load_folder(tmp_path)


@pytest.mark.parametrize("seed", range(5))
def test_places_are_drawn_in_the_largest_part_and_are_the_same_for_the_same_world(seed):
    map_ = as_map(floor(seed, blocked=0.4))
    parts = components(map_.world)
    pairs = drawn(map_, 6)
    assert len(pairs) == 6
    for scenario in pairs:
        assert {parts.labels[scenario.start], parts.labels[scenario.goal]} == {parts.sizes.argmax() + 1}
        assert scenario.optimum >= scenario.straight_line > 0
    assert [pair.digest for pair in drawn(map_, 6)] == [pair.digest for pair in pairs]
    assert len({pair.digest for pair in pairs}) > 1


def test_on_ground_ways_lead_over_the_surface_from_the_first_layer_to_the_last():
    heights = np.random.default_rng(0).random((20, 15)) * 30
    pairs = drawn(over(HeightField(heights, (10.0, 10.0), "hills")), 4)
    assert len(pairs) == 4
    assert {(pair.start[0], pair.goal[0]) for pair in pairs} == {(0, 19)}
    assert all(pair.world.free[pair.start[:2]].argmax() == pair.start[2] for pair in pairs)
