"""A batch: planner runs checked once and packed for the kernel, and what it writes, as plans."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antgym.errors import ParameterError
from antgym.kernels import layout
from antgym.kernels.ants import plan_range
from antgym.kernels.layout import RUN, Ground, History
from antgym.maps.fleet import Fleet
from antgym.maps.motion import MOTIONS, REACH, move_table
from antgym.maps.world import PAD, GridWorld, Scenario
from antgym.planners.buffers import Workspace, grown
from antgym.planners.effort import MOST_EFFORT, each_rules, effort, keys_of
from antgym.planners.ground import pack
from antgym.planners.parameters import check_parameters
from antgym.planners.plans import Plan
from antgym.planners.rules import TRAPS, Rules, find_rules

__all__ = ["MOST_EFFORT", "Batch", "cells_of", "write_parameters"]

_WORKSPACE = Workspace()
_RECORD = np.dtype(
    (np.record, RUN)
)  # interpreted kernels read fields by name, and an array of its own type is slow
_FIRST_CELLS = 64  # of a path; a range of runs that finds longer ones gets room for more
_ROWS: WeakKeyDictionary[Scenario, dict[str | Rules, bytes]] = WeakKeyDictionary()
"""Records of RUN made before, as long as their scenario is in use."""


@dataclass(frozen=True, eq=False)
class Batch:
    """Runs packed for the kernel, and the arrays it writes."""

    scenarios: list[Scenario]
    ground: Ground
    runs: Any
    tables: NDArray[np.int64]
    history: History
    offsets: NDArray[np.int64]
    lengths: NDArray[np.float64]
    made: NDArray[np.int64]
    paths: list[NDArray[np.int64]]
    """Cells of the best path of each run as numbers of bits of the ground, the goal excluded; empty where none is."""

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
        asked = each_rules(rules, count)
        found = {rule: find_rules(rule) for rule in dict.fromkeys(asked)}
        each = [found[rule] for rule in asked]
        runs = _rows(scenarios, asked, each)
        ground = pack([scenario.world for scenario in scenarios], runs["z3"] > 0, runs)
        for name, values in (("ants", ants), ("iterations", iterations)):
            runs[name] = effort(name, values, count)
        runs["key"] = keys_of(seeds, count)
        if count:
            naturals = check_parameters(parameters)
            if len(naturals) != count:
                raise ParameterError(f"{len(naturals)} parameter sets for {count} scenarios")
            write_parameters(runs, naturals, each)
        ends = np.cumsum(runs["iterations"])
        total = ends[-1] if count else 0
        return cls(
            scenarios,
            ground,
            runs,
            _tables(),
            History(np.empty(total), np.empty(total), np.empty(total, np.int64)),
            offsets=ends - runs["iterations"],
            lengths=np.full(count, np.inf),
            made=np.zeros(count, np.int64),
            paths=[np.empty(0, np.int64)] * count,
        )

    def plan_range(self, first: int, last: int) -> None:
        """Plan some of the runs in the calling thread's buffers."""
        origin, resume = first, False
        buffers = _WORKSPACE.reserve(self.runs[first:last])
        cells, spans = (
            np.empty(_FIRST_CELLS * (last - first), np.int64),
            np.zeros((len(self.runs), 2), np.int64),
        )
        with np.errstate(over="ignore"):  # interpreted, the random numbers' wrap-around would warn
            while first < last:
                arrays = (self.history, self.offsets, cells, spans, self.lengths, self.made)
                first = plan_range(
                    self.ground, self.runs, self.tables, *buffers, *arrays, origin, first, last, resume
                )
                if first < last:
                    resume = True
                    if buffers.trail.status[layout.WANTS] == layout.MORE_CELLS:
                        cells = np.concatenate([cells, np.empty_like(cells)])
                    else:
                        buffers = _WORKSPACE.buffers = grown(buffers)
        for i in range(origin, last):
            self.paths[i] = cells[spans[i, 0] : spans[i, 1]]

    def plan(self, index: int, iterations: int | None = None) -> Plan:
        """Return what run ``index`` found."""
        scenario, run = self.scenarios[index], self.runs[index]
        at = self.offsets[index]
        span = slice(at, at + (run.iterations if iterations is None else iterations))
        path = np.empty((0, 3), np.int64)
        if np.isfinite(self.lengths[index]):
            path = np.vstack([cells_of(scenario, self.paths[index] - run.origin), scenario.goal]).astype(
                np.int64
            )
        h = self.history
        return Plan(
            float(self.lengths[index]),
            path,
            h.best[span],
            h.mean[span],
            h.arrived[span],
            int(self.made[index]),
        )


