"""Buffers of the ant kernel: one set a thread, reused from plan to plan, grown when a plan visits more nodes."""

import threading
from typing import Any, NamedTuple

import numpy as np

from antgym.errors import ParameterError
from antgym.kernels.layout import (
    EITHER,
    LEVEL_SIZE,
    MORE_ROWS,
    MOST_REQUIRED,
    ROWS,
    STATUS_SIZE,
    WANTS,
    WIDTH,
    Moves,
    Nodes,
    Trail,
)
from antgym.kernels.nodes import rehash

_FIRST_ROWS, _RESERVED_ROWS = 2048, 1 << 18
_FIRST_DEPTH = 64
MOST_ROWS = 1 << 26  # an edge is row · 32 + slot in an int32


class Buffers(NamedTuple):
    """What :func:`antgym.kernels.ants.advance` works in."""

    moves: Moves
    nodes: Nodes
    trail: Trail


def new_buffers(runs: Any) -> Buffers:
    """Return empty buffers for (B,) records of RUN; rows and depth come as they are needed."""
    moves = Moves(
        dy=np.zeros(WIDTH, np.int64),
        dz=np.zeros(WIDTH, np.int64),
        end=np.zeros(WIDTH, np.int64),
        required=np.zeros((MOST_REQUIRED, WIDTH), np.int64),
        either=np.zeros((EITHER, WIDTH), np.int64),
        ahead=np.zeros(WIDTH, np.float32),
        along_y=np.zeros(WIDTH, np.float32),
        along_z=np.zeros(WIDTH, np.float32),
        step=np.ones(WIDTH, np.float32),
        level=np.zeros(WIDTH, np.float32),
        length=np.ones(WIDTH),
    )
    rows, words, *sizes = _sizes(runs)
    return Buffers(moves, _new_nodes(rows, words), _new_trail(*sizes))


def fitted(buffers: Buffers, runs: Any) -> Buffers:
    """Return buffers that are done with, or larger ones, for (B,) records of RUN; what they held is forgotten."""
    have = _capacities(buffers)
    sizes = tuple(map(max, have, _sizes(runs)))
    if sizes == have:
        return buffers
    return buffers._replace(nodes=_new_nodes(*sizes[:2]), trail=_new_trail(*sizes[2:]))


def grown(buffers: Buffers) -> Buffers:
    """Return buffers with the same contents and twice as much of what the kernel says it wants."""
    return _with_more_rows(buffers) if buffers.trail.status[WANTS] == MORE_ROWS else _deepened(buffers)


def _with_more_rows(buffers: Buffers) -> Buffers:
    """Return buffers with twice the rows; ParameterError past what an edge number holds."""
    old, count = buffers.nodes, int(buffers.trail.status[ROWS])
    if 2 * len(old.cell) > MOST_ROWS:
        raise ParameterError(
            f"this run may visit over {MOST_ROWS:,} cells; give it fewer ants or a smaller world"
        )
    nodes = _new_nodes(2 * len(old.cell), old.seen.shape[1])
    for name in set(Nodes._fields) - {"table", "scratch", "spare"}:
        getattr(nodes, name)[:count] = getattr(old, name)[:count]
    rehash(nodes, count)
    return buffers._replace(nodes=nodes)


def _deepened(buffers: Buffers) -> Buffers:
    """Return buffers whose ants may make twice the moves."""
    old = buffers.trail
    trail = _new_trail(len(old.row), 2 * len(old.edge), 2 * len(old.best_edge))
    for name in ("row", "depth", "active", "length", "share", "edge", "best_edge", "status", "levels"):
        kept = getattr(old, name)
        getattr(trail, name)[: len(kept)] = kept
    return buffers._replace(trail=trail)


class Workspace(threading.local):
    """The buffers of the calling thread."""

    buffers: Buffers | None = None

    def reserve(self, runs: Any) -> Buffers:
        """Return this thread's buffers, grown to fit every one of (B,) records of RUN."""
        self.buffers = new_buffers(runs) if self.buffers is None else fitted(self.buffers, runs)
        return self.buffers


def _sizes(runs: Any) -> tuple[int, ...]:
    """Return the rows, words of tabu bits, ants, edges and moves of a path that buffers for the runs begin with.

    Rows are reserved for all nodes that a run can visit, within reason: memory that is not touched is not taken, and
    one large piece saves copies and lies in large pages.
    """
    ants, layers = runs["ants"], np.where(runs["roams"], _FIRST_DEPTH, runs["layers"])
    most = np.minimum(runs["cells"], 1 + ants * layers * runs["iterations"]).max()
    words = -(-np.where(runs["roams"], ants, 1) // 64)
    sizes = (
        np.clip(most, _FIRST_ROWS, _RESERVED_ROWS),
        words.max(),
        ants.max(),
        (ants * layers).max(),
        layers.max(),
    )
    return tuple(int(size) for size in sizes)


def _capacities(buffers: Buffers) -> tuple[int, ...]:
    nodes, trail = buffers.nodes, buffers.trail
    return len(nodes.cell), nodes.seen.shape[1], len(trail.row), len(trail.edge), len(trail.best_edge)


def _new_nodes(rows: int, words: int) -> Nodes:
    slots = (rows, WIDTH)
    return Nodes(
        cell=np.empty(rows, np.int64),
        place=np.empty(rows, np.int64),
        eta=np.empty(slots, np.float32),
        tau=np.empty(slots, np.float64),
        weight=np.empty(slots, np.float32),
        sums=np.empty(slots, np.float32),
        child=np.empty(slots, np.int32),
        mark=np.empty(rows, np.int64),
        peak=np.empty(rows, np.float32),
        top=np.empty(rows, np.float32),
        greedy=np.empty(rows, np.int32),
        state=np.empty(rows, np.uint8),
        point=np.empty(rows, np.float64),
        degree=np.empty(rows, np.int64),
        nearest=np.empty(rows, np.float64),
        seen=np.empty((rows, words), np.uint64),
        table=np.zeros(1 << (2 * rows - 1).bit_length(), np.int32),
        scratch=np.zeros((2, WIDTH), np.float32),
        spare=np.zeros((2, 1, WIDTH), np.float32),
    )


def _new_trail(ants: int, edges: int, depth: int) -> Trail:
    due = edges + depth
    return Trail(
        row=np.empty(ants, np.int64),
        depth=np.empty(ants, np.int64),
        active=np.empty(ants, np.int64),
        length=np.empty(ants),
        share=np.empty(ants),
        edge=np.empty(edges, np.int32),
        best_edge=np.empty(depth, np.int32),
        due=np.empty(due, np.int32),
        wide=np.empty(due, np.float64),
        narrow=np.empty(due, np.float32),
        weight=np.empty(due, np.float32),
        status=np.zeros(STATUS_SIZE, np.int64),
        levels=np.zeros(LEVEL_SIZE),
    )
