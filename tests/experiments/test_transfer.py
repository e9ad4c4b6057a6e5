"""Transfer on unseen maps: a tiny measurement from artefacts to tables and pictures."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("matplotlib")

from agents.published import PolicyCard
from antgym.errors import ParameterError
from antgym.tuning.ledger import TRIALS
from experiments import artefacts, transfer
from experiments.trainings import trainings
from experiments.transfer import COPY, DEFAULT, Arguments, Outcome


def test_a_tiny_measurement_writes_its_tables_and_pictures(tmp_path):
    names = ("transfer_graph", COPY, "neighbours", DEFAULT)
    artefacts.make_artefacts(artefacts.Arguments(names, preset="smoke", out=tmp_path / "trained"))
    asked = Arguments(
        tmp_path / "trained", tmp_path / "out", maps=2, seeds=1, budgets=(0, 4), fresh=2, agents=names
    )
    path = transfer.report(asked)
    text, numbers = path.read_text(), json.loads(path.with_suffix(".json").read_text())
    assert "## 0 trials a target" in text
    assert "## The graph: each source left out" in text
    assert "| arrived |" in text
    assert set(numbers) == {f"{name}/{budget}" for name in names for budget in (0, 4)}
    assert np.shape(numbers["transfer_graph/4"]) == (2, 1)
    for name in ("graph.png", "transfer.png"):
        assert (tmp_path / "out" / name).read_bytes().startswith(b"\x89PNG")
    _goes_on_where_it_stopped(asked, text, numbers)
    _names_who_cannot_play(asked)


def _names_who_cannot_play(asked):
    """Before anything runs, and in a folder of its own."""
    pytest.importorskip("sb3_contrib")
    pytest.importorskip("safetensors")
    for name, message in (
        ("rl", r"experiments\.train PPO antgym/MountainOneShot-v0 --out"),
        ("rl_committee", "shipped: rl_committee:open-committee"),
        ("rl:open-trials", "budgets are 1 or more"),
    ):
        other = replace(asked, agents=(*asked.agents, name), out=asked.out / "other")
        with pytest.raises(ParameterError, match=message):
            transfer.measure(other)
        assert not other.out.exists()
    one = replace(
        asked, agents=(*asked.agents, "rl:open-one-shot"), out=asked.out / "one", budgets=(0,), fresh=1
    )
    assert (0, "rl:open-one-shot") in transfer.measure(one)


def _goes_on_where_it_stopped(asked, text, numbers):
    """A third of the ledger is left; the rest is run again, to the same end."""
    trials = asked.out / TRIALS
    whole = trials.read_text().splitlines()
    trials.write_text("\n".join(whole[: len(whole) // 3]) + "\n")
    path = transfer.report(asked)
    assert path.read_text() == text
    assert json.loads(path.with_suffix(".json").read_text()) == numbers
    assert sorted(trials.read_text().splitlines()) == sorted(whole)


def test_worse_is_what_two_standard_errors_cannot_explain():
    """Three maps, clearly worse, worse within the noise, better; by hand."""
    ours = Outcome(np.array([[[0.5, 0.5]], [[0.2, 0.4]], [[0.1, 0.1]]]), 0.0, 1.0)
    theirs = Outcome(np.array([[[0.2, 0.2]], [[0.2, 0.3]], [[0.2, 0.2]]]), 0.0, 1.0)
    assert transfer.worse(ours, theirs) == 1
    assert transfer.worse(ours, ours) == 0


def card(seed, evaluations=64, **asked):
    settings = {"asked": {"seed": seed, "validation": 50, **asked}}
    return PolicyCard("PPO", "MlpPolicy", {}, 68, seed=seed, evaluations=evaluations, settings=settings)


def test_trainings_that_differ_in_their_seed_are_one_agent_too():
    """By hand: two maps, a seed each."""
    first, second, alone = (
        Outcome(np.array([[[a]], [[b]]]), trials, arrived)
        for a, b, trials, arrived in ((0.1, 0.3, 4, 1.0), (0.3, 0.5, 2, 0.5), (0.9, 0.9, 0, 0.0))
    )
    outcomes = {(5, "rl:ppo-1"): first, (5, "rl:ppo-2"): second, (5, "rl:sac-1"): alone}
    cards = {"rl:ppo-1": card(1), "rl:ppo-2": card(2), "rl:sac-1": card(1)}
    shown = transfer.with_trainings(outcomes, cards)
    assert set(shown) == {*outcomes, (5, "rl:ppo, 2 trainings")}
    together = shown[5, "rl:ppo, 2 trainings"]
    assert together.means.tolist() == [[0.1, 0.3], [0.3, 0.5]]
    assert (together.trials, together.arrived) == (3.0, 0.75)


def test_other_trainings_are_none_of_one_agent_whatever_they_are_called():
    same = {"a-1": card(1), "a-2": card(2, follows=None)}
    assert trainings(same) == {"a, 2 trainings": ["a-1", "a-2"]}
    for other in (card(3, evaluations=32), card(3, follows="0f" * 32)):
        assert trainings({**same, "a-3": other}) == trainings(same)
        assert not trainings({"a-1": card(1), "a-2": other})


def test_the_references_of_negative_transfer_must_be_there():
    with pytest.raises(ParameterError, match="; add copy_best_source and published_default"):
        transfer.measure(Arguments(agents=("transfer_graph",)))


def test_a_folder_of_one_map_is_too_little_to_measure_on(tmp_path):
    (tmp_path / "test").mkdir()
    docs = Path(transfer.__file__).parents[1] / "docs"
    shutil.copy(docs / "hills.asc", tmp_path / "test")
    (tmp_path / "suite.toml").write_text("scenarios = 1\n")
    with pytest.raises(ParameterError, match=r"--split test: 1 map, .* two at least"):
        transfer.measure(Arguments(suite=str(tmp_path), split="test", out=tmp_path / "out"))
