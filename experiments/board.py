"""The currency between a leaderboard and its faces: rows of gaps, their order and what they are measured by.

A board is computed from ledgers and holds plain numbers; whoever shows it (``board_table``, ``report.page``) recomputes
nothing but statistics of its gaps.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antgym.errors import AntgymError
from experiments.statistics import (
    Estimate,
    cluster_interval,
    holm,
    interquartile_interval,
    interquartile_mean,
    paired_difference,
    paired_p_value,
    probability_of_improvement,
    share_closed,
)

Track = Literal["A", "B", "C"]
EXACT = "exact planner"  # the row, and the path of a picture, that is the exact optimum
SBS, VBS = "best_static", "virtual best (bound)"  # rows that others are measured by, where a board has them
ROUNDING = 1e-9
ALPHA = 0.05  # of ties, over all places of a board together
DRAWS, FEWEST_REPS = 1_000_000, 10_000
"""Maps that resampling for a p-value draws. With fewer, no p would be so small that twenty places may share ALPHA: on
12 maps and 10,000 resamples the least that 17 comparisons could come to was 0.076, now it is 0.033."""


@dataclass(frozen=True)
class Row:
    """What one agent, or one reference that is no agent, achieved on every scenario of a board.

    Attributes:
        name: how every face calls it; unique within a board.
        kind: ``"agent"`` competes for a place, ``"reference"`` is there to compare with.
        summary: one line.
        gaps: maps × seeds; each the mean gap of the fresh re-evaluations of one recommendation.
        success: share of the fresh re-evaluations that found a path, in [0, 1].
        deploy: trials paid on a new map, mean.
        training: trials paid once, before any new map; None where nobody counted them.
        tuner_seconds: seconds of the agent's own thinking on a new map, mean of those known, None where none are.
        planner_seconds: seconds of planner runs on a new map, the same.
        optimism: mean of re-evaluated − observed gap; None where nothing was observed.
        card: whatever else there is to say about it; shown as it is.
        failure: how many of its runs its own failure ended, and how; empty where none did.
        steers: whether it may change a setting within a run.
    """

    name: str
    kind: Literal["agent", "reference"]
    summary: str
    gaps: tuple[tuple[float, ...], ...]
    success: float
    deploy: float
    training: int | None
    tuner_seconds: float | None
    planner_seconds: float | None
    optimism: float | None
    card: dict[str, Any]
    failure: str = ""
    steers: bool = False

    def __post_init__(self) -> None:
        if not self.gaps or not self.gaps[0] or len({len(seeds) for seeds in self.gaps}) > 1:
            raise AntgymError(
                f"{self.name}: gaps are maps × seeds, equally many seeds a map and at least one"
            )
        for i, seeds in enumerate(self.gaps):
            if not all(np.isfinite(gap) and gap >= -ROUNDING for gap in seeds):
                raise AntgymError(
                    f"{self.name}: scenario {i} has gaps {seeds}; below 0 or not finite is a bug"
                )

    @cached_property
    def mean(self) -> float:
        """Mean gap."""
        return float(np.mean(self.gaps))

    @cached_property
    def interquartile(self) -> float:
        """Mean of the middle half of all gaps."""
        return interquartile_mean(self.gaps)

    @cached_property
    def interquartile_ends(self) -> tuple[float, float] | None:
        """95 % interval of that mean, over maps; None for a single map."""
        return interquartile_interval(self.gaps) if len(self.gaps) > 1 else None

    @cached_property
    def interval(self) -> tuple[float, float] | None:
        """95 % interval of the mean gap over maps and seeds; None for a single map, which has none."""
        return cluster_interval(self.gaps) if len(self.gaps) > 1 else None

    @cached_property
    def scenario_means(self) -> tuple[float, ...]:
        """Mean gap per scenario."""
        return tuple(float(np.mean(seeds)) for seeds in self.gaps)


@dataclass(frozen=True, eq=False)
class Picture:
    """One scenario of a board, and the paths that its agents' settings led to.

    Attributes:
        name: of the scenario.
        heights: (nx, ny) heights of the ground in world units, or None where ``free`` tells all of it.
        free: (nx, ny, nz) uint8, 1 where a cell is free.
        cell: edge lengths of a cell along x, y, z in world units.
        paths: (n, 3) cell indices by row name, whole or not; the exact optimum's under ``EXACT``.
        lengths: in world units, by row name; a name without a path found none.
        optimum: exact shortest length in world units.
    """

    name: str
    heights: NDArray[np.float64] | None
    free: NDArray[np.uint8]
    cell: tuple[float, float, float]
    paths: dict[str, NDArray[np.int64]]
    lengths: dict[str, float]
    optimum: float

    def __post_init__(self) -> None:
        if self.free.ndim != 3:
            raise AntgymError(
                f"{self.name}: free cells are an (nx, ny, nz) array, got shape {self.free.shape}"
            )
        if self.heights is not None and self.heights.shape != self.free.shape[:2]:
            raise AntgymError(
                f"{self.name}: heights {self.heights.shape} do not fit a world {self.free.shape}"
            )
        for name, path in self.paths.items():
            if path.ndim != 2 or path.shape[1] != 3 or name not in self.lengths:
                raise AntgymError(f"{self.name}: the path of {name} is not (n, 3) cells with a length")


class Place(NamedTuple):
    """An agent's place, and whether it is not told apart from the agent above it."""

    number: int
    tied: bool

    def __str__(self) -> str:
        return f"{self.number} ≈" if self.tied else str(self.number)


