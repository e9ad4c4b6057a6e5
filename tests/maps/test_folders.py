"""A folder of map files in the place of a suite, and the places that are drawn on maps that name none."""

import os
from pathlib import Path

import numpy as np
import pytest

from antgym.errors import AntgymError, MapError, ParameterError, ScenarioError
from antgym.exports import write_map, write_scenarios
from antgym.maps.folders import load_folder
from antgym.maps.formats.elevation import HeightField
from antgym.maps.formats.pictures import encoded
from antgym.maps.ground import over
from antgym.maps.map import Frame, Map
from antgym.maps.motion import Motion
from antgym.maps.pairs import components, drawn
from antgym.maps.readers import KINDS, options_of, read_scenarios
from antgym.maps.suite_file import READING
from antgym.maps.suites import load_suite
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
        ("ants = true\n", "ants = True: needs a whole number"),
        ("ants = \n", r"suite\.toml: not TOML .*line 1"),
        (
            '["one.map"]\npixels = 5\n',
            r"suite\.toml: \['one\.map'\] unknown setting 'pixels'; did you mean 'pixel'",
        ),
        ('["one.map"]\nradius = "wide"\n', r"\['one\.map'\] radius = 'wide': needs a number"),
        ('["one.map"]\ncell = 0.5\n', r"one\.map: a \.map file has no option 'cell'"),
        ('["three.map"]\nants = 5\n', r"\['three\.map'\] matches no map; did you mean 'two\.map'"),
        ('["one.map"]\nstart = [1, 2]\n', r"suite\.toml: start and goal of one\.map come together"),
        (
            '["two.map"]\nradius = 1\n',
            r"two\.map\.scen says what is where .*; radius would make it another map",
        ),
        (f"ants = {'1' * 5000}\n", r"suite\.toml: not TOML"),
        (f"ants = 0x{'f' * 5000}\n", r"suite\.toml: not TOML"),
        (f"radius = {'1' * 400}\n", "needs a number"),
        ("longest = 0\n", "longest = 0: needs a number above 0"),
        ("split = 0.5\n", r"split = 0\.5: needs shares above 0 by split"),
        ("split = { train = 0.9, test = 0.2 }\n", "the shares add up to more than 1"),
        ("split = { trains = 0.9 }\n", "split: unknown split 'trains'; did you mean 'train'"),
        ("split = { test = 0.5 }\n", "split gives no share to 'train'"),
        ("split = { test = 0.9, train = 0.1 }\n", "0.1 of 2 maps leave train none"),
    ],
)
def test_bad_settings_are_named(folder, text, message):
    (folder / "suite.toml").write_text(text)
    with pytest.raises(AntgymError, match=message):
        load_folder(folder)


def test_a_table_holds_for_the_maps_that_its_name_matches(folder):
    (folder / "suite.toml").write_text(
        'ants = 5\nscenarios = 2\n["o*.map"]\nants = 7\nrules = ["max_min"]\nradius = 0.5\n["one.map"]\nants = 9\n'
    )
    found = {item.name: (item.ants, item.rules) for item in load_folder(folder)}
    rest = (5, "ant_colony_system")
    one = (9, "max_min")
    assert found == {"two.map.scen:2": rest, "two.map.scen:10": rest, "one.map#0": one, "one.map#1": one}


def test_what_is_said_of_every_map_is_asked_of_the_kinds_that_know_it(tmp_path):
    pytest.importorskip("PIL")
    for name in ("a.png", "b.png"):
        (tmp_path / name).write_bytes(encoded(np.full((4, 6), 255, np.uint8)))
    write_map(tmp_path / "c.map", floor(1))
    (tmp_path / "suite.toml").write_text('pixel = 0.5\nscenarios = 1\n["b.png"]\npixel = 0.25\ncell = 0.5\n')
    cells = {
        item.name: (item.scenario.world.shape[:2], item.scenario.world.cell[0])
        for item in load_folder(tmp_path)
    }
    assert cells == {"a.png#0": ((6, 4), 0.5), "b.png#0": ((3, 2), 0.5), "c.map#0": ((12, 12), 1.0)}


