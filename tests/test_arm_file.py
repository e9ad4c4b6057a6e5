"""``antgym plan --smooth`` and ``antgym arm``: from a map to joint angles; whatever is wrong is one line."""

import json
from pathlib import Path

import numpy as np
import pytest

from antgym import arm_file, cli, commands
from antgym.errors import MapError
from antgym.planners.smoothing import smooth
from antgym.robots import find_arm

HILLS = str(Path(__file__).parents[1] / "docs" / "hills.asc")
PLAN = (
    "plan",
    HILLS,
    *[
        "--start",
        "0",
        "10",
        "2",
        "--goal",
        "20",
        "10",
        "2",
        "--beta",
        "0.2",
        "--rise",
        "10",
        "--iterations",
        "20",
    ],
    "--no-picture",
)
PLACED = ("--scale", "0.001", "--at", "0.25", "-0.16", "0.2")


def exit_code(*arguments):
    with pytest.raises(SystemExit) as caught:
        cli.main([str(argument) for argument in arguments])
    return caught.value.code


def table(path):
    """The columns of a CSV file by name."""
    names = path.read_text().split("\n", 1)[0].split(",")
    return dict(zip(names, np.loadtxt(path, delimiter=",", skiprows=1, unpack=True), strict=True))


@pytest.fixture(scope="module")
def way(tmp_path_factory):
    """What antgym plan writes of a smoothed path."""
    stem = tmp_path_factory.mktemp("plan") / "way"
    assert exit_code(*PLAN, "--smooth", "spline", "--out", stem) == 0
    return stem


def test_a_smoothed_plan_is_written_beside_the_planned_one(way):
    record = json.loads(way.with_name("way.json").read_text())
    smoothed, points = record["smoothed"], table(way.with_name("way.smooth.csv"))
    assert smoothed["method"] == "spline"
    assert smoothed["before"] == pytest.approx(record["length"])
    steps = np.diff(smoothed["points"], axis=0)
    assert np.linalg.norm(steps, axis=1).sum() == pytest.approx(smoothed["length"])
    assert smoothed["length"] < smoothed["before"]
    assert np.stack([points[axis] for axis in "xyz"], axis=1).tolist() == smoothed["points"]
    assert smoothed["points"][0] == pytest.approx(record["points"][0])
    assert smoothed["points"][-1] == pytest.approx(record["points"][-1])


def test_the_report_says_what_smoothing_gained(capsys):
    assert cli.run([*PLAN, "--smooth", "shortcut"]) == 0
    (line,) = (line for line in capsys.readouterr().out.splitlines() if line.startswith("smooth"))
    assert "% shorter" in line


def test_a_plan_is_not_smoothed_unless_asked(tmp_path, capsys):
    assert cli.run([*PLAN, "--out", str(tmp_path / "way")]) == 0
    assert "\nsmooth " not in capsys.readouterr().out
    assert json.loads((tmp_path / "way.json").read_text())["smoothed"] is None
    assert sorted(path.name for path in tmp_path.iterdir()) == [*("way.csv", "way.json", "way.poses.json")]


def test_where_no_ant_arrived_there_is_nothing_to_smooth(tmp_path):
    arguments = [*PLAN, "--beta", "60", "--ants", "1", "--smooth", "spline", "--out", str(tmp_path / "none")]
    assert cli.run(arguments) == 1
    assert json.loads((tmp_path / "none.json").read_text())["smoothed"] is None


@pytest.mark.parametrize("name", ["way.csv", "way.smooth.csv"])
def test_an_arm_follows_what_was_planned(way, name, tmp_path, capsys):
    pytest.importorskip("matplotlib")
    assert (
        cli.run(
            [
                "arm",
                str(way.with_name(name)),
                *PLACED,
                "--tool",
                "180",
                "15",
                "0",
                "--out",
                str(tmp_path / "arm.v1"),
            ]
        )
        == 0
    )
    said, columns = capsys.readouterr().out, table(tmp_path / "arm.v1.csv")
    joints = np.stack([columns[f"joint_{i}"] for i in range(1, 7)], axis=1)
    points = np.stack([columns[axis] for axis in "xyz"], axis=1)
    poses = find_arm("lr_mate_200id").forward(joints)
    assert poses[:, :3, 3] == pytest.approx(points, abs=1e-9)
    assert np.abs(np.degrees(np.arccos(-poses[:, 2, 2])) - 15).max() < 1e-6
    planned = table(way.with_name(name))
    assert points[[0, -1]] == pytest.approx(
        np.stack([planned[axis][[0, -1]] for axis in "xyz"], axis=1) / 1000 + (0.25, -0.16, 0.2)
    )
    assert f"seconds  {columns['t'][-1]:.4g}" in said
    assert "lr_mate_200id, 6 joints" in said
    assert (tmp_path / "arm.v1.png").read_bytes().startswith(b"\x89PNG")
    assert sorted(path.suffix for path in tmp_path.iterdir()) == [".csv", ".png"]