@dataclass(frozen=True)
class Board:
    """A leaderboard: every row on the same scenarios.

    Attributes:
        title: of what it is on, the same for all boards of a site.
        track: "A": tuned on each map by itself; "B": trained, then none or a few trials on each map; "C": control
            within one run.
        command: what makes this board again.
        rows: in any order.
        scenarios: names, in the order of every row's gaps.
        budget: trials that an agent may pay on a new map.
        seeds: tuner seeds per map.
        manifest: what ran, with which versions, where.
        pictures: scenarios to look at, any number.
    """

    title: str
    track: Track
    command: str
    rows: tuple[Row, ...]
    scenarios: tuple[str, ...]
    budget: int
    seeds: int
    manifest: dict[str, Any]
    pictures: tuple[Picture, ...]

    def __post_init__(self) -> None:
        names = [row.name for row in self.rows]
        if not names or len(set(names)) < len(names):
            raise AntgymError(f"a board needs rows with names of their own, got {names}")
        for row in self.rows:
            if len(row.gaps) != len(self.scenarios):
                raise AntgymError(
                    f"{row.name} has gaps on {len(row.gaps)} of {len(self.scenarios)} scenarios"
                )

    def key(self, name: str, scenario: str, seed: int) -> str:
        """Return the ledger's key of the run behind a gap of a row.

        Args:
            name: of the row.
            scenario: one of the board's.
            seed: the tuner's.
        """
        budget = (
            () if self.track == "C" else (str(self.budget),)
        )  # a run that is steered is itself the only trial
        return "/".join((name, *budget, scenario, str(seed)))

    @cached_property
    def ranked(self) -> tuple[Row, ...]:
        """All rows, references among them, by mean gap."""
        return tuple(sorted(self.rows, key=lambda row: row.mean))

    @cached_property
    def places(self) -> dict[str, Place]:
        """Places of the agents by name; references have none."""
        agents = [row for row in self.ranked if row.kind == "agent"]
        ties = [False, *_ties(agents)]
        return {row.name: Place(i + 1, ties[i]) for i, row in enumerate(agents)}

    @cached_property
    def outdone_by(self) -> tuple[Row, ...]:
        """References that are better than every agent, without the bounds, which are so by what they are."""
        best = min((row.mean for row in self.rows if row.kind == "agent"), default=-np.inf)
        others = (row for row in self.ranked if row.kind == "reference" and row.name not in (EXACT, VBS))
        return tuple(row for row in others if row.mean < best)

    @cached_property
    def closed(self) -> dict[str, Estimate]:
        """Share of what lies between SBS and VBS that each row closes, by name; empty where the two are not apart."""
        static, best = self._find(SBS), self._find(VBS)
        if static is None or best is None or len(static.gaps) < 2:
            return {}
        if paired_difference(static.gaps, best.gaps).low <= 0:
            return {}
        return {row.name: share_closed(row.gaps, static.gaps, best.gaps) for row in self.rows}

    @cached_property
    def better(self) -> dict[str, Estimate]:
        """Probability that each other row is better than SBS on a map, a tie counting half, by name."""
        static = self._find(SBS)
        if static is None or len(static.gaps) < 2:
            return {}
        others = [row for row in self.rows if row is not static]
        return {row.name: probability_of_improvement(row.gaps, static.gaps) for row in others}

    def _find(self, name: str) -> Row | None:
        return next((row for row in self.rows if row.name == name), None)


def _ties(agents: Sequence[Row]) -> list[bool]:
    """Return for all but the first of some ranked rows whether they are tied with the row above, all judged at once.

    One map tells nobody apart.
    """
    pairs = list(pairwise(agents))
    if not pairs or len(agents[0].gaps) < 2:
        return [True for _ in pairs]
    reps = max(FEWEST_REPS, DRAWS // len(agents[0].gaps))
    apart = holm([paired_p_value(row.gaps, better.gaps, reps=reps) for better, row in pairs])
    return [bool(p > ALPHA) for p in apart]


def failures(board: Board) -> list[str]:
    """Return what there is to say of agents whose runs failed, a line each."""
    return [f"{row.name}: {row.failure}." for row in board.ranked if row.failure]
