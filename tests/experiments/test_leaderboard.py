"""The leaderboard: the same ledger however it is run, stopped, killed or resumed."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("optuna")  # an agent
pytest.importorskip("plotly")  # the page
pytest.importorskip("matplotlib")  # the real terrain

from agents.graph import TransferGraph
from agents.static import StaticSetting
from antgym.errors import LedgerError, ParameterError
from antgym.planners.parameters import ColonyParameters
from antgym.tuning.ledger import MANIFEST, TRIALS
from experiments import contest, leaderboard
from experiments.leaderboard import STATIC, Arguments, run_board
from experiments.presets import PRESETS, Preset

AGENTS = ("uniform_random", "random_search", "optuna_tpe")
TINY = Preset(2, 2, 5, 2, 0, 3, 1, 1, 1, 1, 1)
ROOT = Path(leaderboard.__file__).parents[1]


def write_trained(folder):
    """Artefacts of agents that need training, as small as they come: nobody here plays with them."""
    folder.mkdir(parents=True)
    names, unit = ColonyParameters._fields, (0.6, 0.2, 0.6, 0.6)
    StaticSetting(unit, 7, names).save(folder / "static.json")
    TransferGraph(("a", "b", "c"), names, (unit,) * 3, (((1.0, 1.0),) * 3,) * 3).save(folder / "graph.json")
    (folder / "policy.json").write_text('{"evaluations": 0}')


@pytest.fixture
def board(monkeypatch, tmp_path):
    """A function that runs a tiny board in a folder of the given name and returns the folder."""
    monkeypatch.setitem(PRESETS, "smoke", TINY)

    def run(name="board", agents=AGENTS):
        folder = tmp_path / name
        if not folder.exists():
            write_trained(folder / "trained")
        assert run_board(Arguments("smoke", folder, agents)) == folder / "index.html"
        return folder

    return run


def lines(folder):
    """The whole lines of a ledger's trials, in the order they were written."""
    data = (folder / TRIALS).read_bytes()
    return data[: data.rfind(b"\n") + 1].decode().splitlines()


def records(folder, kind):
    return [fields for fields in map(json.loads, lines(folder)) if fields["kind"] == kind]


def test_threads_change_no_trial(board, monkeypatch):
    found = []
    for threads in "12":
        monkeypatch.setenv("ANTGYM_THREADS", threads)
        found.append(sorted(lines(board(threads))))
    assert found[0] == found[1]


def test_every_agent_plays_every_map_with_every_seed(board):
    outcomes = records(board(), "outcome")
    expected = {(agent, seed) for agent in (*AGENTS, STATIC) for seed in "01"}
    played = [tuple(fields["run"].split("/")) for fields in outcomes]
    assert len(played) == len(set(played)) == 2 * len(expected)
    assert {(run[0], run[-1]) for run in played} == expected


def test_nobody_spends_more_than_the_budget(board):
    spent = {}
    for fields in records(board(), "trial"):
        spent[fields["run"].split("/")[0]] = spent.get(fields["run"].split("/")[0], 0) + 1
    assert spent == {"random_search": 4 * TINY.budget, "optuna_tpe": 4 * TINY.budget}


def test_gaps_are_never_negative_and_never_above_the_cap(board):
    gaps = np.array([fields["gaps"] for fields in records(board(), "outcome")])
    assert gaps.shape == (16, TINY.fresh)
    assert ((gaps >= 0) & (gaps <= 1)).all()


def test_the_page_and_the_table_show_every_agent(board):
    folder = board()
    for name in ("index.html", "board.md"):
        text = (folder / name).read_text(encoding="utf-8")
        assert all(agent in text for agent in (*AGENTS, STATIC))


def test_a_finished_board_is_shown_again_without_a_trial(board, monkeypatch):
    folder = board()
    before = (folder / TRIALS).read_bytes()
    (folder / "index.html").unlink()
    monkeypatch.setattr(contest, "tune_together", lambda *_: pytest.fail("a run was played again"))
    board()
    assert (folder / TRIALS).read_bytes() == before


