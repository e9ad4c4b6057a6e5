"""Disc worlds: a rectangle of the plane with discs in it, and the points in it that can be a start or a goal."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antgym.errors import MapError, ScenarioError
from antgym.maps.motion import LAYERED, STRAIGHT, Motion
from antgym.maps.world import Scenario

Point = tuple[float, float]
Floats = NDArray[np.float64]
FARTHEST, NARROWEST = 1e9, 1e-6  # from the origin, and of a side of the bounds: doubles resolve both at once


@dataclass(frozen=True, eq=False, init=False)
class DiscWorld:
    """A rectangle of the plane with discs in it, which a round robot must not touch.

    Args:
        discs: (n, 3) centre x, centre y and radius of each, in world units; they may overlap, and lie anywhere;
            n may be 0. Copied.
        bounds: (x_min, x_max, y_min, y_max), where the robot's centre may be.
        robot_radius: what every disc is grown by, ≥ 0.
        safe_distance: D_safe, the clearance that a planner should keep beyond that, ≥ 0; a path that does not is
            still a path.

    Attributes:
        discs: as above, read-only float64.
        bounds: as above.
        robot_radius: as above.
        safe_distance: as above.

    Raises:
        MapError: if a number is not finite, a radius or a distance not positive, a side of the bounds below 1e-6, or
            anything farther than 1e9 from the origin.
    """

    discs: Floats = field(repr=False)
    bounds: tuple[float, float, float, float]
    robot_radius: float
    safe_distance: float

    def __init__(
        self,
        discs: ArrayLike,
        bounds: Sequence[float],
        *,
        robot_radius: float = 0.0,
        safe_distance: float = 0.0,
    ) -> None:
        object.__setattr__(self, "discs", _checked_discs(discs))
        object.__setattr__(self, "bounds", _checked_bounds(bounds))
        for name, value in (("robot_radius", robot_radius), ("safe_distance", safe_distance)):
            number = _numbers(value, name).reshape(-1)
            if len(number) != 1 or not 0 <= number[0] <= FARTHEST:
                raise MapError(f"{name} = {value}: must be one number from 0 to {FARTHEST:g}")
            object.__setattr__(self, name, float(number[0]))

    def __reduce__(self) -> tuple[Any, ...]:
        return _built_anew, (self.discs, self.bounds, self.robot_radius, self.safe_distance)

    @property
    def grown(self) -> Floats:
        """(n, 3) the discs as a point would meet them: grown by the robot's radius."""
        return self.discs + np.array([0.0, 0.0, self.robot_radius])

    @property
    def width(self) -> float:
        """The longer side of the bounds."""
        x_min, x_max, y_min, y_max = self.bounds
        return max(x_max - x_min, y_max - y_min)

    def centre(self, points: ArrayLike) -> Floats:
        """Return points as (..., 2) float64: in this world a place is where it is."""
        return np.asarray(points, dtype=np.float64)

    def clearances(self, path: ArrayLike) -> Floats:
        """Return how far each segment of an (m + 1, 2) path stays from all discs, (m,); negative where it cuts one.

        The robot's radius is taken off; inf where there are no discs.
        """
        points, grown = self.centre(path), self.grown
        begin, along = points[:-1, None], np.diff(points, axis=0)[:, None]
        square = np.maximum((along**2).sum(axis=2), np.finfo(float).tiny)
        to_disc = grown[None, :, :2] - begin
        share = np.clip((to_disc * along).sum(axis=2) / square, 0.0, 1.0)
        apart = to_disc - share[:, :, None] * along
        return (np.hypot(apart[:, :, 0], apart[:, :, 1]) - grown[:, 2]).min(axis=1, initial=np.inf)

    def checked_end(self, point: Sequence[float], label: str) -> Point:
        """Return a start or goal as two plain floats.

        Raises:
            ScenarioError: if it is no point, lies out of bounds, or in or on a disc.
        """
        try:
            x, y = (float(value) for value in point)
        except (TypeError, ValueError, OverflowError):
            raise ScenarioError(f"{label} = {point!r}: among discs a place is two numbers (x, y)") from None
        x_min, x_max, y_min, y_max = self.bounds
        if not (x_min <= x <= x_max and y_min <= y <= y_max):
            raise ScenarioError(f"{label} ({x:g}, {y:g}) lies outside the bounds {self.bounds}")
        gaps = np.hypot(*(self.discs[:, :2] - (x, y)).T) - self.grown[:, 2]
        if len(gaps) and gaps.min() <= 0:
            worst = int(gaps.argmin())
            raise ScenarioError(
                f"{label} ({x:g}, {y:g}) lies {-gaps[worst]:g} inside disc {worst} {tuple(self.discs[worst].tolist())}"
                f", robot radius {self.robot_radius:g} included; move it, or shrink the disc"
            )
        return x, y

    def checked_motion(self, motion: Motion, start: Point, goal: Point) -> Motion:  # noqa: ARG002
        """Return the straight motion, the only one there is among discs; ScenarioError where a grid's was asked for."""
        if motion not in (LAYERED, STRAIGHT):
            raise ScenarioError(f"the {motion.name} motion walks a grid; among discs leave the motion out")
        return STRAIGHT

    @property
    def frame(self) -> str:
        """Bounds and distances, as a scenario's digest has them."""
        return f"{self.bounds}{self.robot_radius}{self.safe_distance}"

    def contents(self) -> Iterator[bytes]:
        """Yield all that is in this world, within what its ``frame`` says."""
        yield self.discs.astype("<f8").tobytes()


