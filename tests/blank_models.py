"""Untrained models of stable-baselines3 in the shapes that training gives them, and what they are asked."""

import gymnasium
import numpy as np

from antgym.tuning.actions import choices
from antgym.tuning.features import TASK_FEATURES

SIZE = len(TASK_FEATURES)


class Blank(gymnasium.Env):
    """An environment of given spaces in which nothing happens."""

    def __init__(self, size=SIZE, picture=None, action="setting", chosen=4):
        vector = gymnasium.spaces.Box(-1.5, 1.5, (size,), np.float32)
        self.observation_space = vector
        if picture:
            sides = gymnasium.spaces.Box(0.0, 1.0, picture, np.float32)
            self.observation_space = gymnasium.spaces.Dict({"features": vector, "map": sides})
        spaces = {
            "setting": gymnasium.spaces.Box(-1, 1, (chosen,), np.float32),
            "moved": gymnasium.spaces.Box(-1, 1, (chosen,), np.float32),
            "each": gymnasium.spaces.MultiDiscrete(list(choices("each", chosen))),
            "one": gymnasium.spaces.Discrete(choices("one", chosen)[0]),
        }
        self.action_space = spaces[action]

    def reset(self, *, seed=None, options=None):
        return self.observation_space.sample(), {}

    def step(self, action):
        return self.observation_space.sample(), 0.0, True, False, {}


def blank_model(algorithm="PPO", *, size=SIZE, picture=None, action="setting", chosen=4, seed=0, **kwargs):
    """An untrained model, its features standardised by numbers that the constructor does not hold."""
    import torch

    from agents.networks import algorithm_class
    from antgym.envs.sb3 import FeatureExtractor, MapExtractor

    torch.set_num_threads(1)
    rng = np.random.default_rng(seed)
    reader = {"mean": rng.normal(size=size).tolist(), "deviation": rng.uniform(0.1, 1, size).tolist()}
    policy_kwargs = {
        "net_arch": [8, 8],
        "features_extractor_class": MapExtractor if picture else FeatureExtractor,
        "features_extractor_kwargs": {**reader, **({"width": 5} if picture else {})},
        **({"lstm_hidden_size": 6} if algorithm == "RecurrentPPO" else {}),
    }
    if algorithm == "ARS":
        policy_kwargs = {"net_arch": [8, 8]}
    if algorithm in ("SAC", "TD3", "DDPG", "TQC", "CrossQ", "DQN", "QRDQN"):
        kwargs["buffer_size"] = 10
    name = ("MultiInput" if picture else "Mlp") + ("Lstm" if algorithm == "RecurrentPPO" else "") + "Policy"
    model = algorithm_class(algorithm)(
        name,
        Blank(size, picture, action, chosen),
        seed=seed,
        device="cpu",
        policy_kwargs=policy_kwargs,
        **kwargs,
    )
    with torch.no_grad():  # ARS begins at zero, others near it: a test would see little of them
        for weights in model.policy.parameters():
            weights.add_(0.3 * torch.randn_like(weights))
    return model
