"""Frozen policies: loaded from stable-baselines3's zip with a card beside it, asked once, paid nothing."""

import json
from dataclasses import replace

import gymnasium
import numpy as np
import pytest

from agents.policy import PolicyAgent
from antgym.errors import ParameterError
from antgym.tuning import Session, observe, observe_with_map, tune
from antgym.tuning.problem import TuningProblem


@pytest.fixture
def checkpoint(tmp_path, bowl):
    """An untrained policy of the right shapes, saved as training would save it."""
    sb3, gym = pytest.importorskip("stable_baselines3"), pytest.importorskip("gymnasium")
    features = bowl(1).task.features

    class Blank(gym.Env):
        observation_space = gym.spaces.Box(-1, 1, features.shape, np.float32)
        action_space = gym.spaces.Box(-1, 1, (4,), np.float32)

        def reset(self, *, seed=None, options=None):
            return features, {}

        def step(self, action):
            return features, 0.0, True, False, {}

    model = sb3.TD3(
        "MlpPolicy", Blank(), seed=0, device="cpu", buffer_size=10, policy_kwargs={"net_arch": [8]}
    )
    model.save(tmp_path / "policy.zip")
    (tmp_path / "policy.json").write_text(json.dumps({"algorithm": "TD3", "env": "blank", "evaluations": 0}))
    return tmp_path / "policy.zip", model


def test_a_policy_recommends_its_deterministic_action_and_runs_nothing(checkpoint, bowl):
    path, model = checkpoint
    session = bowl(5)
    result = tune(PolicyAgent(path), session, seed=0)
    action, _ = model.predict(observe(session.task), deterministic=True)
    np.testing.assert_allclose(result.recommendation, (action + 1) / 2, atol=1e-6)
    assert session.left == 5


@pytest.mark.parametrize("kind", ["map2d", "map3d"])
def test_a_policy_trained_on_maps_looks_at_the_map(tmp_path, valley, kind):
    sb3 = pytest.importorskip("stable_baselines3")
    env = gymnasium.make("antgym/MountainOneShot-v0", observation=kind)
    model = sb3.PPO("MultiInputPolicy", env, seed=0, device="cpu", policy_kwargs={"net_arch": [8]})
    model.save(tmp_path / "policy.zip")
    (tmp_path / "policy.json").write_text(json.dumps({"algorithm": "PPO"}))
    session = Session(TuningProblem(valley), 1)
    result = tune(PolicyAgent(tmp_path / "policy"), session, seed=0)
    seen = observe_with_map(session.task, flat=kind == "map2d")
    action, _ = model.predict(seen, deterministic=True)
    np.testing.assert_allclose(result.recommendation, (action + 1) / 2, atol=1e-6)


def test_a_policy_trained_on_another_observation_is_refused(checkpoint, bowl):
    session = bowl(5)
    task = replace(session.task, features=np.zeros(3, np.float32))
    with pytest.raises(ParameterError, match=r"takes observations of shape .*, the task's is \(3,\)"):
        PolicyAgent(checkpoint[0]).reset(task, seed=0)


@pytest.mark.parametrize(
    ("card", "reason"),
    [
        (None, "no such file"),
        ("{", "no JSON"),
        ("[]", "unknown"),
        ('{"algorithm": "TD4"}', "did you mean 'TD3'"),
    ],
)
def test_a_card_that_cannot_be_used_says_why(card, reason, tmp_path):
    if card is not None:
        (tmp_path / "policy.json").write_text(card)
    with pytest.raises(ParameterError, match=rf"policy\.json: .*{reason}"):
        PolicyAgent(tmp_path / "policy.zip")


def test_a_card_without_its_checkpoint_is_refused(tmp_path):
    (tmp_path / "policy.json").write_text('{"algorithm": "TD3"}')
    with pytest.raises(ParameterError, match=r"policy\.zip: no such checkpoint"):
        PolicyAgent(tmp_path / "policy")
