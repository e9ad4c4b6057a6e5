"""Flights: runs of bees checked once and packed for the kernel, and what it writes, as plans."""

import math
import threading
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antgym.errors import ParameterError
from antgym.kernels.bees import fly_range
from antgym.kernels.hive import FLIGHT, LANES, LEVEL_SIZE, STATUS_SIZE, SUMMED, Comb, Discs
from antgym.kernels.layout import History
from antgym.maps.discs import DiscScenario, DiscWorld
from antgym.planners.bee_rules import BeeRules, find_bee_rules
from antgym.planners.effort import each_rules, effort, keys_of
from antgym.planners.parameters import check_bee_parameters
from antgym.planners.plans import Plan

FEWEST_BEES = 4  # two sources: a bee moves by its distance from another one
_RECORD = np.dtype((np.record, FLIGHT))  # interpreted kernels read fields by name
_ROWS: WeakKeyDictionary[Any, dict[str | BeeRules, bytes]] = WeakKeyDictionary()
"""Records of FLIGHT made before, as long as their scenario is in use."""


@dataclass(frozen=True, eq=False)
class Flights:
    """Runs packed for the kernel, and the arrays it writes."""

    scenarios: list[DiscScenario]
    discs: Discs
    runs: Any
    history: History
    offsets: NDArray[np.int64]
    paths: NDArray[np.float64]
    lengths: NDArray[np.float64]
    made: NDArray[np.int64]

    @classmethod
    def of(
        cls,
        scenarios: list[DiscScenario],
        parameters: ArrayLike,
        rules: str | BeeRules | Sequence[str | BeeRules],
        bees: int | Sequence[int],
        cycles: int | Sequence[int],
        seeds: ArrayLike,
    ) -> "Flights":
        """Check everything once and pack it."""
        count = len(scenarios)
        asked = each_rules(rules, count)
        found = {rule: find_bee_rules(rule) for rule in dict.fromkeys(asked)}
        rows = [_row(*pair, found[pair[1]]) for pair in zip(scenarios, asked, strict=True)]
        runs = np.frombuffer(bytearray().join(rows), _RECORD)
        discs = _packed(scenarios, runs)
        _write_effort(runs, effort("ants", bees, count), effort("iterations", cycles, count))
        runs["key"] = keys_of(seeds, count)
        if count:
            naturals = check_bee_parameters(parameters, bool((runs["tabu"] > 0).any()))
            if len(naturals) != count:
                raise ParameterError(f"{len(naturals)} parameter sets for {count} scenarios")
            write_bee_parameters(runs, naturals)
        ends = np.cumsum(runs["cycles"])
        total = ends[-1] if count else 0
        return cls(
            scenarios,
            discs,
            runs,
            History(np.empty(total), np.empty(total), np.empty(total, np.int64)),
            offsets=ends - runs["cycles"],
            paths=np.empty((count, 2, runs["points"].max(initial=0) + 2)),
            lengths=np.full(count, np.inf),
            made=np.zeros(count, np.int64),
        )

    def plan_range(self, first: int, last: int) -> None:
        """Plan some of the runs in the calling thread's comb."""
        comb = _WORKSPACE.reserve(self.runs[first:last])
        with np.errstate(over="ignore"):  # interpreted, the random numbers' wrap-around would warn
            written = (self.history, self.offsets, self.paths, self.lengths, self.made)
            fly_range(self.discs, self.runs, comb, *written, first, last)

    def plan(self, index: int, cycles: int | None = None) -> Plan:
        """Return what run ``index`` found."""
        run, at, h = self.runs[index], self.offsets[index], self.history
        span = slice(at, at + (run.cycles if cycles is None else cycles))
        path = self.paths[index, :, : run.points + 2].T.copy()
        length, made = float(self.lengths[index]), int(self.made[index])
        return Plan(length, path, h.best[span], h.mean[span], h.arrived[span], made, "bee")


def fitted(comb: Comb | None, runs: Any) -> Comb:
    """Return a comb that is done with, or a larger one, for every one of (B,) records of FLIGHT."""
    sizes = _sizes(runs)
    if comb is not None:
        have = len(comb.value), comb.place.shape[2] - 2, len(comb.tabu), len(comb.gaps)
        sizes = tuple(map(max, have, sizes))
        if sizes == have:
            return comb
    return _comb_of(*sizes)


class _Workspace(threading.local):
    """The comb of the calling thread."""

    comb: Comb | None = None

    def reserve(self, runs: Any) -> Comb:
        """Return this thread's comb, grown to fit every one of (B,) records of FLIGHT."""
        self.comb = fitted(self.comb, runs)
        return self.comb


