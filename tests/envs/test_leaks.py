"""Nothing of the optimum leaks into what is seen or walked: it may be wrong, or refuse to be known, and only rewards
notice. That no world of one split is in another is for ``tests/maps/test_suites.py``.
"""

import gymnasium
import numpy as np
import pytest
from efforts import quick, some_steps

from antgym.envs.catalogue import CATALOGUE
from antgym.maps.suites import load_suite
from antgym.maps.world import Scenario

pytestmark = pytest.mark.parametrize("entry", CATALOGUE, ids=lambda entry: entry.id)
NEARER = property(lambda scenario: 0.8 * scenario.straight_line)  # than any path can be: every gap grows
SLOTS, MAPS = 3, 2


class AskedError(Exception):
    """Somebody asked for the optimum."""


@property
def refused(scenario):
    raise AskedError


def settings(entry):
    return {"split": "test", **quick(entry), "observation": "map"}


def actions(entry, shape):
    return np.random.default_rng(3).uniform(-1, 1, (some_steps(entry), *shape)).astype(np.float32)


def frozen(observation):
    return {name: part.tobytes() for name, part in observation.items()}


def played_together(entry):
    """(what agents see and what the planner walked, what rewards are made of) of some steps of a batch."""
    batch = gymnasium.make_vec(entry.id, num_envs=SLOTS, **settings(entry))
    seen, judged = [frozen(batch.reset(seed=3)[0])], []
    for chosen in actions(entry, batch.action_space.shape):
        observations, rewards, ends, _, infos = batch.step(chosen)
        ended = [frozen(last) for last in infos.get("final_obs", ()) if last is not None]
        lengths = infos.get("final_info", infos).get("length", np.zeros(0))
        seen.append((frozen(observations), ended, ends.tolist(), lengths.tolist()))
        seen += [
            (repr(env.session.trials), env.session.lengths, repr(env.session.task.space))
            for env in batch.envs
        ]
        judged += rewards.tolist()
    return seen, judged


def test_another_optimum_changes_rewards_and_nothing_that_is_seen_or_walked(entry, monkeypatch):
    seen, rewards = played_together(entry)
    monkeypatch.setattr(Scenario, "optimum", NEARER)
    seen_now, rewards_now = played_together(entry)
    assert seen_now == seen
    assert rewards_now != rewards


def seen_alone(entry, picked, step):
    """All that is seen of an episode on one map, stepped by ``step``, and the path that was walked last."""
    env = gymnasium.make(entry.id, **settings(entry)).unwrapped
    seen = [frozen(env.reset(seed=4, options={"scenario": picked})[0])]
    for action in actions(entry, env.action_space.shape):
        step(env, action)
        seen += [frozen(env._episodes.observed(np.array([0]))), repr(env.session.trials)]
        if env.over:
            break
    return [*seen, env._episodes.walked(0).result().path.tobytes()]


def unjudged(env, action):
    """A step that ends where its reward needs the optimum: all that comes before is paid for and recorded."""
    with pytest.raises(AskedError):
        env.step(action)


def test_nobody_asks_for_the_optimum_before_a_reward_is_due(entry, monkeypatch):
    """Not for an observation, not for a trial and not for a fresh run: where it refuses, all of these go on."""
    suite = load_suite(entry.kwargs["suite"], "test")
    picks = np.linspace(0, len(suite) - 1, MAPS).astype(int).tolist()
    told = [seen_alone(entry, picked, lambda env, action: env.step(action)) for picked in picks]
    monkeypatch.setattr(Scenario, "optimum", refused)
    assert [seen_alone(entry, picked, unjudged) for picked in picks] == told


@pytest.mark.slow
def test_no_map_of_the_test_split_needs_its_optimum_to_be_seen(entry, monkeypatch):
    """In one regime every map; how it is described does not depend on the regime, so every fifth in the others."""
    items = load_suite(entry.kwargs["suite"], "test")[
        :
    ]  # made before: recipes leave out worlds with long detours
    monkeypatch.setattr(Scenario, "optimum", refused)
    for kind in ("map2d", "map3d"):
        env = gymnasium.make(entry.id, **{**settings(entry), "observation": kind})
        for i in range(0, len(items), 1 if entry.regime == "OneShot" else 5):
            vars(items[i].scenario).pop("descriptors", None)  # seen anew
            assert env.reset(seed=0, options={"scenario": i})[0] in env.observation_space
