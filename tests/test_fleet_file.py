"""``antgym fleet``: several robots on a map file, from the command line to timed paths and pictures."""

import csv
import json
import re
from xml.etree import ElementTree

import numpy as np
import pytest

from antgym import GridWorld, Motion, Scenario, cli, fleet_pictures, plan_fleet, write_map
from antgym.envs.fleet_pictures import COLOURS
from antgym.errors import MissingExtraError, ParameterError, ScenarioError
from antgym.planners.timed import TimedPath, nearest_approach

ENDS = ("--starts", "0,4", "4,0", "--goals", "8,4", "4,8")
FEW = ("--ants", "5", "--iterations", "10")


@pytest.fixture
def floor(tmp_path):
    free = np.ones((9, 9))
    free[2, 2] = 0
    write_map(tmp_path / "floor.map", GridWorld(free, (1.0, 1.0, 1.0)))
    return tmp_path / "floor.map"


def run(floor, *arguments):
    return cli.run(["fleet", str(floor), *map(str, arguments)])


def test_two_that_cross_are_planned_and_written(floor, tmp_path, capsys):
    out = tmp_path / "way"
    assert run(floor, *ENDS, *FEW, "--apart", 1.2, "--speeds", 0.7, 0.3, "--out", out, "--no-picture") == 0
    said = capsys.readouterr().out
    assert "robots   2, 1.2 cells apart at least, at 0.7, 0.3 cells/s" in said
    assert "status   solved" in said
    record = json.loads((tmp_path / "way.json").read_text())
    assert record["gap"] == pytest.approx(record["length"] / record["optimum"] - 1)
    assert (record["starts"], record["goals"]) == ([[0, 4, 0], [4, 0, 0]], [[8, 4, 0], [4, 8, 0]])
    rows = list(csv.DictReader((tmp_path / "way.csv").read_text().splitlines()))
    assert max(len(row[axis].partition(".")[2]) for row in rows for axis in "txyz") <= 9
    points = [
        np.array([[float(row[axis]) for axis in "txyz"] for row in rows if row["robot"] == str(i)])
        for i in range(2)
    ]
    one, other = (TimedPath(each[:, 1:], each[:, 0]) for each in points)
    assert nearest_approach(one, other) >= 1.2 - 1e-6
    assert max(one.arrival, other.arrival) == pytest.approx(record["makespan"])
    assert not (tmp_path / "way.png").exists()


def test_in_the_page_robots_are_where_their_times_have_them(floor, tmp_path):
    run(floor, *ENDS, *FEW, "--apart", 1.2, "--out", tmp_path / "way", "--no-picture")
    text = (tmp_path / "way.html").read_text()
    drawing = ElementTree.fromstring(text[text.index("<svg") : text.index("</svg>") + 6])
    record = json.loads((tmp_path / "way.json").read_text())
    moving = [circle for circle in drawing.iter("circle") if len(circle)]
    assert len(moving) == 2
    for circle, path in zip(moving, record["paths"], strict=True):
        x, y = ([float(v) for v in part.get("values").split(";")] for part in circle.findall("animate"))
        keys = [float(key) for key in circle.find("animate").get("keyTimes").split(";")]
        assert (keys[0], keys[-1]) == (0, 1)
        assert sorted(keys) == keys
        assert np.column_stack([x, y])[:-1].tolist() == (np.array(path["cells"])[:, :2] + 0.5).tolist()
        assert keys[:-1] == pytest.approx(np.array(path["times"]) / record["makespan"], abs=1e-6)
    assert "h1v1h-1z" in next(drawing.iter("path")).get("d")  # the blocked cell


def test_a_strip_has_as_many_frames_as_asked_for(floor, tmp_path):
    pytest.importorskip("matplotlib")
    widths = []
    for frames in (2, 4):
        run(floor, *ENDS, *FEW, "--apart", 1, "--frames", frames, "--out", tmp_path / "way")
        widths.append(int.from_bytes((tmp_path / "way.png").read_bytes()[16:20], "big"))
    assert widths[1] == 2 * widths[0]


