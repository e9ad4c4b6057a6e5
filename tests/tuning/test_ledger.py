"""Ledgers: what is told is on disk, a resumed run is the run that was not stopped, and damage is named."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from antgym.errors import LedgerError
from antgym.maps.world import GridWorld, Scenario
from antgym.tuning import problem as problems
from antgym.tuning.agent import tune
from antgym.tuning.ledger import MANIFEST, TIMING, TRIALS, Ledger, Outcome
from antgym.tuning.problem import TuningProblem
from antgym.tuning.session import Record, Session, Trial
from experiments.orders import ask, asked, broken, note_broken

CONFIG, VERSIONS = {"budget": 9, "maps": ["a"]}, {"antgym": "1", "numpy": "2"}
OUTCOME = Outcome((0.1, 0.2, 0.3, 0.4), (130.5, float("inf")), (0.25, 1.0))


def record(index, length=123.4, unit=(0.1, 0.25, 1 / 3, 1.0)):
    return Record(Trial(index, unit, 1.5, 77), length, 2**63 - 1)


def opened(folder, config=CONFIG, versions=VERSIONS):
    return Ledger(folder, config, versions, {"threads": 2})


def sorted_lines(folder):
    return sorted((folder / TRIALS).read_text().splitlines())


class Pacing:
    """An agent whose next batch depends on what it was told, and that can crash before a batch."""

    def __init__(self, crash_at=None):
        self.crash_at = crash_at

    def reset(self, task, *, seed):
        self.rng, self.batches, self.best = np.random.default_rng(seed), 0, np.full(len(task.space), 0.5)

    def ask(self):
        self.batches += 1
        if self.batches == self.crash_at:
            raise KeyboardInterrupt
        return np.clip(self.best + 0.3 * self.rng.standard_normal((3, len(self.best))), 0, 1)

    def tell(self, trials):
        self.best = np.array(min(trials, key=lambda trial: (trial.cost, trial.work)).unit)

    def recommend(self):
        return self.best


@pytest.fixture
def problem(valley):
    return TuningProblem(valley, ants=4, iterations=4, seed=11)


@pytest.fixture
def planner_runs(monkeypatch):
    """How many runs each call of the planner made."""
    calls, plan_many = [], problems.plan_many

    def counted(scenarios, *args, **kwargs):
        calls.append(len(scenarios))
        return plan_many(scenarios, *args, **kwargs)

    monkeypatch.setattr(problems, "plan_many", counted)
    return calls


def play(problem, folder, agent=None, budget=9):
    with opened(folder) as ledger:
        run = ledger.run("pacing/valley/0")
        return tune(agent or Pacing(), Session(problem, budget, run), seed=3)


def test_what_is_written_is_read_again(tmp_path):
    records = [record(0), record(1, float("inf")), record(2, 0.1 + 0.2)]
    with opened(tmp_path) as ledger:
        ledger.run("a/b/0").append(records[:2])
        ledger.run("a/b/1").append([record(0)])
        ledger.run("a/b/0").append(records[2:])
        ledger.run("a/b/0").finish(OUTCOME)
    with opened(tmp_path) as ledger:
        runs = {run.key: run for run in ledger.runs()}
        assert list(runs) == ["a/b/0", "a/b/1"]
        assert (runs["a/b/0"].records, runs["a/b/0"].outcome) == (records, OUTCOME)
        assert (runs["a/b/1"].records, runs["a/b/1"].outcome) == ([record(0)], None)


def test_every_line_is_plain_json(tmp_path):
    """NaN and Infinity are no JSON, though Python writes them."""
    with opened(tmp_path) as ledger:
        ledger.run("a").append([record(0, float("inf"))])
        ledger.run("a").finish(OUTCOME)

    def refuse(constant):
        raise AssertionError(constant)

    lines = [json.loads(line, parse_constant=refuse) for line in sorted_lines(tmp_path)]
    assert [line["kind"] for line in lines] == ["outcome", "trial"]


def test_the_manifest_keeps_config_first_versions_and_facts(tmp_path):
    with opened(tmp_path) as ledger:
        ledger.run("a").append([record(0)])
    with opened(tmp_path, versions={"antgym": "9"}) as ledger:
        assert ledger.manifest == json.loads((tmp_path / MANIFEST).read_text())
        assert ledger.manifest == {"schema": 2, "config": CONFIG, "versions": VERSIONS, "threads": 2}


def test_seconds_lie_apart_from_the_trials(tmp_path):
    with opened(tmp_path) as ledger:
        ledger.run("a").time(tuner=0.12345678)
    assert (tmp_path / TIMING).read_text() == '{"run":"a","tuner":0.123457}\n'
    assert (tmp_path / TRIALS).read_bytes() == b""


def test_recorded_trials_are_fed_back_without_a_planner_run(problem, tmp_path, planner_runs):
    first = play(problem, tmp_path)
    assert planner_runs == [3, 3, 3]
    again = play(problem, tmp_path)
    assert planner_runs == [3, 3, 3]
    assert again.trials == first.trials
    assert again.recommendation.tolist() == first.recommendation.tolist()


def test_a_run_that_crashed_between_two_batches_ends_like_one_that_did_not(problem, tmp_path, planner_runs):
    whole, crashed = tmp_path / "whole", tmp_path / "crashed"
    play(problem, whole)
    with pytest.raises(KeyboardInterrupt):
        play(problem, crashed, Pacing(crash_at=3))
    assert len(sorted_lines(crashed)) == 6
    planner_runs.clear()
    play(problem, crashed)
    assert planner_runs == [3]
    assert sorted_lines(crashed) == sorted_lines(whole)


@pytest.mark.parametrize("share", np.linspace(0, 1, 12))
def test_a_run_cut_off_at_any_byte_ends_like_one_that_was_not(problem, tmp_path, share):
    whole, torn = tmp_path / "whole", tmp_path / "torn"
    play(problem, whole)
    play(problem, torn)
    os.truncate(torn / TRIALS, int(share * (torn / TRIALS).stat().st_size))
    play(problem, torn)
    assert (torn / TRIALS).read_bytes() == (whole / TRIALS).read_bytes()


def test_a_batch_recorded_in_part_is_finished(problem, tmp_path, planner_runs):
    trials = play(problem, tmp_path).trials
    lines = (tmp_path / TRIALS).read_text().splitlines(keepends=True)
    (tmp_path / TRIALS).write_text("".join(lines[:4]))
    planner_runs.clear()
    assert play(problem, tmp_path).trials == trials
    assert planner_runs == [2, 3]


def test_another_proposal_than_the_recorded_is_named(tmp_path):
    with opened(tmp_path) as ledger:
        ledger.run("ga/valley/3").append([record(0), record(1)])
    with opened(tmp_path, versions={"antgym": "1", "numpy": "3", "cmaes": "0.1"}) as ledger:
        message = (
            r"run 'ga/valley/3', trial 1: .* setting .* now it is \(0.9, .*"
            r"versions changed: cmaes None -> 0.1, numpy 2 -> 3"
        )
        with pytest.raises(LedgerError, match=message):
            ledger.run("ga/valley/3").replay(1, (0.9, 0.9, 0.9, 0.9), 2**63 - 1)


def test_another_proposal_under_the_same_versions_says_so(tmp_path):
    with opened(tmp_path) as ledger:
        ledger.run("ga").append([record(0)])
        with pytest.raises(LedgerError, match="no library version changed"):
            ledger.run("ga").replay(0, (0.5,) * 4, 2**63 - 1)


def test_an_agent_that_changed_is_stopped_before_a_planner_run(problem, tmp_path, planner_runs):
    play(problem, tmp_path, budget=3)
    planner_runs.clear()
    with opened(tmp_path) as ledger, pytest.raises(LedgerError, match="trial 0"):
        tune(Pacing(), Session(problem, 3, ledger.run("pacing/valley/0")), seed=4)
    assert planner_runs == []


@pytest.mark.parametrize("file", [TRIALS, TIMING])
def test_a_last_line_cut_short_is_dropped(tmp_path, file):
    with opened(tmp_path) as ledger:
        ledger.run("a").append([record(0)])
        ledger.run("a").time(tuner=1.0)
    whole = (tmp_path / file).read_bytes()
    (tmp_path / file).write_bytes(whole + whole[:-1])
    with opened(tmp_path) as ledger:
        assert len(ledger.run("a").records) == 1
    assert (tmp_path / file).read_bytes() == whole


@pytest.mark.parametrize(
    "damage",
    [
        "{",
        "\0\0\0",
        "[]",
        "7",
        '{"run": "a"}',
        '{"run":"a","kind":"trial","index":5,"unit":[],"cost":1,"work":1}',
    ],
)
def test_a_damaged_line_is_named_with_its_number(tmp_path, damage):
    with opened(tmp_path) as ledger:
        ledger.run("a").append([record(i) for i in range(3)])
    lines = (tmp_path / TRIALS).read_text().splitlines()
    lines[1] = damage
    (tmp_path / TRIALS).write_text("\n".join(lines) + "\n")
    with pytest.raises(LedgerError, match=r"trials\.jsonl, line 2 is damaged"):
        opened(tmp_path)


def test_a_damaged_ledger_is_left_as_it_is_and_unlocked(tmp_path):
    with opened(tmp_path):
        pass
    (tmp_path / TRIALS).write_text("{\n")
    for _ in range(2):
        with pytest.raises(LedgerError, match="line 1 is damaged"):
            opened(tmp_path)
    assert (tmp_path / TRIALS).read_text() == "{\n"


def test_a_damaged_manifest_is_named(tmp_path):
    (tmp_path / MANIFEST).write_text('{"schema"')
    with pytest.raises(LedgerError, match=r"manifest\.json is damaged"):
        opened(tmp_path)


def test_another_schema_is_refused(tmp_path):
    (tmp_path / MANIFEST).write_text('{"schema": 0}')
    with pytest.raises(LedgerError, match="schema 0, this antgym reads 1, 2;"):
        opened(tmp_path)


def test_a_second_handle_on_the_folder_is_refused(tmp_path):
    with opened(tmp_path), pytest.raises(LedgerError, match="in use by another process"):
        opened(tmp_path)
    with opened(tmp_path) as ledger:
        ledger.run("a").append([record(0)])


def test_another_process_on_the_folder_is_refused(tmp_path):
    script = (
        "import sys\nfrom antgym.errors import LedgerError\nfrom antgym.tuning.ledger import Ledger\n"
        "try:\n    Ledger(sys.argv[1], {}, {})\nexcept LedgerError as error:\n    print(error)\n"
    )
    with opened(tmp_path):
        done = subprocess.run(
            [sys.executable, "-c", script, tmp_path], capture_output=True, text=True, check=True
        )
    assert "in use by another process" in done.stdout


def test_a_folder_begun_with_another_config_is_refused_by_what_differs(tmp_path):
    with opened(tmp_path) as ledger:
        ledger.run("a").append([record(0)])
    with pytest.raises(LedgerError, match=r"begun with other settings .budget: .*; seeds: "):
        opened(tmp_path, {"budget": 10, "maps": ["a"], "seeds": 3})


def test_a_folder_in_which_nothing_ran_is_begun_anew(tmp_path):
    """A start that failed before its first trial binds neither to its config nor to its files."""
    with opened(tmp_path) as ledger:
        ledger.pin({"graph.json": "aa"})
        ask(tmp_path, ["a", "b", "c"])
        note_broken(tmp_path, ["c"], "no memory")
    other = {"budget": 10}
    with opened(tmp_path, other) as ledger:
        ledger.pin({"graph.json": "bb"})
        ask(tmp_path, ["c"], anew=ledger.renewed)
        ledger.run("c").append([record(0)])
        ask(tmp_path, ["d"], anew=ledger.renewed)
    assert (asked(tmp_path), broken(tmp_path)) == (["c", "d"], {})
    with pytest.raises(LedgerError, match="begun with other settings"):
        opened(tmp_path)
    with opened(tmp_path, other) as ledger, pytest.raises(LedgerError, match=r"graph\.json is not the file"):
        ledger.pin({"graph.json": "aa"})


def test_a_config_that_json_changes_is_still_the_same_config(tmp_path):
    for _ in range(2):
        with opened(tmp_path, {"maps": ("a", "b"), "effort": (1, 2)}):
            pass


def test_a_path_that_is_no_folder_is_refused(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(LedgerError, match="cannot hold a ledger"):
        opened(tmp_path / "file")


FULL_DISK = """
import resource, sys
from pathlib import Path
sys.path[:0] = [{tests!r}]
import test_ledger as t
folder = Path(sys.argv[1])
with t.opened(folder) as ledger:
    run = ledger.run("a")
    run.append([t.record(0)])
    size = (folder / t.TRIALS).stat().st_size
    resource.setrlimit(resource.RLIMIT_FSIZE, (size + 20, resource.RLIM_INFINITY))
    for _ in range(2):
        try:
            run.append([t.record(1), t.record(2)])
        except t.LedgerError as error:
            print(error)
    print(len(run.records), (folder / t.TRIALS).stat().st_size == size)
    resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
    run.append([t.record(1)])
