"""The native batch: N environments whose planner runs are one call."""

from collections.abc import Sequence
from copy import deepcopy
from typing import Any, cast

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space, create_empty_array, iterate
from numpy.typing import NDArray

from antgym.envs.base import TuningEnv, settings
from antgym.envs.episodes import Observation
from antgym.envs.infos import Columns, gathered, some
from antgym.errors import ParameterError, nearest
from antgym.tuning.seeding import child_states

_SLOT = 7  # seed domain of the slots of a batch


def env_seeds(root: int, count: int) -> list[int]:
    """Return the seeds with which the slots of a batch, each alone, repeat their trajectories; never root + i."""
    seeds: list[int] = (child_states([root] * count, [(_SLOT, i) for i in range(count)])[:, 0] >> 1).tolist()
    return seeds


class NativeVectorEnv(VectorEnv[Observation, NDArray[np.float32], NDArray[Any]]):
    """N tuning environments stepped together; each slot repeats a single environment with its seed.

    Args:
        envs: the slots, all of one kind.
        autoreset_mode: when a finished slot begins its next episode. SAME_STEP wastes no step where episodes have
            one step; NEXT_STEP answers the step after the end with the new episode and reward 0; DISABLED leaves
            it to ``reset(options={"reset_mask": mask})``.
    """

    def __init__(self, envs: Sequence[TuningEnv], autoreset_mode: AutoresetMode) -> None:
        if not envs:
            raise ParameterError("num_envs = 0: a batch needs an environment at least")
        self.envs, self.num_envs = list(envs), len(envs)
        self.metadata = {**TuningEnv.metadata, "autoreset_mode": autoreset_mode}
        self.mode = autoreset_mode
        self.render_mode = self.envs[0].render_mode
        self.single_action_space = self.envs[0].action_space
        self.single_observation_space = self.envs[0].observation_space
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self._episodes = self.envs[0].alike(self.num_envs)
        for i, env in enumerate(self.envs):
            env.join(self._episodes, i)
        self._shown: Any = create_empty_array(self.single_observation_space, self.num_envs)
        self._over = np.zeros(self.num_envs, bool)

    @property
    def planner_runs(self) -> int:
        """Planner runs of all slots so far."""
        return int(self._episodes.planner_runs.sum())

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | NDArray[np.integer] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Observation, dict[str, Any]]:
        """Begin an episode in every slot, or in those of ``options["reset_mask"]``.

        Args:
            seed: root seed (slot i gets ``env_seeds(seed, n)[i]``), or one seed a slot, or None to go on.
            options: ``reset_mask``, (n,) bool, and what the single environment's reset takes.
        """
        options = dict(options or {})
        mask = np.asarray(options.pop("reset_mask", np.ones(self.num_envs, bool)), dtype=bool)
        seeds = _slot_seeds(seed, self.num_envs)
        if len(seeds) != self.num_envs or mask.shape != (self.num_envs,):
            raise ParameterError(
                f"{len(seeds)} seeds and a mask of {mask.shape} for {self.num_envs} environments"
            )
        slots = np.flatnonzero(mask)
        picked = self._episodes.picked(options)
        told = self._begin(slots, [self.envs[i].root(seeds[i]) for i in slots.tolist()], picked)
        return self._observations(), self._gathered([(slots, told)])

    def step(
        self, actions: NDArray[np.float32]
    ) -> tuple[Observation, NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """Pay for every slot's setting in one planner call, judge them in another where rewards need it."""
        rewards, ends = np.zeros(self.num_envs), np.zeros(self.num_envs, bool)
        if self.mode is AutoresetMode.DISABLED and self._over.any():
            raise ParameterError(
                f"slots {np.flatnonzero(self._over).tolist()} are over; reset them by reset_mask"
            )
        if np.shape(actions) != self.action_space.shape:
            raise ParameterError(f"actions of shape {np.shape(actions)} for {self.num_envs} environments")
        anew, slots = np.flatnonzero(self._over), np.flatnonzero(~self._over)
        parts: list[tuple[NDArray[np.intp], Columns]] = []
        if len(slots):
            self._episodes.require_open(slots)
            units = settings(self.single_action_space, np.asarray(actions)[slots])
            shown, rewards[slots], ends[slots], told = self._episodes.step(slots, units)
            self._show(slots, shown)
            if self.mode is AutoresetMode.SAME_STEP:
                # no slot was waiting, so slots are places in what is told
                anew, slots = np.flatnonzero(ends), np.flatnonzero(~ends)
                last = {"final_obs": list(iterate(self.observation_space, shown)), "final_info": told}
                parts = [(anew, some(last, anew)), (slots, some(told, slots))]
            else:
                self._over[slots] = ends[slots]
                parts = [(slots, told)]
        parts.append((anew, self._begin(anew)))
        return self._observations(), rewards, ends, np.zeros(self.num_envs, bool), self._gathered(parts)

    def encode(self, **naturals: float) -> NDArray[np.float32]:
        """Return the (n, d) actions of natural values in the slots' episodes; ParameterError outside their ranges."""
        return np.stack([env.encode(**naturals) for env in self.envs])

    def render(self) -> tuple[Any, ...]:
        """Return the pictures of all slots."""
        return tuple(env.render() for env in self.envs)

    def _begin(
        self,
        slots: NDArray[np.intp],
        roots: Sequence[int | None] | None = None,
        picked: int | None = None,
    ) -> Columns:
        """Begin an episode in some slots and return its infos."""
        if not len(slots):
            return {}
        shown, told = self._episodes.begin(slots, roots, picked)
        self._show(slots, shown)
        self._over[slots] = False
        return told

    def _show(self, slots: NDArray[np.intp], observations: Any) -> None:
        """Keep what some slots show."""
        if isinstance(self._shown, dict):
            for name, part in self._shown.items():
                part[slots] = observations[name]
        else:
            self._shown[slots] = observations

    def _gathered(self, parts: Sequence[tuple[NDArray[np.intp], Columns]]) -> dict[str, Any]:
        return gathered(self.num_envs, parts)

    def _observations(self) -> Observation:
        """Return what all slots show, in arrays of its own."""
        return cast("Observation", deepcopy(self._shown))


def _slot_seeds(
    seed: int | Sequence[int | None] | NDArray[np.integer] | None, count: int
) -> Sequence[int | None]:
    if seed is None:
        return [None] * count
    each: Any = env_seeds(int(seed), count) if isinstance(seed, int | np.integer) and seed >= 0 else seed
    fits = isinstance(each, Sequence | np.ndarray) and all(
        one is None or (isinstance(one, int | np.integer) and one >= 0) for one in each
    )
    if not fits:
        raise ParameterError(f"seed = {seed!r}: needs a whole number from 0 on, one for each slot, or None")
    return [None if one is None else int(one) for one in each]


def make_one_shot(
    num_envs: int = 1, autoreset_mode: AutoresetMode | str | None = None, **kwargs: Any
) -> NativeVectorEnv:
    """Entry point of ``gymnasium.make_vec`` for OneShot; SAME_STEP by default, for NEXT_STEP wastes half the steps."""
    from antgym.envs.one_shot import OneShotEnv

    mode = _mode(autoreset_mode, AutoresetMode.SAME_STEP)
    return NativeVectorEnv([OneShotEnv(**kwargs) for _ in range(num_envs)], mode)


def make_trials(
    num_envs: int = 1, autoreset_mode: AutoresetMode | str | None = None, **kwargs: Any
) -> NativeVectorEnv:
    """Entry point of ``gymnasium.make_vec`` for Trials; NEXT_STEP by default, as Gymnasium's own."""
    from antgym.envs.trials import TrialsEnv

    mode = _mode(autoreset_mode, AutoresetMode.NEXT_STEP)
    return NativeVectorEnv([TrialsEnv(**kwargs) for _ in range(num_envs)], mode)


def make_control(
    num_envs: int = 1, autoreset_mode: AutoresetMode | str | None = None, **kwargs: Any
) -> NativeVectorEnv:
    """Entry point of ``gymnasium.make_vec`` for Control; NEXT_STEP by default, as Gymnasium's own."""
    from antgym.envs.control import ControlEnv

    mode = _mode(autoreset_mode, AutoresetMode.NEXT_STEP)
    return NativeVectorEnv([ControlEnv(**kwargs) for _ in range(num_envs)], mode)


def _mode(value: AutoresetMode | str | None, default: AutoresetMode) -> AutoresetMode:
    if value is None:
        return default
    valid = tuple(mode.value for mode in AutoresetMode)
    if not isinstance(value, AutoresetMode) and value not in valid:
        raise ParameterError(f"unknown autoreset_mode {value!r}; {nearest(str(value), valid)}")
    return AutoresetMode(value)