def test_discs_are_as_large_as_what_robots_keep_apart():
    figure = pytest.importorskip("matplotlib.figure").Figure()
    world = GridWorld(np.ones((5, 5)))
    plan = plan_fleet([Scenario(world, (0, 0), (4, 4), Motion("grid8"))], (1.0, 2.0, 0.9, 300.0), apart=1)
    axes = figure.subplots()
    fleet_pictures._draw(axes, plan, 0.0)
    (disc,) = axes.patches
    assert (disc.radius, disc.get_linewidth()) == (0.5, 0)


@pytest.mark.parametrize(("room", "said"), [(("--radius", 0.4), True), (("--apart", 0.8), False)])
def test_the_page_says_where_walls_are_grown(floor, tmp_path, room, said):
    run(floor, *ENDS, *FEW, *room, "--out", tmp_path / "way", "--no-picture")
    assert ("Walls are grown by the radius" in (tmp_path / "way.html").read_text()) == said


def test_where_nobody_gets_past_the_status_says_so_and_there_is_no_picture(tmp_path, capsys):
    write_map(tmp_path / "corridor.map", GridWorld(np.ones((9, 1)), (1.0, 1.0, 1.0)))
    ends = ("--starts", "0,0", "8,0", "--goals", "8,0", "0,0")
    assert run(tmp_path / "corridor.map", *ends, *FEW, "--radius", 0.4, "--out", tmp_path / "none") == 1
    assert "found no way past others" in capsys.readouterr().out
    record = json.loads((tmp_path / "none.json").read_text())
    assert (record["length"], record["paths"]) == (None, [])
    assert {path.suffix for path in tmp_path.glob("none*")} == {".json"}


BAD = {
    "no ends": ((), ScenarioError, "0 starts and 0 goals"),
    "fewer goals": (("--starts", "0,0", "1,1", "--goals", "2,2"), ScenarioError, "2 starts and 1 goals"),
    "no distance": (ENDS, ParameterError, "Give --radius, or --apart"),
    "outside": (
        ("--starts", "0,4", "9,0", "--goals", "8,4", "4,8", "--apart", "1"),
        ScenarioError,
        "start of robot 1",
    ),
    "speeds": ((*ENDS, "--apart", "1", "--speeds", "1", "2", "3"), ParameterError, "3 speeds for 2 robots"),
    "rules": ((*ENDS, "--apart", "1", "--rules", "zhang"), ParameterError, "unknown rules 'zhang'"),
}


@pytest.mark.parametrize(("arguments", "kind", "words"), BAD.values(), ids=BAD)
def test_what_cannot_be_used_is_said(floor, arguments, kind, words):
    with pytest.raises(kind, match=words):
        run(floor, *arguments)


def test_robots_have_the_colours_that_environments_give_them(floor, tmp_path):
    run(floor, *ENDS, *FEW, "--apart", 1, "--no-picture", "--out", tmp_path / "way")
    found = re.findall(r'stroke="#(\w{6})" stroke-width="[^"]*" opacity', (tmp_path / "way.html").read_text())
    assert [list(bytes.fromhex(colour)) for colour in found] == np.round(255 * COLOURS[:2]).tolist()


def test_pictures_are_of_solved_plans_and_some_frames(monkeypatch):
    world = GridWorld(np.ones((5, 5)))
    plan = plan_fleet([Scenario(world, (0, 0), (4, 4), Motion("grid8"))], (1.0, 2.0, 0.9, 300.0), apart=1)
    with pytest.raises(ParameterError, match="frames = 1: a strip has 2 to 12"):
        fleet_pictures.strip(plan, "", frames=1)
    monkeypatch.setitem(__import__("sys").modules, "matplotlib.figure", None)
    with pytest.raises(MissingExtraError, match="matplotlib"):
        fleet_pictures.strip(plan, "")
