"""Boards with strangers on them: what fails is named and counted, what is sound is unmoved, and the guide holds."""

import json
import re
import shlex
import shutil
from copy import copy
from pathlib import Path

import numpy as np
import pytest
import tyro

pytest.importorskip("plotly")  # the page
pytest.importorskip("matplotlib")  # the real terrain

from antgym.envs.control import BLOCKS
from antgym.errors import LedgerError, ParameterError
from antgym.maps.suites import load_suite
from antgym.tuning import Session
from antgym.tuning.ledger import TRIALS, Ledger
from antgym.tuning.run_features import CONTROL_FEATURES
from antgym.tuning.session import steer_together
from experiments import steering
from experiments.artefacts import prepare
from experiments.contest import enter, foreign_files, jobs, play
from experiments.leaderboard import Arguments, plan_board, run_board
from experiments.presets import PRESETS, Preset
from experiments.rows import to_row
from experiments.tracks import ALWAYS, Round

ROOT = Path(__file__).parents[2]
ZOO = ROOT / "tests" / "agents" / "zoo.py"
EXAMPLE = ROOT / "docs" / "example-submission"
TINY = Preset(2, 1, 5, 2, 0, 3, 1, 2, 2, 8, 32)


@pytest.fixture(scope="module")
def trained(tmp_path_factory):
    """What the references of every board need, as small as it comes."""
    folder = tmp_path_factory.mktemp("trained")
    prepare(folder, "mountain-v0", TINY, ALWAYS)
    return folder


def run_tiny(folder, trained, *names, **others):
    """Run a tiny board in a folder and return the folder."""
    shutil.copytree(trained, folder / "trained")
    asked = {"suite": "mountain-v0", "split": "test", "budgets": (5,), "call_seconds": 0.5, **others}
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(PRESETS, "smoke", TINY)
        run_board(Arguments("smoke", folder, names, **asked))
    return folder


def records(folder):
    return [json.loads(line) for line in (folder / TRIALS).read_text().splitlines()]


BAD = {"HangsAwake": "hung: no answer within 0.5 s", "AnswersNaN": "alpha = nan", "Dies": "exit status 3"}
SOUND = ("sobol", f"{ZOO}:Honest", f"{ZOO}:Overspends")


@pytest.fixture(scope="module")
def sly(tmp_path_factory):
    """A submission whose names are meant for a browser to run."""
    folder = tmp_path_factory.mktemp("sly")
    shutil.copy(EXAMPLE / "table.json", folder)
    manifest = json.loads((EXAMPLE / "submission.json").read_text())
    manifest |= {"name": "<script>alert(1)</script>", "summary": '"><img src=x onerror=alert(1)>'}
    manifest["track"] = "A"
    (folder / "submission.json").write_text(json.dumps(manifest))
    return folder


@pytest.fixture(scope="module")
def together(tmp_path_factory, trained, sly):
    """A board of sound agents and bad ones."""
    bad = [f"{ZOO}:{kind}" for kind in BAD]
    return run_tiny(tmp_path_factory.mktemp("board") / "together", trained, *SOUND, str(sly), *bad)


def test_those_who_fail_are_named_and_count_as_without_a_path(together):
    failed = [line for line in records(together) if "failure" in line]
    assert len(failed) == len(BAD) * TINY.scenarios * TINY.seeds
    for line in failed:
        assert BAD[line["run"].partition("zoo.py:")[2].partition("/")[0]] in line["failure"]
        assert (line["gaps"], line["lengths"], line["unit"]) == ([1.0] * 2, [None] * 2, [0.5] * 4)
    for face in ("index.html", "board.md"):
        text = (together / face).read_text()
        said = "2 of 2 runs failed and count as if they had found no path, the first because zoo.py"
        assert all(f"{said}:{kind}" in text for kind in BAD)


def test_a_board_goes_on_as_if_those_who_fail_were_not_there(together, trained, tmp_path):
    alone = run_tiny(tmp_path / "alone", trained, *SOUND)
    runs = {line["run"] for line in records(alone)}
    assert [line for line in records(together) if line["run"] in runs] == records(alone)
    assert all(name in (together / "board.md").read_text() for name in SOUND)


