"""The leaderboard: the same ledger however it is run, stopped, killed or resumed."""

import json
import os
import shlex
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("optuna")  # an agent
pytest.importorskip("plotly")  # the page
pytest.importorskip("matplotlib")  # the real terrain

from agents.published import SHIPPED
from agents.steering import FLAGSHIP
from antgym.console import parse
from antgym.errors import LedgerError, ParameterError
from antgym.planners.threads import thread_count
from antgym.tuning.ledger import MANIFEST, TRIALS, Ledger
from experiments import contest, leaderboard, provenance, steering
from experiments.artefacts import prepare
from experiments.leaderboard import Arguments, plan_board, run_board
from experiments.orders import ask, asked
from experiments.presets import PRESETS, Preset
from experiments.tracks import ALWAYS

AGENTS = ("uniform_random", "random_search", "optuna_tpe", "neighbours")
PLAYING = {*AGENTS, *ALWAYS}
TINY = Preset(2, 2, 5, 2, 0, 2, 1, 2, 2, 8, 32)
BUDGETS = {"A": (1, 5), "B": (0, 1, 5)}
ROOT = Path(leaderboard.__file__).parents[1]


@pytest.fixture(scope="session")
def trained(tmp_path_factory):
    """Files of agents that need training, as small as they come; of the policy only what a hash can be taken of."""
    folder = tmp_path_factory.mktemp("trained")
    prepare(folder, "mountain-v0", TINY, ALWAYS)
    (folder / "policy.json").write_text('{"evaluations": 0}')
    return folder


@pytest.fixture
def small(monkeypatch):
    """The preset of tests."""
    monkeypatch.setitem(PRESETS, "smoke", TINY)


@pytest.fixture(scope="session")
def finished(tmp_path_factory, trained):
    """The folder of a board that is only looked at."""
    folder = tmp_path_factory.mktemp("finished") / "board"
    shutil.copytree(trained, folder / "trained")
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(PRESETS, "smoke", TINY)
        run_board(Arguments("smoke", folder, AGENTS))
    return folder


@pytest.fixture
def board(small, finished, tmp_path):
    """A function that goes on with a copy of the finished board, and returns its folder."""
    shutil.copytree(finished, tmp_path / "board")

    def run(agents=AGENTS, **others):
        folder = tmp_path / "board"
        assert run_board(Arguments("smoke", folder, agents, **others)) == folder / "index.html"
        return folder

    return run


def lines(folder):
    """The whole lines of a ledger's trials, in the order they were written."""
    data = (folder / TRIALS).read_bytes()
    return data[: data.rfind(b"\n") + 1].decode().splitlines()


def records(folder, kind):
    return [fields for fields in map(json.loads, lines(folder)) if fields["kind"] == kind]


def test_every_agent_plays_every_map_with_every_seed_at_every_budget(finished):
    outcomes = records(finished, "outcome")
    expected = {(agent, str(budget), seed) for agent in PLAYING for budget in BUDGETS["A"] for seed in "01"}
    played = [tuple(fields["run"].split("/")) for fields in outcomes]
    assert len(played) == len(set(played)) == 2 * len(expected)
    assert {(*run[:2], run[-1]) for run in played} == expected


def test_nobody_spends_more_than_the_budget(finished):
    spent = Counter(fields["run"] for fields in records(finished, "trial"))
    budgets = {run: int(run.split("/")[1]) for run in spent}
    assert all(spent[run] <= budget for run, budget in budgets.items())
    searches = [run for run in spent if run.startswith(("random_search", "optuna_tpe"))]
    assert all(spent[run] == budgets[run] for run in searches)
    assert len(searches) == 2 * 2 * 2 * len(BUDGETS["A"])


def test_gaps_are_never_negative_and_never_above_the_cap(finished):
    gaps = np.array([fields["gaps"] for fields in records(finished, "outcome")])
    assert gaps.shape == (2 * 2 * len(BUDGETS["A"]) * len(PLAYING), TINY.fresh)
    assert ((gaps >= 0) & (gaps <= 1)).all()


def test_the_page_and_the_tables_show_every_agent_and_every_reference(finished):
    for name in ("index.html", "board.md"):
        text = (finished / name).read_text(encoding="utf-8")
        assert all(agent in text for agent in (*PLAYING, "exact planner", "virtual best (bound)"))