@cache
def _tables() -> NDArray[np.int64]:
    """Return (t, PARTS, WIDTH, 3): steps, required cells and either cells of every motion, padded with zeros."""
    tables = np.zeros((len(MOTIONS), layout.PARTS, layout.WIDTH, 3), np.int64)
    for padded, table in zip(tables, map(move_table, MOTIONS), strict=True):
        count, required = table.required.shape[:2]
        padded[layout.STEP, :count] = table.steps
        padded[layout.REQUIRED : layout.REQUIRED + required, :count] = table.required.swapaxes(0, 1)
        padded[-layout.EITHER :, :count] = table.either.swapaxes(0, 1)
    return tables


def _rows(scenarios: list[Scenario], asked: list[str | Rules], rules: list[Rules]) -> Any:
    """Return (B,) records of RUN with all that follows from a scenario and its rules; they come again and again."""
    parts = []
    for scenario, name, rule in zip(scenarios, asked, rules, strict=True):
        known = _ROWS.get(scenario)
        if known is None:
            known = _ROWS[scenario] = {}
        row = known.get(name)
        if row is None:
            if not isinstance(scenario.world, GridWorld):
                called = repr(name) if isinstance(name, str) else "of ants"
                raise ParameterError(
                    f"rules {called} walk a grid, and {scenario.name!r} lies among discs; take rules of bees (wu2018)"
                )
            if isinstance(scenario, Fleet):
                raise ParameterError(f"{scenario.name!r} is a fleet; plan it by plan_fleet")
            row = known[name] = _row(scenario, rule)
        parts.append(row)
    return np.frombuffer(bytearray().join(parts), _RECORD)


def _row(scenario: Scenario, rules: Rules) -> bytes:
    run = np.zeros(1, _RECORD)
    for name, value in {**_of_scenario(scenario), **_of_rules(rules)}.items():
        run[name] = value
    edge, (least, most) = min(scenario.world.cell), rules.clearance
    run["nearest_goal"], run["ramp_from"], run["ramp_over"] = edge, least * edge, (most - least) * edge
    run["mean_move"] = scenario.mean_move if rules.initial == "degree" else 1.0
    run["roams"] = ~run["layered"] | (run["trap"] == layout.RETREAT)
    run["linked"] = run["roams"] | run["on_nodes"]
    run["censused"] = run["per_edge"] | run["by_degree"]
    return run.tobytes()


def _of_scenario(scenario: Scenario) -> dict[str, float]:
    motion, world = scenario.motion, scenario.world
    slots, crossed = move_table(motion).required.shape[:2]
    ends = (index + PAD for cell in (scenario.start, scenario.goal) for index in cell)
    cells = zip(("start_x", "start_y", "start_z", "goal_x", "goal_y", "goal_z"), ends, strict=True)
    edges = zip(("cell_x", "cell_y", "cell_z"), world.cell, strict=True)
    return {
        **dict(zip(("stride_x", "stride_y"), world.strides, strict=False)),
        **dict(cells),
        **dict(edges),
        "layers": scenario.layers if motion.layered else 0,
        "cells": world.size,
        "table": MOTIONS.index(motion),
        "slots": slots,
        "crossed": crossed,
        "width": -(-slots // layout.LANES) * layout.LANES,
        "reach": REACH,
        "layered": motion.layered,
        "either": motion.corners == "one",
    }


def _of_rules(rules: Rules) -> dict[str, float]:
    plain = ("w1", "w2", "z2", "z3", "q0", "ranked", "elite", "local", "local_to", "limits", "best_only")
    return {
        **{name: getattr(rules, name) for name in (*plain, "clipped", "selective")},
        "step_share": rules.target != "start",
        "distance_share": rules.target != "current",
        "to_goal": rules.target == "goal",
        "plain": rules.greedy == "plain",
        "trap": TRAPS.index(rules.trap),
        "per_edge": rules.deposit == "edge",
        "by_degree": rules.initial == "degree",
        "on_nodes": rules.pheromone_on == "node",
    }


def write_parameters(runs: Any, values: NDArray[np.float64], rules: list[Rules]) -> None:
    """Write (k, 4) natural parameters into the records of runs."""
    runs["alpha"], runs["beta"], runs["rho"] = values[:, 0], values[:, 1], values[:, 2]
    runs["deposit"] = values[:, 3] / [rule.initial_pheromone for rule in rules]


def cells_of(scenario: Scenario, indices: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the (n, 3) cells behind indices into the flat storage of a scenario's world."""
    return np.stack(np.unravel_index(indices, scenario.world.padded), axis=1) - PAD