def test_a_board_that_goes_on_ends_the_runs_of_who_answers_otherwise(tmp_path):
    """Be it with other settings or with none, and nobody else's."""
    item = load_suite("mountain-v0", "test")[0]
    playing = enter([f"{ZOO}:{kind}" for kind in ("Whimsical", "LosesHeart", "Honest")], tmp_path, {})
    todo = list(jobs(playing, [item], 1, [5]))
    with Ledger(tmp_path / "ledger", {}, {}) as ledger:
        for job in todo:  # as if it had been stopped after a batch
            session = Session(job.problem, 5, ledger.run(job.key))
            session.evaluate(_first_batch(playing[2].agent, session, job.agent_seed))
        play(todo, ledger, 2, lambda _: None)
        *fickle, honest = (ledger.run(job.key) for job in todo)
    for run, kind in zip(fickle, ("Whimsical", "LosesHeart"), strict=True):
        assert f"zoo.py:{kind}: ask() answered otherwise than before" in run.outcome.failure
        assert len(run.records) == 3
    assert (len(honest.records), honest.outcome.failure) == (5, "")


def _first_batch(agent, session, seed):
    agent = copy(agent)
    agent.reset(session.task, seed=seed)
    return agent.ask()


def test_a_run_within_that_goes_on_ends_where_its_stranger_recommends_otherwise(tmp_path):
    items = steering.steerable(load_suite("mountain-v0", "test")[:1])
    playing = enter([f"{ZOO}:{kind}" for kind in ("Wavers", "Honest")], tmp_path, {})
    todo = [steering.Job(e, items[0], 0) for e in steering.controllers(playing, (), "", None)]
    with Ledger(tmp_path / "ledger", {}, {}) as ledger:
        for job in todo:  # as if it had been stopped between a trial and its outcome
            session = Session(job.problem, 1, ledger.run(job.key))
            session.open(BLOCKS)
            for _ in range(BLOCKS):
                steer_together([(session, [0.5] * 4)])
        steering.play(todo, ledger, lambda _: None)
        wavering, honest = (ledger.run(job.key).outcome for job in todo)
    assert "zoo.py:Wavers: recommend() answered otherwise than before" in wavering.failure
    assert (honest.failure, honest.unit) == ("", (0.5,) * 4 * BLOCKS)


def test_nobody_is_charged_for_more_than_the_budget(together):
    trials = [line for line in records(together) if line["kind"] == "trial" and "Overspends" in line["run"]]
    assert len(trials) == TINY.budget * TINY.scenarios


def test_script_in_the_names_of_a_submission_is_text_on_the_page(together):
    page = (together / "index.html").read_text()
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in page
    assert "<script>alert" not in page
    assert "<img src=x" not in page


def test_a_file_that_changed_needs_another_folder(tmp_path):
    mine = tmp_path / "mine.py"
    mine.write_text(ZOO.read_text())
    name = f"{mine}:Honest"
    with Ledger(tmp_path / "ledger", {}, {}) as ledger:
        ledger.pin(foreign_files([name, str(EXAMPLE)]))
        ledger.pin(foreign_files([name, str(EXAMPLE)]))
        mine.write_text(ZOO.read_text() + "\n")
        with pytest.raises(LedgerError, match=r"mine.py:Honest \(mine.py\) is not the file"):
            ledger.pin(foreign_files([name]))


def test_what_an_agent_imports_from_beside_it_is_pinned_too_and_none_of_it_is_run(tmp_path):
    (tmp_path / "kit").mkdir()
    (tmp_path / "kit" / "__init__.py").write_text("")
    (tmp_path / "kit" / "steps.py").write_text("from helper import SIZE")
    (tmp_path / "helper.py").write_text("SIZE = 1\nraise SystemExit")
    (tmp_path / "apart.py").write_text("")
    (tmp_path / "mine.py").write_text(f"import numpy\nimport kit.steps\n{ZOO.read_text()}")
    name = f"{tmp_path / 'mine.py'}:Honest"
    files = ("helper.py", "kit/__init__.py", "kit/steps.py", "mine.py")
    before = foreign_files([name])
    assert sorted(before) == [f"{name} ({file})" for file in files]
    (tmp_path / "helper.py").write_text("SIZE = 2")
    after = foreign_files([name])
    assert [key for key in before if before[key] != after[key]] == [f"{name} (helper.py)"]


def test_strangers_and_submissions_play_where_settings_stay_within_a_run(trained, tmp_path):
    """Track C takes what agents recommend without a trial; who fails is no reason for the others to stop."""
    names = (f"{ZOO}:Honest", f"{ZOO}:AnswersNaN", str(EXAMPLE))
    folder = run_tiny(tmp_path / "within", trained, *names, track=("C",), budgets=())
    ended = {
        line["run"].split("/mountain-v0")[0]: line for line in records(folder) if line["kind"] == "outcome"
    }
    assert "alpha = nan" in ended[names[1]]["failure"]
    assert (ended[names[1]]["gaps"], ended[names[1]]["unit"]) == ([1.0], [0.5] * 4)
    assert ended[names[2]]["unit"][:4] == [0.047, 0.087, 0.613, 0.773]
    assert "failure" not in ended[names[0]]