"""


def test_a_full_disk_leaves_no_half_accepted_trial(tmp_path):
    script = FULL_DISK.format(tests=str(Path(__file__).parent))
    done = subprocess.run(
        [sys.executable, "-c", script, tmp_path], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    first, second, kept = done.stdout.splitlines()
    assert first == second
    assert "trials.jsonl cannot be written: File too large; nothing of this batch is kept" in first
    assert kept == "1 True"
    with opened(tmp_path) as ledger:
        assert ledger.run("a").records == [record(0), record(1)]


def test_inf_lengths_of_a_real_run_survive(tmp_path):
    free = np.ones((5, 3, 3), bool)
    free[2] = False
    walled_in = TuningProblem(Scenario(GridWorld(free), (0, 1, 1), (4, 1, 1)), ants=2, iterations=2)
    play(walled_in, tmp_path, budget=2)
    with opened(tmp_path) as ledger:
        assert [r.length for r in ledger.run("pacing/valley/0").records] == [float("inf")] * 2


def test_another_planner_seed_than_the_recorded_is_named(tmp_path):
    with opened(tmp_path) as ledger:
        ledger.run("ga").append([record(0)])
        with pytest.raises(LedgerError, match="planner seed 9223372036854775807, now it is 5"):
            ledger.run("ga").replay(0, record(0).trial.unit, 5)


def test_a_pinned_file_may_not_change(tmp_path):
    with opened(tmp_path) as ledger:
        ledger.pin({"graph.json": "aa"})
    with opened(tmp_path) as ledger:
        ledger.pin({"graph.json": "aa", "policy.zip": "bb"})
        with pytest.raises(LedgerError, match=r"policy\.zip is not the file"):
            ledger.pin({"policy.zip": "cc"})


def test_a_run_that_failed_is_kept_with_its_reason(tmp_path):
    failed = Outcome((0.5,) * 4, (float("inf"),), (1.0,), "ask() hung")
    with opened(tmp_path) as ledger:
        ledger.run("bad/0").finish(failed)
        ledger.run("good/0").finish(OUTCOME)
    assert ["failure" in line for line in sorted_lines(tmp_path)] == [True, False]
    with opened(tmp_path) as ledger:
        assert ledger.run("bad/0").outcome == failed
