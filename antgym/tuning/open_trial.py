"""A trial under way: one paid planner run that is steered, block by block; see :meth:`Session.open`."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from antgym.errors import ParameterError
from antgym.planners.pausing import advance_together
from antgym.planners.swarms import start
from antgym.tuning.problem import TRIAL, TuningProblem


class OpenTrial:
    """One planner run in blocks of equal length up to one, each walked under a setting of its own.

    It is walked as an ordinary trial of the same index: with one setting throughout, it finds the same path.

    Args:
        problem: what is planned.
        index: of this trial in its session.
        blocks: how many, as many as there are iterations at most.
        buffers: released by a run of the same kind that is done with.

    Attributes:
        index: of this trial in its session.
        blocks: how many.
        seed: of the planner.
        units: the settings of the blocks walked so far, each value in [0, 1].
        straight_line: from start to goal, in world units.
        colony: the run itself, of ants or of bees; the harness's, for it knows the scenario.

    Raises:
        ParameterError: if there are fewer iterations than blocks, or the problem is a fleet's.
    """

    def __init__(self, problem: TuningProblem, index: int, blocks: int, buffers: Any = None) -> None:
        if not isinstance(blocks, int) or not 1 <= blocks <= problem.iterations:
            raise ParameterError(
                f"blocks = {blocks!r}: a run of {problem.iterations} iterations is steered in 1 to "
                f"{problem.iterations} blocks"
            )
        self.index, self.blocks = index, blocks
        self.seed = int(problem.seeds(TRIAL, index, 1)[0])
        self.units: tuple[tuple[float, ...], ...] = ()
        self._iterations, self.straight_line = problem.iterations, problem.scenario.straight_line
        self._dimension = len(problem.space)
        self.colony = start(
            problem.scenario,
            rules=problem.rules,
            ants=problem.ants,
            iterations=problem.iterations,
            seed=self.seed,
            buffers=buffers,
        )

    @property
    def over(self) -> bool:
        """Whether every block is walked."""
        return len(self.units) == self.blocks

    @property
    def length(self) -> float:
        """Length of the shortest path so far, inf before any."""
        return self.colony.best

    @property
    def parameters(self) -> tuple[float, ...]:
        """Natural values of the last block's setting; ParameterError before any."""
        return self.colony.parameters[: self._dimension]  # without a tabu list, bees have no radius

    @property
    def next_block(self) -> int:
        """Iterations of the next block."""
        walked = len(self.units)
        return self._iterations * (walked + 1) // self.blocks - self._iterations * walked // self.blocks


def walk_together(trials: list[OpenTrial], units: NDArray[np.float64], naturals: NDArray[np.float64]) -> None:
    """Walk the next block of several open trials in one planner call.

    Args:
        trials: n different ones, none of them over.
        units: (n, d) settings.
        naturals: (n, d) what they decode to, each in its own problem's space.
    """
    advance_together([trial.colony for trial in trials], naturals, [trial.next_block for trial in trials])
    for trial, unit in zip(trials, units.tolist(), strict=True):
        trial.units += (tuple(unit),)