def test_a_submission_that_steers_plays_within_runs_and_nowhere_else(trained, tmp_path):
    """What its weights make impossible is its own failure, there as well."""
    pytest.importorskip("stable_baselines3")
    torch = pytest.importorskip("torch")
    from blank_models import blank_model

    from agents.networks import export

    model, names = blank_model(size=len(CONTROL_FEATURES)), {}
    for name in ("sound", "beyond"):
        names[name] = str(tmp_path / name)
        export(model, tmp_path / name / "net", regime="Control")
        manifest = json.loads((EXAMPLE / "submission.json").read_text())
        manifest |= {"track": "C", "kind": "policy", "files": ["net.json", "net.safetensors"]}
        (tmp_path / name / "submission.json").write_text(json.dumps(manifest))
        with torch.no_grad():  # of the second
            for weights in model.policy.parameters():
                weights.copy_(torch.where(weights > 0, 3e38, -3e38))
    with pytest.raises(ParameterError, match="sound steers runs, which is track C; add --track C"):
        run_tiny(tmp_path / "before", trained, names["sound"])
    folder = run_tiny(tmp_path / "board", trained, *names.values(), track=("A", "C"))
    runs = {name: [line for line in records(folder) if line["run"].startswith(names[name])] for name in names}
    kinds = [line["kind"] for line in runs["sound"]]
    assert (kinds.count("trial"), kinds.count("outcome")) == (TINY.scenarios * TINY.seeds,) * 2
    assert all("its network cannot work" in line["failure"] for line in runs["beyond"])
    assert len(runs["beyond"]) == TINY.scenarios * TINY.seeds


def test_a_submissions_trials_stand_in_the_table(tmp_path):
    (entrant,) = enter([str(EXAMPLE)], tmp_path, {})
    assert (entrant.training, entrant.kind, entrant.track, entrant.trials) == (512, "agent", "B", 0)


def test_trials_before_the_board_stand_beside_those_on_it(sly, tmp_path):
    """A table tuned on each map was paid for on each map, and is no zero-shot agent."""
    manifest = json.loads((sly / "submission.json").read_text()) | {"trials": 4}
    mine = tmp_path / "mine"
    shutil.copytree(sly, mine)
    (mine / "submission.json").write_text(json.dumps(manifest))
    played = Round("A", 5, tuple(enter([str(mine)], tmp_path, {})), load_suite("mountain-v0", "test")[:1], 1)
    with Ledger(tmp_path / "ledger", {}, {}) as ledger:
        play(list(played.jobs), ledger, 2, lambda _: None)
        assert to_row(played, played.entrants[0], ledger, {}).deploy == 4


def test_a_submission_that_would_be_on_no_board_is_refused(tmp_path):
    with pytest.raises(ParameterError, match="submitted for track B, 0 trials on each map, has no place"):
        plan_board(Arguments("smoke", tmp_path, (str(EXAMPLE),), track=("A",)))


def test_a_limit_of_no_time_is_refused(tmp_path):
    with pytest.raises(ParameterError, match="--call-seconds 0"):
        enter([f"{ZOO}:Honest"], tmp_path, {}, call_seconds=0.0)


def blocks(text, language):
    return re.findall(rf"```{language}\n(.*?)```", text, flags=re.DOTALL)


def test_a_newcomer_adds_an_agent_from_the_guide_alone(monkeypatch, tmp_path, capsys):
    guide = (ROOT / "docs" / "add-your-agent.md").read_text()
    (code,) = blocks(guide, "python")
    assert len(code.splitlines()) <= 30
    name = re.search(r"Save this as `(\w+\.py)`", guide)[1]
    command = next(line for line in blocks(guide, "sh") if "experiments.leaderboard" in line)
    monkeypatch.chdir(tmp_path)
    Path(name).write_text(code)
    python, dash, module, *arguments = shlex.split(command)
    assert (python, dash, module) == ("python", "-m", "experiments.leaderboard")
    page = run_board(tyro.cli(Arguments, args=arguments))
    assert page == Path("out/mine/index.html")
    row = next(line for line in Path("out/mine/board.md").read_text().splitlines() if "MyAgent" in line)
    assert "%" not in row.split("|")[3]
    assert np.isfinite(float(row.split("|")[3].split()[0]))
    assert "MyAgent" in page.read_text()
    assert "MyAgent" in capsys.readouterr().out
