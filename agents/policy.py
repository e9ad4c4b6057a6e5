"""Frozen policies of stable-baselines3: a setting from what is seen of the task, with no trial."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antgym.errors import MissingExtraError, ParameterError, nearest
from antgym.tuning import Task, Trial, observe, observe_with_map

Floats = NDArray[np.float64]
ALGORITHMS = ("A2C", "DDPG", "PPO", "SAC", "TD3")


class PolicyAgent:
    """Recommend the deterministic action of a trained policy.

    A checkpoint is unpickled by stable-baselines3: load only those that you trained yourself.

    Args:
        path: checkpoint ``<name>.zip``, or the name alone, or the card beside it: ``<name>.json``, which holds at
            least ``{"algorithm": "TD3"}`` and, for tables, ``env`` and ``evaluations``.

    Attributes:
        card: what the JSON file says.

    Raises:
        ParameterError: where a file is missing, is no JSON object, or names an unknown algorithm.
    """

    def __init__(self, path: str | Path) -> None:
        stem = str(path).removesuffix(".zip").removesuffix(".json")
        self.path = Path(f"{stem}.zip")
        self.card = _read_card(Path(f"{stem}.json"))
        if not self.path.is_file():
            raise ParameterError(f"{self.path}: no such checkpoint")
        self._model = _load(self.path, str(self.card["algorithm"]))

    def reset(self, task: Task, *, seed: int) -> None:  # noqa: ARG002 - a deterministic policy
        """Look at the task; ParameterError where the policy was trained on another observation."""
        self._dimension = len(task.space)
        space = self._model.observation_space
        observation: Any = observe(task)
        if (
            isinstance(space, Mapping) and space.get("map") is not None
        ):  # trained with a map beside the features
            observation = observe_with_map(task, flat=len(space["map"].shape) == 3)
        if _shapes(observation) != _shapes(space):
            raise ParameterError(
                f"{self.path}: takes observations of shape {_shapes(space)}, the task's is {_shapes(observation)}"
            )
        action, _ = self._model.predict(observation, deterministic=True)
        self._setting = np.clip((np.asarray(action, dtype=np.float64) + 1) / 2, 0.0, 1.0)
        if self._setting.shape != (self._dimension,):
            raise ParameterError(
                f"{self.path}: picks {self._setting.size} parameters, the task has {self._dimension}"
            )

    def ask(self) -> Floats:
        """Return no settings, (0, d)."""
        return np.empty((0, self._dimension))

    def tell(self, trials: Sequence[Trial]) -> None:
        """Ignore trials."""

    def recommend(self) -> Floats:
        """Return the policy's setting, (d,)."""
        return self._setting.copy()


def _shapes(seen: Any) -> Any:
    """Return the shape of an observation or its space, of each part by name where it has several."""
    return {name: part.shape for name, part in seen.items()} if isinstance(seen, Mapping) else seen.shape


def _read_card(path: Path) -> dict[str, Any]:
    try:
        card = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise ParameterError(f"{path}: no such file; it says which algorithm made the checkpoint") from None
    except (UnicodeDecodeError, json.JSONDecodeError) as error:
        raise ParameterError(f"{path}: no JSON ({error})") from None
    if not isinstance(card, dict) or card.get("algorithm") not in ALGORITHMS:
        name = str(card.get("algorithm")) if isinstance(card, dict) else ""
        raise ParameterError(f"{path}: algorithm {name!r} is unknown; {nearest(name, ALGORITHMS)}")
    return card


def _load(path: Path, algorithm: str) -> Any:
    try:
        import stable_baselines3
        import torch
    except ModuleNotFoundError as error:
        raise MissingExtraError("stable-baselines3", "rl") from error
    torch.set_num_threads(1)  # the nets are tiny: more threads only fight the planner's
    return getattr(stable_baselines3, algorithm).load(path, device="cpu")
