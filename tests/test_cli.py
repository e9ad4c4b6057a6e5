"""The console script: each subcommand by process and in process; whatever is wrong is one line and exit code 2."""

import json
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from antgym import cli, console, listing, plan_file
from antgym.envs.cards import load_card, summary
from antgym.envs.catalogue import CATALOGUE
from antgym.errors import AntgymError, MapError
from antgym.maps.formats.elevation import HeightField
from antgym.maps.recipes import SUITES
from antgym.maps.world import Scenario
from antgym.planners.colony import plan
from antgym.planners.rules import PAPERS
from antgym.planners.swarms import find_swarm_rules

ROOT = Path(__file__).parents[1]
HILLS = str(ROOT / "docs" / "hills.asc")
ENDS = ("--start", "0", "10", "2", "--goal", "20", "10", "2")
SOLVED = ("plan", HILLS, *ENDS, "--beta", "0.2", "--rise", "10", "--iterations", "20")


def shell(*arguments, **keywords):
    command = [sys.executable, "-m", "antgym.cli", *map(str, arguments)]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False, **keywords)


def exit_code(*arguments):
    with pytest.raises(SystemExit) as caught:
        cli.main([str(argument) for argument in arguments])
    return caught.value.code


def test_help_is_quick_and_names_the_subcommands():
    begun = time.perf_counter()
    done = shell("--help")
    seconds = time.perf_counter() - begun
    assert done.returncode == 0
    assert all(name in done.stdout for name in ("plan", "envs", "bench"))
    assert seconds < 5  # under 1 on a quiet machine; what it must not do is in the next test


