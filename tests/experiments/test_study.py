"""Studies: what is tried is data, what is done is kept, and the best is told with what it cost."""

import json
import tomllib

import pytest

pytest.importorskip("sb3_contrib", reason="needs the extra rl")

from antgym.errors import ParameterError
from experiments import learners, study, train
from experiments.learners import CONFIGS, FILES
from experiments.study import Arguments, as_toml, configurations

SPACE = {
    "learning_rate": {"low": 1e-4, "high": 1e-2},
    "n_epochs": [1, 2],
    "policy_kwargs.net_arch": [[4], [8]],
}
PRESENT = {
    "num_envs": 4,
    "n_steps": 5,
    "batch_size": 20,
    "policy_kwargs": {"net_arch": [6], "log_std_init": -1.0},
}


def test_the_first_is_what_there_is_and_the_others_lie_in_the_space():
    tried = configurations(SPACE, PRESENT, 9, seed=3)
    assert tried[0] == PRESENT
    assert len({json.dumps(settings) for settings in tried}) == 9
    for settings in tried[1:]:
        assert 1e-4 <= settings["learning_rate"] <= 1e-2
        assert settings["n_epochs"] in (1, 2)
        assert settings["policy_kwargs"]["net_arch"] in ([4], [8])
        assert (settings["num_envs"], settings["policy_kwargs"]["log_std_init"]) == (4, -1.0)
    assert configurations(SPACE, PRESENT, 5, seed=3) == tried[:5]


def test_settings_survive_being_written():
    assert tomllib.loads(as_toml(PRESENT)) == PRESENT


@pytest.mark.parametrize("path", sorted((CONFIGS / "spaces").iterdir()), ids=lambda path: path.name)
def test_every_space_is_of_settings_that_an_algorithm_has(path):
    spaces = tomllib.loads(path.read_text())
    known = tomllib.loads((CONFIGS / path.name).read_text())
    assert path.name in FILES.values()
    for algorithm, space in spaces.items():
        for settings in configurations(space, known[algorithm], 3, seed=0):
            assert tomllib.loads(as_toml(settings)) == settings


def test_a_study_trains_what_is_missing_and_tells_the_best_first(tmp_path, monkeypatch):
    monkeypatch.setattr(learners, "STANDARD_MAPS", 3)
    monkeypatch.setattr(study, "_space", lambda _: SPACE)
    monkeypatch.setattr(learners.Learner, "settings", PRESENT)
    asked = Arguments("PPO", "antgym/MountainOneShot-v0", 2, 20, out=tmp_path, validation=2)
    records = study.study(asked)
    kept = [json.loads(line) for line in (tmp_path / "study.jsonl").read_text().splitlines()]
    assert sorted(records, key=lambda record: record["number"]) == kept
    assert records[0]["gap"] <= records[1]["gap"]
    assert all(0 < record["evaluations"] <= 20 and record["validation_runs"] > 0 for record in records)
    monkeypatch.setattr(train, "_run", None)
    assert study.study(asked) == records


def test_what_has_no_space_is_named():
    with pytest.raises(ParameterError, match="no space for 'ARS'"):
        study.study(Arguments("ARS"))
    with pytest.raises(ParameterError, match="there is no space of settings for Control"):
        study.study(Arguments("PPO", "antgym/OpenControl-v0"))