def test_other_tracks_join_the_ledger_of_a_board_and_share_what_they_can(board, finished):
    """B's rounds with trials are A's; without a trial only those who learnt have a place; C steers single runs."""
    folder = board(track=("C", "A", "B"))
    before = lines(finished)
    assert lines(folder)[: len(before)] == before
    joined = [json.loads(line) for line in lines(folder)[len(before) :]]
    assert {fields["run"].split("/")[1] for fields in joined if fields["run"].count("/") == 3} == {"0"}
    steered = {fields["run"].split("/")[0] for fields in joined if fields["run"].count("/") == 2}
    assert steered == {*ALWAYS, "neighbours", steering.SCHEDULE, "open-control"} - {"random_search"}
    tables = (folder / "board.md").read_text(encoding="utf-8")
    without = tables.partition("0 trials per map")[2].partition("##")[0]
    assert "| 1 | neighbours |" in without
    assert "*uniform_random*" in without
    assert "optuna_tpe" not in without
    assert tables.count("In italics: references.") == len((*BUDGETS["A"], *BUDGETS["B"], "C"))


def test_help_names_every_reference(capsys):
    with pytest.raises(SystemExit):
        parse(Arguments, ["--help"], "board")
    told = " ".join(capsys.readouterr().out.replace("│", " ").split())
    assert all(name in told for name in (*ALWAYS, "exact planner", "virtual best"))


@pytest.mark.parametrize("controllers", [None, (), ("x", "y")])
def test_the_command_on_a_board_makes_it_again(controllers):
    given = Arguments(
        "full", Path("x"), suite="own maps", split="test", track=("A", "C"), maps=3, controllers=controllers
    )
    words = shlex.split(leaderboard.command(given))
    assert words[:3] == ["python", "-m", "experiments.leaderboard"]
    assert parse(Arguments, [*words[3:], "--out", "x"], "board") == given


def test_threads_change_no_trial(small, finished, trained, tmp_path, monkeypatch):
    """ANTGYM_THREADS was whatever it is for these tests; another number leaves the same ledger."""
    monkeypatch.setenv("ANTGYM_THREADS", "1" if thread_count() > 1 else "2")
    shutil.copytree(trained, tmp_path / "board" / "trained")
    run_board(Arguments("smoke", tmp_path / "board", AGENTS))
    assert sorted(lines(tmp_path / "board")) == sorted(lines(finished))


def test_a_finished_board_is_shown_again_without_a_trial(board, finished, monkeypatch):
    monkeypatch.setattr(contest, "tune_together", lambda *_: pytest.fail("a run was played again"))
    folder = board()
    for name in (TRIALS, "timing.jsonl", "board.md", "index.html"):
        assert (folder / name).read_bytes() == (finished / name).read_bytes()


