"""Features: what can be seen of a scenario before anything is planned, whatever its motion.

None needs the optimum, a shortest path or anything derived from one; lengths enter only as ratios, so the unit does
not matter. The one walk taken is that of a single greedy ant. One vector serves all: flat worlds and layered ones
say what they are, and a feature that has nothing to say there has a plain value.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antgym.maps.measures import NEAR, TIPS, measure
from antgym.maps.moves import PATIENCE, ROUND_ABOUT
from antgym.maps.surroundings import ASIDE, FARTHEST, SAMPLE
from antgym.maps.world import Scenario

__all__ = ["FEATURES", "Feature", "describe", "feature_table"]


class Feature(NamedTuple):
    """One entry of the descriptor; values are clipped into [low, high]."""

    name: str
    low: float
    high: float
    meaning: str


FEATURES: tuple[Feature, ...] = (
    Feature("moves", -1.5, 1.5, "log10 of the fewest moves from start to goal, obstacles ignored, over 20"),
    Feature("cells_x", -1.5, 1.5, "log10 of the cells along x, over 20"),
    Feature("cells_y", -1.5, 1.5, "log10 of the cells along y, over 20"),
    Feature("cells_z", -1.5, 1.5, "log10 of the cells along z, over 20"),
    Feature("stretch_y", -1.0, 1.0, "log2 of a cell's edge along y over that along x, / 3"),
    Feature("stretch_z", -1.0, 1.0, "log2 of a cell's edge along z over that along x, / 3"),
    Feature(
        "offset_x", 0.0, 1.0, "cells from start to goal along x, over the farthest that `moves` can lead"
    ),
    Feature("offset_y", 0.0, 1.0, "the same along y"),
    Feature("offset_z", -1.0, 1.0, "the same along z, positive upwards"),
    Feature("layered", 0.0, 1.0, "1 if every move goes one layer on along x, 0 on a grid"),
    Feature("flat", 0.0, 1.0, "1 if the world is one cell high"),
    Feature("move_count", 0.0, 1.0, "moves of the motion, / 26"),
    Feature("side_cells", 0.0, 1.0, "mean number of cells that a move needs free besides its end, / 3"),
    Feature("blocked", 0.0, 1.0, "share of blocked cells; layered: from the start's layer to the goal's"),
    Feature(
        "blocked_in_reach",
        0.0,
        1.0,
        "the same between start and goal: on some path were nothing blocked (layered), within "
        f"{ROUND_ABOUT:g} straight lines (grids)",
    ),
    Feature("blocked_near_line", 0.0, 1.0, f"the same at most {NEAR} cells from the straight line"),
    Feature("blocked_on_line", 0.0, 1.0, "blocked share of the straight line from start to goal"),
    Feature("walls_on_line", 0.0, 1.0, "obstacles that the straight line crosses, / 10"),
    Feature("sight_from_start", 0.0, 1.0, "share of the straight line up to its first blocked cell"),
    Feature("sight_from_goal", 0.0, 1.0, "the same from the goal"),
    Feature(
        "narrowest_layer",
        0.0,
        1.0,
        "free share, within reach, of the layer where it is smallest; grids: layers across the main axis",
    ),
    Feature("column_mean", 0.0, 1.0, "mean height of the columns (their topmost blocked cell), 1 = ceiling"),
    Feature("column_sd", 0.0, 1.0, "twice the standard deviation of the column heights"),
    Feature("column_max", 0.0, 1.0, "highest column"),
    Feature("full_columns", 0.0, 1.0, "share of columns without a free cell"),
    Feature("roughness", 0.0, 1.0, "mean difference in height between columns side by side"),
    Feature("covered", 0.0, 1.0, "share of the free cells with a blocked one somewhere above"),
    Feature("surface", 0.0, 1.0, "share of the pairs of cells side by side of which one is blocked"),
    Feature("branching", 0.0, 1.0, f"mean share of legal moves over up to {SAMPLE} free cells within reach"),
    Feature("dead_ends", 0.0, 1.0, "share of those cells without a legal move; grids: with one at most"),
    Feature("squeezed", 0.0, 1.0, f"share of them between two blocked cells at most {ASIDE} to either side"),
    Feature("tight", 0.0, 1.0, "share of them next to a blocked cell"),
    Feature(
        "clearance",
        0.0,
        1.0,
        f"mean log2(1 + cells to the nearest blocked one, {FARTHEST} at most) / 4 of them",
    ),
    Feature("clearance_on_line", 0.0, 1.0, "the same along the straight line"),
    Feature(
        "ahead_of_start",
        0.0,
        1.0,
        f"blocked share of the {2 * TIPS + 1} cells a side between it and the goal",
    ),
    Feature("behind_start", 0.0, 1.0, "the same on its other side"),
    Feature("ahead_of_goal", 0.0, 1.0, "the same on the goal's side towards the start"),
    Feature("behind_goal", 0.0, 1.0, "the same on its other side"),
    Feature("ways_out", 0.0, 1.0, "share of the moves from the start that are legal"),
    Feature("ways_in", 0.0, 1.0, "share of the moves to the goal that are legal"),
    Feature(
        "greedy_arrives",
        0.0,
        1.0,
        "1 if always taking the shortest step + distance to the goal arrives; grids: never to a cell twice, "
        f"{PATIENCE} times the fewest moves at most",
    ),
    Feature(
        "greedy_progress", 0.0, 1.0, "share of the layers (grids: of the straight line) that this walk closes"
    ),
    Feature("greedy_detour", 0.0, 1.0, "its length over the straight line, minus 1; 1 if it is stuck"),
)
_LOW, _HIGH = (np.array([feature[bound] for feature in FEATURES]) for bound in (1, 2))


def describe(scenario: Scenario) -> NDArray[np.float32]:
    """Return the (len(FEATURES),) float32 descriptor of a scenario, each entry within its bounds."""
    values = measure(scenario)
    return np.clip([values[feature.name] for feature in FEATURES], _LOW, _HIGH).astype(np.float32)


def feature_table(features: Sequence[Feature] = FEATURES) -> str:
    """Return the Markdown table of some features, by default of all that describe a scenario."""
    rows = ["| num | feature | low | high | meaning |", "|---|---|---|---|---|"]
    rows += [f"| {i} | {f.name} | {f.low:g} | {f.high:g} | {f.meaning} |" for i, f in enumerate(features)]
    return "\n".join(rows)
