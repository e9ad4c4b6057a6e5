"""The native batch as a stable-baselines3 VecEnv; the only module of antgym that imports that library."""

from collections.abc import Iterable, Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from antgym.envs.episodes import Observation
from antgym.envs.vector import NativeVectorEnv
from antgym.errors import MissingExtraError

try:
    from stable_baselines3.common.vec_env import VecEnv
except ImportError:
    raise MissingExtraError("stable-baselines3", "rl") from None


class NativeVecEnv(VecEnv):
    """A :class:`NativeVectorEnv` in SAME_STEP mode, as stable-baselines3 wants its environments."""

    def __init__(self, native: NativeVectorEnv, seed: int | None = None) -> None:
        self.native = native
        self.render_mode = native.render_mode
        super().__init__(native.num_envs, native.single_observation_space, native.single_action_space)
        self._root = seed
        self._actions: NDArray[np.float32] = np.zeros(0, np.float32)

    def reset(self) -> Observation:
        """Begin an episode in every slot and return the observations."""
        seed = self._seeds[0] if self._seeds[0] is not None else self._root
        observations, infos = self.native.reset(seed=None if seed is None else int(seed))
        self._root = None
        self.reset_infos = _split(infos, self.num_envs)
        self._reset_seeds()
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
    """
    native = gymnasium.make_vec(
        env_id,
        num_envs=n,
        vectorization_mode="vector_entry_point",
        autoreset_mode=AutoresetMode.SAME_STEP.value,
        **kwargs,
    )
    assert isinstance(native, NativeVectorEnv)
    return NativeVecEnv(native, seed)


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
