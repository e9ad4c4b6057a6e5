"""Episodes of environments of one kind in arrays: one row alone, in a batch as many as there are slots."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from numbers import Integral
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antgym.envs.draws import Problems
from antgym.envs.infos import Columns
from antgym.envs.verdicts import Verdicts, judged, worths
from antgym.errors import ParameterError
from antgym.planners.fleet import FleetRun
from antgym.planners.swarms import Swarm, walked
from antgym.tuning.observation import observe_together
from antgym.tuning.problem import TRIAL, TuningProblem
from antgym.tuning.session import Session
from antgym.tuning.sessions import Account, Sessions

Observation = NDArray[np.float32] | dict[str, NDArray[np.float32]]
Rows = NDArray[np.intp]


class Terms(NamedTuple):
    """What environments of one kind have in common.

    Attributes:
        problems: that episodes are drawn from.
        reward: one of ``REWARDS``.
        flat: which map is shown, see :func:`antgym.maps.occupancy.occupancy`; None for no map.
        budget: trials that an episode pays for.
        window: how many of the last trials are shown; 0 shows the features of the task alone.
    """

    problems: Problems
    reward: str
    flat: bool | None
    budget: int
    window: int


class Episodes(ABC):
    """The episodes that environments of one kind are in: how they are drawn, judged and told of.

    Args:
        count: of the environments.
        terms: of all of them.

    Attributes:
        roots: root seed of each; None before its first episode.
        planner_runs: (count,) int64, by each so far, fresh ones included.
    """

    def __init__(self, count: int, terms: Terms) -> None:
        self.terms = terms
        self.roots: list[int | None] = [None] * count
        self._indices = np.zeros(count, np.int64)  # of the episodes under their roots
        self._drawn = np.zeros(count, np.intp)  # indices of their scenarios
        self._seeds = np.zeros(count, np.int64)  # of their problems
        self._begun = np.zeros(count, bool)
        self.planner_runs = np.zeros(count, np.int64)

    def begin(
        self, rows: Rows, roots: Sequence[int | None] | None = None, picked: int | None = None
    ) -> tuple[Observation, Columns]:
        """Begin an episode in some rows; return what they show, one below the other, and infos.

        Args:
            rows: at least one.
            roots: a new root seed for each, whose episode 0 begins, or None for the next episode of its own.
            picked: index of the scenario, instead of drawing it.
        """
        problems, places = self.terms.problems, rows.tolist()
        asked = roots or [None] * len(places)
        after = [self.roots[i] if root is None else root for i, root in zip(places, asked, strict=True)]
        indices = np.where([root is None for root in asked], self._indices[rows] + 1, 0)
        drawn, seeds = problems.draw(after, indices)
        if picked is not None:
            drawn[:] = picked
        self._open(rows, problems.of(drawn), seeds)
        for i, root in zip(places, after, strict=True):
            self.roots[i] = root
        self._indices[rows], self._drawn[rows] = indices, drawn
        self._seeds[rows], self._begun[rows] = seeds, True
        return self.observed(rows), problems.told(drawn, seeds)

    def step(
        self, rows: Rows, units: NDArray[np.float64]
    ) -> tuple[Observation, NDArray[np.float64], NDArray[np.bool_], Columns]:
        """Step some rows: what they ask is one planner call, what judging them needs another.

        Args:
            rows: at least one, none of them over.
            units: a setting each.

        Returns:
            What they show, one below the other, rewards, whether episodes ended, and infos.
        """
        verdicts = self.spend(rows, units)
        problems, drawn = self.terms.problems.of(self._drawn[rows]), self._drawn[rows]
        told = judged(problems, verdicts)
        rewards = self.pay_out(rows, worths(self.terms.reward, problems, verdicts, told))
        told = self.terms.problems.told(drawn, self._seeds[rows]) | told
        return self.observed(rows), rewards, self.over(rows), told

    @abstractmethod
    def spend(self, rows: Rows, units: NDArray[np.float64]) -> Verdicts:
        """Pay for settings, run what judging them needs, and return what it came to."""

    def pay_out(self, rows: Rows, worth: NDArray[np.float64]) -> NDArray[np.float64]:  # noqa: ARG002 - others need rows
        """Return the rewards of verdicts of some worth, see :func:`antgym.envs.verdicts.worths`."""
        return worth

    @abstractmethod
    def over(self, rows: Rows) -> NDArray[np.bool_]:
        """Return which episodes have ended."""

    @abstractmethod
    def session(self, row: int) -> Session | Account:
        """Return the session of an episode, or how it stands."""

    @abstractmethod
    def walked(self, row: int) -> Swarm | FleetRun | None:
        """Return the colony or hive of the last run, or the fleet's; None before any."""

    def observed(self, rows: Rows) -> Observation:
        """Return the observations of some rows, one below the other, in arrays of their own."""
        flat, features = self.terms.flat, self._vectors(rows)
        if flat is None:
            return features
        problems = self.terms.problems.of(self._drawn[rows])
        return {"features": features, "map": np.stack([problem.scenario.chart(flat) for problem in problems])}

    def problem(self, row: int) -> TuningProblem:
        """Return the problem of an episode."""
        return self.terms.problems.at(int(self._drawn[row]), int(self._seeds[row]))

    def require_begun(self, rows: Rows) -> None:
        """Raise ParameterError before the first reset."""
        if not self._begun[rows].all():
            raise ParameterError("the environment has no episode yet; call reset() first")

    def picked(self, options: Mapping[str, Any] | None) -> int | None:
        """Return the index of the scenario that the options of a reset pick, None where it is left to the draw."""
        for name in options or ():
            if name != "scenario":
                raise ParameterError(f"unknown reset option {name!r}; valid: scenario")
        if not options:
            return None
        chosen, count = options["scenario"], len(self.terms.problems)
        if not isinstance(chosen, Integral) or not 0 <= int(chosen) < count:
            raise ParameterError(f"scenario {chosen!r}: this split holds 0 to {count - 1}")
        return int(chosen)

    def require_open(self, rows: Rows) -> None:
        """Raise ParameterError where an episode is over, or before the first reset."""
        self.require_begun(rows)
        if self.over(rows).any():
            raise ParameterError("the episode is over; call reset()")

    @abstractmethod
    def _open(self, rows: Rows, problems: list[TuningProblem], seeds: NDArray[np.int64]) -> None:
        """Begin the sessions of new episodes, on problems under seeds in the place of their own."""

    @abstractmethod
    def _vectors(self, rows: Rows) -> NDArray[np.float32]:
        """Return the vectors to show, in an array of their own."""


