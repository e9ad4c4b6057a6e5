"""Scenes: JSON in and out, and what is wrong with a file said by field."""

import json

import pytest
from discs import disc_scenarios
from hypothesis import given

from antgym.errors import MapError, ScenarioError
from antgym.maps.scenes import read_discs, scene_of, scene_text

GOOD = {"start": [0, 0], "goal": [4, 6], "circles_x_y_r": [[1.5, 4.5, 1.5]]}


@given(scenario=disc_scenarios())
def test_a_scene_written_and_read_is_the_same_scenario(scenario):
    assert scene_of(scene_text(scenario)).digest == scenario.digest


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"start": None}, "start = None: must be two numbers"),
        ({"goal": [1]}, "goal = .* two numbers"),
        ({"goal": ["1", 2]}, "goal = .* two numbers"),
        ({"circles_x_y_r": [[1, 2]]}, "discs are an"),
        ({"circles_x_y_r": {"x": 1}}, "discs must be numbers"),
        ({"robot_radius": "0.2"}, "robot_radius must be numbers"),
        ({"robot_radus": 0.2}, "unknown field 'robot_radus'; did you mean 'robot_radius'"),
        ({"bounds_xmin_xmax_ymin_ymax": [0, 1]}, "bounds = .* four numbers"),
        ({"rects_x_y_w_h": []}, "the field 'rects_x_y_w_h': only discs can be obstacles"),
        ({"name": 3}, "name must be a text"),
        ({"circles_x_y_r": [[1, 2, 10**400]]}, "discs must be"),
    ],
)
def test_a_bad_field_is_named(tmp_path, changes, message):
    path = tmp_path / "scene.json"
    path.write_text(json.dumps({**GOOD, **changes}))
    with pytest.raises(MapError, match=f"scene.json: {message}"):
        read_discs(path)


@pytest.mark.parametrize(
    ("text", "message"),
    [("", "not JSON"), ("[" * 100_000, "not JSON"), ("[1]", "JSON object"), ("{}", "'start' is missing")],
)
def test_what_is_no_scene_is_refused(text, message):
    with pytest.raises(MapError, match=message):
        scene_of(text)


def test_an_end_within_a_disc_is_a_scenario_error_that_names_the_file(tmp_path):
    path = tmp_path / "scene.json"
    path.write_text(json.dumps({**GOOD, "goal": [1.5, 4.5]}))
    with pytest.raises(ScenarioError, match=r"scene.json: goal .* inside disc 0"):
        read_discs(path)


def test_a_missing_or_unreadable_file_is_refused(tmp_path):
    with pytest.raises(MapError, match="no such file"):
        read_discs(tmp_path / "none.json")
    (tmp_path / "bytes.json").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(MapError, match="not a readable text file"):
        read_discs(tmp_path / "bytes.json")


def test_without_bounds_there_is_room_all_around():
    world = scene_of(json.dumps(GOOD)).world
    x_min, x_max, y_min, y_max = world.bounds
    assert max(x_min, y_min) < 0
    assert min(x_max, y_max) > 6 - 2
    assert scene_of(json.dumps(GOOD)).optimum == pytest.approx(7.2111, abs=0.3)


def test_every_scene_of_discs_beside_the_checkout_is_read(shared_data):
    counts = {}
    for path in sorted((shared_data / "circles").glob("*.json")):
        if path.stem != "zhm_rrt2d":  # holds rectangles
            counts[path.stem] = len(read_discs(path).world.discs)
    assert counts == {"barn_0": 209, "barn_100": 247, "barn_200": 349, "pythonrobotics_rrt": 7}
