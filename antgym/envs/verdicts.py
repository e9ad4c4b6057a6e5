"""Verdicts: what the steps of several environments came to, and what that is worth."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antgym.envs.infos import Columns
from antgym.planners.parameters import ColonyParameters
from antgym.planners.space import decode_together
from antgym.tuning.problem import COST_CAP, TuningProblem, gaps

REWARDS = ("gap", "length", "improvement")


class Verdict(NamedTuple):
    """What one step came to.

    Attributes:
        unit: the setting that counts, each value in [0, 1].
        length: that it came to, in world units; inf where there was no path.
        default: what a fresh run of the published default came to, where the reward compares with it.
        facts: that the regime adds to info.
        parameters: natural values of the setting, where the regime has them; it is decoded otherwise.
    """

    unit: Sequence[float]
    length: float
    default: float | None = None
    facts: Mapping[str, Any] = {}
    parameters: Sequence[float] | None = None


def facts(problems: Sequence[TuningProblem]) -> Columns:
    """Return what info tells of problems before anything is run."""
    return {
        "scenario": [problem.scenario.name for problem in problems],
        "seed": [problem.seed for problem in problems],
        "ants": [problem.ants for problem in problems],
        "iterations": [problem.iterations for problem in problems],
        "rules": [problem.rules for problem in problems],
    }


def judged(problems: Sequence[TuningProblem], verdicts: Sequence[Verdict]) -> Columns:
    """Return what info tells after a step."""
    lengths = np.array([verdict.length for verdict in verdicts])
    straight_lines = np.array([problem.scenario.straight_line for problem in problems])
    return {
        **facts(problems),
        "length": np.minimum(lengths, COST_CAP * straight_lines),
        "optimum": [problem.scenario.optimum for problem in problems],
        "gap": gaps(problems, lengths),
        "solved": np.isfinite(lengths),
        "parameters": dict(zip(ColonyParameters._fields, _naturals(problems, verdicts).T, strict=True)),
        **{name: [verdict.facts[name] for verdict in verdicts] for name in verdicts[0].facts},
    }


def worths(
    reward: str, problems: Sequence[TuningProblem], verdicts: Sequence[Verdict], told: Columns
) -> NDArray[np.float64]:
    """Return what each verdict is worth under one of ``REWARDS``; see the environments' docstrings."""
    if reward == "length":
        return -np.asarray(told["length"])
    worth = -np.asarray(told["gap"])
    compared = [i for i, verdict in enumerate(verdicts) if verdict.default is not None]
    if compared:
        defaults = np.array([verdicts[i].default for i in compared])
        worth[compared] += gaps([problems[i] for i in compared], defaults)
    return worth


def _naturals(problems: Sequence[TuningProblem], verdicts: Sequence[Verdict]) -> NDArray[np.float64]:
    if verdicts[0].parameters is not None:
        return np.array([verdict.parameters for verdict in verdicts])
    units = np.array([verdict.unit for verdict in verdicts])
    return decode_together([problem.space for problem in problems], units)
