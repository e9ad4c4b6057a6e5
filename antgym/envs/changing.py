"""stable-baselines3: batches whose actions are changes, of the last setting or of where an episode begins."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from antgym.envs.control import ControlEnv
from antgym.envs.episodes import Observation
from antgym.errors import MissingExtraError, ParameterError
from antgym.tuning.actions import Change, Start, changed, choices, moved, starts_of

if TYPE_CHECKING:
    from antgym.envs.sb3 import NativeVecEnv
try:
    from stable_baselines3.common.vec_env import VecEnvWrapper
except ImportError:
    raise MissingExtraError("stable-baselines3", "rl") from None


class _StartedVecEnv(VecEnvWrapper):
    """A batch that knows the setting from which every slot's episode begins; Control shows it as the last block's."""

    def __init__(self, envs: "NativeVecEnv", start: Start | None, space: Any = None) -> None:
        super().__init__(envs, action_space=space)
        (dimension,) = envs.action_space.shape
        _require_start(start, dimension)
        single = envs.native.envs[0]
        self.start = start
        self._units = np.zeros((self.num_envs, dimension))
        self._described, self._shows = len(single.task_features), isinstance(single, ControlEnv)

    def reset(self) -> Observation:
        """Begin an episode in every slot."""
        shown: Observation = self.venv.reset()
        return self._begin(np.ones(self.num_envs, bool), shown)

    def step_wait(self) -> Any:
        """Step the batch."""
        shown, rewards, ends, infos = self.venv.step_wait()
        return self._begin(ends, shown), rewards, ends, infos

    def _begin(self, slots: NDArray[np.bool_], shown: Observation) -> Observation:
        """Go back to the start in some slots, and show it where the regime does."""
        if slots.any():
            features = shown["features"] if isinstance(shown, dict) else shown
            dimension = self._units.shape[1]
            self._units[slots] = starts_of(self.start, features[slots, : self._described], dimension)
            if self._shows:
                features[slots, -dimension:] = self._units[slots]
        return shown

    def _ask(self, units: NDArray[np.float64]) -> None:
        self.venv.step_async((2 * units - 1).astype(np.float32))


class ChangingVecEnv(_StartedVecEnv):
    """Control by factorised changes: an action moves the last block's setting and does not set it anew.

    Args:
        envs: a batch of Control.
        how: ``"each"``: `MultiDiscrete`, a change of ``CHANGES`` a parameter; ``"one"``: `Discrete`, a change of one
            parameter or none, for DQN and its like.
        start: (d,) setting in [0, 1] that the first action of a run changes, or one by the name of its rules, or a
            function of features of tasks; by default the published one. The observation shows it as the setting of the
            last block.
    """

    def __init__(self, envs: "NativeVecEnv", how: Change, start: Start | None = None) -> None:
        if not isinstance(envs.native.envs[0], ControlEnv):
            raise ParameterError("settings are changed block by block in Control alone")
        counts = choices(how, *envs.action_space.shape)
        spaces = gymnasium.spaces
        space: Any = spaces.MultiDiscrete(list(counts)) if how == "each" else spaces.Discrete(counts[0])
        super().__init__(envs, start, space)
        self.how = how

    def step_async(self, actions: NDArray[np.int64]) -> None:
        """Change the settings."""
        self._units = changed(self._units, actions, self.how)
        self._ask(self._units)


class MovedVecEnv(_StartedVecEnv):
    """Settings as moves from a start: action 0 is the start itself, and not the published default.

    Args:
        envs: a batch.
        start: where every action of an episode is counted from, as for :class:`ChangingVecEnv`; a policy of OneShot
            makes what is learnt here a correction of its choice.
    """

    def __init__(self, envs: "NativeVecEnv", start: Start) -> None:
        super().__init__(envs, start)

    def step_async(self, actions: NDArray[np.float32]) -> None:
        """Move the starts."""
        self._ask(moved(self._units, actions))


def _require_start(start: Start | None, dimension: int) -> None:
    """Raise ParameterError where a start is no setting, nor settings by rules; a function is taken as it is."""
    if start is None or callable(start):
        return
    for one in start.values() if isinstance(start, Mapping) else [start]:
        units = np.asarray(one, dtype=np.float64)
        if units.shape != (dimension,) or not ((units >= 0) & (units <= 1)).all():
            raise ParameterError(f"start = {one!r}: needs {dimension} values from 0 to 1")
