"""Published policies as agents: a setting from what is seen of the task, or trials that a policy picks one by one."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from agents.choosing import start_in
from agents.networks import Player, load
from agents.published import SHIPPED, PolicyCard
from agents.shipped import find_policy, shipped_names
from antgym.errors import ParameterError, nearest
from antgym.tuning import Task, Trial, incumbent, moved, observe, observe_with_map, settings_of, starts_of

Floats = NDArray[np.float64]
FLAGSHIP = "open-one-shot"


class PolicyAgent:
    """Follow a published policy, deterministically.

    A policy of OneShot recommends without a trial. One of Trials picks every trial from what it sees, which is what
    `TrialsEnv` shows, and recommends what that pays for: the setting with the lowest mean cost. Files are read without
    running anything of them.

    Args:
        path: NAME of NAME.json and NAME.safetensors, either file, or the name of a policy that is shipped; None for the
            shipped ``policy``.
        policy: name of a shipped policy.

    Attributes:
        card: what the JSON file says.

    Raises:
        ParameterError: where a file is missing or damaged, no such policy is shipped, or it is one that steers a run.
    """

    def __init__(self, path: str | Path | None = None, *, policy: str = FLAGSHIP) -> None:
        self.path = shipped(policy) if path is None else find_policy(path)
        self.card, self._network = load(self.path)
        if self.card.regime == "Control":
            raise ParameterError(
                f"{self.path}: steers a run and picks no setting; agents.steering.PolicyController plays it"
            )
        self._start = start_in(self.path, self.card)

    def reset(self, task: Task, *, seed: int) -> None:  # noqa: ARG002 - a deterministic policy
        """Look at the task; ParameterError where the policy was trained on another observation or other parameters."""
        if self.card.regime == "Trials" and task.budget == 0:
            raise ParameterError(
                f"{self.path}: picks trials, but the task's budget is 0; a policy of Trials is played where "
                "budgets are 1 or more"
            )
        require_parameters(self.path, self.card, task)
        self._task, self._player = task, Player(self._network)
        self._trials: list[Trial] = []
        self._begin = starts_of(self._start, task.features[None], len(task.space))[0]
        self._setting = self._begin
        if self.card.regime == "OneShot":
            self._setting = self._pick()

    def ask(self) -> Floats:
        """Return the next setting, (1, d); none, (0, d), from a policy of OneShot."""
        return np.empty((0, len(self._setting))) if self.card.regime == "OneShot" else self._pick()[None]

    def tell(self, trials: Sequence[Trial]) -> None:
        """Remember trials; a policy of OneShot has no use for them."""
        self._trials += trials
        if self.card.regime == "Trials":
            self._setting = np.array(incumbent(self._trials)[0])

    def recommend(self) -> Floats:
        """Return the policy's setting, (d,); from one of Trials the incumbent, before any trial its start."""
        return self._setting.copy()

    def _pick(self) -> Floats:
        seen = self._observe()
        require_shape(self.path, self.card, seen)
        action = self._player.act(seen)
        return moved(self._begin, action) if self.card.action == "moved" else settings_of(action)

    def _observe(self) -> Any:
        card = self.card
        if card.map is None:
            return observe(self._task, self._trials, window=card.window)
        flat = card.observation == "map2d"
        return observe_with_map(self._task, self._trials, window=card.window, flat=flat)


def shipped(policy: str) -> Path:
    """Return the path of a policy that comes with antgym; ParameterError names those that there are."""
    known = shipped_names()
    if policy not in known:
        hint = nearest(policy, known) if known else "none is, so far"
        raise ParameterError(
            f"agent 'rl' needs path=, the fitted artefact it works with: no policy {policy!r} is shipped; {hint}"
        )
    return SHIPPED / policy


def require_parameters(path: Path, card: PolicyCard, task: Task) -> None:
    """Raise ParameterError where a policy picks other parameters than a task has."""
    if tuple(card.parameters) != task.space.names:
        raise ParameterError(f"{path}: picks {card.parameters}, the task has {list(task.space.names)}")


def require_shape(path: Path, card: PolicyCard, seen: Any) -> None:
    """Raise ParameterError where an observation is not of the shape that a policy was trained on."""
    vector = seen["features"] if card.map is not None else seen
    if vector.shape != (card.size,):
        raise ParameterError(
            f"{path}: takes observations of shape {(card.size,)}, the task's is {vector.shape}"
        )
