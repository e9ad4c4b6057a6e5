"""Findings: a comparison counted over maps, every figure with its interval, and the claims that are judged by them."""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from experiments.statistics import Estimate, cluster_interval, paired_difference, wilson_interval
from experiments.tables.comparison import CAP, Comparison, Outcome, Result, Values

Marks = NDArray[np.bool_]
REPRODUCED, DIRECTION, NOT_REPRODUCED = "reproduced", "direction only", "not reproduced"


class Claim(NamedTuple):
    """What a paper says, whether it holds here, and by which figures."""

    text: str
    holds: bool
    figures: str

    def __str__(self) -> str:
        return f"{self.text}: **{'holds' if self.holds else 'does not hold'}**. {self.figures}"


def verdict(claims: Sequence[Claim]) -> str:
    """Reproduced where every claim of a paper holds, direction only where the first, its headline, does, else not."""
    if all(claim.holds for claim in claims):
        return REPRODUCED
    return DIRECTION if claims[0].holds else NOT_REPRODUCED


class Tally(NamedTuple):
    """On which maps the improved colony is ahead; all (maps,) bool.

    Attributes:
        lower: its mean gap over the seeds is below the basic one's after the last iteration.
        tied: the two are equal, which counts as not lower.
        sooner: its mean gap is down to the basic one's last in an earlier iteration than the basic one's own is.
    """

    lower: Marks
    tied: Marks
    sooner: Marks

    @property
    def both(self) -> Marks:
        """Lower, and sooner."""
        return self.lower & self.sooner


class Findings(NamedTuple):
    """All that a report says.

    Attributes:
        tally: on which maps the improved colony is ahead.
        claims: the paper's, the one that the comparison is about first.
        changes: by idea, how the mean gap changes where the improved colony is ``"without"`` it, and where the
            basic one has it ``"alone"``.
    """

    tally: Tally
    claims: list[Claim]
    changes: dict[str, dict[str, Estimate]]


def find(result: Result, further: Callable[[Result], list[Claim]]) -> Findings:
    """Work a comparison out; ``further`` judges the claims that only its paper makes."""
    counted = tally(result.improved, result.basic)
    claims = [headline(result.comparison, counted), *further(result)]
    return Findings(counted, claims, changes(result))


def tally(improved: Outcome, basic: Outcome) -> Tally:
    """Count maps; a colony whose mean gap is still the cap has got nowhere, so whoever gets below it is sooner."""
    target = basic.curves[:, -1]
    ours, theirs = improved.curves[:, -1], target
    return Tally(
        ours < theirs, ours == theirs, _arrival(improved.curves, target) < _arrival(basic.curves, target)
    )


def _arrival(curves: Values, target: Values) -> Values:
    """Return the first iteration of each map at which the mean gap is down to the target, inf where it never is."""
    there = (curves <= target[:, None]) & (curves < CAP)
    return np.where(there.any(axis=1), there.argmax(axis=1), np.inf)


def headline(comparison: Comparison, counted: Tally) -> Claim:
    """Judge the claim that the comparison is about."""
    marks = counted.both if comparison.also_sooner else counted.lower
    claim = judge(comparison.claim, marks, comparison.bar)
    ties = int(counted.tied.sum())
    return claim._replace(figures=f"{claim.figures} Exact ties, which count against it: {ties}.")


def judge(text: str, marks: Marks, bar: int) -> Claim:
    """Return whether a claim holds on as many maps as the bar asks of 100."""
    hits, count = int(marks.sum()), len(marks)
    low, high = wilson_interval(hits, count)
    interval = f"95 % interval {100 * low:.0f}–{100 * high:.0f} %"
    figures = f"On {hits} of {count} maps ({interval}); the bar is {bar} of 100."
    return Claim(text, 100 * hits >= bar * count, figures)


def estimate(values: ArrayLike) -> Estimate:
    """Return the mean of (maps, seeds) values and its bootstrap interval over maps."""
    array = np.asarray(values, dtype=np.float64)
    return Estimate(float(array.mean()), *cluster_interval(array))


def length_ratio(above: Values, below: Values) -> Estimate:
    """Return how many times as long the paths above are: ratios of means over the seeds, averaged over maps.

    Args:
        above: (maps, seeds) lengths over the optimum.
        below: likewise, the same maps.
    """
    return estimate((above.mean(axis=1) / below.mean(axis=1))[:, None])


def first_lengths(outcome: Outcome) -> Values:
    """Return (maps, seeds), the first path of every run over the optimum; ``1 + CAP`` where there is none."""
    found = np.isfinite(outcome.ratios)
    first = np.take_along_axis(outcome.ratios, found.argmax(axis=2)[:, :, None], axis=2)[:, :, 0]
    return np.where(found.any(axis=2), first, 1 + CAP)


def changes(result: Result) -> dict[str, dict[str, Estimate]]:
    """Return by idea how the mean gap changes where the improved colony lacks it, and where the basic one has it."""
    pairs = {"without": result.improved, "alone": result.basic}
    return {
        field: {
            how: paired_difference(result.outcomes[f"{how} {field}"].final, reference.final)
            for how, reference in pairs.items()
        }
        for field in result.comparison.ideas
    }


def numbers(result: Result, findings: Findings) -> dict[str, Any]:
    """Return what the JSON file holds: all that the tables are made of, map by map."""
    comparison = result.comparison
    return {
        "paper": comparison.paper,
        "family": comparison.family,
        **{name: getattr(comparison, name) for name in ("size", "ants", "iterations", "kappa", "bar")},
        "seed": result.options.seed,
        "verdict": verdict(findings.claims),
        "claims": [claim._asdict() for claim in findings.claims],
        "maps": {
            name: getattr(findings.tally, name).tolist() for name in ("lower", "tied", "sooner", "both")
        },
        "final_gaps": {label: outcome.final.tolist() for label, outcome in result.outcomes.items()},
        "curves": {
            label: result.outcomes[label].curves.mean(axis=0).tolist() for label in ("improved", "basic")
        },
        "changes": {
            field: {how: change._asdict() for how, change in row.items()}
            for field, row in findings.changes.items()
        },
    }
