"""The agent protocol and the loop that runs it."""

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from antgym.tuning.problem import Task
from antgym.tuning.session import Session, Trial


class Agent(Protocol):
    """Who picks the parameters. All settings are in the unit cube of ``task.space``."""

    def reset(self, task: Task, *, seed: int) -> None:
        """Forget everything but what training left, and take on a task."""
        ...

    def ask(self) -> NDArray[np.float64]:
        """Return (k, d) settings to try next; k = 0 ends the run and leaves the rest of the budget unspent."""
        ...

    def tell(self, trials: Sequence[Trial]) -> None:
        """Learn from trials: those of the last ask, fewer where the budget ended."""
        ...

    def recommend(self) -> NDArray[np.float64]:
        """Return the (d,) setting to use: the agent's own judgement under noise, at any time after reset."""
        ...


class Result(NamedTuple):
    """What a tuning run ends with: the recommended setting, (d,) in [0, 1], and every trial."""

    recommendation: NDArray[np.float64]
    trials: tuple[Trial, ...]


def tune(agent: Agent, session: Session, *, seed: int) -> Result:
    """Let an agent spend a session; its recommendation may be asked for with no trial spent."""
    agent.reset(session.task, seed=seed)
    while session.left and len(units := agent.ask()):
        agent.tell(session.evaluate(units))
    return Result(session.problem.space.check(agent.recommend())[0], session.trials)
