"""What the bee kernel reads and writes: the record of a run, the discs, and the comb that holds its sources."""

from typing import NamedTuple

import numpy as np

LANES = 4  # discs looked at together; worlds are padded to whole lanes
# slots of Comb.status and Comb.levels
DONE, DRAWN, MADE, LISTED, STAMP, STATUS_SIZE = range(6)
BEST_VALUE, BEST_LENGTH, BEST_GAP, LEVEL_SIZE = range(4)
LENGTH, GAP, HITS, SUMMED = range(4)  # rows of Comb.before and Comb.after

FLIGHT = np.dtype(
    [
        ("first", np.int64),  # where the discs of this world begin and end
        ("last", np.int64),
        ("sources", np.int64),  # employed bees
        ("onlookers", np.int64),
        ("points", np.int64),  # way-points between start and goal
        ("cycles", np.int64),  # G_max of (12)
        ("tabu", np.int64),  # entries of the list, 0 = none
        ("redraws", np.int64),  # of a scout that lands too near one of them, at most
        ("key", np.uint64),  # of the random numbers
        ("x_min", np.float64),
        ("x_max", np.float64),
        ("y_min", np.float64),
        ("y_max", np.float64),
        ("start_x", np.float64),
        ("start_y", np.float64),
        ("goal_x", np.float64),
        ("goal_y", np.float64),
        ("safe", np.float64),  # D_safe
        ("weight", np.float64),  # k of (4)
        ("per_length", np.float64),  # cost of a unit of length,
        ("per_shortfall", np.float64),  # of a unit that the smallest clearance lacks,
        ("per_hit", np.float64),  # and of a segment that touches a disc
        ("aim", np.float64),  # phi of (3)
        ("limit", np.float64),
        ("xi_max", np.float64),
        ("xi_min", np.float64),
        ("radius", np.float64),  # of a tabu entry
        ("pull", np.float64),  # C, towards the best path so far
        ("printed", np.bool_),  # cost as (4)-(6) print it
        ("away", np.bool_),  # xi as it is, not a random share of it between -xi and xi
        ("neighbour", np.bool_),  # scouts move one coordinate (9), they do not draw a new path (7)
        ("elite", np.bool_),  # the best source is never abandoned
    ],
    align=True,
)
"""One run of a hive: scenario, rule, parameters and effort, as the kernel reads it."""


class Discs(NamedTuple):
    """The discs of all worlds of a batch, each world padded with discs of radius -inf: (n,) float64."""

    x: np.ndarray
    y: np.ndarray
    radius: np.ndarray  # grown by the robot's


class Comb(NamedTuple):
    """The sources of one run (s of them, p way-points), and what it remembers.

    ``before`` and ``after`` hold what the segments before, and from, one on add up to: where one way-point moves, two
    segments change and the rest is two look-ups.
    """

    place: np.ndarray  # (s, 2, p + 2) float64, x and y of start, way-points and goal
    length: np.ndarray  # (s, p + 1) float64, of every segment
    gap: np.ndarray  # (s, p + 1) float64, its clearance, negative within a disc
    before: np.ndarray  # (s, SUMMED, p + 2) float64: length, smallest gap and number of touching segments
    after: np.ndarray  # likewise
    value: np.ndarray  # (s,) float64, f of (8)
    sums: np.ndarray  # (s,) float64, prefix sums of the qualities
    tries: np.ndarray  # (s,) int64, since the source last improved
    best: np.ndarray  # (2, p + 2) float64, the path of the least f so far
    tabu: np.ndarray  # (entries, 2, p + 2) float64
    stamp: np.ndarray  # (entries,) int64: when it was listed or hit
    gaps: np.ndarray  # (discs of a world,) float64, scratch
    status: np.ndarray  # (STATUS_SIZE,) int64
    levels: np.ndarray  # (LEVEL_SIZE,) float64
