"""Comparisons: a paper's improved colony and its own basic one on the same maps, many instead of the paper's one.

Both get the same effort, and each the parameters that its rules publish. The improved colony also walks without each
of its ideas, and the basic one with each alone. This is not tuning, so nobody pays for a run.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antgym.console import progress
from antgym.errors import ParameterError
from antgym.maps.world import Scenario
from antgym.planners.colony import Plans, plan_many
from antgym.planners.rules import PAPERS, Rules
from experiments.artefacts import derived_seed
from experiments.tables.draws import draw

MAPS = 100
CAP = 1.0  # gap of a run without a path, and of any worse one, as everywhere
DECIMALS = 9  # of a ratio: equal lengths differ by the order in which their moves are added up
STRIDE = 10  # maps from one step of the bar to the next

Values = NDArray[np.float64]


@dataclass(frozen=True)
class Options:
    """How much of a comparison to run, and other choices where the paper is silent."""

    out: Path = Path("out/tables")
    """Folder of the paper's .md, .json and .png."""
    share: float = 1.0
    """Share of the 100 maps, for a quick look: above 0, 1 at most; two maps at least."""
    seed: int = 0
    """Root seed of the planner; the maps stay."""
    size: int | None = None
    """Cells a side, in place of ours; other maps."""
    ants: int | None = None
    """Ants per iteration, in place of the paper's or ours."""
    kappa: float | None = None
    """Deposit κ = Q / straight line of both colonies, in place of the default of the rules."""


@dataclass(frozen=True)
class Comparison:
    """What a paper compares, and what with.

    Attributes:
        paper: name of the improved rules, and of the files.
        basic: name of the basic rules.
        claim: what the paper says of the two, as a sentence without its end.
        family: of the maps.
        size: cells a side.
        iterations: of every run.
        bar: of 100 maps, on how many the claim is to hold.
        also_sooner: whether the claim is about iterations too.
        ideas: fields of the improved rules that the basic ones lack, and how the table calls each.
        silent: what the paper leaves open and what we take, as sentences.
        ants: per iteration.
        seeds: planner seeds a map; the more, the less a map is won by luck.
        idea_seeds: of a colony with or without one idea: its row is a mean, and need not win map by map.
        kappa: Q / straight line of both; the defaults of their rules where None.
        wanted: which maps of the family are like the paper's.
    """

    paper: str
    basic: str
    claim: str
    family: str
    size: int
    iterations: int
    bar: int
    also_sooner: bool
    ideas: dict[str, str]
    silent: str
    ants: int = 20
    seeds: int = 5
    idea_seeds: int = 3
    kappa: float | None = None
    wanted: Callable[[Scenario], bool] = lambda scenario: True

    def under(self, options: Options) -> "Comparison":
        """Return the comparison with what the options choose otherwise."""
        chosen = {name: getattr(options, name) for name in ("size", "ants", "kappa")}
        return replace(self, **{name: value for name, value in chosen.items() if value is not None})

    def parameters(self, rules: Rules, scenario: Scenario) -> Values:
        """Return (4,) natural values: what the rules publish, and κ where it is chosen otherwise."""
        values = rules.ranges.space(scenario.straight_line).default
        if self.kappa is not None:
            values[3] = self.kappa * scenario.straight_line
        return values

    def colonies(self) -> Iterator[tuple[str, Rules, int]]:
        """Yield the label, the rules and the seeds a map of every colony: the two, then by idea."""
        improved, basic = PAPERS[self.paper], PAPERS[self.basic]
        yield "improved", improved, self.seeds
        yield "basic", basic, self.seeds
        for field in self.ideas:
            yield f"without {field}", improved._replace(**{field: getattr(basic, field)}), self.idea_seeds
            yield f"alone {field}", basic._replace(**{field: getattr(improved, field)}), self.idea_seeds


class Outcome(NamedTuple):
    """What one colony did on every map.

    Attributes:
        ratios: (maps, seeds, iterations) shortest length so far over the exact optimum, inf before any path.
        rising: (maps, seeds) share of the iterations whose mean length is above that of the one before.
        lost: (maps, seeds) share of the ants that did not arrive.
    """

    ratios: Values
    rising: Values
    lost: Values

    @property
    def gaps(self) -> Values:
        """(maps, seeds, iterations), ``CAP`` at most and without a path."""
        gaps: Values = np.minimum(self.ratios - 1, CAP)
        return gaps

    @property
    def final(self) -> Values:
        """(maps, seeds) gaps after the last iteration."""
        return self.gaps[:, :, -1]

    @property
    def curves(self) -> Values:
        """(maps, iterations) mean gap over the seeds."""
        curves: Values = self.gaps.mean(axis=1)
        return curves


class Result(NamedTuple):
    """A comparison as it was run, and the outcome of every colony by its label."""

    comparison: Comparison
    options: Options
    outcomes: dict[str, Outcome]

    @property
    def improved(self) -> Outcome:
        """The paper's colony."""
        return self.outcomes["improved"]

    @property
    def basic(self) -> Outcome:
        """What it is compared with."""
        return self.outcomes["basic"]


def compare(comparison: Comparison, options: Options) -> Result:
    """Run all colonies on all maps.

    Raises:
        ParameterError: if the share is not in (0, 1], or the planner cannot use the ants or κ.
        MapError: if the family has no maps of the size.
    """
    if not 0 < options.share <= 1:
        raise ParameterError(
            f"share = {options.share}: must be above 0 and 1 at most, 1 being all {MAPS} maps"
        )
    comparison = comparison.under(options)
    count, colonies = max(2, round(MAPS * options.share)), list(comparison.colonies())
    title = f"{comparison.paper}: {len(colonies)} colonies on {count} maps"
    outcomes = {}
    with progress(title, len(colonies) * count) as advance:
        scenarios = draw(comparison.paper, count, comparison.family, comparison.size, comparison.wanted)
        for label, rules, seeds in colonies:
            parts = []
            for first in range(0, count, STRIDE):
                some = scenarios[first : first + STRIDE]
                names = (comparison.paper, label, options.seed, first)
                parts.append(_walk(comparison, rules, some, seeds, derived_seed(*names)))
                advance(len(some))
            outcomes[label] = Outcome(*map(np.concatenate, zip(*parts, strict=True)))
    return Result(comparison, options, outcomes)


def _walk(comparison: Comparison, rules: Rules, scenarios: list[Scenario], seeds: int, seed: int) -> Outcome:
    each = [scenario for scenario in scenarios for _ in range(seeds)]
    plans = plan_many(
        each,
        [comparison.parameters(rules, scenario) for scenario in each],
        rules=rules,
        ants=comparison.ants,
        iterations=comparison.iterations,
        seeds=np.random.SeedSequence(seed).generate_state(len(each), np.uint64),
    )
    optima = np.array([scenario.optimum for scenario in each])
    return _outcome(plans, optima, comparison.ants, (len(scenarios), seeds))


def _outcome(plans: Plans, optima: Values, ants: int, shape: tuple[int, int]) -> Outcome:
    runs = [plans.plan(i) for i in range(len(plans))]
    best, mean, arrived = (
        np.array([getattr(run, name) for run in runs]) for name in ("best", "mean", "arrived")
    )
    return Outcome(
        np.round(best / optima[:, None], DECIMALS).reshape(*shape, -1),
        (mean[:, 1:] > mean[:, :-1]).mean(axis=1).reshape(shape),
        (1 - arrived / ants).mean(axis=1).reshape(shape),
    )
