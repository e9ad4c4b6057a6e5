"""The console script: each subcommand by process and in process; whatever is wrong is one line and exit code 2."""

import io
import json
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from antgym import cli, commands, console, listing, plan_file
from antgym.envs.cards import load_card, summary
from antgym.envs.catalogue import CATALOGUE
from antgym.errors import AntgymError
from antgym.exports import write_map
from antgym.maps.features import FEATURES
from antgym.maps.map import Frame, Map
from antgym.maps.motion import Motion
from antgym.maps.readers import read_map, read_scenarios
from antgym.maps.recipes import SUITES
from antgym.maps.world import GridWorld
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


@pytest.mark.parametrize(
    "words", ["antgym.cli plan --help", "antgym.cli envs", "experiments.committee --help"]
)
def test_a_reader_that_has_gone_as_head_does_ends_a_command_without_a_word(words):
    """Nobody reads from the first byte on; what prints by itself, by rich and by tyro all end alike."""
    read, write = os.pipe()
    os.close(read)
    with os.fdopen(write, "wb") as pipe:
        command = [sys.executable, "-m", *words.split()]
        done = subprocess.run(command, cwd=ROOT, stdout=pipe, stderr=subprocess.PIPE, text=True, check=False)
    assert (done.returncode, done.stderr) == (console.BROKEN_PIPE, "")


def test_what_is_wrong_is_said_even_where_nobody_reads_the_output(monkeypatch, capsys):
    class Gone(io.StringIO):
        def flush(self):
            raise BrokenPipeError

        def fileno(self):
            return os.open(os.devnull, os.O_WRONLY)

    def script():
        raise AntgymError("no such map")

    monkeypatch.setattr(sys, "stdout", Gone())
    with pytest.raises(SystemExit) as caught:
        console.main(script)
    assert caught.value.code == console.BROKEN_PIPE
    assert capsys.readouterr().err == "error: no such map\n"


@pytest.mark.parametrize(
    "title", ["PPO", "PPO on OpenOneShot-v0: gap 0.281, best 0.281, and more than fits there"]
)
def test_a_bar_s_numbers_are_whole_on_a_narrow_terminal(title, monkeypatch, capsys):
    for name, value in {"COLUMNS": "80", "TTY_COMPATIBLE": "1", "TERM": "xterm", "NO_COLOR": "1"}.items():
        monkeypatch.setenv(name, value)
    with console.progress(title, 100_000) as advance:
        advance(640)
    said = capsys.readouterr().err
    for whole in ("   640/100000", "-:--:--", title[:50]):
        assert whole in said
    assert ("…" in said) == (len(title) > 52)


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
    assert sorted(path.name[6:] for path in tmp_path.iterdir()) == [".csv", ".json", ".png", ".poses.json"]