def test_a_map_may_have_one_scenario_that_is_named_in_cells_or_in_its_own_unit(folder):
    (folder / "suite.toml").write_text(
        '["two.map"]\nstart = [0, 8]\ngoal = [8.0, 0.0]\n'
        '["one.map"]\nstart = [0.5, 0.5]\ngoal = [11.5, 10.5]\nunit = "map"\n'
    )
    write_map(folder / "one.map", GridWorld(np.ones((12, 12)), UNIT))
    ends = {item.name: (item.scenario.start, item.scenario.goal) for item in load_folder(folder)}
    assert ends == {"one.map": ((0, 0, 0), (11, 10, 0)), "two.map": ((0, 8, 0), (8, 0, 0))}
    (folder / "suite.toml").write_text('["one.map"]\nstart = [0, 12]\ngoal = [0, 0]\n')
    with pytest.raises(ScenarioError, match=r"one\.map: start \(0, 12\) lies outside the map"):
        load_folder(folder)
    free = np.ones((12, 12))
    free[8, 0] = 0
    write_map(folder / "one.map", GridWorld(free, UNIT))
    (folder / "suite.toml").write_text('["one.map"]\nstart = [8, 0]\ngoal = [0, 0]\n')
    with pytest.raises(
        ScenarioError, match=r"one\.map: what suite\.toml says .*: start \(8, 0, 0\) is blocked"
    ):
        load_folder(folder)


def test_rows_are_no_longer_than_the_longest_and_a_seed_draws_them(folder):
    def names(settings):
        (folder / "suite.toml").write_text(settings)
        return [item.name for item in load_folder(folder) if item.name.startswith("two")]

    near = [f"two.map.scen:{line}" for line in range(2, 7)]  # lengths 8 to 9.7
    assert names("longest = 9.7\n") == near
    draws = [names(f"longest = 9.7\nscenarios = 3\nseed = {seed}\n") for seed in range(6)]
    assert all(len(draw) == 3 and set(draw) <= set(near) for draw in draws)
    assert len({tuple(draw) for draw in draws}) > 1
    (folder / "one.map").unlink()
    with pytest.raises(MapError, match=r"no row of its scenario files can be planned under its suite\.toml"):
        names("longest = 1\n")


def test_benchmarks_become_splits_of_a_suite_by_links_to_their_folders(tmp_path, shared_data):
    """As the README's table has it, of fewer rows: no map of a split is in the other, every length is as declared."""
    for split, name in (("validation", "mapf"), ("test", "movingai2d")):
        (tmp_path / split).symlink_to(shared_data / name)
    (tmp_path / "suite.toml").write_text("longest = 60\nscenarios = 2\nseed = 0\n")
    for split, maps in (("validation", 6), ("test", 12)):
        items = load_suite(str(tmp_path), split)
        assert len({item.scenario.world.bits.tobytes() for item in items}) == maps
        for item in items:
            scen, _, line = item.name.rpartition(":")
            row = next(row for row in read_scenarios(tmp_path / split / scen) if row.line == int(line))
            lies = scen.startswith("battleground")  # see the benchmark's README
            assert item.scenario.optimum == pytest.approx(row.length, abs=0.006) or lies
            assert row.length <= 60


def test_shares_split_the_maps_and_no_map_is_in_two_splits(tmp_path):
    for seed in range(10):
        write_map(tmp_path / f"{seed}.map", floor(seed))
    (tmp_path / "suite.toml").write_text(
        "scenarios = 1\nsplit = { train = 0.6, validation = 0.1, test = 0.3 }\n"
    )
    parts = [
        {item.name for item in load_suite(str(tmp_path), split)} for split in ("train", "validation", "test")
    ]
    assert [len(part) for part in parts] == [6, 1, 3]
    assert len(set.union(*parts)) == 10
    with pytest.raises(ParameterError, match=r"suite\.toml: split gives no share to 'ood', only"):
        load_folder(tmp_path, "ood")
    (tmp_path / "test").mkdir()
    with pytest.raises(ParameterError, match=r"split gives shares, but .* has a folder 'test'"):
        load_folder(tmp_path)


def test_settings_know_every_option_of_every_kind_of_map():
    kinds = {option for name in KINDS for option in options_of(Path(f"a{name}"))}
    assert {*READING} == kinds | {"relief"}


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


def test_a_folder_that_has_test_maps_alone_is_told_that_train_is_missing(tmp_path):
    (tmp_path / "test").mkdir()
    write_map(tmp_path / "test" / "one.map", floor(3))
    with pytest.raises(MapError, match=r"has no train split: its maps are all in test/, .* into \S+/train$"):
        load_folder(tmp_path)
    assert len(load_folder(tmp_path, "test")) > 0


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
