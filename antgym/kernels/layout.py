"""What the ant kernels read and write: the record of a run, and the buffers it is walked in."""

from typing import NamedTuple

import numpy as np

WIDTH, LANES, SHIFT = 32, 8, 5
CLEAN, SUMS_STALE, ROW_STALE, DEAD_END = np.uint8(0), np.uint8(1), np.uint8(2), np.uint8(3)
_F = np.float32
BLOCKED = _F(-1e30)  # log2 η of a slot that is no legal move
OUTGROWN = _F(60.0)
FOLD_BELOW, FLOOR = 2.0**-500, 2.0**-1000  # of the global scale, and of any pheromone

MOST_REQUIRED, EITHER = 7, 2
STEP, REQUIRED, PARTS = (
    0,
    1,
    1 + MOST_REQUIRED + EITHER,
)  # of a move table: steps, required cells, either cells

DIE, RETREAT, LOOKAHEAD = 0, 1, 2  # RUN.trap
# slots of Trail.status and Trail.levels
ROWS, DONE, MADE, DRAWN, PACE, ACTIVE, DEEPEST, BEST_DEPTH, WANTS, STATUS_SIZE = range(10)
SCALE, UNVISITED, BEST, LOW, HIGH, LEVEL_SIZE = range(6)
MORE_ROWS, MORE_DEPTH, MORE_CELLS = 1, 2, 3  # Trail.status[WANTS]

# What a paused run reports of itself: the shortest length so far (inf before any), the share by which the block
# shortened it, the mean length of the last iteration (inf where none arrived), iterations since it last improved, the
# share of the block's ants that arrived, and of the last iteration how open choices were and how different the walks
SHORTEST, GAINED, MEAN, STAGNATION, ARRIVED, BRANCHING, DISTINCT, REPORT_SIZE = range(8)

RUN = np.dtype(
    [
        ("origin", np.int64),  # where this world begins in ``bits``; a cell is the number of its bit
        ("clear_shift", np.int64),  # from a cell to its place in the flat ``clearance`` array
        ("cells", np.int64),  # of the world: no more nodes than these can ever be visited
        ("stride_x", np.int64),
        ("stride_y", np.int64),
        ("start_x", np.int64),
        ("start_y", np.int64),
        ("start_z", np.int64),
        ("goal_x", np.int64),
        ("goal_y", np.int64),
        ("goal_z", np.int64),
        ("layers", np.int64),  # moves of every path under the layered motion
        ("reach", np.int64),  # cells that y and z may change per layer
        ("table", np.int64),  # which of the move tables
        ("slots", np.int64),  # moves in it
        ("width", np.int64),  # the same, rounded up to whole LANES
        ("crossed", np.int64),  # cells that each of its moves needs free
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
        ("z2", np.float32),  # exponent of the attraction, 1 / distance to the goal
        ("nearest_goal", np.float32),  # least distance that the attraction sees
        ("z3", np.float32),  # exponent of the clearance's ramp
        ("ramp_from", np.float32),  # clearance up to which a cell is no candidate
        ("ramp_over", np.float32),  # further clearance over which the ramp rises to 1
        ("q0", np.float32),
        ("alpha", np.float32),
        ("beta", np.float32),
        ("rho", np.float64),
        ("deposit", np.float64),  # Q / initial pheromone
        # every ant that arrived deposits (ranked = 0), or the best ranked - 1 do, weighted ranked - 1 down to 1
        ("ranked", np.int64),
        ("elite", np.float64),  # weight of the deposit on the best path so far
        ("local", np.float64),  # share that a passing ant takes off
        ("local_to", np.float64),  # and replaces by this pheromone
        ("mean_move", np.float64),  # mean length of the world's moves, where the initial pheromone needs it
        ("trap", np.int64),
        ("limits", np.bool_),  # MAX-MIN
        ("best_only", np.bool_),  # pheromone fades and grows on the best path alone
        ("to_goal", np.bool_),  # the anchor is the goal, not the start
        ("plain", np.bool_),  # the greedy move ignores alpha and beta
        ("clipped", np.bool_),  # the step counts as no longer than the mean of a cell's moves
        ("selective", np.bool_),  # only ants no longer than midway between best and worst deposit
        ("per_edge", np.bool_),  # deposits by the edge's length, not the path's
        ("by_degree", np.bool_),  # initial pheromone by length and degree, not uniform
        ("on_nodes", np.bool_),  # pheromone lies on cells, not on moves
        ("layered", np.bool_),
        ("either", np.bool_),  # a move needs one of two further cells
        ("roams", np.bool_),  # ants keep a tabu list: they could come back to a cell, or retreat
        ("linked", np.bool_),  # rows must know all the rows around them
        ("censused", np.bool_),  # rows must know their degree and their shortest move
    ],
    align=True,
)
"""One planner run: scenario, rule, parameters and effort, as the kernels read it."""