def test_without_out_nothing_is_written(way, capsys):
    assert (
        cli.run(
            [
                "arm",
                str(way.with_name("way.csv")),
                *PLACED,
                "--arm",
                "wei2018_palletizer",
                "--at",
                "0.8",
                "0",
                "0.2",
            ]
        )
        == 0
    )
    assert "wrote" not in capsys.readouterr().out


def test_a_map_can_be_turned(tmp_path):
    (tmp_path / "way.csv").write_text("x,y,z\n1.0,0,0.5\n1.2,0,0.5\n")
    assert (
        cli.run(
            [
                "arm",
                str(tmp_path / "way.csv"),
                "--arm",
                "wei2018_palletizer",
                "--turn",
                "90",
                "--no-picture",
                "--out",
                str(tmp_path / "arm"),
            ]
        )
        == 0
    )
    columns = table(tmp_path / "arm.csv")
    assert (columns["x"][-1], columns["y"][-1]) == pytest.approx((0, 1.2))


FILES = {
    "no column": ("x,y\n1,2\n", ":1: no column z"),
    "empty": ("", ":1: no column x, y, z"),
    "word": ("x,y,z\n1,2,3\n1,two,3\n", ":3: a way-point is three numbers"),
    "ragged": ("x,y,z\n1,2,3\n1,2\n", ":3: a way-point is three numbers"),
    "one point": ("x,y,z\n1,2,3\n", "at least two different points, got 1"),
    "no point": ("x,y,z\n", "at least two different points, got 0"),
    "not finite": ("x,y,z\n1,2,3\n1,2,inf\n", "finite points"),
    "far away": ("x,y,z\n1,2,3\n1e9,2,3\n", "is it in metres"),
    "out of reach": ("x,y,z\n1,2,3\n1.01,2,3\n", "way-points 0 to 1, from (1, 2, 3) m on: out of reach"),
}


@pytest.mark.parametrize(("text", "words"), FILES.values(), ids=FILES)
def test_a_file_that_cannot_be_followed_is_one_line(text, words, tmp_path, capsys):
    (tmp_path / "way.csv").write_text(text)
    assert exit_code("arm", tmp_path / "way.csv") == 2
    said = capsys.readouterr().err
    assert words in said
    assert said.count("\n") == 1


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--arm", "lr_mate"), "did you mean 'lr_mate_200id'"),
        (("--tool", "nan", "0", "0"), "finite numbers of degrees"),
        (("--spacing", "0"), "spacing = 0"),
        (("--scale", "nan"), "a scale above 0"),
        (("--turn", "inf"), "finite numbers"),
    ],
)
def test_an_option_that_cannot_be_used_is_one_line(options, words, way, capsys):
    assert exit_code("arm", way.with_name("way.csv"), *PLACED, *options) == 2
    assert words in capsys.readouterr().err


def test_files_that_are_none_are_named(tmp_path):
    (tmp_path / "binary.csv").write_bytes(b"\xff\xfe\x00")
    for name, words in (("absent.csv", "no such file"), ("binary.csv", "not a text file")):
        with pytest.raises(MapError, match=f"{name}: {words}"):
            arm_file.read_points(tmp_path / name)


def test_matplotlib_is_asked_for_before_the_work(way, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(arm_file.plan_file.importlib.util, "find_spec", lambda name: None)
    arguments = ("arm", way.with_name("way.csv"), *PLACED, "--out", tmp_path / "arm")
    assert exit_code(*arguments) == 2
    assert "antgym[viz]" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
    assert exit_code(*arguments, "--no-picture") == 0


def test_smoothing_is_the_library_s(way):
    record = json.loads(way.with_name("way.json").read_text())
    from antgym.plan_file import find

    found = find(commands.PlanFile(Path(HILLS), (0, 10, 2), (20, 10, 2), beta=0.2, rise=10, iterations=20))
    again = smooth(found.plan.path, found.scenario)
    assert again.length == record["smoothed"]["length"]