def test_plan_is_the_library_s_plan():
    found = plan_file.find(
        commands.PlanFile(Path(HILLS), (0, 10, 2), (20, 10, 2), alpha=1, beta=0.2, rho=0.9, Q=300)
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
    found = plan_file.find(commands.PlanFile(Path(HILLS), (0, 10), (20, 10), ants=1, iterations=1))
    default = PAPERS["liu2020"].ranges.space(found.scenario.straight_line).default
    assert list(found.setting) == default.tolist()


def test_two_numbers_stand_on_the_surface():
    scenario = plan_file.find(
        commands.PlanFile(Path(HILLS), (0, 10), (20, 10), ants=1, iterations=1)
    ).scenario
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
    found = plan_file.find(
        commands.PlanFile(Path(HILLS), (0, 10, 2), (20, 10, 2), rise=10, ants=2, iterations=2)
    )
    assert not found.plan.solved
    assert plan_file.picture(found).startswith(b"\x89PNG")


@pytest.fixture
def room(tmp_path):
    """A yaml map of 20 x 12 cells of half a metre with a wall, its corner at (-5, -3) m."""
    pytest.importorskip("yaml")
    pytest.importorskip("PIL")
    free = np.ones((20, 12))
    free[10, :9] = 0
    world = GridWorld(free, (0.5, 0.5, 0.5))
    write_map(
        tmp_path / "room.yaml", Map(world, Motion("grid8"), Frame((-5.0, -3.0, 0.0), 0.0, "m"), "r", "r")
    )
    return tmp_path / "room.yaml"


def test_a_yaml_map_is_planned_in_metres_and_written_in_metres(room, tmp_path, capsys):
    ends = ("--start", "-4.8,-2.8", "--goal", "4.8", "-2.8", "--unit", "map")
    assert (
        cli.run(
            ["plan", str(room), *ends, "--iterations", "30", "--out", str(tmp_path / "way"), "--no-picture"]
        )
        == 0
    )
    said = capsys.readouterr().out
    assert "20 x 12 x 1 cells of 0.5 x 0.5 x 0.5 m, (0, 0, 0) to (19, 0, 0)" in said
    assert "--motion grid8 --rules ant_colony_system" in said
    record = json.loads((tmp_path / "way.json").read_text())
    assert record["points"][0] == [-4.75, -2.75, 0.25]
    assert record["frame"] == {"origin": [-5, -3, 0], "yaw": 0, "unit": "m", "down": False}
    found = json.loads((tmp_path / "way.poses.json").read_text())
    assert [list(pose["pose"]["position"].values()) for pose in found["poses"]] == record["points"]


def test_cells_and_metres_mean_the_same_places(room):
    by_cell = plan_file.read(commands.MapFile(room, (0, 0), (19, 0)))
    by_metre = plan_file.read(commands.MapFile(room, (-4.75, -2.75), (4.7, -2.6), unit="map"))
    assert by_cell.scenario.digest == by_metre.scenario.digest


def test_a_robot_s_radius_and_convex_obstacles_change_the_world(room, capsys):
    wide = plan_file.read(commands.MapFile(room, (0, 0), (19, 0), radius=0.6)).scenario.world
    assert wide.free[8:13, 0].tolist() == [[1], [0], [0], [0], [1]]
    cup = plan_file.read(commands.MapFile(room, (0, 0), (19, 0), convex=True))
    assert cup.filled == (cup.scenario.world, 0, 0)
    ends = ("--start", "0,0", "--goal", "19,0")
    assert cli.run(["plan", str(room), *ends, "--convex", "--iterations", "20", "--beta", "5"]) in (0, 1)
    assert "convex   0 cells filled" in capsys.readouterr().out


def test_a_map_is_shown_with_size_share_parts_features_and_letters(room, capsys):
    assert cli.run(["map", str(room), "--start", "0,0", "--goal", "19,0"]) == 0
    said = capsys.readouterr().out
    for words in (
        "ROS 2 map, room.yaml",
        "20 x 12 cells, counted from 0; x -5 to 5, y -3 to 3 m",
        "231 cells, 96.2%",
        "1, the largest with 100.0% of them",
        "(0, 0, 0) at (-4.75, -2.75, 0.25), (19, 0, 0)",
        "flat 1",
    ):
        assert words in said
    assert all(f"{feature.name} " in said for feature in FEATURES)
    picture = said.splitlines()[-6:]
    assert picture[-1] == "S         %        G"
    assert picture[0] == " " * 20


@pytest.mark.parametrize(
    "kind", ["dem/DEM_10m.asc", "voxel3d/forest0.bt", "movingai2d/den009d.map", "images/house.png"]
)
def test_maps_of_every_shape_are_shown_between_places_that_are_drawn(shared_data, kind, tmp_path, capsys):
    assert cli.run(["map", str(shared_data / kind), "--out", str(tmp_path / "a.png")]) == 0
    said = capsys.readouterr().out
    assert "optimum" in said
    assert "S" in said.split("features")[1]
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


def test_a_map_becomes_other_files(room, tmp_path):
    out = [str(tmp_path / name) for name in ("b.map", "b.map.scen", "b.yaml", "b.3dmap")]
    assert cli.run(["map", str(room), "--start", "0,0", "--goal", "19,0", "--out", *out]) == 0
    rows = read_scenarios(tmp_path / "b.map.scen")
    assert (rows[0].start, rows[0].goal) == ((0, 0), (19, 0))
    assert rows[0].length == pytest.approx(
        2 * plan_file.read(commands.MapFile(room, (0, 0), (19, 0))).scenario.optimum
    )
    worlds = [read_map(tmp_path / name).world for name in ("b.map", "b.yaml", "b.3dmap")]
    assert len({world.bits.tobytes() for world in worlds}) == 1


def test_a_map_on_which_nothing_is_joined_is_shown_without_features(tmp_path, capsys):
    (tmp_path / "shut.map").write_text("type octile\nheight 1\nwidth 3\nmap\n.@.\n")
    assert cli.run(["map", str(tmp_path / "shut.map")]) == 0
    assert "none: no two places that are joined" in capsys.readouterr().out


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
    "no such map": ("map", "absent.map"),
    "unknown kind of map": ("map", "README.md"),
    "an option of another kind": ("map", HILLS, "--ros", "1"),
    "one end": ("map", HILLS, "--start", "0", "1"),
    "unknown kind to write": ("map", HILLS, "--out", "a.stl"),
    "not flat": ("map", HILLS, "--out", "a.map"),
    "unknown unit": ("plan", HILLS, *ENDS, "--unit", "feet"),
    "no radius": ("plan", HILLS, *ENDS, "--radius", "-1"),
    "convex hills": ("plan", HILLS, *ENDS, "--convex"),
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
