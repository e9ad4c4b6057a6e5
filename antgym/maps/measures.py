"""Measures: the values behind the features, by what they look at; names are those of the features."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from antgym.maps.motion import REACH, Motion, move_table
from antgym.maps.moves import fewest_moves, greedy_walk, legal_moves
from antgym.maps.surroundings import FARTHEST, LINE_SAMPLES, Surroundings
from antgym.maps.world import Scenario

NEAR = 2  # cells from the straight line that count as near it
TIPS = 3  # cells: half the edge of the boxes before and behind start and goal

Measures = dict[str, float]


def measure(scenario: Scenario) -> Measures:
    """Return every feature's value, unclipped."""
    around = Surroundings(scenario)
    return {
        **_sizes(scenario),
        **_motion(scenario.motion),
        **_obstacles(around),
        **_line(around),
        **_columns(around.free),
        **_places(around),
        **_ends(around),
        **_greed(scenario),
    }


def _sizes(scenario: Scenario) -> Measures:
    nx, ny, nz = scenario.world.shape
    dx, dy, dz = scenario.world.cell
    moves = fewest_moves(scenario)
    sideways = REACH * moves if scenario.motion.layered else moves
    x, y, z = np.subtract(scenario.goal, scenario.start).tolist()
    return {
        "moves": np.log10(moves / 20),
        "cells_x": np.log10(nx / 20),
        "cells_y": np.log10(ny / 20),
        "cells_z": np.log10(nz / 20),
        "stretch_y": np.log2(dy / dx) / 3,
        "stretch_z": np.log2(dz / dx) / 3,
        "offset_x": abs(x) / moves,
        "offset_y": abs(y) / sideways,
        "offset_z": z / sideways,
        "flat": float(nz == 1),
    }


@lru_cache
def _motion(motion: Motion) -> Measures:
    table = move_table(motion)
    aside = []
    for step, required, either in zip(table.steps, table.required, table.either, strict=True):
        cells = {tuple(cell) for cell in required.tolist()} - {tuple(step.tolist()), (0, 0, 0)}
        aside.append(len(cells) + bool((either != step).any()))  # one of two cells is one cell more
    return {
        "layered": float(motion.layered),
        "move_count": len(table.steps) / 26,
        "side_cells": float(np.mean(aside)) / 3,
    }


def _obstacles(around: Surroundings) -> Measures:
    free, reach = around.free, around.reach
    apart = (around.goal - around.start) * np.array(around.scenario.world.cell)
    axis = 0 if around.scenario.motion.layered else int(np.abs(apart).argmax())
    others = tuple(i for i in range(3) if i != axis)
    cells, free_cells = reach.sum(axis=others), (free & reach).sum(axis=others)
    first, last = sorted((around.start[axis], around.goal[axis]))
    between = np.flatnonzero(cells[first : last + 1]) + first
    changes = sum(np.count_nonzero(np.diff(free, axis=i)) for i in range(3))
    pairs = sum(free.size // n * (n - 1) for n in free.shape)
    return {
        "blocked": 1 - free.mean(),
        "blocked_in_reach": 1 - free_cells.sum() / cells.sum(),
        "narrowest_layer": (free_cells[between] / cells[between]).min(),
        "surface": changes / pairs,
    }


def _line(around: Surroundings) -> Measures:
    blocked = ~around.free[tuple(around.line.T)]
    walls = np.count_nonzero(blocked[1:] & ~blocked[:-1])
    cells = around.line[::LINE_SAMPLES]
    return {
        "blocked_on_line": blocked.mean(),
        "walls_on_line": walls / 10,
        "sight_from_start": blocked.argmax() / len(blocked) if walls else 1.0,
        "sight_from_goal": blocked[::-1].argmax() / len(blocked) if walls else 1.0,
        "blocked_near_line": around.blocked_share(cells, NEAR).mean(),
        "clearance_on_line": _shown(around.clearance(cells)),
    }


def _columns(free: NDArray[np.bool_]) -> Measures:
    nz = free.shape[2]
    topmost = nz - (~free[:, :, ::-1]).argmax(axis=2)
    tops = np.where(free.all(axis=2), 0, topmost)
    heights = tops / nz
    jumps = np.concatenate([np.abs(np.diff(heights, axis=axis)).ravel() for axis in (0, 1)])
    free_count = np.count_nonzero(free)
    return {
        "column_mean": heights.mean(),
        "column_sd": 2 * heights.std(),
        "column_max": heights.max(),
        "full_columns": 1 - free.any(axis=2).mean(),
        "roughness": jumps.sum() / max(jumps.size, 1),  # a single column has no neighbour
        "covered": (tops.sum() - (free.size - free_count)) / free_count,
    }


def _places(around: Surroundings) -> Measures:
    cells = around.sample
    legal = legal_moves(around.scenario, cells + around.first)
    clearance = around.clearance(cells)
    few = 0 if around.scenario.motion.layered else 1
    return {
        "branching": legal.mean(),
        "dead_ends": (legal.sum(axis=1) <= few).mean(),
        "squeezed": around.squeezed(cells).mean(),
        "tight": (clearance == 1).mean(),
        "clearance": _shown(clearance),
    }


def _ends(around: Surroundings) -> Measures:
    scenario, ends = around.scenario, np.stack([around.start, around.goal])
    apart = around.goal - around.start
    towards = np.rint(TIPS * apart / np.abs(apart).max()).astype(np.int64) * np.array([[1], [-1]])
    ahead = around.blocked_share(ends + towards, TIPS)
    behind = around.blocked_share(ends - towards, TIPS)
    return {
        "ahead_of_start": ahead[0],
        "behind_start": behind[0],
        "ahead_of_goal": ahead[1],
        "behind_goal": behind[1],
        "ways_out": legal_moves(scenario, np.array([scenario.start])).mean(),
        "ways_in": _ways_in(scenario),
    }


def _ways_in(scenario: Scenario) -> float:
    steps, free = move_table(scenario.motion).steps, scenario.world.free
    before = np.array(scenario.goal) - steps
    moves = np.flatnonzero(((before >= 0) & (before < free.shape)).all(axis=1))
    moves = moves[free[tuple(before[moves].T)] != 0]
    return float(legal_moves(scenario, before[moves])[np.arange(len(moves)), moves].sum()) / len(steps)


def _greed(scenario: Scenario) -> Measures:
    walk = greedy_walk(scenario)
    return {
        "greedy_arrives": float(walk.arrived),
        "greedy_progress": walk.progress,
        "greedy_detour": walk.length / scenario.straight_line - 1 if walk.arrived else 1.0,
    }


def _shown(clearance: NDArray[np.int64]) -> float:
    return float(np.log2(1 + clearance).mean() / np.log2(1 + FARTHEST))
