"""The agent protocol and the loops that run it: one agent, or many in lock-step."""

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from antgym.errors import ParameterError
from antgym.tuning.problem import Task
from antgym.tuning.session import Session, Trial, evaluate_together


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


def tune_together(runs: Sequence[tuple[Agent, Session, int]]) -> list[Result]:
    """Let many agents spend a session each, in lock-step: what they ask for in a round is one planner call.

    Every result is that of ``tune(agent, session, seed=seed)``, bit for bit. Seeds × maps of an evolutionary agent so
    cost one planner call a generation, which keeps all cores busy where the batch of a single agent would not.

    Args:
        runs: (agent, session, seed); every agent and every session an object of its own.

    Raises:
        ParameterError: where an agent or a session appears twice (nobody is charged).
    """
    for place, what in enumerate(("an agent", "a session")):
        if len({id(run[place]) for run in runs}) < len(runs):
            raise ParameterError(f"{what} appears twice; every run needs one of its own")
    for agent, session, seed in runs:
        agent.reset(session.task, seed=seed)
    playing = [(agent, session) for agent, session, _ in runs]
    while playing:
        asked = [(a, s, units) for a, s in playing if s.left and len(units := a.ask())]
        told = evaluate_together([(session, units) for _, session, units in asked])
        for (agent, _, _), trials in zip(asked, told, strict=True):
            agent.tell(trials)
        playing = [(agent, session) for agent, session, _ in asked]
    return [Result(s.problem.space.check(a.recommend())[0], s.trials) for a, s, _ in runs]