_WORKSPACE = _Workspace()


def write_bee_parameters(runs: Any, values: NDArray[np.float64]) -> None:
    """Write (k, 4) natural parameters into the records of runs."""
    runs["limit"], runs["xi_max"], runs["xi_min"], runs["radius"] = values.T


def _write_effort(runs: Any, bees: NDArray[np.int64], cycles: NDArray[np.int64]) -> None:
    if (bees < FEWEST_BEES).any():
        raise ParameterError(
            f"ants = {bees.min()}: a hive has {FEWEST_BEES} bees at least, two with a source each"
        )
    runs["sources"], runs["onlookers"], runs["cycles"] = bees // 2, bees - bees // 2, cycles


def _row(scenario: DiscScenario, name: str | BeeRules, rules: BeeRules) -> bytes:
    """Return a record of FLIGHT with all that follows from a scenario and its rules; they come again and again."""
    known = _ROWS.setdefault(scenario, {})
    if name not in known:
        if not isinstance(scenario.world, DiscWorld):
            called = repr(name) if isinstance(name, str) else "of bees"
            raise ParameterError(
                f"rules {called} fly among discs, and {scenario.name!r} is a grid; take rules of ants"
            )
        run = np.zeros(1, _RECORD)
        for field, value in {**_of_scenario(scenario), **_of_rules(rules, scenario.straight_line)}.items():
            run[field] = value
        known[name] = run.tobytes()
    return known[name]


def _of_scenario(scenario: DiscScenario) -> dict[str, float]:
    world, (start_x, start_y), (goal_x, goal_y) = scenario.world, scenario.start, scenario.goal
    return {
        **dict(zip(("x_min", "x_max", "y_min", "y_max"), world.bounds, strict=True)),
        **{"start_x": start_x, "start_y": start_y, "goal_x": goal_x, "goal_y": goal_y},
        "safe": world.safe_distance,
        "aim": math.atan2(goal_y - start_y, goal_x - start_x),  # (2), as seen from the start
    }


def _of_rules(rules: BeeRules, straight_line: float) -> dict[str, float]:
    plain = ("points", "tabu", "redraws", "pull", "printed", "away", "elite", "weight")
    return {
        **{name: getattr(rules, name) for name in plain},
        "neighbour": rules.scout == "neighbour",
        "per_length": rules.weight / straight_line,
        "per_shortfall": (1 - rules.weight) / straight_line,
        "per_hit": (1 - rules.weight) * rules.hit,
    }


def _packed(scenarios: list[DiscScenario], runs: Any) -> Discs:
    """Return the discs of all worlds, each once and padded to whole lanes; write where those of each run lie."""
    places: dict[int, tuple[int, int]] = {}
    parts, end = [np.empty((0, 3))], 0
    for run, scenario in zip(runs, scenarios, strict=True):
        key = id(scenario.world)
        if key not in places:
            grown = scenario.world.grown
            nothing = np.tile([0.0, 0.0, -np.inf], (-len(grown) % LANES, 1))
            parts += [grown, nothing]
            places[key] = end, end + len(grown) + len(nothing)
            end = places[key][1]
        run["first"], run["last"] = places[key]
    x, y, radius = np.concatenate(parts).T
    return Discs(np.ascontiguousarray(x), np.ascontiguousarray(y), np.ascontiguousarray(radius))


def _sizes(runs: Any) -> tuple[int, ...]:
    """Return the sources, way-points, tabu entries and discs that a comb for the runs has room for."""
    discs = runs["last"] - runs["first"]
    return tuple(int(part.max(initial=1)) for part in (runs["sources"], runs["points"], runs["tabu"], discs))


def _comb_of(sources: int, points: int, tabu: int, discs: int) -> Comb:
    return Comb(
        place=np.empty((sources, 2, points + 2)),
        length=np.empty((sources, points + 1)),
        gap=np.empty((sources, points + 1)),
        before=np.empty((sources, SUMMED, points + 2)),
        after=np.empty((sources, SUMMED, points + 2)),
        value=np.empty(sources),
        sums=np.empty(sources),
        tries=np.empty(sources, np.int64),
        best=np.empty((2, points + 2)),
        tabu=np.empty((tabu, 2, points + 2)),
        stamp=np.empty(tabu, np.int64),
        gaps=np.empty(discs),
        status=np.zeros(STATUS_SIZE, np.int64),
        levels=np.zeros(LEVEL_SIZE),
    )