def test_a_board_goes_on_with_what_is_missing(board):
    folder = board()
    whole = lines(folder)
    (folder / TRIALS).write_text("\n".join(whole[: len(whole) // 3]) + '\n{"run":"half a li')
    assert sorted(lines(board())) == sorted(whole)


def test_another_set_of_agents_needs_another_folder(board):
    board()
    with pytest.raises(LedgerError, match=r"begun with other settings .agents: "):
        board(agents=AGENTS[:1])


def test_an_unknown_agent_is_named_before_anything_is_written(tmp_path):
    with pytest.raises(ParameterError, match="did you mean 'random_search'"):
        run_board(Arguments("smoke", tmp_path / "board", ("random_serch",)))
    assert not (tmp_path / "board").exists()


def command(folder):
    return [
        sys.executable,
        "-m",
        "experiments.leaderboard",
        "--preset",
        "smoke",
        "--out",
        folder,
        "--agents",
        *AGENTS,
    ]


def start(folder):
    """A board in a process of its own that Ctrl-C reaches, even where the tests run in the background."""
    return subprocess.Popen(
        command(folder),
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # noqa: PLW1509 - one call, no lock
    )


def finish(folder):
    done = subprocess.run(command(folder), cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done


def signal_at(folder, count, number):
    """Run a board, signal it when its ledger has so many whole lines, and return what it left."""
    process = start(folder)
    while process.poll() is None and (not (folder / TRIALS).exists() or len(lines(folder)) < count):
        time.sleep(0.002)
    process.send_signal(number)
    _, errors = process.communicate()
    return process.returncode, errors


@pytest.fixture(scope="session")
def whole(tmp_path_factory):
    """A smoke board that nobody interrupted."""
    folder = tmp_path_factory.mktemp("leaderboard") / "whole"
    finish(folder)
    return folder


@pytest.fixture
def begun(whole, tmp_path):
    """A folder with the trained agents of the whole board, so that what is interrupted are trials."""
    shutil.copytree(whole / "trained", tmp_path / "begun" / "trained")
    return tmp_path / "begun"


@pytest.mark.slow
def test_killed_again_and_again_a_board_loses_nothing_and_repeats_nothing(whole, begun):
    rng, total, kept = np.random.default_rng(0), len(lines(whole)), []
    for _ in range(5):
        code, _ = signal_at(begun, len(kept) + int(rng.integers(1, total // 6)), signal.SIGKILL)
        assert code == -signal.SIGKILL
        now = lines(begun)
        assert now[: len(kept)] == kept
        kept = now
    assert len(kept) < total
    finish(begun)
    trials = [(fields["run"], fields["index"]) for fields in records(begun, "trial")]
    assert len(trials) == len(set(trials))
    assert sorted(lines(begun)) == sorted(lines(whole))
    assert (begun / "index.html").stat().st_size > 10_000


@pytest.mark.slow
def test_ctrl_c_says_how_to_go_on_and_the_same_command_does(whole, begun):
    code, errors = signal_at(begun, 10, signal.SIGINT)
    assert code == 130
    assert errors.strip().splitlines()[-1] == "interrupted; the same command goes on where this one stopped"
    assert "Traceback" not in errors
    finish(begun)
    assert sorted(lines(begun)) == sorted(lines(whole))


@pytest.mark.slow
def test_a_folder_in_use_is_one_line_and_exit_code_2(begun):
    process = start(begun)
    while not (begun / MANIFEST).exists():  # written under the lock
        time.sleep(0.01)
    os.kill(process.pid, signal.SIGSTOP)  # else it might be done before the other begins
    done = subprocess.run(command(begun), cwd=ROOT, capture_output=True, text=True, check=False)
    os.kill(process.pid, signal.SIGCONT)
    process.communicate()
    assert done.returncode == 2
    assert done.stderr.startswith("error: ")
    assert "in use by another process" in done.stderr


def test_bees_have_a_board(monkeypatch, tmp_path):
    """With every trained agent's file made in their world, and a picture of the discs."""
    monkeypatch.setitem(
        PRESETS, "smoke", TINY._replace(race_maps=2, race_settings=2, experience_maps=8, experience_trials=32)
    )
    chosen = ("random_search", "portfolio")
    page = run_board(Arguments("smoke", tmp_path / "bees", chosen, "tabu-bee-v0", "test"))
    text = page.read_text(encoding="utf-8")
    assert "tabu-bee-v0, test" in text
    assert "tangents and arcs; no bees" in text
    assert "--suite tabu-bee-v0 --split test" in text
    assert json.loads((tmp_path / "bees" / "trained" / "static.json").read_text())["parameters"][0] == "limit"
