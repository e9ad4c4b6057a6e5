"""Tuning a map of one's own: by process, killed, stopped and resumed; what is wrong is one line."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("optuna")

from antgym import cli, plan_file
from antgym.errors import AgentError, AntgymError, BudgetError, LedgerError, ParameterError
from antgym.tuning.ledger import TRIALS
from experiments import artefacts, tune
from experiments.tune import Arguments

ROOT = Path(tune.__file__).parents[1]
HILLS = ROOT / "docs" / "hills.asc"
ENDS = ("--start", "0", "10", "2", "--goal", "20", "10", "2", "--rise", "10")


def shell(*arguments):
    command = [sys.executable, "-m", "experiments.tune", *map(str, arguments)]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)


def arguments(tmp_path, **changes):
    given = {"rise": 10.0, "agent": "random_search", "budget": 6, "iterations": 10, "fresh": 3}
    given |= {"out": tmp_path / "way", "picture": False, **changes}
    ends = {"file": HILLS, "start": (0, 10, 2), "goal": (20, 10, 2)}
    return Arguments(**{**ends, **given})


def test_a_map_is_tuned_and_everything_is_written(tmp_path):
    done = shell(HILLS, *ENDS, "--budget", 12, "--iterations", 20, "--out", tmp_path / "way")
    assert done.returncode == 0, done.stderr
    assert "expected" in done.stdout
    assert (tmp_path / "way.png").read_bytes().startswith(b"\x89PNG")
    record = json.loads((tmp_path / "way.json").read_text())
    assert len(record["tuning"]["fresh_gaps"]) == 16
    assert record["gap"] == pytest.approx(min(record["tuning"]["fresh_gaps"]))
    assert len((tmp_path / "way.trials" / TRIALS).read_text().splitlines()) == 12
    setting = done.stdout.partition("\nsetting ")[2].splitlines()[0].split()
    assert cli.run(["plan", str(HILLS), *ENDS, *setting, "--out", str(tmp_path / "again")]) == 0
    assert (tmp_path / "again.csv").read_bytes() == (tmp_path / "way.csv").read_bytes()


def test_the_setting_is_judged_on_runs_that_no_trial_was(tmp_path, monkeypatch, capsys):
    seen = []
    monkeypatch.setattr(tune, "plan_many", lambda *a, **k: seen.extend(k["seeds"]) or plan_many(*a, **k))
    from antgym.planners.planning import plan_many

    assert tune.run(arguments(tmp_path)) == 0
    trials = [
        json.loads(line)["seed"] for line in (tmp_path / "way.trials" / TRIALS).read_text().splitlines()
    ]
    assert len(seen) == len(set(seen)) == 3
    assert not set(seen) & {int(seed, 16) >> 32 for seed in trials}
    assert "6 trials" in capsys.readouterr().out


def test_no_trial_asks_for_no_ledger(tmp_path):
    assert tune.run(arguments(tmp_path, agent="published_default", budget=0)) in (0, 1)
    assert not (tmp_path / "way.trials").exists()


def test_a_run_that_was_killed_goes_on_and_ends_as_if_nothing_had_been(tmp_path):
    options = (*ENDS, "--agent", "random_search", "--budget", "200", "--iterations", "30", "--no-picture")
    whole = shell(HILLS, *options, "--out", tmp_path / "whole")
    command = [sys.executable, "-m", "experiments.tune", str(HILLS), *options, "--out", str(tmp_path / "way")]
    process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    trials = tmp_path / "way.trials" / TRIALS
    while not trials.exists() or trials.stat().st_size < 2_000:
        assert process.poll() is None
        time.sleep(0.01)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    kept = len(trials.read_text().splitlines())
    again = shell(HILLS, *options, "--out", tmp_path / "way")
    assert 0 < kept < 200
    assert len(trials.read_text().splitlines()) == 200
    assert again.stdout.replace("way", "whole").splitlines()[:2] == whole.stdout.splitlines()[:2]
    assert trials.read_bytes() == (tmp_path / "whole.trials" / TRIALS).read_bytes()


def test_ctrl_c_says_that_the_same_command_goes_on(tmp_path):
    options = (*ENDS, "--agent", "random_search", "--budget", "100000", "--iterations", "100", "--no-picture")
    command = [sys.executable, "-m", "experiments.tune", str(HILLS), *options, "--out", str(tmp_path / "way")]
    process = subprocess.Popen(
        command,
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # a shell's background job ignores SIGINT, and its children with it
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # noqa: PLW1509 - one call, no lock
    )
    trials = tmp_path / "way.trials" / TRIALS
    try:
        while not trials.exists() or trials.stat().st_size < 2_000:
            assert process.poll() is None
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode == 130
    assert said.splitlines()[-1] == "interrupted; the same command goes on where this one stopped"
    assert trials.stat().st_size > 0


def test_another_budget_needs_another_folder(tmp_path):
    tune.run(arguments(tmp_path))
    with pytest.raises(LedgerError, match=r"budget: 6, now 7.*another --out than"):
        tune.run(arguments(tmp_path, budget=7))


def test_every_agent_has_a_place_of_its_own_for_what_it_finds(tmp_path):
    places = [
        tune.default_out(arguments(tmp_path, agent=agent)).name
        for agent in ("ga", "mine/my_agent.py:MyAgent")
    ]
    assert places == ["hills-ga", "hills-my_agent.py-MyAgent"]


def test_parts_of_a_batch_are_the_batch(tmp_path):
    """The bar moves within a batch; the trials are those of one planner call."""
    from antgym.tuning.problem import TuningProblem
    from antgym.tuning.session import Session
    from experiments.watching import WatchedSession

    scenario = plan_file.read(arguments(tmp_path)).scenario
    problem, seen = TuningProblem(scenario, iterations=5), []
    units = np.random.default_rng(0).random((7, 4))
    watched = WatchedSession(problem, 5, seen.append, part=2)
    assert watched.evaluate(units) == Session(problem, 5).evaluate(units)
    assert seen == [2, 2, 1]
    with pytest.raises(BudgetError, match="all 5 trials are spent"):
        watched.evaluate(units)


def test_a_trained_agent_without_its_file_names_the_command_that_makes_it(tmp_path):
    with pytest.raises(ParameterError, match=r"experiments\.artefacts neighbours --out out/trained"):
        tune.run(arguments(tmp_path, agent="neighbours"))
    with pytest.raises(ParameterError, match=r"is not there.*experiments\.artefacts portfolio --out"):
        tune.run(arguments(tmp_path, agent="portfolio", artefacts=tmp_path))
    with pytest.raises(ParameterError, match=r"rl:open-one-shot.*experiments\.train PPO --out \S+/policy"):
        tune.run(arguments(tmp_path, agent="rl", artefacts=tmp_path))


def test_a_policy_that_is_shipped_needs_no_folder_and_says_what_it_spent(tmp_path, capsys):
    pytest.importorskip("sb3_contrib")
    pytest.importorskip("safetensors")
    for budget in (0, 2):
        tune.run(arguments(tmp_path / str(budget), agent="rl", budget=budget))
        record = json.loads((tmp_path / str(budget) / "way.json").read_text())
        assert record["tuning"]["trials"] == 0
    said = capsys.readouterr().out
    assert "rl, 0 trials, seed 0" in said
    assert "rl, 0 of 2 trials, seed 0" in said


DISCS = {"file": ROOT / "docs" / "discs.json", "start": (), "goal": (), "rise": 0.0}
BEES = {**DISCS, "rules": "wu2018", "ants": 40}


def test_a_scene_of_discs_is_tuned_for_bees_and_planned_again_by_what_is_printed(tmp_path, capsys):
    assert tune.run(arguments(tmp_path, **BEES, iterations=300)) == 0
    said = capsys.readouterr().out
    assert "random_search, 6 trials" in said
    record = json.loads((tmp_path / "way.json").read_text())
    assert record["gap"] == pytest.approx(min(record["tuning"]["fresh_gaps"]))
    setting = said.partition("\nsetting ")[2].splitlines()[0].split()
    again = ["plan", str(BEES["file"]), *setting, "--no-picture", "--out", str(tmp_path / "again")]
    assert cli.run(again) == 0
    assert (tmp_path / "again.csv").read_bytes() == (tmp_path / "way.csv").read_bytes()


def test_an_agent_that_learnt_of_ants_cannot_tune_bees(tmp_path):
    pytest.importorskip("safetensors")
    words = r"--agent rl on \S+discs.json, --rules wu2018: .*picks \['alpha'.* as optuna_tpe"
    for budget in (0, 3):
        with pytest.raises(ParameterError, match=words):
            tune.run(arguments(tmp_path, **BEES, agent="rl", budget=budget))
    assert list(tmp_path.iterdir()) == []


def test_a_trained_agent_tunes_from_its_folder(tmp_path):
    made = artefacts.Arguments(("neighbours", "transfer_graph"), preset="smoke", out=tmp_path / "trained")
    artefacts.make_artefacts(made)
    before = {path: path.stat().st_mtime_ns for path in made.out.iterdir()}
    artefacts.make_artefacts(made)
    assert {path: path.stat().st_mtime_ns for path in made.out.iterdir()} == before
    for agent, budget in (("neighbours", 0), ("transfer_graph", 5)):
        tune.run(arguments(tmp_path / agent, agent=agent, budget=budget, artefacts=made.out))
        assert (tmp_path / agent / "way.json").exists()


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"budget": -1}, "must be 0 or more"),
        ({"fresh": 0}, "at least 1"),
        ({"agent": "optuna_tp"}, "did you mean 'optuna_tpe'"),
        ({"agent": "open-trials"}, "is followed as 'rl:open-trials'"),
        ({"agent": "rl:open-trails"}, "did you mean 'rl:open-trials'"),
        ({"rules": "ants"}, "unknown rules"),
        ({"ants": 0}, "ants = 0"),
        (DISCS, "ants need --start and --goal; .* as --rules wu2018"),
        ({**BEES, "start": (1, 1)}, "--start has no effect here: rules 'wu2018' are of bees"),
        ({**BEES, "ants": 3}, "a hive has 4 bees at least"),
    ],
)
def test_what_is_wrong_is_named_and_nothing_is_written(tmp_path, changes, words):
    with pytest.raises(AntgymError, match=words):
        tune.run(arguments(tmp_path, **changes))
    assert list(tmp_path.iterdir()) == []


def test_what_is_wrong_is_one_line(tmp_path):
    done = shell(HILLS, *ENDS, "--artefact", "x", "--out", tmp_path / "way")
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1
    assert "--artefact" in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_help_teaches():
    done = shell("--help")
    assert done.returncode == 0
    for word in ("--start", "--agent", "--budget", "--artefacts", "experiments.artefacts", "fresh"):
        assert word in done.stdout


def test_an_agent_of_ones_own_tunes_a_map_and_one_that_fails_is_one_line(tmp_path, capsys):
    zoo = ROOT / "tests" / "agents" / "zoo.py"
    assert tune.run(arguments(tmp_path, agent=f"{zoo}:Honest")) in (0, 1)
    assert "zoo.py:Honest, 6 trials" in capsys.readouterr().out
    with pytest.raises(AgentError, match=r"zoo.py:Dies: ask\(\) ended its process"):
        tune.run(arguments(tmp_path, agent=f"{zoo}:Dies", out=tmp_path / "other"))
