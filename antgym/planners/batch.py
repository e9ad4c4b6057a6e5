"""A batch: planner runs checked once and packed for the kernel, and what it writes, as plans."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antgym.errors import ParameterError
from antgym.kernels.ants import plan_range
from antgym.kernels.layout import RUN, History
from antgym.maps.motion import REACH, Motion, move_table
from antgym.maps.world import PAD, GridWorld, Scenario
from antgym.planners.buffers import Workspace, with_more_rows
from antgym.planners.parameters import check_parameters
from antgym.planners.rules import Rules, find_rules

_WORKSPACE = Workspace()
MOST_EFFORT = 1_000_000  # ants, or iterations


@dataclass(frozen=True, eq=False)
class Plan:
    """What one planner run found.

    Attributes:
        length: of the shortest path in world units; inf where no ant arrived.
        path: (layers + 1, 3) int64 cells from start to goal; (0, 3) where there is none.
        best: (iterations,) float64, the shortest length so far.
        mean: (iterations,) float64, mean length over the ants that arrived, inf where none did.
        arrived: (iterations,) int64, how many did.
        moves: moves that all ants made.
    """

    length: float
    path: NDArray[np.int64]
    best: NDArray[np.float64]
    mean: NDArray[np.float64]
    arrived: NDArray[np.int64]
    moves: int

    @property
    def solved(self) -> bool:
        """Whether an ant arrived."""
        return bool(np.isfinite(self.length))

    @property
    def status(self) -> str:
        """``"solved"`` or ``"no ant arrived"``."""
        return "solved" if self.solved else "no ant arrived"


@dataclass(frozen=True, eq=False)
class Batch:
    """Runs packed for the kernel, and the arrays it writes."""

    scenarios: list[Scenario]
    free: NDArray[np.uint8]
    runs: Any
    tables: NDArray[np.int64]
    history: History
    offsets: NDArray[np.int64]
    cells: NDArray[np.int64]
    lengths: NDArray[np.float64]
    made: NDArray[np.int64]

    @classmethod
    def of(
        cls,
        scenarios: list[Scenario],
        parameters: ArrayLike,
        rules: str | Rules | Sequence[str | Rules],
        ants: int | Sequence[int],
        iterations: int | Sequence[int],
        seeds: ArrayLike,
    ) -> "Batch":
        """Check everything once and pack it."""
        count = len(scenarios)
        _require_layered(scenarios)
        each = _each_rules(rules, count)
        runs = np.zeros(count, RUN).view(np.recarray)
        free, runs["origin"] = _pack([s.world for s in scenarios])
        motions = list(dict.fromkeys(s.motion for s in scenarios))
        _write_scenarios(runs, scenarios, motions)
        _write_rules(runs, each)
        for name, values in (("ants", ants), ("iterations", iterations)):
            runs[name] = _effort(name, values, count)
        runs["key"] = _keys(seeds, count)
        if count:
            naturals = check_parameters(parameters)
            if len(naturals) != count:
                raise ParameterError(f"{len(naturals)} parameter sets for {count} scenarios")
            write_parameters(runs, naturals, each)
        ends = np.cumsum([runs["iterations"], runs["layers"]], axis=1)
        total = ends[:, -1] if count else (0, 0)
        history = History(np.empty(total[0]), np.empty(total[0]), np.empty(total[0], np.int64))
        offsets = np.ascontiguousarray((ends - [runs["iterations"], runs["layers"]]).T)
        return cls(
            scenarios,
            free,
            runs,
            _tables(motions),
            history,
            offsets,
            cells=np.empty(total[1], np.int64),
            lengths=np.full(count, np.inf),
            made=np.zeros(count, np.int64),
        )

    def plan_range(self, first: int, last: int) -> None:
        """Plan some of the runs in the calling thread's buffers."""
        runs, arrays = self.runs, (self.history, self.offsets, self.cells, self.lengths, self.made)
        buffers = _WORKSPACE.reserve(
            int(runs["ants"].max()), int((runs["ants"] * runs["layers"]).max()), int(runs["layers"].max())
        )
        resume = False
        with np.errstate(over="ignore"):  # interpreted, the random numbers' wrap-around would warn
            while first < last:
                first = plan_range(self.free, runs, self.tables, *buffers, *arrays, first, last, resume)
                if first < last:
                    buffers = _WORKSPACE.buffers = with_more_rows(buffers)
                    resume = True

    def plan(self, index: int, iterations: int | None = None) -> Plan:
        """Return what run ``index`` found."""
        scenario, run = self.scenarios[index], self.runs[index]
        at, begin = self.offsets[index]
        span = slice(at, at + (run.iterations if iterations is None else iterations))
        path = np.empty((0, 3), np.int64)
        if np.isfinite(self.lengths[index]):
            path = _path(scenario, self.cells[begin : begin + run.layers] - run.origin)
        h = self.history
        return Plan(
            float(self.lengths[index]),
            path,
            h.best[span],
            h.mean[span],
            h.arrived[span],
            int(self.made[index]),
        )


