"""The checker of batches: quiet about ours, and it says what is wrong with those that are broken on purpose."""

import gymnasium
import numpy as np
import pytest
from efforts import quick, some_steps
from gymnasium.spaces import Box
from gymnasium.vector import AutoresetMode

from antgym.envs.catalogue import CATALOGUE
from antgym.envs.checking import check_vector_env
from antgym.envs.one_shot import OneShotEnv
from antgym.envs.trials import TrialsEnv, TrialsEpisodes
from antgym.envs.vector import NativeVectorEnv
from antgym.errors import AntgymError, ContractError, ParameterError

QUICK = {"suite": "mountain-v0", "effort": [2, 2]}


@pytest.mark.parametrize("entry", CATALOGUE, ids=lambda entry: entry.id)
def test_it_has_nothing_to_say_of_ours(entry):
    shown = {"OneShot": "map", "Trials": "features", "Control": "features"}
    made = quick(entry, ants=2, iterations=2)
    check_vector_env(entry.id, steps=some_steps(entry), **made, observation=shown[entry.regime])


def test_a_batch_is_checked_in_its_own_mode():
    check_vector_env(gymnasium.make_vec(CATALOGUE[0].id, num_envs=2, effort=[2, 2]), steps=3)


def broken(kind, mode=AutoresetMode.SAME_STEP, regime=OneShotEnv, **kwargs):
    """Check two slots of a batch that is broken in one way."""
    make = lambda: regime(**QUICK, **kwargs)  # noqa: E731
    check_vector_env(kind([make(), make()], mode), single=make, steps=8)


class WithoutMask(NativeVectorEnv):
    def _gathered(self, parts):
        batch = super()._gathered(parts)
        batch.pop("_seed", None)
        return batch


class Unseeded(NativeVectorEnv):
    def reset(self, *, seed=None, options=None):
        return super().reset(options=options)


class PlainlySeeded(NativeVectorEnv):
    def reset(self, *, seed=None, options=None):
        seeds = None if seed is None else [seed + i for i in range(self.num_envs)]
        return super().reset(seed=seeds, options=options)


class Wide(NativeVectorEnv):
    def _observations(self):
        return super()._observations().astype(np.float64)


class OutOfBounds(NativeVectorEnv):
    def _observations(self):
        batch = super()._observations()
        batch[1, 7] = 9.0
        return batch


class WrittenOver(NativeVectorEnv):
    def _observations(self):
        return self._shown


class NextEpisodeAsFinal(NativeVectorEnv):
    def step(self, actions):
        observations, *rest, infos = super().step(actions)
        infos["final_obs"] = np.array([*observations, None], dtype=object)[:-1]
        return observations, *rest, infos


class WithoutFinals(NativeVectorEnv):
    def step(self, actions):
        *rest, infos = super().step(actions)
        return *rest, {key: value for key, value in infos.items() if "final" not in key}


class ResetsEverybody(NativeVectorEnv):
    def reset(self, *, seed=None, options=None):
        return super().reset(seed=seed)


class SumsUp(NativeVectorEnv):
    def step(self, actions):
        observations, rewards, *rest = super().step(actions)
        return observations, rewards + rewards.sum(), *rest


class NotANumber(NativeVectorEnv):
    def step(self, actions):
        observations, rewards, *rest = super().step(actions)
        return observations, rewards * np.nan, *rest


class WrongSpace(NativeVectorEnv):
    def __init__(self, envs, mode):
        super().__init__(envs, mode)
        self.action_space = Box(-2, 2, self.action_space.shape)


class PaysForBeginnings(NativeVectorEnv):
    def step(self, actions):
        observations, rewards, *rest = super().step(actions)
        return observations, np.where(rewards == 0, -0.5, rewards), *rest


@pytest.mark.parametrize(
    ("kind", "message"),
    [
        (WithoutMask, "reset: info 'seed' has no mask _seed, one bool a slot"),
        (Unseeded, r"reset: observations\[\d, \d+\] is .*, alone, with its seed, it is"),
        (PlainlySeeded, r"reset: observations\[0, 0\] is .*, alone, with its seed, it is"),
        (Wide, r"reset: the observation is float64 of shape \(2, \d+\), its space float32 of shape"),
        (OutOfBounds, r"reset: entry \(1, 7\) of the observation is 9.0, outside \["),
        (WrittenOver, "observations are written over by later steps"),
        (NextEpisodeAsFinal, r"step 0: infos\['final_obs'\]\[0\]\[0\] is .*, alone, with its seed, it is"),
        (WithoutFinals, "step 0, .*: final_obs is there for .* episodes ended in"),
        (SumsUp, r"step 0: rewards\[0\] is .*, alone, with its seed, it is"),
        (NotANumber, "step 0: rewards are .*nan"),
        (WrongSpace, "action_space is .* not single_action_space 2 times"),
    ],
    ids=lambda value: value.__name__ if isinstance(value, type) else "",
)
def test_what_is_broken_is_said(kind, message):
    with pytest.raises(ContractError, match=message) as caught:
        broken(kind)
    assert isinstance(caught.value, AntgymError)
    assert isinstance(caught.value, AssertionError)


def test_a_reset_that_heeds_no_mask_is_found():
    class StaggeredEpisodes(TrialsEpisodes):
        """They end at different times."""

        def over(self, rows):
            return self._sessions.left[rows] <= self._sessions.seeds[rows] % 2

    class Staggered(TrialsEnv):
        _kind = StaggeredEpisodes

    broken(NativeVectorEnv, AutoresetMode.DISABLED, Staggered, budget=3)
    with pytest.raises(ContractError, match=r"reset of slots \[.\] .*: slot . was not to be reset"):
        broken(ResetsEverybody, AutoresetMode.DISABLED, Staggered, budget=3)


def test_a_reward_for_beginning_anew_is_found():
    with pytest.raises(ContractError, match="begin anew, with reward 0"):
        broken(PaysForBeginnings, AutoresetMode.NEXT_STEP)


def test_episodes_must_end_within_the_steps():
    with pytest.raises(ParameterError, match="no episode ended within 5 steps"):
        check_vector_env("antgym/MountainTrials-v0", steps=5, effort=[2, 2])


def test_it_must_know_what_a_slot_repeats():
    with pytest.raises(ParameterError, match="pass single="):
        check_vector_env(NativeVectorEnv([OneShotEnv(**QUICK)], AutoresetMode.SAME_STEP))


def test_arguments_go_with_an_id_alone():
    batch = gymnasium.make_vec(CATALOGUE[0].id, num_envs=2, effort=[2, 2])
    with pytest.raises(ParameterError, match=r"\['budget'\] are arguments of an id"):
        check_vector_env(batch, budget=3)