class Ground(NamedTuple):
    """The worlds of a batch, one behind the other."""

    bits: np.ndarray  # flat uint8, a bit a cell, 1 = free, with blocked borders
    clearance: np.ndarray  # flat float32 distance to the nearest obstacle, of the worlds that need it


class Moves(NamedTuple):
    """The move table of one run, padded to 32 slots."""

    dy: np.ndarray  # (32,) int64
    dz: np.ndarray
    end: np.ndarray  # (32,) int64 cell offsets
    required: np.ndarray  # (MOST_REQUIRED, 32) int64 offsets of the cells that must be free
    either: np.ndarray  # (2, 32) int64 offsets of the cells of which one must be
    ahead: np.ndarray  # (32,) float32 cells along x
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
    child: np.ndarray  # (rows, 32) int32 row behind a move, -1 unknown or not there
    mark: np.ndarray  # (rows,) int64 bit per slot: deposit received, power not renewed
    peak: np.ndarray  # (rows,) float32
    top: np.ndarray  # (rows,) float32 score of the greedy slot
    greedy: np.ndarray  # (rows,) int32
    state: np.ndarray  # (rows,) uint8
    point: np.ndarray  # (rows,) float64 pheromone of the node itself, in the unit of ``tau``
    degree: np.ndarray  # (rows,) int64 legal moves from it
    nearest: np.ndarray  # (rows,) float64 length of the shortest of them, inf where there is none
    seen: np.ndarray  # (rows, words) uint64 bit per ant: this iteration it has been here
    table: np.ndarray  # (power of two,) int32 hash table: row + 1, 0 = empty
    scratch: np.ndarray  # (2, 32) float32
    spare: np.ndarray  # (2, 1, 32) float32: weights and sums of the moves still open to one ant


class Trail(NamedTuple):
    """Where the ants of one iteration are and went, and what the run remembers."""

    row: np.ndarray  # (ants,) int64, -1 = died
    depth: np.ndarray  # (ants,) int64 moves of its path so far
    active: np.ndarray  # (ants,) int64 those still on their way, in order
    length: np.ndarray  # (ants,) float64
    share: np.ndarray  # (ants,) float64 weight of an ant's deposit, then the deposit
    edge: np.ndarray  # (depths · ants,) int32: row · 32 + slot
    best_edge: np.ndarray  # (depths,) int32
    due: np.ndarray  # (depths · (ants + 1),) int32 edges that wait for a new power
    wide: np.ndarray  # (depths · (ants + 1),) float64 their pheromone
    narrow: np.ndarray  # (depths · (ants + 1),) float32 its logarithm
    weight: np.ndarray  # (depths · (ants + 1),) float32 their power
    status: np.ndarray  # (STATUS_SIZE,) int64
    levels: np.ndarray  # (LEVEL_SIZE,) float64


class History(NamedTuple):
    """What a run leaves per iteration."""

    best: np.ndarray  # float64 shortest so far, inf before any
    mean: np.ndarray  # float64 mean over the ants that arrived, inf if none
    arrived: np.ndarray  # int64 ants that arrived
