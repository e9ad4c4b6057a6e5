"""Boards with strangers on them: what fails is named and counted, what is sound is unmoved, and the guide holds."""

import json
import re
import shlex
from pathlib import Path

import numpy as np
import pytest
import tyro

pytest.importorskip("plotly")  # the page
pytest.importorskip("matplotlib")  # the real terrain

from agents.static import StaticSetting
from antgym.errors import LedgerError, ParameterError
from antgym.planners.parameters import ColonyParameters
from antgym.tuning.ledger import TRIALS
from experiments.contest import enter
from experiments.leaderboard import Arguments, run_board
from experiments.presets import PRESETS, Preset

ROOT = Path(__file__).parents[2]
ZOO = ROOT / "tests" / "agents" / "zoo.py"
EXAMPLE = ROOT / "docs" / "example-submission"
TINY = Preset(2, 1, 5, 2, 0, 3, 1, 1, 1, 1, 1)


@pytest.fixture
def board(monkeypatch, tmp_path):
    """A function that runs a tiny board and returns its folder."""
    monkeypatch.setitem(PRESETS, "smoke", TINY)

    def run(name, *names):
        folder = tmp_path / name
        if not folder.exists():
            (folder / "trained").mkdir(parents=True)
            setting = StaticSetting((0.6, 0.2, 0.6, 0.6), 7, ColonyParameters._fields)
            setting.save(folder / "trained" / "static.json")
        run_board(Arguments("smoke", folder, names, suite="mountain-v0", split="test", call_seconds=0.3))
        return folder

    return run


def records(folder):
    return [json.loads(line) for line in (folder / TRIALS).read_text().splitlines()]


BAD = {"HangsAwake": "hung: no answer within 0.3 s", "AnswersNaN": "alpha = nan", "Dies": "exit status 3"}


def test_a_board_goes_on_without_those_who_fail(board):
    sound = ("random_search", f"{ZOO}:Honest", str(EXAMPLE))
    alone = records(board("alone", *sound))
    folder = board("together", *sound, *(f"{ZOO}:{kind}" for kind in BAD))
    together = records(folder)
    assert [line for line in together if "failure" not in line and "zoo.py" not in line["run"]] == [
        line for line in alone if "zoo.py" not in line["run"]
    ]
    failed = [line for line in together if "failure" in line]
    assert len(failed) == len(BAD) * TINY.scenarios * TINY.seeds
    for line in failed:
        assert BAD[line["run"].partition("zoo.py:")[2].partition("/")[0]] in line["failure"]
        assert (line["gaps"], line["lengths"], line["unit"]) == ([1.0] * 2, [None] * 2, [0.5] * 4)
    page, table = (folder / "index.html").read_text(), (folder / "board.md").read_text()
    assert all(name in table for name in sound)
    assert page.count("2 failed, each counts as no path: zoo.py:") >= len(BAD)


def test_nobody_is_charged_for_more_than_the_budget(board):
    folder = board("greedy", f"{ZOO}:Overspends")
    trials = [line for line in records(folder) if line["kind"] == "trial"]
    assert len(trials) == TINY.budget * TINY.scenarios


def test_a_file_that_changed_needs_another_folder(board, tmp_path):
    mine = tmp_path / "mine.py"
    mine.write_text(ZOO.read_text())
    folder = board("changed", f"{mine}:Honest")
    before = (folder / TRIALS).read_bytes()
    assert (board("changed", f"{mine}:Honest") / TRIALS).read_bytes() == before
    mine.write_text(ZOO.read_text() + "\n")
    with pytest.raises(LedgerError, match=r"mine.py:Honest \(mine.py\) is not the file"):
        board("changed", f"{mine}:Honest")


def test_script_in_the_names_of_a_submission_is_text_on_the_page(board, tmp_path):
    folder = tmp_path / "sly"
    folder.mkdir()
    (folder / "table.json").write_text((EXAMPLE / "table.json").read_text())
    manifest = json.loads((EXAMPLE / "submission.json").read_text())
    manifest |= {"name": "<script>alert(1)</script>", "summary": '"><img src=x onerror=alert(1)>'}
    (folder / "submission.json").write_text(json.dumps(manifest))
    page = (board("page", str(folder)) / "index.html").read_text()
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in page
    assert "<script>alert" not in page
    assert "<img src=x" not in page


def test_a_submissions_trials_stand_in_the_table(board, tmp_path):
    (entrant,) = enter([str(EXAMPLE)], tmp_path, {})
    assert (entrant.training, entrant.kind) == (512, "agent")


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
