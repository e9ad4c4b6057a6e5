"""Replay: a table of trials is what the environment would have paid for them, and a training is charged for it."""

import json

import numpy as np
import pytest

pytest.importorskip("sb3_contrib", reason="needs the extra rl")
pytest.importorskip("safetensors", reason="needs the extra rl")

from agents.published import read_card
from antgym.errors import ParameterError
from antgym.maps.suites import load_suite
from antgym.tuning.problem import TRIAL
from experiments import artefacts, learners, train
from experiments.presets import PRESETS
from experiments.replay import Replayed

SETTINGS = """[SAC]
num_envs = 4
learning_starts = 100
batch_size = 8
gradient_steps = 1
gamma = 0.0
table_steps = 20
[TD3]
num_envs = 4
"""


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    """Three maps, eight settings, two runs of each: 48 trials."""
    folder = tmp_path_factory.mktemp("table")
    preset = PRESETS["smoke"]._replace(experience_maps=3, experience_trials=48)
    artefacts.prepare(folder, "mountain-v0", preset, ["neighbours"])
    return folder / "experience.json"


@pytest.fixture
def asked(tmp_path, monkeypatch, table):
    """A function that returns arguments of a tiny training that begins with the table."""
    monkeypatch.setattr(learners, "STANDARD_MAPS", 3)
    config = tmp_path / "tiny.toml"
    config.write_text(SETTINGS)

    def made(algorithm="SAC", env="antgym/MountainOneShot-v0", out="policy", **others):
        given = {"experience": table, "evaluations": 56, "validation": 3, **others}
        return train.Arguments(algorithm, env, out=tmp_path / out, config=config, **given)

    return made


def learner(asked, **others):
    return learners.Learner("SAC", "antgym/MountainOneShot-v0", None, others, None, asked().config)


def test_gaps_are_those_of_the_runs_that_the_table_was_made_of(asked, table):
    found, experience = Replayed(table, learner(asked), 48), Replayed(table, learner(asked), 48)._table
    for item, gaps in zip(load_suite("mountain-v0", "train")[:3], found.gaps, strict=True):
        problem = artefacts.problem(item, "experience")
        again = problem.run(np.tile(experience.settings, (2, 1)), TRIAL, 0)  # as the table was made
        assert gaps.T.reshape(-1) == pytest.approx(problem.gap(again.lengths), abs=1e-9)


def test_what_is_replayed_is_one_whole_episode_a_trial(asked, table):
    taught, found = learner(asked), Replayed(table, learner(asked), 40)
    model = taught.model(taught.train_envs(0), 0, 60)
    found.fill(model)
    buffer, rows = model.replay_buffer, 32 // 4  # two maps of 16 trials
    assert (found.trials, buffer.pos, buffer.full, model.learning_starts) == (32, rows, False, 0)
    assert (buffer.dones[:rows] == 1).all()
    assert -buffer.rewards[:rows].ravel() == pytest.approx(found.gaps.ravel(), abs=1e-6)
    settings = (buffer.actions[:rows].reshape(2, 8, 2, 4)[0, :, 0] + 1) / 2
    assert settings == pytest.approx(found._table.settings, abs=1e-6)


def test_a_training_is_charged_for_the_table_and_plays_with_what_is_left(asked):
    told = train.train(asked())
    assert told["evaluations"] == read_card(asked().out).evaluations == 48 + 8
    assert told["history"][0][0] == 48


def test_as_much_is_replayed_as_is_said(asked):
    assert train.train(asked(replayed=20))["history"][0][0] == 16 + 4


def test_a_training_that_was_stopped_gives_the_policy_of_one_that_was_not(asked, monkeypatch):
    whole, cut = asked(out="whole"), asked(out="cut")
    train.train(whole)
    gap, calls = train.Validation.gap, []

    def stopping(self, model):
        calls.append(1)
        if len(calls) == 4:
            raise KeyboardInterrupt
        return gap(self, model)

    monkeypatch.setattr(train.Validation, "gap", stopping)
    with pytest.raises(KeyboardInterrupt):
        train.train(cut)
    train.train(cut)
    cards = [json.loads(arguments.out.with_suffix(".json").read_text()) for arguments in (whole, cut)]
    assert cards[0]["sha256"] == cards[1]["sha256"]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"algorithm": "TD3"}, "TD3 on antgym/MountainOneShot-v0 replays no table"),
        ({"kwargs": '{"effort": [5, 3]}'}, "replays no table"),
        ({"kwargs": '{"reward": "improvement"}'}, "replays no table"),
        ({"action": "moved", "start": (0.9, 0.5, 0.5, 0.5)}, "replays no table; .* with --action setting"),
        ({"evaluations": 15}, "15 evaluations pay for no map"),
        ({"env": "antgym/RoomOneShot-v0"}, "is no train map of what antgym/RoomOneShot-v0 draws from"),
    ],
)
def test_a_table_that_does_not_fit_is_one_clear_error(asked, change, message):
    with pytest.raises(ParameterError, match=message):
        train.train(asked(**change))
