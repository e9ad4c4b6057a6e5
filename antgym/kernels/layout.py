"""What the ant kernels read and write: the record of a run, and the buffers it is walked in."""

from typing import NamedTuple

import numpy as np

WIDTH, LANES, SHIFT = 32, 8, 5
CLEAN, SUMS_STALE, ROW_STALE, DEAD_END = np.uint8(0), np.uint8(1), np.uint8(2), np.uint8(3)
_F = np.float32
BLOCKED = _F(-1e30)  # log2 η of a slot that is no legal move
OUTGROWN = _F(60.0)
FOLD_BELOW, FLOOR = 2.0**-500, 2.0**-1000  # of the global scale, and of any pheromone

# slots of Trail.status and Trail.levels
ROWS, DONE, MADE, STATUS_SIZE = 0, 1, 2, 3
SCALE, UNVISITED, BEST, LOW, HIGH, LEVEL_SIZE = 0, 1, 2, 3, 4, 5

RUN = np.dtype(
    [
        ("origin", np.int64),  # where this world begins in the flat ``free`` array; cells are indices into it
        ("stride_x", np.int64),
        ("stride_y", np.int64),
        ("start_x", np.int64),
        ("start_y", np.int64),
        ("start_z", np.int64),
        ("goal_y", np.int64),
        ("goal_z", np.int64),
        ("layers", np.int64),
        ("reach", np.int64),  # cells that y and z may change per layer
        ("table", np.int64),  # which of the move tables
        ("ants", np.int64),
        ("iterations", np.int64),
        ("key", np.uint64),  # of the random numbers
        ("cell_x", np.float64),
        ("cell_y", np.float64),
        ("cell_z", np.float64),
        # D = 1 / (step_share · step + distance_share · distance to the anchor)
        ("step_share", np.float32),
        ("distance_share", np.float32),
        ("w1", np.float32),
        ("w2", np.float32),
        ("q0", np.float32),
        ("alpha", np.float32),
        ("beta", np.float32),
        ("rho", np.float64),
        ("deposit", np.float64),  # Q / initial pheromone
        # every ant that arrived deposits (ranked = 0), or the best ranked - 1 do, weighted ranked - 1 down to 1
        ("ranked", np.int64),
        ("elite", np.float64),  # weight of the deposit on the best path so far
        (
            "local",
            np.float64,
        ),  # share of an edge's pheromone that a passing ant puts back to its initial value
        ("limits", np.bool_),  # MAX-MIN
        ("best_only", np.bool_),  # pheromone fades and grows on the best path alone
        ("lookahead", np.bool_),  # a move into a dead end is no move
        ("to_goal", np.bool_),  # the anchor is the goal, not the start
        ("plain", np.bool_),  # the greedy move ignores alpha and beta
    ],
    align=True,
)
"""One planner run: scenario, rule, parameters and effort, as the kernels read it."""


class Moves(NamedTuple):
    """The move table of one run, padded to 32 slots."""

    dy: np.ndarray  # (32,) int64
    dz: np.ndarray
    crossed: np.ndarray  # (3, 32) int64 cell offsets: before the layer boundary, behind it, the end
    along_y: np.ndarray  # (32,) float32 world units
    along_z: np.ndarray
    step: np.ndarray  # (32,) float32 length
    level: np.ndarray  # (32,) float32 log2(|dz| + 1)
    length: np.ndarray  # (32,) float64


class Nodes(NamedTuple):
    """Visited nodes, one row each."""

    cell: np.ndarray  # (rows,) int64
    place: np.ndarray  # (rows,) int64 where in ``table``
    eta: np.ndarray  # (rows, 32) float32 log2 of the heuristic
    tau: np.ndarray  # (rows, 32) float64 pheromone / (initial pheromone · scale)
    weight: np.ndarray  # (rows, 32) float32
    sums: np.ndarray  # (rows, 32) float32 prefix sums, lane-major
    child: np.ndarray  # (rows, 32) int32 row behind a move, -1 unknown
    mark: np.ndarray  # (rows,) int64 bit per slot: deposit received, power not renewed
    peak: np.ndarray  # (rows,) float32
    top: np.ndarray  # (rows,) float32 score of the greedy slot
    greedy: np.ndarray  # (rows,) int32
    state: np.ndarray  # (rows,) uint8
    table: np.ndarray  # (power of two,) int32 hash table: row + 1, 0 = empty
    scratch: np.ndarray  # (2, 32) float32


class Trail(NamedTuple):
    """Where the ants of one iteration are and went, and what the run remembers."""

    row: np.ndarray  # (ants,) int64, -1 = died
    length: np.ndarray  # (ants,) float64
    share: np.ndarray  # (ants,) float64 weight of an ant's deposit, then the deposit
    edge: np.ndarray  # (layers · ants,) int32: row · 32 + slot
    best_edge: np.ndarray  # (layers,) int32
    due: np.ndarray  # (layers · (ants + 1),) int32 edges that wait for a new power
    wide: np.ndarray  # (layers · (ants + 1),) float64 their pheromone
    narrow: np.ndarray  # (layers · (ants + 1),) float32 its logarithm
    weight: np.ndarray  # (layers · (ants + 1),) float32 their power
    status: np.ndarray  # (STATUS_SIZE,) int64
    levels: np.ndarray  # (LEVEL_SIZE,) float64


class History(NamedTuple):
    """What a run leaves per iteration."""

    best: np.ndarray  # float64 shortest so far, inf before any
    mean: np.ndarray  # float64 mean over the ants that arrived, inf if none
    arrived: np.ndarray  # int64 ants that arrived
