"""Buffers of the ant kernel: one set a thread, reused from plan to plan, grown when a plan visits more nodes."""

import threading
from typing import NamedTuple

import numpy as np

from antgym.errors import ParameterError
from antgym.kernels.layout import LEVEL_SIZE, ROWS, STATUS_SIZE, WIDTH, Moves, Nodes, Trail
from antgym.kernels.nodes import rehash

_FIRST_ROWS = 2048
MOST_ROWS = 1 << 26  # an edge is row · 32 + slot in an int32
_FAR = 1 << 40  # a padded slot moves out of every reach


class Buffers(NamedTuple):
    """What :func:`antgym.kernels.ants.advance` works in."""

    moves: Moves
    nodes: Nodes
    trail: Trail


def new_buffers(colony: int, edges: int, layers: int) -> Buffers:
    """Return empty buffers for a colony of ants and edges = layers · ants; rows come as nodes are visited."""
    far = np.full(WIDTH, _FAR)
    moves = Moves(
        dy=far,
        dz=far.copy(),
        crossed=np.zeros((3, WIDTH), np.int64),
        along_y=np.zeros(WIDTH, np.float32),
        along_z=np.zeros(WIDTH, np.float32),
        step=np.ones(WIDTH, np.float32),
        level=np.zeros(WIDTH, np.float32),
        length=np.ones(WIDTH),
    )
    return Buffers(moves, _new_nodes(_FIRST_ROWS), _new_trail(colony, edges, layers))


def with_more_rows(buffers: Buffers) -> Buffers:
    """Return buffers with twice the rows and the same contents; ParameterError past what an edge number holds."""
    old, count = buffers.nodes, int(buffers.trail.status[ROWS])
    if 2 * len(old.cell) > MOST_ROWS:
        raise ParameterError(
            f"this run may visit over {MOST_ROWS:,} cells; give it fewer ants or a smaller world"
        )
    nodes = _new_nodes(2 * len(old.cell))
    for name in set(Nodes._fields) - {"table", "scratch"}:
        getattr(nodes, name)[:count] = getattr(old, name)[:count]
    rehash(nodes, count)
    return buffers._replace(nodes=nodes)


class Workspace(threading.local):
    """The buffers of the calling thread."""

    buffers: Buffers | None = None

    def reserve(self, colony: int, edges: int, layers: int) -> Buffers:
        """Return this thread's buffers, grown to fit every run of a batch."""
        old = self.buffers
        if old is None:
            self.buffers = new_buffers(colony, edges, layers)
        elif len(old.trail.row) < colony or len(old.trail.edge) < edges or len(old.trail.best_edge) < layers:
            sizes = (len(old.trail.row), len(old.trail.edge), len(old.trail.best_edge))
            trail = _new_trail(*np.maximum(sizes, (colony, edges, layers)).tolist())
            nodes = _new_nodes(len(old.nodes.cell))  # empty, as the new trail says
            self.buffers = old._replace(nodes=nodes, trail=trail)
        assert self.buffers is not None
        return self.buffers


def _new_nodes(rows: int) -> Nodes:
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
        table=np.zeros(1 << (2 * rows - 1).bit_length(), np.int32),
        scratch=np.zeros((2, WIDTH), np.float32),
    )


def _new_trail(colony: int, edges: int, layers: int) -> Trail:
    return Trail(
        row=np.empty(colony, np.int64),
        length=np.empty(colony),
        share=np.empty(colony),
        edge=np.empty(edges, np.int32),
        best_edge=np.empty(layers, np.int32),
        due=np.empty(edges + layers, np.int32),
        wide=np.empty(edges + layers, np.float64),
        narrow=np.empty(edges + layers, np.float32),
        weight=np.empty(edges + layers, np.float32),
        status=np.zeros(STATUS_SIZE, np.int64),
        levels=np.zeros(LEVEL_SIZE),
    )