def _require_layered(scenarios: list[Scenario]) -> None:
    for scenario in scenarios:
        if not scenario.motion.layered:
            raise ParameterError(
                f"scenario {scenario.name!r} has the {scenario.motion.name} motion: the colony walks the layered "
                "motion only, so far"
            )


def _each_rules(rules: str | Rules | Sequence[str | Rules], count: int) -> list[Rules]:
    if isinstance(rules, (str, Rules)):
        return [find_rules(rules)] * count
    if len(rules) != count:
        raise ParameterError(f"{len(rules)} rules for {count} scenarios; give one, or one each")
    return [find_rules(rule) for rule in rules]


def _effort(name: str, values: int | Sequence[int], count: int) -> NDArray[np.int64]:
    array = np.asarray(values)
    if array.size and (array.dtype.kind not in "iu" or (array < 1).any() or (array > MOST_EFFORT).any()):
        raise ParameterError(f"{name} = {values}: whole numbers from 1 to {MOST_EFFORT:,} are needed")
    if array.ndim and len(array) != count:
        raise ParameterError(f"{len(array)} values of {name} for {count} scenarios; give one, or one each")
    return np.broadcast_to(array, (count,)).astype(np.int64)


def _keys(seeds: ArrayLike, count: int) -> NDArray[np.uint64]:
    values = np.asarray(seeds, dtype=object).ravel()
    if len(values) != count:
        raise ParameterError(f"{len(values)} seeds for {count} scenarios")
    for seed in values:
        if not isinstance(seed, int | np.integer) or not 0 <= seed < 1 << 64:
            raise ParameterError(f"seed = {seed!r}: must be a whole number in [0, 2^64)")
    return values.astype(np.uint64)


def _pack(worlds: list[GridWorld]) -> tuple[NDArray[np.uint8], NDArray[np.int64]]:
    """Lay worlds one behind the other, each once; a single world is used where it lies."""
    bases: dict[int, int] = {}
    parts: list[NDArray[np.uint8]] = []
    size = 0
    for world in worlds:
        if id(world) not in bases:
            bases[id(world)] = size
            parts.append(world.storage.reshape(-1))
            size += world.storage.size
    free = parts[0] if len(parts) == 1 else np.concatenate(parts or [np.empty(0, np.uint8)])
    free.setflags(write=False)  # as a world's own cells are: one type, one compilation
    return free, np.array([bases[id(world)] for world in worlds], dtype=np.int64)


def _tables(motions: list[Motion]) -> NDArray[np.int64]:
    return np.array([(t.before, t.after, t.steps) for t in map(move_table, motions)])


def _write_scenarios(runs: Any, scenarios: list[Scenario], motions: list[Motion]) -> None:
    names = ("stride_x", "stride_y", "start_x", "start_y", "start_z", "goal_y", "goal_z", "layers", "table")
    places = [(*_places(s), motions.index(s.motion)) for s in scenarios]
    for name, column in zip(names, np.array(places, dtype=np.int64).reshape(-1, len(names)).T, strict=True):
        runs[name] = column
    cells = np.array([s.world.cell for s in scenarios]).reshape(-1, 3)
    for name, column in zip(("cell_x", "cell_y", "cell_z"), cells.T, strict=True):
        runs[name] = column
    runs["reach"] = REACH


def _places(scenario: Scenario) -> tuple[int, ...]:
    _, sy, sz = scenario.world.storage.shape
    (xs, ys, zs), (_, yg, zg) = scenario.start, scenario.goal
    return sy * sz, sz, xs + PAD, ys + PAD, zs + PAD, yg + PAD, zg + PAD, scenario.layers


def _write_rules(runs: Any, rules: list[Rules]) -> None:
    runs["step_share"] = [rule.target != "start" for rule in rules]
    runs["distance_share"] = [rule.target != "current" for rule in rules]
    runs["to_goal"] = [rule.target == "goal" for rule in rules]
    runs["plain"] = [rule.greedy == "plain" for rule in rules]
    runs["lookahead"] = [rule.trap == "lookahead" for rule in rules]
    for name in ("w1", "w2", "q0", "ranked", "elite", "local", "limits", "best_only"):
        runs[name] = [getattr(rule, name) for rule in rules]


def write_parameters(runs: Any, values: NDArray[np.float64], rules: list[Rules]) -> None:
    """Write (k, 4) natural parameters into the records of runs."""
    runs["alpha"], runs["beta"], runs["rho"] = values[:, 0], values[:, 1], values[:, 2]
    runs["deposit"] = values[:, 3] / [rule.initial_pheromone for rule in rules]


def _path(scenario: Scenario, indices: NDArray[np.int64]) -> NDArray[np.int64]:
    return np.vstack([cells_of(scenario, indices), scenario.goal]).astype(np.int64)


def cells_of(scenario: Scenario, indices: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the (n, 3) cells behind indices into the flat storage of a scenario's world."""
    return np.stack(np.unravel_index(indices, scenario.world.storage.shape), axis=1) - PAD