DiscScenario = Scenario[DiscWorld, Point]
"""A scenario among discs, as annotations name it."""


def _built_anew(discs: Floats, bounds: Sequence[float], robot: float, safe: float) -> DiscWorld:
    return DiscWorld(discs, bounds, robot_radius=robot, safe_distance=safe)


def _checked_discs(discs: ArrayLike) -> Floats:
    array = _numbers(discs, "discs")
    if array.size == 0:
        array = array.reshape(0, 3)
    if array.ndim != 2 or array.shape[1] != 3:
        raise MapError(f"discs are an (n, 3) array of x, y, radius, got shape {array.shape}")
    for row, (x, y, radius) in enumerate(array.tolist()):
        if not max(abs(x), abs(y), radius) <= FARTHEST or not radius > 0:
            raise MapError(
                f"disc {row}: ({x:g}, {y:g}, {radius:g}) needs a radius above 0 and nothing beyond {FARTHEST:g}"
            )
    array = array.copy()
    array.setflags(write=False)
    return array


def _checked_bounds(bounds: Sequence[float]) -> tuple[float, float, float, float]:
    array = _numbers(bounds, "bounds")
    if array.shape != (4,) or not (np.abs(array) <= FARTHEST).all():
        raise MapError(
            f"bounds = {bounds}: needs four numbers x_min, x_max, y_min, y_max within {FARTHEST:g}"
        )
    x_min, x_max, y_min, y_max = array.tolist()
    if not min(x_max - x_min, y_max - y_min) >= NARROWEST:
        raise MapError(
            f"bounds = {bounds}: need x_min < x_max and y_min < y_max, {NARROWEST:g} apart at least"
        )
    return x_min, x_max, y_min, y_max


def _numbers(values: ArrayLike, label: str) -> Floats:
    try:
        array = np.asarray(values)
        if array.size and array.dtype.kind not in "iuf":
            raise TypeError("no numbers")
        array = array.astype(np.float64)
    except (TypeError, ValueError):
        raise MapError(f"{label} must be numbers, in rows of one length, got {values!r:.80}") from None
    if not np.isfinite(array).all():
        raise MapError(f"{label} must be finite, got {float(array[~np.isfinite(array)][0])}")
    return array


def path_length(path: ArrayLike) -> float:
    """Return the length of an (n, 2) path, its segments added from the start on."""
    points = np.asarray(path, dtype=np.float64).tolist()
    total = 0.0
    for one, other in pairwise(points):
        total += math.dist(one, other)
    return total
