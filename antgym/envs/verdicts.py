"""Verdicts: what a step of several environments came to, and what that is worth."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antgym.envs.infos import Columns
from antgym.tuning.problem import COST_CAP, TuningProblem, gaps

REWARDS = ("gap", "length", "improvement")


class Verdicts(NamedTuple):
    """What one step of n environments came to.

    Attributes:
        parameters: (n, d) natural values of the settings that count.
        lengths: (n,) that these came to, in world units; inf where there was no path.
        defaults: (n,) what fresh runs of the published default came to, nan where the reward compares with none.
        facts: that the regime adds to info.
    """

    parameters: NDArray[np.float64]
    lengths: NDArray[np.float64]
    defaults: NDArray[np.float64] | None = None
    facts: Columns = {}  # noqa: RUF012 - of a tuple, which nobody writes to


def judged(problems: Sequence[TuningProblem], verdicts: Verdicts) -> Columns:
    """Return what info tells of a step beside what it tells of problems."""
    lengths = verdicts.lengths
    straight_lines = np.array([problem.scenario.straight_line for problem in problems])
    return {
        "length": np.minimum(lengths, COST_CAP * straight_lines),
        "optimum": np.array([problem.scenario.optimum for problem in problems]),
        "gap": gaps(problems, lengths),
        "solved": np.isfinite(lengths),
        "parameters": dict(zip(problems[0].space.names, verdicts.parameters.T, strict=True)),
        **verdicts.facts,
    }


def worths(
    reward: str, problems: Sequence[TuningProblem], verdicts: Verdicts, told: Columns
) -> NDArray[np.float64]:
    """Return what each verdict is worth under one of ``REWARDS``; see the environments' docstrings."""
    if reward == "length":
        return -np.asarray(told["length"])
    worth = -np.asarray(told["gap"])
    if verdicts.defaults is not None:
        compared = np.flatnonzero(~np.isnan(verdicts.defaults)).tolist()
        worth[compared] += gaps([problems[i] for i in compared], verdicts.defaults[compared])
    return worth