def test_help_imports_nothing_heavy():
    script = (
        "import sys\nfrom antgym.cli import main\ntry:\n    main(['plan', '--help'])\n"
        "except SystemExit:\n    pass\n"
        "print([n for n in ('numba', 'scipy', 'matplotlib', 'torch') if n in sys.modules])"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert done.stdout.splitlines()[-1] == "[]"


def test_the_script_is_declared():
    assert 'antgym = "antgym.cli:main"' in (ROOT / "pyproject.toml").read_text(encoding="utf-8")


def test_envs_lists_every_id_with_its_sizes_and_card():
    done = shell("envs")
    assert done.returncode == 0, done.stderr
    for entry in CATALOGUE:
        assert entry.id in done.stdout
        assert summary(load_card(entry.world), steered=entry.regime == "Control") in done.stdout
    assert "(4,)" in done.stdout


@pytest.mark.parametrize("entry", CATALOGUE, ids=lambda entry: entry.id)
def test_envs_prints_the_page_of_one(entry, capsys):
    assert cli.run(["envs", entry.id]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert said.startswith(entry.id)
    for word in (
        entry.entry_point,
        entry.vector_entry_point,
        entry.kwargs["suite"],
        summary(load_card(entry.world), steered=entry.regime == "Control"),
    ):
        assert word in said
    assert ("budget: 10" in said) == entry.id.endswith("Trials-v0")
    for rules in SUITES[entry.kwargs["suite"]].rules:
        first, second, *_ = find_swarm_rules(rules).ranges
        assert f"{rules} {first[0]:.4g} < {first[1]:.4g} < {first[2]:.4g} {second[0]:.4g} <" in said


def test_a_page_shows_the_whole_card(monkeypatch, capsys):
    card = {
        "gap": {"published default": [0.6, 0.5, 0.7], "SBS": [0.3, 0.2, 0.4]},
        "headroom": {"over SBS by rule": [0.4, 0.3, 0.5]},
        "noted": "by hand",
    }
    monkeypatch.setattr(listing, "load_card", lambda world: card)
    cli.run(["envs", "antgym/RoomTrials-v0"])
    said = capsys.readouterr().out
    assert "headroom 40% [30%, 50%]" in said
    assert '"noted": "by hand"' in said


def test_bench_prints_figures_and_writes_them(tmp_path):
    file = tmp_path / "bench.json"
    done = shell("bench", "--workload", "tiny", "--repeats", "1", "--json", file)
    assert done.returncode == 0, done.stderr
    (row,) = json.loads(file.read_text())["rows"]
    assert "tiny" in done.stdout
    assert min(row[name] for name in ("ns_per_move", "plans_per_second", "exact_plans_per_second")) > 0


def test_plan_writes_what_it_prints(tmp_path):
    done = shell(*SOLVED, "--out", tmp_path / "way.v1")
    assert done.returncode == 0, done.stderr
    record = json.loads((tmp_path / "way.v1.json").read_text())
    lines = (tmp_path / "way.v1.csv").read_text().splitlines()
    assert lines[0] == "i,j,k,x,y,z"
    assert [line.split(",")[:3] for line in lines[1:]] == [[str(i) for i in c] for c in record["cells"]]
    assert record["cells"][0] == [0, 10, 2]
    assert record["points"][0] == [7.5, 157.5, 37.5]
    steps = np.diff(record["points"], axis=0)
    assert np.linalg.norm(steps, axis=1).sum() == pytest.approx(record["length"])
    assert record["gap"] == pytest.approx(record["length"] / record["optimum"] - 1)
    for word in (f"{record['length']:.6g}", f"{record['optimum']:.6g}", f"{record['gap']:.2%}", "arrived"):
        assert word in done.stdout
    assert (tmp_path / "way.v1.png").read_bytes().startswith(b"\x89PNG")
    assert sorted(path.suffix for path in tmp_path.iterdir()) == [".csv", ".json", ".png"]


def test_plan_is_the_library_s_plan():
    found = plan_file.find(
        cli.PlanFile(Path(HILLS), (0, 10, 2), (20, 10, 2), alpha=1, beta=0.2, rho=0.9, Q=300)
    )
    field_plan = plan(found.scenario, (1.0, 0.2, 0.9, 300.0), ants=20, iterations=100, seed=0)
    assert found.plan.path.tolist() == field_plan.path.tolist()


@pytest.mark.parametrize("motion", ["grid4", "grid8"])
def test_a_flat_colony_plans_one_level_of_the_ground(motion, tmp_path, capsys):
    heights = np.zeros((12, 12))
    heights[5, :9] = 1.0
    np.save(tmp_path / "wall.npy", heights)
    ends = ("--start", "0", "0", "0", "--goal", "11", "0", "0")
    flat = ("--levels", "1", "--motion", motion, "--rules", "zhang2011")
    assert cli.run(["plan", str(tmp_path / "wall.npy"), *ends, *flat]) == 0
    assert f"--motion {motion} --rules zhang2011" in capsys.readouterr().out
    with pytest.raises(AntgymError, match="needs a world one cell high"):
        cli.run(["plan", str(tmp_path / "wall.npy"), *ends, "--motion", motion])


def test_what_is_left_out_is_the_published_default():
    found = plan_file.find(cli.PlanFile(Path(HILLS), (0, 10), (20, 10), ants=1, iterations=1))
    default = PAPERS["liu2020"].ranges.space(found.scenario.straight_line).default
    assert list(found.setting) == default.tolist()


def test_two_numbers_stand_on_the_surface():
    scenario = plan_file.find(cli.PlanFile(Path(HILLS), (0, 10), (20, 10), ants=1, iterations=1)).scenario
    for x, y, z in (scenario.start, scenario.goal):
        assert scenario.world.free[x, y, z]
        assert z == 0 or not scenario.world.free[x, y, z - 1]


def test_where_no_ant_arrives_a_hint_says_what_to_try(capsys, tmp_path):
    arguments = ("plan", HILLS, *ENDS, "--rise", "10", "--out", tmp_path / "none", "--no-picture")
    assert exit_code(*arguments) == 1
    said = capsys.readouterr().out
    assert "none: no ant arrived" in said
    assert "--beta" in said.split("hint")[1]
    record = json.loads((tmp_path / "none.json").read_text())
    assert (record["status"], record["length"], record["gap"], record["cells"]) == (
        "no ant arrived",
        None,
        None,
        [],
    )
    assert (tmp_path / "none.csv").read_text() == "i,j,k,x,y,z\n"
    assert not (tmp_path / "none.png").exists()


def test_a_picture_needs_no_path(tmp_path):
    pytest.importorskip("matplotlib")
    found = plan_file.find(cli.PlanFile(Path(HILLS), (0, 10, 2), (20, 10, 2), rise=10, ants=2, iterations=2))
    assert not found.plan.solved
    assert plan_file.picture(found).startswith(b"\x89PNG")


def test_the_box_fits_the_relief_and_keeps_the_file_s_datum():
    heights = np.full((5, 4), 103.0)
    heights[2, 2] = 131.0
    terrain = plan_file.build(HeightField(heights, (10.0, 10.0), "a"), None, 0.0, None)
    assert terrain.floor == 100.0
    assert terrain.world.shape == (5, 4, 6)  # 31 above the floor fill four levels, two are air
    assert terrain.world.free[2, 2].tolist() == [0, 0, 0, 0, 1, 1]
    assert terrain.coordinates(np.array([[0, 0, 1]])).tolist() == [[5.0, 5.0, 115.0]]
    assert Scenario(terrain.world, (0, 0, 1), (4, 0, 1)).optimum == 40.0


def test_missing_heights_are_filled_only_when_asked():
    field = HeightField(np.array([[1.0, np.nan], [2.0, 3.0]]), (1.0, 1.0), "a.npy")
    with pytest.raises(MapError, match=r"a\.npy: 1 heights are missing; .*--fill"):
        plan_file.build(field, None, 0.0, None)
    assert plan_file.build(field, None, 0.0, 9.0).heights[0, 1] == 9.0


def test_units_that_do_not_match_are_noticed_before_memory_is_taken():
    for far, spacing in ((9e9, 1e-3), (1e300, 1e-300), (-1e300, 1e-300)):
        field = HeightField(np.array([[0.0, far], [2.0, 3.0]]), (spacing, spacing), "a.npy")
        with pytest.raises(MapError, match="must share a unit"):
            plan_file.build(field, None, 0.0, None)


BAD = {
    "no command": (),
    "unknown command": ("plna",),
    "no ends": ("plan", HILLS),
    "unknown option": ("plan", HILLS, *ENDS, "--bta", "1"),
    "word for a number": ("plan", HILLS, *ENDS, "--beta", "big"),
    "no such file": ("plan", "absent.asc", *ENDS),
    "unknown kind of file": ("plan", "README.md", *ENDS),
    "one number": ("plan", HILLS, "--start", "1", "--goal", "20", "10"),
    "half a cell": ("plan", HILLS, "--start", "1", "2.5", "--goal", "20", "10"),
    "outside": ("plan", HILLS, "--start", "0", "99", "--goal", "20", "10"),
    "outside upwards": ("plan", HILLS, "--start", "0", "10", "99", "--goal", "20", "10"),
    "negative": ("plan", HILLS, "--start", "0", "-1", "--goal", "20", "10"),
    "blocked": ("plan", HILLS, "--start", "0", "10", "0", "--goal", "20", "10"),
    "no air": ("plan", HILLS, "--start", "8", "0", "--goal", "20", "10", "--levels", "2"),
    "no way": ("plan", HILLS, *ENDS, "--levels", "3"),
    "backwards": ("plan", HILLS, "--start", "20", "10", "--goal", "0", "10"),
    "no levels": ("plan", HILLS, *ENDS, "--levels", "0"),
    "levels without bound": ("plan", HILLS, *ENDS, "--levels", "999999999"),
    "negative rise": ("plan", HILLS, *ENDS, "--rise", "-1"),
    "rise without bound": ("plan", HILLS, *ENDS, "--rise", "inf"),
    "rise that is no number": ("plan", HILLS, *ENDS, "--rise", "nan"),
    "fill that is no number": ("plan", HILLS, *ENDS, "--fill", "nan"),
    "unknown rules": ("plan", HILLS, *ENDS, "--rules", "liu2021"),
    "rho": ("plan", HILLS, *ENDS, "--rho", "1.5"),
    "Q": ("plan", HILLS, *ENDS, "--Q", "nan"),
    "no ants": ("plan", HILLS, *ENDS, "--ants", "0"),
    "negative seed": ("plan", HILLS, *ENDS, "--seed", "-1"),
    "unwritable": (*SOLVED, "--no-picture", "--out", f"{HILLS}/way"),
    "unknown environment": ("envs", "antgym/OpenTrial-v0"),
    "unknown workload": ("bench", "--workload", "huge"),
    "no turns": ("bench", "--repeats", "0"),
}


@pytest.mark.parametrize("arguments", BAD.values(), ids=BAD)
def test_bad_input_is_one_line(arguments, capsys):
    assert exit_code(*arguments) == 2
    said = capsys.readouterr().err
    assert said.startswith("error: ")
    assert said.count("\n") == 1
    assert "Traceback" not in said


def test_bad_input_is_one_line_in_a_process_too():
    done = shell("plan", "absent.asc", *ENDS)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert done.stderr.startswith("error: absent.asc: no such file")


def test_a_picture_without_matplotlib_is_one_line_before_anything_is_written(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(plan_file.importlib.util, "find_spec", lambda name: None)
    assert exit_code(*SOLVED, "--out", tmp_path / "way") == 2
    assert "antgym[viz]" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
    assert exit_code(*SOLVED, "--out", tmp_path / "way", "--no-picture") == 0


def test_ctrl_c_is_a_word_and_130(monkeypatch, capsys):
    def stopped(_):
        raise KeyboardInterrupt

    monkeypatch.setattr(cli, "envs", stopped)
    assert exit_code("envs") == 130
    assert capsys.readouterr().err == "interrupted\n"


def test_a_file_is_there_as_a_whole_or_not_at_all(tmp_path, monkeypatch):
    target = tmp_path / "deep" / "file"
    console.write_whole(target, b"old")

    def broken(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(console.os, "replace", broken)
    with pytest.raises(AntgymError, match="cannot be written: No space left on device"):
        console.write_whole(target, b"new")
    assert [path.name for path in target.parent.iterdir()] == ["file"]
    assert target.read_bytes() == b"old"
