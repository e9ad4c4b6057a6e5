"""Grid worlds and scenarios: a 0/1 grid with a cell size, and a start and a goal in any world under a motion rule."""

import hashlib
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Generic, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antgym.errors import MapError, ScenarioError
from antgym.maps.ends import checked_end, require_reach
from antgym.maps.motion import LAYERED, Motion
from antgym.maps.packing import PAD, is_binary, packed

if TYPE_CHECKING:
    from typing_extensions import TypeVar

    from antgym.maps.disc_chart import DiscChart
    from antgym.maps.discs import DiscWorld
    from antgym.maps.occupancy import Chart

    # a plain Scenario is one of a grid
    World = TypeVar("World", bound="GridWorld | DiscWorld", default="GridWorld")
    Place = TypeVar("Place", bound="tuple[float, ...]", default="Cell")
else:
    from typing import TypeVar

    World, Place = TypeVar("World"), TypeVar("Place")

__all__ = ["MOST_CLEARED", "PAD", "Cell", "GridWorld", "Scenario"]

MOST_CLEARED = 1 << 24  # cells: 256 × 256 × 256
Cell = tuple[int, int, int]


@dataclass(frozen=True, eq=False, init=False)
class GridWorld:
    """A box of equal cells, each free (1) or blocked (0).

    Args:
        free: (nx, ny, nz) array of 0/1 or bool, or (nx, ny) for a flat world, one cell high; copied.
        cell: edge lengths of a cell along x, y, z in world units (any unit; lengths come out in it).

    Attributes:
        cell: as above.
        shape: cells along x, y, z.
        bits: flat uint8, what the kernels read: a bit a cell of ``storage``, in its order, lowest bits first.

    Raises:
        MapError: if the array has neither two nor three dimensions, is empty or holds anything but 0 and 1, or
            if a cell edge is not positive and finite.
    """

    cell: tuple[float, float, float]
    shape: Cell
    bits: NDArray[np.uint8] = field(repr=False)

    def __init__(self, free: ArrayLike, cell: tuple[float, float, float] = (15.0, 15.0, 15.0)) -> None:
        array = np.asarray(free)
        if array.ndim not in (2, 3) or array.size == 0:
            raise MapError(f"a world is a non-empty (nx, ny, nz) or (nx, ny) array, got shape {array.shape}")
        if not is_binary(array):
            raise MapError(
                "a world holds only 0 (blocked) and 1 (free); threshold it first, or use voxelise()"
            )
        edges = tuple(float(edge) for edge in cell)
        if len(edges) != 3 or not all(np.isfinite(edge) and edge > 0 for edge in edges):
            raise MapError(f"cell edges must be three positive numbers (x, y, z), got {cell}")
        array = array.reshape(*array.shape[:2], -1)
        object.__setattr__(self, "cell", edges)
        object.__setattr__(self, "shape", array.shape)
        object.__setattr__(self, "bits", packed(array))

    def __reduce__(self) -> tuple[Any, ...]:
        return _from_bits, (self.bits, self.shape, self.cell)  # built anew, so that a copy is read-only too

    @property
    def padded(self) -> Cell:
        """Cells of ``storage`` along x, y, z."""
        nx, ny, nz = self.shape
        return nx + 2 * PAD, ny + 2 * PAD, nz + 2 * PAD

    @property
    def strides(self) -> Cell:
        """How far apart in ``bits`` neighbours along x, y, z are, in cells."""
        _, sy, sz = self.padded
        return sy * sz, sz, 1

    @cached_property
    def storage(self) -> NDArray[np.uint8]:
        """The world within blocked borders of PAD cells, ``padded`` uint8, read-only; unpacked when first asked for."""
        storage = self._unpacked(0, self.padded[0])
        storage.setflags(write=False)
        return storage

    def planes(self, first: int, last: int) -> NDArray[np.uint8]:
        """Return ``free[first:last]`` (0 ≤ first ≤ last ≤ nx), unpacked for the caller alone."""
        return self._unpacked(first + PAD, last + PAD)[:, PAD:-PAD, PAD:-PAD]

    def _unpacked(self, first: int, last: int) -> NDArray[np.uint8]:
        plane, odd = self.strides[0], first * self.strides[0] % 8
        count = (last - first) * plane
        cells = np.unpackbits(self.bits[first * plane // 8 :], count=odd + count, bitorder="little")
        return cells[odd:].reshape(last - first, *self.padded[1:])

    @property
    def free(self) -> NDArray[np.uint8]:
        """(nx, ny, nz) uint8, 1 = free; a view into ``storage``."""
        return self.storage[PAD:-PAD, PAD:-PAD, PAD:-PAD]

    @cached_property
    def free_count(self) -> int:
        """Number of free cells."""
        return int(np.bitwise_count(self.bits).sum())

    @property
    def size(self) -> int:
        """Number of cells."""
        return math.prod(self.shape)

    @property
    def frame(self) -> str:
        """Cells and their edges, as a scenario's digest has them."""
        return f"{self.shape}{self.cell}"

    def is_free(self, cell: Sequence[int]) -> bool:
        """Whether one cell, given by indices within ``shape``, is free."""
        place = sum((i + PAD) * stride for i, stride in zip(cell, self.strides, strict=True))
        return bool(self.bits[place >> 3] >> (place & 7) & 1)

    @cached_property
    def clearance(self) -> NDArray[np.float32]:
        """Distance from each cell's centre to that of the nearest blocked one, in world units, laid out as ``storage``.

        Exact and Euclidean; inf where nothing is blocked. The walls of the box do not count, its border cells hold 0.

        Raises:
            MapError: if the world has over ``MOST_CLEARED`` cells: the exact transform takes some 30 bytes a cell.
        """
        if self.size > MOST_CLEARED:
            raise MapError(
                f"a world of {self.size:,} cells is too large for the distance to its obstacles, which rules with "
                f"z3 > 0 need (zhang_apf): at most {MOST_CLEARED:,} cells; crop it, coarsen it, or set z3 = 0"
            )
        from scipy.ndimage import distance_transform_edt

        clearance = np.zeros(self.padded, dtype=np.float32)
        inside = clearance[PAD:-PAD, PAD:-PAD, PAD:-PAD]
        inside[:] = np.inf if self.free_count == self.size else distance_transform_edt(self.free, self.cell)
        clearance.setflags(write=False)
        return clearance

    def centre(self, cells: ArrayLike) -> NDArray[np.float64]:
        """Return the centres of cells, (..., 3) in world units, the corner of cell (0, 0, 0) at the origin."""
        return (np.asarray(cells, dtype=np.float64) + 0.5) * np.asarray(self.cell)

    def checked_end(self, cell: Sequence[int], label: str) -> Cell:
        """Return a start or goal as a cell; ScenarioError where it cannot be one."""
        return checked_end(self, cell, label)

    def checked_motion(self, motion: Motion, start: Cell, goal: Cell) -> Motion:
        """Return a motion; ScenarioError where this world does not suit it, or the goal is out of its reach."""
        if motion.layered:
            require_reach(start, goal)
        elif motion.name == "straight":
            raise ScenarioError(
                "the straight motion leads past discs, this world has cells; name a grid's motion"
            )
        elif motion.name != "grid26" and self.shape[2] != 1:
            raise ScenarioError(
                f"the {motion.name} motion needs a world one cell high, got {self.shape} cells; "
                "take one level of it, free[:, :, z] (antgym plan: --levels 1), or the grid26 motion"
            )
        return motion

    def contents(self) -> Iterator[bytes]:
        """Yield all that is in this world, within what its ``frame`` says."""
        for first in range(0, self.shape[0], 8):  # eight planes end on a byte
            yield np.packbits(self.planes(first, min(first + 8, self.shape[0]))).tobytes()


@dataclass(frozen=True, eq=False)
class Scenario(Generic[World, Place]):
    """One planning question: a world, a start, a goal and the motion rule between them.

    What a place is, the world says: a cell of a :class:`GridWorld`, a point of a
    :class:`~antgym.maps.discs.DiscWorld`.

    Args:
        world: the grid, or the discs.
        start: (x, y, z) cell indices, or (x, y) in a world one cell high, which must be free; among discs (x, y) in
            world units, clear of them.
        goal: likewise; under the layered motion in a later layer.
        motion: the motion rule; the exact optimum is exact under it. Among discs there is only one: leave it out.
        name: how tables call it; agents never see it.

    Raises:
        ScenarioError: if start or goal is outside, blocked or equal, the goal is out of the motion's reach, or
            the motion is flat and the world is not.
    """

    world: World
    start: Place
    goal: Place
    motion: Motion = LAYERED
    name: str = "unnamed"

    def __post_init__(self) -> None:
        for label in ("start", "goal"):
            object.__setattr__(self, label, self.world.checked_end(getattr(self, label), label))
        if self.start == self.goal:
            kind = "cell" if isinstance(self.world, GridWorld) else "point"
            raise ScenarioError(f"start and goal are the same {kind} {self.start}; choose two")
        motion = self.world.checked_motion(self.motion, cast("Any", self.start), cast("Any", self.goal))
        object.__setattr__(self, "motion", motion)

    def __reduce__(self) -> tuple[Any, ...]:
        return Scenario, (self.world, self.start, self.goal, self.motion, self.name)

    @property
    def layers(self) -> int:
        """Number of moves of every path under the layered motion; under any other, paths differ in it."""
        if not self.motion.layered:
            raise ScenarioError(f"the {self.motion.name} motion has no layers")
        return int(self.goal[0] - self.start[0])

    @cached_property
    def straight_line(self) -> float:
        """Euclidean distance from start to goal in world units, obstacles ignored."""
        return math.dist(*self.world.centre([self.start, self.goal]).tolist())

    @cached_property
    def optimum(self) -> float:
        """Exact shortest length under ``motion`` in world units; raises ScenarioError where no path exists."""
        from antgym.maps.optimum import shortest_length

        return shortest_length(self)

    @property
    def _on_a_grid(self) -> "Scenario":
        """This scenario, where its world is a grid."""
        if not isinstance(self.world, GridWorld):
            raise ScenarioError(
                f"scenario {self.name!r} lies among discs and has no cells; this needs a GridWorld"
            )
        return cast("Scenario", self)

    @cached_property
    def mean_move(self) -> float:
        """Mean length of all moves between free cells of the world, in world units; 0 where there is none."""
        from antgym.maps.moves import mean_length

        return mean_length(self._on_a_grid)

    @cached_property
    def descriptors(self) -> NDArray[np.float32]:
        """What ``describe`` of :mod:`antgym.maps.features`, or ``describe_discs``, says of it, computed once."""
        from antgym.maps.disc_features import describe_discs
        from antgym.maps.features import describe

        on_a_grid = isinstance(self.world, GridWorld)
        descriptors = describe(self._on_a_grid) if on_a_grid else describe_discs(cast("Any", self))
        descriptors.setflags(write=False)
        return descriptors

    @cached_property
    def chart(self) -> "Chart | DiscChart":
        """What draws the down-sampled map of :func:`antgym.maps.occupancy.occupancy`, each picture once."""
        from antgym.maps.disc_chart import DiscChart
        from antgym.maps.occupancy import Chart

        if isinstance(self.world, GridWorld):
            question = self._on_a_grid
            return Chart(question.world, [question.start], [question.goal])
        discs = cast("Any", self)
        return DiscChart(discs.world, discs.start, discs.goal)

    @cached_property
    def digest(self) -> str:
        """Hash of everything that defines the question (name excluded), 64 hex digits."""
        digest = hashlib.sha256(f"{self.world.frame}{self.start}{self.goal}{self.motion.key}".encode())
        for part in self.world.contents():
            digest.update(part)
        return digest.hexdigest()

    def with_motion(self, motion: Motion) -> "Scenario[World, Place]":
        """Return the same question under another motion rule."""
        return replace(self, motion=motion)


def _from_bits(bits: NDArray[np.uint8], shape: Cell, cell: tuple[float, float, float]) -> GridWorld:
    """Return the world that a pickled one was."""
    world = GridWorld.__new__(GridWorld)
    bits.setflags(write=False)
    for name, value in (("cell", cell), ("shape", shape), ("bits", bits)):
        object.__setattr__(world, name, value)
    return world
