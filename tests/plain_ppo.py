"""Proximal policy optimisation in one file, after CleanRL: nothing of any library but Gymnasium's and torch's own.

It takes a vector environment in SAME_STEP mode with episodes that end by termination, and reads nothing but what
``step`` returns. Schulman et al. 2017, arXiv:1707.06347, with the generalised advantage of arXiv:1506.02438.
"""

from dataclasses import dataclass

import numpy as np
import torch
from torch import nn
from torch.distributions import Normal


@dataclass(frozen=True)
class Settings:
    """The usual ones."""

    steps: int = 16  # of every slot between two updates
    epochs: int = 8
    minibatches: int = 4
    learning_rate: float = 1e-3
    gamma: float = 0.99
    lam: float = 0.95
    clip: float = 0.2
    value_weight: float = 0.5
    most_gradient: float = 0.5
    seed: int = 0


class Policy(nn.Module):
    """A Gaussian over actions and a value, of flat observations."""

    def __init__(self, inputs, actions):
        super().__init__()
        self.mean, self.value = _network(inputs, actions, 0.01), _network(inputs, 1, 1.0)
        self.log_sd = nn.Parameter(torch.full((actions,), -0.5))

    def forward(self, observations):
        mean = self.mean(observations)
        return Normal(mean, self.log_sd.exp().expand_as(mean)), self.value(observations).squeeze(-1)

    def act(self, observation):
        """The mean action, within the box."""
        with torch.no_grad():
            return self.mean(torch.as_tensor(observation)).clamp(-1, 1).numpy()


def _network(inputs, outputs, gain):
    layers = [nn.Linear(inputs, 64), nn.Tanh(), nn.Linear(64, 64), nn.Tanh(), nn.Linear(64, outputs)]
    for layer in layers[::2]:
        nn.init.orthogonal_(layer.weight, gain if layer is layers[-1] else 2**0.5)
        nn.init.zeros_(layer.bias)
    return nn.Sequential(*layers)


def train(envs, updates, settings=Settings()):
    """Return the policy after some updates, and the mean return of the episodes that ended before each of them."""
    torch.manual_seed(settings.seed)
    policy = Policy(envs.single_observation_space.shape[0], envs.single_action_space.shape[0])
    optimiser = torch.optim.Adam(policy.parameters(), lr=settings.learning_rate, eps=1e-5)
    observations, _ = envs.reset(seed=settings.seed)
    returns, running = [], np.zeros(envs.num_envs)
    for _ in range(updates):
        batch, observations, finished = _rollout(envs, policy, observations, running, settings)
        returns.append(float(np.mean(finished)))
        _update(policy, optimiser, batch, settings)
    return policy, returns


def _rollout(envs, policy, observations, running, settings):
    """Play ``steps`` steps in every slot; (flat batch, next observations, returns of finished episodes)."""
    seen, finished = [], []
    for _ in range(settings.steps):
        now = torch.as_tensor(observations)
        with torch.no_grad():
            chosen, value = policy(now)
            actions = chosen.sample()
        observations, rewards, ends, truncated, _ = envs.step(actions.clamp(-1, 1).numpy())
        assert not truncated.any()
        seen.append((now, actions, chosen.log_prob(actions).sum(-1), value, *_tensors(rewards, ends)))
        running += rewards
        finished += running[ends].tolist()
        running[ends] = 0
    with torch.no_grad():
        _, value = policy(torch.as_tensor(observations))
    now, actions, log_probs, values, rewards, ends = map(torch.stack, zip(*seen, strict=True))
    advantages, ahead = torch.zeros_like(values), torch.zeros_like(value)
    for t in reversed(range(settings.steps)):
        after = values[t + 1] if t + 1 < settings.steps else value
        surprise = rewards[t] + settings.gamma * after * (1 - ends[t]) - values[t]
        advantages[t] = ahead = surprise + settings.gamma * settings.lam * (1 - ends[t]) * ahead
    batch = (now, actions, log_probs, advantages, advantages + values)
    return [part.flatten(0, 1) for part in batch], observations, finished


def _tensors(*arrays):
    return [torch.as_tensor(array, dtype=torch.float32) for array in arrays]


def _update(policy, optimiser, batch, settings):
    for _ in range(settings.epochs):
        for chosen in torch.randperm(len(batch[0])).chunk(settings.minibatches):
            now, actions, old, advantages, targets = (part[chosen] for part in batch)
            distribution, values = policy(now)
            ratio = (distribution.log_prob(actions).sum(-1) - old).exp()
            gain = (advantages - advantages.mean()) / (advantages.std() + 1e-8)
            clipped = ratio.clamp(1 - settings.clip, 1 + settings.clip)
            loss = -torch.min(ratio * gain, clipped * gain).mean()
            loss = loss + settings.value_weight * (values - targets).square().mean()
            optimiser.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_(policy.parameters(), settings.most_gradient)
            optimiser.step()
