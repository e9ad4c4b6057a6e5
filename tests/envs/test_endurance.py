"""Ten thousand random steps in every environment: whatever is drawn, nothing breaks and nothing leaves its bounds."""

import gymnasium
import numpy as np
import pytest

from antgym.envs.catalogue import CATALOGUE

SLOTS, STEPS = 100, 10_000


@pytest.mark.slow
@pytest.mark.parametrize("env_id", [entry.id for entry in CATALOGUE])
def test_ten_thousand_random_steps(env_id):
    batch = gymnasium.make_vec(env_id, num_envs=SLOTS, effort=[5, 3])
    rng = np.random.default_rng(0)
    batch.reset(seed=1)
    for _ in range(STEPS // SLOTS):
        actions = rng.uniform(-1, 1, batch.action_space.shape).astype(np.float32)
        observations, rewards, _, _, _ = batch.step(actions)
        assert observations in batch.observation_space
        assert ((rewards >= -1) & (rewards <= 0)).all()