def test_a_board_goes_on_with_what_is_missing(board, finished, tmp_path):
    whole = lines(finished)
    (tmp_path / "board" / TRIALS).write_text("\n".join(whole[: len(whole) // 3]) + '\n{"run":"half a li')
    assert sorted(lines(board())) == sorted(whole)


def test_another_set_of_agents_needs_another_folder(board):
    with pytest.raises(LedgerError, match=r"begun with other settings .agents: "):
        board(AGENTS[:1])


@pytest.mark.parametrize(
    ("others", "message"),
    [
        ({"agents": ("ga", "ga")}, "--agents ga ga: name at least one, and each once"),
        ({"track": ()}, "--track : name at least one"),
        ({"split": "train"}, "agents learn from these maps"),
        ({"maps": 0}, "--maps 0"),
        ({"budgets": (0,)}, "1 or more in track A"),
        ({"budgets": (-1,), "track": ("B",)}, "--budgets -1"),
        ({"controllers": ("steer",)}, "add --track C"),
        ({"controllers": ("nothere",), "track": ("C",)}, r"nothere\.json: no such policy"),
        ({"controllers": ("open-trials",), "track": ("C",)}, "policies of Control and OneShot take part"),
        (
            {"controllers": ("open-control",), "track": ("C",), "suite": "tabu-bee-v0", "split": "test"},
            "the task has .'limit'",
        ),
        ({"agents": ("rl_committee",)}, "shipped: rl_committee:open-committee"),
        ({"agents": ("rl:open-trials",), "track": ("B",)}, "budgets are 1 or more"),
        ({"agents": ("rl:open-trials",), "track": ("C",)}, "budgets are 1 or more"),
        ({"suite": "no/folder"}, "no such folder"),
        ({"suite": "fleet-v0", "split": "test", "track": ("A", "C")}, "is a fleet, .* leave track C out"),
    ],
)
def test_what_no_board_can_be_made_of_is_refused_before_anything_is_written(tmp_path, others, message):
    with pytest.raises(ParameterError, match=message):
        run_board(Arguments("smoke", tmp_path / "board", **others))
    assert not (tmp_path / "board").exists()


def test_a_boards_config_holds_what_decides_failures_and_the_harness_that_does():
    short, long = (plan_board(Arguments("smoke", call_seconds=seconds)).config for seconds in (1.0, 2.0))
    assert {name for name in short if short[name] != long[name]} == {"call_seconds"}
    assert short["code"] == provenance.code_hash(*provenance.CONTEST) != provenance.code_hash()


def test_a_board_of_control_that_names_no_policy_needs_none_of_their_libraries(tmp_path):
    board = Arguments("smoke", tmp_path, ("random_search",), track=("C",), controllers=())
    plan = plan_board(board)
    assert "torch" not in plan.versions
    (played,) = leaderboard.untrained_board(board, plan)
    assert not {entrant.name for entrant in played.entrants} - {*ALWAYS, steering.SCHEDULE}
    assert {entrant.name for entrant in played.entrants if entrant.steers} == {steering.SCHEDULE}


def test_controllers_of_one_name_are_refused_before_anything_is_written(tmp_path):
    for path in SHIPPED.glob(f"{FLAGSHIP}.*"):
        shutil.copy(path, tmp_path)
    policies = (FLAGSHIP, str(tmp_path / FLAGSHIP))
    board = Arguments("smoke", tmp_path / "board", ("random_search",), track=("C",), controllers=policies)
    with pytest.raises(ParameterError, match="controllers need names of their own"):
        run_board(board)
    assert not board.out.exists()


def test_what_was_asked_under_other_settings_is_forgotten_before_a_training_that_may_be_stopped(
    tmp_path, monkeypatch
):
    with Ledger(tmp_path, {"of": "before"}, {}):
        ask(tmp_path, ["old/1/map/0"])

    def stopped(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(leaderboard, "prepare", stopped)
    with pytest.raises(KeyboardInterrupt):
        run_board(Arguments("smoke", tmp_path, ("random_search",)))
    assert asked(tmp_path) == []


def test_maps_of_ones_own_need_rules_that_agents_can_learn_of(tmp_path):
    docs = ROOT / "docs"
    for split, names in {"train": ["hills.asc"], "test": ["hills.asc", "flat.yaml", "flat.png"]}.items():
        (tmp_path / "own" / split).mkdir(parents=True)
        for name in names:
            shutil.copy(docs / name, tmp_path / "own" / split / name)
    own = Arguments("smoke", tmp_path / "board", suite=str(tmp_path / "own"), split="test", maps=1)
    with pytest.raises(ParameterError, match="rules ant_colony_system, which test has"):
        plan_board(own)


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


@pytest.mark.slow
def test_threads_change_neither_a_trial_nor_a_table(tmp_path, begun):
    """On every track, with the trained agents of one board; seconds apart, which a table holds in two columns."""
    found = []
    for threads in "12":
        folder = tmp_path / threads
        shutil.copytree(begun / "trained", folder / "trained")
        environment = {**os.environ, "ANTGYM_THREADS": threads}
        words = [*command(folder), "--track", "A", "B", "C"]
        done = subprocess.run(words, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        found.append((sorted(lines(folder)), without_seconds(folder / "board.md")))
    assert found[0] == found[1]
    assert len(found[0][1]) > 10


def without_seconds(path):
    """The lines of all tables, the columns of seconds left out."""
    shown, kept = [], []
    for line in path.read_text(encoding="utf-8").splitlines():
        cells = line.split(" | ")
        if cells[0] == "| #":
            kept = [i for i, heading in enumerate(cells) if heading not in ("tuner s", "planner s")]
        shown += [tuple(cells[i] for i in kept)] if len(cells) > len(kept) else [line]
    return shown


def test_bees_have_boards(monkeypatch, tmp_path):
    """On every track, with every trained agent's file made in their world, and pictures of the discs."""
    monkeypatch.setitem(PRESETS, "smoke", TINY._replace(seeds=1))
    arguments = Arguments(
        "smoke", tmp_path / "bees", ("portfolio",), "tabu-bee-v0", "test", ("A", "B", "C"), maps=1
    )
    text = run_board(arguments).read_text(encoding="utf-8")
    assert "tabu-bee-v0, test" in text
    assert "tangents and arcs; no bees" in text
    assert "--suite tabu-bee-v0 --split test" in text
    assert json.loads((tmp_path / "bees" / "trained" / "static.json").read_text())["parameters"][0] == "limit"
