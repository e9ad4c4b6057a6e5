"""Findings: what all draws say together, and whether the paper's claims hold by it."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from experiments.statistics import Estimate, paired_difference
from experiments.tables.findings import DIRECTION, NOT_REPRODUCED, REPRODUCED, estimate
from experiments.tables.liu2020.draw import Answer, Draw
from experiments.tables.liu2020.methods import COPY, METHODS, TRANSFER, Method
from experiments.tables.report import percent

Values = NDArray[np.float64]
SMALL_PART = 0.1  # of a search's time; the paper's transfer takes 0.2 to 0.5 % of it


class Standing(NamedTuple):
    """A row of Table 4.

    Attributes:
        method: which.
        gap: mean over the draws.
        difference: its gap less that of transfer as printed, paired by draw; None for that transfer itself.
        solved: share of the fresh runs that found a path.
        evaluations: of the target, mean.
        before: evaluations of other maps that it needs first, mean.
        seconds: on the target, mean.
    """

    method: Method
    gap: Estimate
    difference: Estimate | None
    solved: float
    evaluations: float
    before: float
    seconds: float

    @property
    def ratio(self) -> float | None:
        """The paper's seconds over ours; None where the paper gives none."""
        return None if self.method.seconds is None else self.method.seconds / max(self.seconds, 1e-6)


class Claim(NamedTuple):
    """What the paper says, and by how much it is so: an estimate that is above 0 on the paper's side."""

    text: str
    margin: Estimate
    figures: str

    @property
    def holds(self) -> bool:
        """Whether the whole interval is on the paper's side."""
        return self.margin.low > 0

    def __str__(self) -> str:
        word = "holds" if self.holds else "is refuted" if self.margin.high < 0 else "is undecided"
        return f"{self.text}: **{word}**. {self.figures}"


class Findings(NamedTuple):
    """All that a report says of two draws or more.

    Attributes:
        standings: rows of Table 4, shortest paths first.
        claims: the paper's, of length and of time.
    """

    standings: list[Standing]
    claims: list[Claim]

    @property
    def verdict(self) -> str:
        """Reproduced where every claim holds, direction only where every mean is on the paper's side, else not."""
        if all(claim.holds for claim in self.claims):
            return REPRODUCED
        return DIRECTION if all(claim.margin.mean > 0 for claim in self.claims) else NOT_REPRODUCED


def find(draws: Sequence[Draw]) -> Findings:
    """Work out two draws or more."""
    standings = [_stand(method, draws) for method in METHODS]
    rivals = [method for method in METHODS if method.is_papers and method is not TRANSFER]
    lengths = [_shorter(rival, draws) for rival in rivals]
    times = [_sooner(rival, draws) for rival in rivals if rival.seconds is not None]
    return Findings(sorted(standings, key=lambda row: row.gap.mean), lengths + times)


def answers(method: Method, draws: Sequence[Draw]) -> list[Answer]:
    """Return what a method arrived at, one answer a draw."""
    return [next(each for each in draw.answers if each.method == method.label) for draw in draws]


def gaps(method: Method, draws: Sequence[Draw]) -> Values:
    """Return (draws, RUNS) gaps of fresh runs."""
    return np.array([answer.gaps for answer in answers(method, draws)])


def worse_than_copy(method: Method, draws: Sequence[Draw]) -> int:
    """Return on how many draws a method's mean gap is above that of copying: negative transfer."""
    return int((gaps(method, draws).mean(axis=1) > gaps(COPY, draws).mean(axis=1)).sum())


def _stand(method: Method, draws: Sequence[Draw]) -> Standing:
    found, ours = gaps(method, draws), answers(method, draws)
    solved = np.mean([[length is not None for length in answer.lengths] for answer in ours])
    means = [
        float(np.mean([getattr(a, name) for a in ours])) for name in ("evaluations", "before", "seconds")
    ]
    difference = None if method is TRANSFER else _difference(method, draws)
    return Standing(method, estimate(found), difference, float(solved), *means)


def _difference(method: Method, draws: Sequence[Draw]) -> Estimate:
    return paired_difference(gaps(method, draws), gaps(TRANSFER, draws))


def _shorter(rival: Method, draws: Sequence[Draw]) -> Claim:
    margin = _difference(rival, draws)
    figures = f"The other's gap is {percent(margin, sign='+')} points from transfer's."
    return Claim(f"Transfer's path is shorter than that of {rival.label}", margin, figures)


def _sooner(rival: Method, draws: Sequence[Draw]) -> Claim:
    theirs = np.array([answer.seconds for answer in answers(rival, draws)])
    ours = np.array([answer.seconds for answer in answers(TRANSFER, draws)])
    fitting = np.array([draw.fitting_seconds for draw in draws])
    part, whole = (estimate((seconds / theirs)[:, None]) for seconds in (ours, ours + fitting))
    margin = Estimate(SMALL_PART - part.mean, SMALL_PART - part.high, SMALL_PART - part.low)
    printed = (TRANSFER.seconds or 0) / (rival.seconds or 1)
    figures = (
        f"It takes {percent(part)} % of it (the paper: {100 * printed:.1f}), "
        f"{percent(whole)} % with what fitting the sources takes."
    )
    return Claim(f"Transfer takes at most {SMALL_PART:.0%} of the time of {rival.label}", margin, figures)
