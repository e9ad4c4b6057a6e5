"""stable-baselines3: the native batch as its VecEnv, and what is put around it."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from antgym.envs.catalogue import CATALOGUE
from antgym.envs.changing import ChangingVecEnv, MovedVecEnv
from antgym.envs.episodes import Observation
from antgym.envs.extractors import FeatureExtractor, MapExtractor
from antgym.envs.vector import NativeVectorEnv, env_seeds
from antgym.errors import MissingExtraError, ParameterError, nearest

try:
    from stable_baselines3.common.vec_env import VecEnv, VecEnvWrapper
except ImportError:
    raise MissingExtraError("stable-baselines3", "rl") from None

__all__ = [
    "ChangingVecEnv",
    "FeatureExtractor",
    "MapExtractor",
    "MovedVecEnv",
    "NativeVecEnv",
    "ScaledRewards",
    "make_sb3_vec",
]


class NativeVecEnv(VecEnv):
    """A :class:`NativeVectorEnv` in SAME_STEP mode, as stable-baselines3 wants its environments."""

    def __init__(self, native: NativeVectorEnv, seed: int | None = None) -> None:
        self.native = native
        self.render_mode = native.render_mode
        super().__init__(native.num_envs, native.single_observation_space, native.single_action_space)
        self._root = seed
        self._actions: NDArray[np.float32] = np.zeros(0, np.float32)

    def set_options(self, options: Sequence[Mapping[str, Any]] | Mapping[str, Any] | None = None) -> None:
        """Keep options for the next reset alone: one dict for all slots, or one a slot, as ``{"scenario": 3}``.

        Raises:
            ParameterError: where there is not one dict for every slot.
        """
        each = [options or {}] * self.num_envs if isinstance(options, Mapping | None) else list(options)
        if len(each) != self.num_envs or not all(isinstance(one, Mapping) for one in each):
            raise ParameterError(
                f"options = {options!r}: needs one dict, or a list of {self.num_envs}, one for every slot"
            )
        if any("reset_mask" in one for one in each):
            raise ParameterError("reset_mask: a VecEnv is reset as a whole; leave it out")
        self._options = [dict(one) for one in each]

    def reset(self) -> Observation:
        """Begin an episode in every slot and return the observations; seeds and options hold for this reset alone."""
        root = self._seeds[0] if self._seeds[0] is not None else self._root
        seeds = [None] * self.num_envs if root is None else env_seeds(int(root), self.num_envs)
        options, self._root = self._options, None
        self._reset_seeds()
        self._reset_options()
        for asked in [one for i, one in enumerate(options) if one not in options[:i]]:
            mask = np.array([one == asked for one in options])
            observations, batch = self.native.reset(seed=seeds, options={**asked, "reset_mask": mask})
            infos = _split(batch, self.num_envs)
            for i in np.flatnonzero(mask):
                self.reset_infos[i] = infos[i]
        return observations

    def step_async(self, actions: NDArray[np.float32]) -> None:
        """Keep the actions."""
        self._actions = actions

    def step_wait(self) -> Any:
        """Step the batch; a finished slot shows its last observation in ``terminal_observation``."""
        observations, rewards, ends, _, batch = self.native.step(self._actions)
        infos = _split(
            {k: v for k, v in batch.items() if not k.lstrip("_").startswith("final")}, self.num_envs
        )
        finals = _split(batch.get("final_info", {}), self.num_envs)
        for i in np.flatnonzero(ends):
            self.reset_infos[i] = infos[i]
            infos[i] = {
                **finals[i],
                "terminal_observation": batch["final_obs"][i],
                "TimeLimit.truncated": False,
            }
        return observations, rewards.astype(np.float32), ends, infos

    def close(self) -> None:
        """Close the batch."""
        self.native.close()

    def get_attr(self, attr_name: str, indices: int | Iterable[int] | None = None) -> list[Any]:
        """Return an attribute of the chosen slots."""
        return [getattr(self.native.envs[i], attr_name) for i in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: int | Iterable[int] | None = None) -> None:
        """Set an attribute of the chosen slots."""
        for i in self._get_indices(indices):
            setattr(self.native.envs[i], attr_name, value)

    def env_method(
        self, method_name: str, *args: Any, indices: int | Iterable[int] | None = None, **kwargs: Any
    ) -> list[Any]:
        """Call a method of the chosen slots."""
        return [
            getattr(self.native.envs[i], method_name)(*args, **kwargs) for i in self._get_indices(indices)
        ]

    def env_is_wrapped(
        self,
        wrapper_class: type,  # noqa: ARG002 - the base class names it
        indices: int | Iterable[int] | None = None,
    ) -> list[bool]:
        """Return False for every chosen slot: the batch wraps nothing."""
        return [False for _ in self._get_indices(indices)]

    def get_images(self) -> Sequence[NDArray[np.uint8] | None]:
        """Return the pictures of all slots."""
        return list(self.native.render())


def make_sb3_vec(env_id: str, n: int, seed: int | None = None, **kwargs: Any) -> NativeVecEnv:
    """Return n environments as one stable-baselines3 VecEnv, planned together.

    Args:
        env_id: a registered id, as ``"antgym/MountainOneShot-v0"``.
        n: number of slots.
        seed: root seed of the first reset; slot seeds come from ``env_seeds``.
        kwargs: the environment's own arguments.

    Raises:
        ParameterError: on an id that is none of antgym's, and on arguments that it does not take.
    """
    try:
        native = gymnasium.make_vec(
            env_id,
            num_envs=n,
            vectorization_mode="vector_entry_point",
            autoreset_mode=AutoresetMode.SAME_STEP.value,
            **kwargs,
        )
    except (TypeError, gymnasium.error.Error) as error:
        raise ParameterError(
            f"make_sb3_vec({env_id!r}, {_listed(n, kwargs)}): {error}{_hint(env_id)}"
        ) from error
    if not isinstance(native, NativeVectorEnv):
        raise ParameterError(f"{env_id!r} makes no batch of antgym{_hint(env_id)}")
    return NativeVecEnv(native, seed)


class ScaledRewards(VecEnvWrapper):
    """Rewards times a constant; what learners with a temperature or a value loss are tuned for is about ±1.

    Args:
        envs: a batch.
        scale: the constant.
    """

    def __init__(self, envs: VecEnv, scale: float) -> None:
        super().__init__(envs)
        self.scale = scale

    def reset(self) -> Observation:
        """Begin an episode in every slot."""
        shown: Observation = self.venv.reset()
        return shown

    def step_wait(self) -> Any:
        """Step the batch."""
        shown, rewards, ends, infos = self.venv.step_wait()
        return shown, rewards * np.float32(self.scale), ends, infos


def _split(batch: dict[str, Any], count: int) -> list[dict[str, Any]]:
    """Turn Gymnasium's dict of arrays into one dict a slot, without the masks."""
    out: list[dict[str, Any]] = [{} for _ in range(count)]
    for key, values in batch.items():
        if key.startswith("_"):
            continue
        each: list[Any] = _split(values, count) if isinstance(values, dict) else values.tolist()
        for i in range(count):
            out[i][key] = each[i]
    return out


def _listed(n: int, kwargs: dict[str, Any]) -> str:
    return ", ".join([f"n={n}", *(f"{name}=..." for name in kwargs)])


def _hint(env_id: str) -> str:
    """Return the clause that names antgym's ids where this is none of them."""
    known = tuple(entry.id for entry in CATALOGUE)
    return "" if env_id in known else f"; {nearest(env_id, known)}"
