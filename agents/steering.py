"""Controllers: who sets the parameters of a run on the way, block by block; agents choose before it."""

from collections.abc import Sequence
from copy import copy
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from agents.choosing import start_in
from agents.networks import Player, load
from agents.policy import require_parameters, require_shape
from agents.shipped import find_policy
from antgym.errors import ParameterError
from antgym.tuning import Agent, Task, changed, moved, settings_of, starts_of

Floats = NDArray[np.float64]
FLAGSHIP = "open-control"


class Controller(Protocol):
    """Who steers a run."""

    def reset(self, task: Task, *, seed: int) -> None:
        """Begin a run, forgetting the one before."""
        ...

    def act(self, observation: NDArray[np.float32]) -> Floats:
        """Return the (d,) setting in [0, 1] for the next block, from what `ControlEnv` shows before it."""
        ...


class Schedule(NamedTuple):
    """The first two parameters of a static setting (α and β of ants) times a factor each, before and after blocks."""

    first: tuple[float, float]
    second: tuple[float, float]
    switch: int

    def label(self, names: Sequence[str]) -> str:
        """Return how cards name it, by the names of the parameters."""
        first, second = names[:2]
        return f"{first} x {self.first}, {second} x {self.second}, change after block {self.switch}"


class ConstantController:
    """What an agent recommends without a trial, throughout.

    Args:
        agent: never told of the run.

    Attributes:
        setting: what it recommended for the run that was begun, (d,) in [0, 1].
    """

    setting: Floats

    def __init__(self, agent: Agent) -> None:
        self.agent = agent

    def reset(self, task: Task, *, seed: int) -> None:
        """Let the agent choose."""
        agent = copy(self.agent)  # what training left is shared, what a task brings is not
        agent.reset(replace(task, budget=0), seed=seed)
        self.setting = np.asarray(agent.recommend(), dtype=np.float64)

    def act(self, observation: NDArray[np.float32]) -> Floats:  # noqa: ARG002 - a constant looks at nothing
        """Return the setting."""
        return self.setting


class ScheduleController(ConstantController):
    """The same, its first two parameters multiplied by a schedule's factors, held within their ranges.

    Args:
        agent: whose recommendation is the static setting.
        schedule: the factors.
    """

    def __init__(self, agent: Agent, schedule: Schedule) -> None:
        super().__init__(agent)
        self._schedule = schedule

    def reset(self, task: Task, *, seed: int) -> None:
        """Work out both settings."""
        super().reset(task, seed=seed)
        space, zero = task.space, np.zeros(len(task.space))
        low, high, static = (space.decode(unit)[0] for unit in (zero, zero + 1, self.setting))
        parts = []
        for part in range(2):
            factors = np.ones(len(static))
            factors[:2] = self._schedule.first[part], self._schedule.second[part]
            moved = space.encode(np.clip(static * factors, low, high))[0]
            parts.append(self.setting if (factors == 1).all() else np.clip(moved, 0.0, 1.0))
        self._parts, self._block = parts, 0

    def act(self, observation: NDArray[np.float32]) -> Floats:  # noqa: ARG002 - a schedule looks at nothing
        """Return the setting of the block."""
        self._block += 1
        return self._parts[self._block > self._schedule.switch]


class PolicyController:
    """A published policy of Control, deterministic.

    Args:
        path: NAME of its two files, or either, or of one that is shipped.

    Attributes:
        card: what its JSON says.

    Raises:
        ParameterError: where a file is missing or damaged, or the policy is of another regime.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = find_policy(path)
        self.card, self._network = load(self.path)
        if self.card.regime != "Control":
            raise ParameterError(f"{self.path}: a policy of {self.card.regime} steers no run")
        self._start = start_in(self.path, self.card)

    def reset(self, task: Task, *, seed: int) -> None:  # noqa: ARG002 - a deterministic policy
        """Begin a run; ParameterError where the policy sets other parameters."""
        require_parameters(self.path, self.card, task)
        self._player, self._first = Player(self._network), True
        self._begin = self._setting = starts_of(self._start, task.features[None], len(task.space))[0]
        flat = self.card.observation == "map2d"
        self._map = None if self.card.map is None else task.map(flat)

    def act(self, observation: NDArray[np.float32]) -> Floats:
        """Return the setting that the policy asks for, or that its change of the last one leads to."""
        seen = observation.copy()
        if self._first:  # where changes begin is shown as the last block's setting
            seen[-len(self._setting) :] = self._setting
        self._first = False
        shown: Any = seen if self._map is None else {"features": seen, "map": self._map}
        require_shape(self.path, self.card, shown)
        action = self._player.act(shown)
        if self.card.action == "setting":
            self._setting = settings_of(action)
        elif self.card.action == "moved":
            self._setting = moved(self._begin, action)
        else:
            self._setting = changed(self._setting[None], action[None], self.card.action)[0]
        return self._setting


class HeldController(PolicyController):
    """A published policy of Control whose first setting stays: what of its lead is owed to changing it shows beside it.

    That is no more than a bound of what steering is worth: the first setting was not trained to stay.
    """

    def act(self, observation: NDArray[np.float32]) -> Floats:
        """Return the setting that the policy asked for before the first block."""
        return super().act(observation) if self._first else self._setting
