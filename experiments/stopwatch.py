"""An agent as a contest plays it: copied for one run, timed, and kept from stopping the others where it fails."""

import time
from collections.abc import Sequence
from copy import copy
from typing import Any

import numpy as np

from agents.stranger import Stranger
from antgym.errors import AgentError
from antgym.tuning.agent import Agent
from antgym.tuning.problem import Task
from antgym.tuning.session import Record

UNLIKE = (
    "answered otherwise than before the board was stopped: its draws have to follow from reset's seed alone"
)
DEFAULT = 0.5  # of every parameter: the published one


class Stopwatch:
    """A copy of an agent, the seconds spent inside it, and how it failed, if it is a stranger's and did.

    An agent that failed asks for nothing more, and stands with the published default, which is not its own answer.

    Args:
        agent: is copied: what training left is shared, what a task brings is not.
        kept: what the ledger holds of its trials from before the board was stopped.
    """

    def __init__(self, agent: Agent, kept: Sequence[Record]) -> None:
        self._agent, self._kept, self._told = copy(agent), kept, 0
        self.seconds = 0.0
        self.failure = ""

    def _timed(self, name: str, *args: Any, **kwargs: Any) -> Any:
        if self.failure:
            return self._nothing
        begun = time.perf_counter()
        try:
            return getattr(self._agent, name)(*args, **kwargs)
        except AgentError as error:
            self.failure = str(error)
            return self._nothing
        finally:
            self.seconds += time.perf_counter() - begun

    def reset(self, task: Task, *, seed: int) -> None:
        """Pass on."""
        self._nothing = np.empty((0, len(task.space)))
        self._timed("reset", task, seed=seed)

    def ask(self) -> Any:
        """Pass on; a stranger that asks for something else than before the board was stopped has failed."""
        units = self._timed("ask")
        if isinstance(self._agent, Stranger) and not self.failure:
            before = [list(record.trial.unit) for record in self._kept[self._told : self._told + len(units)]]
            stops_early = not len(units) and self._told < len(self._kept)
            if stops_early or before != units[: len(before)].tolist():
                self.failure = f"{self._agent.name}: ask() {UNLIKE}"
                return self._nothing
        return units

    def tell(self, trials: Any) -> None:
        """Pass on."""
        self._told += len(trials)
        self._timed("tell", trials)

    def recommend(self) -> Any:
        """Pass on."""
        found = self._timed("recommend")
        return np.full(self._nothing.shape[1], DEFAULT) if self.failure else found

    def stop(self) -> None:
        """End a stranger's process; what it computed between calls is counted too."""
        if isinstance(self._agent, Stranger):
            self._agent.close()
            self.seconds = max(self.seconds, self._agent.cpu)