class PaidEpisodes(Episodes):
    """Episodes whose steps pay for trials."""

    def __init__(self, count: int, terms: Terms) -> None:
        super().__init__(count, terms)
        self._sessions = Sessions(count, terms.budget, len(terms.problems.names))

    def over(self, rows: Rows) -> NDArray[np.bool_]:
        """Return which episodes have ended."""
        return self._sessions.left[rows] == 0

    def session(self, row: int) -> Account:
        """Return how the session of an episode stands."""
        return self._sessions.account(row)

    def walked(self, row: int) -> Swarm | FleetRun | None:
        """Return the colony or hive of the last run, or the fleet's; None before any.

        It is walked again, same seed and same ants.
        """
        problem, trials = self.problem(row), self.session(row).trials
        if not trials:
            return None
        return walked(
            problem.scenario,
            problem.space.decode(trials[-1].unit)[0],
            rules=problem.rules,
            ants=problem.ants,
            iterations=problem.iterations,
            seed=int(problem.seeds(TRIAL, trials[-1].index, 1)[0]),
        )

    def _open(self, rows: Rows, problems: list[TuningProblem], seeds: NDArray[np.int64]) -> None:
        self._sessions.begin(rows, problems, seeds)

    def _vectors(self, rows: Rows) -> NDArray[np.float32]:
        features, sessions = self.terms.problems.features(self._drawn[rows]), self._sessions
        if not self.terms.window:
            return features
        history = sessions.history(rows, self.terms.window)
        left = (sessions.total - sessions.made[rows]) / sessions.total
        return observe_together(features, left, history["unit"], history["cost"])
