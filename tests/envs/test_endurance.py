"""Ten thousand random steps in every environment: whatever is drawn, nothing breaks and nothing leaves its bounds."""

import gymnasium
import numpy as np
import pytest
from efforts import flown_by_bees
from gymnasium.envs.registration import load_env_creator

from antgym.envs.catalogue import AT_ONCE, CATALOGUE

SLOTS, STEPS = 100, 10_000


@pytest.mark.slow
@pytest.mark.parametrize("entry", CATALOGUE, ids=lambda entry: entry.id)
def test_ten_thousand_random_steps(entry):
    least = load_env_creator(entry.entry_point).least_iterations
    effort = [5 if flown_by_bees(entry) else 2, max(2, least)]  # what endures is not the planner
    # test has fewer maps than train, and making one of Open takes longer than all steps on it
    fleets = entry.world in AT_ONCE  # a step of theirs is planned again and again
    few = {"budget": 3} if fleets and entry.regime == "Trials" else {}  # so that episodes end
    batch = gymnasium.make_vec(entry.id, num_envs=SLOTS, effort=effort, split="test", **few)
    rng = np.random.default_rng(0)
    batch.reset(seed=1)
    ended, most = 0, -np.inf
    for _ in range((STEPS // 20 if fleets else STEPS) // SLOTS):
        actions = rng.uniform(-1, 1, batch.action_space.shape).astype(np.float32)
        observations, rewards, ends, _, _ = batch.step(actions)
        assert observations in batch.observation_space
        assert (np.abs(rewards) <= 1).all()
        ended, most = ended + ends.sum(), max(most, rewards.max())
    assert ended >= SLOTS
    assert most > -1, "so small an effort finds no path at all"
