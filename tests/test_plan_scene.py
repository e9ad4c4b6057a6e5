"""``antgym plan`` past discs: what it prints and writes, and what it says of options that are not for bees."""

import json
from pathlib import Path

import numpy as np
import pytest

from antgym import cli, commands, plan_scene
from antgym.errors import AntgymError
from antgym.maps.discs import path_length
from antgym.planners.bee_rules import BEE_PAPERS
from antgym.planners.planning import plan

ROOT = Path(__file__).parents[1]
POSTS = str(ROOT / "docs" / "discs.json")
SOLVED = ("plan", POSTS, "--rules", "wu2018", "--ants", "40", "--iterations", "300")


def test_a_scene_is_planned_and_everything_is_written(tmp_path, capsys):
    pytest.importorskip("matplotlib")
    assert cli.run([*SOLVED, "--out", str(tmp_path / "way.v1")]) == 0
    said = capsys.readouterr().out
    record = json.loads((tmp_path / "way.v1.json").read_text())
    for word in (f"{record['length']:.6g}", f"{record['optimum']:.6g}", f"{record['gap']:.2%}", "5 discs"):
        assert word in said
    assert record["length"] == pytest.approx(path_length(record["points"]))
    assert record["gap"] == pytest.approx(record["length"] / record["optimum"] - 1)
    assert (record["points"][0], record["points"][-1]) == ([1, 1], [9, 9])
    first, *rows = (tmp_path / "way.v1.csv").read_text().splitlines()
    assert first == "x,y"
    assert [[float(value) for value in row.split(",")] for row in rows] == record["points"]
    assert (tmp_path / "way.v1.png").read_bytes().startswith(b"\x89PNG")
    assert sorted(path.suffix for path in tmp_path.iterdir()) == [".csv", ".json", ".png"]


@pytest.mark.parametrize("rules", ["wu2018", "abc_standard"])
def test_it_is_the_library_s_plan_at_the_published_default(rules):
    found = plan_scene.find(commands.PlanFile(Path(POSTS), rules=rules, ants=12, iterations=30, seed=5))
    setting = BEE_PAPERS[rules].space(12, 10.0).default
    again = plan(found.scenario, setting, rules=rules, ants=12, iterations=30, seed=5)
    assert list(found.setting.values()) == setting.tolist()
    assert np.array_equal(found.plan.path, again.path)


def test_the_setting_it_prints_gives_the_same_path(tmp_path, capsys):
    given = ("--limit", "33", "--xi-max", "1.25", "--no-picture")
    cli.run([*SOLVED, *given, "--out", str(tmp_path / "one")])
    setting = capsys.readouterr().out.partition("\nsetting ")[2].splitlines()[0].split()
    assert {"33", "1.25", "--tabu-radius"} <= set(setting)
    cli.run(["plan", POSTS, *setting, "--no-picture", "--out", str(tmp_path / "two")])
    assert (tmp_path / "one.csv").read_bytes() == (tmp_path / "two.csv").read_bytes()


def test_where_no_bee_arrives_a_hint_says_what_to_try_and_no_way_is_written(tmp_path, capsys):
    arguments = ["plan", POSTS, "--rules", "abc_standard", "--ants", "4", "--iterations", "1"]
    assert cli.run([*arguments, "--no-picture", "--out", str(tmp_path / "none")]) == 1
    said = capsys.readouterr().out
    assert "none: no bee arrived" in said
    assert "--iterations 4" in said.split("hint")[1]
    record = json.loads((tmp_path / "none.json").read_text())
    assert (record["status"], record["length"], record["gap"], record["points"]) == (
        "no bee arrived",
        None,
        None,
        [],
    )
    assert (tmp_path / "none.csv").read_text() == "x,y\n"


def test_a_picture_needs_no_way():
    pytest.importorskip("matplotlib")
    found = plan_scene.find(commands.PlanFile(Path(POSTS), rules="abc_standard", ants=4, iterations=1))
    assert not found.plan.solved
    assert plan_scene.picture(found).startswith(b"\x89PNG")


def test_scenes_of_the_benchmarks_are_planned(shared_data):
    for path in sorted((shared_data / "circles").glob("barn_*.json")):
        found = plan_scene.find(commands.PlanFile(path, rules="wu2018", ants=40, iterations=300))
        assert 0 <= found.gap < 0.2


BAD = {
    "--beta has no effect here: rules 'wu2018' are of bees": ("--rules", "wu2018", "--beta", "2"),
    "--start has no effect here": ("--rules", "wu2018", "--start", "1", "1"),
    "rules 'abc_gbest' have no tabu list": ("--rules", "abc_gbest", "--tabu-radius", "2"),
    "ants = 3: a hive has 4 bees at least": ("--rules", "wu2018", "--ants", "3"),
    "ants need --start and --goal; a scene of discs holds its own": (),
    "did you mean 'wu2018'": ("--rules", "wu2081"),
    "limit = 0": ("--rules", "wu2018", "--limit", "0"),
}


@pytest.mark.parametrize(("words", "options"), BAD.items(), ids=BAD)
def test_what_is_wrong_is_said(words, options):
    with pytest.raises(AntgymError, match=words):
        cli.run(["plan", POSTS, *options])


def test_parameters_of_bees_are_not_for_ants():
    hills = ("plan", str(ROOT / "docs" / "hills.asc"), "--start", "0", "10", "--goal", "20", "10")
    with pytest.raises(AntgymError, match="--xi-max has no effect here: rules 'liu2020' are of ants"):
        cli.run([*hills, "--xi-max", "1"])
