"""Following: a path in metres becomes joint angles over time, by the branches of the inverse of least motion."""

from collections.abc import Iterator
from itertools import groupby

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antgym.errors import ParameterError, ReachError
from antgym.robots import timing
from antgym.robots.arms import Arm
from antgym.robots.branches import deviation, least_motion
from antgym.robots.chain import Floats
from antgym.robots.trajectory import Trajectory, rates

DOWN = np.diag([1.0, -1.0, -1.0])  # the tool's z axis points down, its x axis along the base's
DOWN.setflags(write=False)
MOST_SAMPLES = 20_000  # some seconds


def follow(
    arm: Arm,
    points: ArrayLike,
    *,
    tool: ArrayLike = DOWN,
    spacing: float = 0.002,
    margin: float = 0.05,
    speed: float = 0.25,
    acceleration: float = 1.0,
) -> Trajectory:
    """Let an arm follow a path with its tool held one way, as fast as its joints and the limits given allow.

    The path is sampled; every sample is solved for all branches of the inverse within the joint limits; a shortest path
    over the branches, of least joint motion, picks one for each; then it is timed. Only the tool's path is planned:
    that the links keep clear of obstacles is not checked.

    Args:
        arm: who follows.
        points: (n, 3) metres in the base frame, n ≥ 2, joined by straight lines: a planner's path is
            ``place(scenario.world.centre(plan.path), scale, at)``.
        tool: (3, 3) rotation of the tool in the base frame, the same all along; straight down by default.
        spacing: metres between samples, at most, > 0.
        margin: how near to a singularity the arm may come, in [0, 1): the sine of the wrist's or the elbow's angle, or
            the share of the reach from axis 1.
        speed: of the tool, metres per second, > 0.
        acceleration: of the tool, along and across the path, metres per second², > 0; joint accelerations are not
            limited, for their limits are not published.

    Raises:
        ReachError: if a part of the path is out of reach, or reached only past joint limits or near a singularity, or
            no branch leads from one sample to the next; it names the way-points.
        ParameterError: if an argument cannot be used.
    """
    for name, value in (("spacing", spacing), ("speed", speed), ("acceleration", acceleration)):
        if not (np.isfinite(value) and value > 0):
            raise ParameterError(f"{name} = {value}: must be a number above 0")
    if not 0 <= margin < 1:
        raise ParameterError(f"margin = {margin}: must be in [0, 1)")
    samples, waypoints = _sampled(_checked_points(points), spacing)
    choices = _choices(arm, _poses(samples, tool), waypoints, margin)
    joints = least_motion(arm, samples, choices)
    off = deviation(arm, joints[:-1], joints[1:], (samples[:-1] + samples[1:]) / 2)
    load = (rates(samples, joints) / arm.speeds).max(axis=1)  # of the busiest joint, at 1 m/s
    speeds = timing.fastest(samples, speed / np.maximum(1.0, speed * load), acceleration)
    times = timing.arrivals(samples, speeds)
    return Trajectory(arm, times, joints, samples, speeds, float(off.max()), float(arm.margins(joints).min()))


def place(
    points: ArrayLike, scale: float = 1.0, at: ArrayLike = (0.0, 0.0, 0.0), turn: float = 0.0
) -> Floats:
    """Return points of a map in the base frame of an arm.

    Args:
        points: (n, 3) in the map's unit, as ``scenario.world.centre(plan.path)`` has them.
        scale: metres in one of the map's units: 0.001 for millimetres.
        at: (3,) metres, where the map's origin lies in the base frame.
        turn: radians that the map is turned about z, anticlockwise from above.

    Returns:
        (n, 3) metres.

    Raises:
        ParameterError: if the scale is not above 0, or anything is not finite.
    """
    if not (np.isfinite([scale, turn, *np.asarray(at, dtype=np.float64)]).all() and scale > 0):
        raise ParameterError(
            f"scale = {scale}, at = {at!r}, turn = {turn}: finite numbers, and a scale above 0"
        )
    c, s = np.cos(turn), np.sin(turn)
    turned = _checked_points(points) @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    return scale * turned + np.asarray(at, dtype=np.float64)


def _checked_points(points: ArrayLike) -> Floats:
    array = np.asarray(points, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != 3 or not np.isfinite(array).all():
        raise ParameterError(f"a path is (n, 3) finite points, got shape {array.shape}")
    return array


def _sampled(points: Floats, spacing: float) -> tuple[Floats, NDArray[np.int64]]:
    """Return the points and others between them, at most ``spacing`` apart, and the way-point at or before each.

    Points that repeat the one before are left out, and not counted.
    """
    points = points[np.append(True, (np.diff(points, axis=0) != 0).any(axis=1))[: len(points)]]
    if len(points) < 2:
        raise ParameterError(f"a path has at least two different points, got {len(points)}")
    along = np.diff(points, axis=0)
    parts = np.ceil(np.linalg.norm(along, axis=1) / spacing)
    parts = np.maximum(parts, 2 if len(along) == 1 else 1)  # rest, something, rest
    if not parts.sum() < MOST_SAMPLES:
        raise ParameterError(
            f"a path of {np.linalg.norm(along, axis=1).sum():.6g} m takes {parts.sum():.6g} samples {spacing:g} m "
            f"apart, and {MOST_SAMPLES:,} are the most; is it in metres (scale, --scale)? Or space them more widely "
            "(spacing, --spacing)"
        )
    waypoints = np.repeat(np.arange(len(along)), parts.astype(int))
    share = np.concatenate([np.arange(n) / n for n in parts])
    samples = points[waypoints] + share[:, None] * along[waypoints]
    return np.vstack([samples, points[-1:]]), np.append(waypoints, len(along))


def _poses(points: Floats, tool: ArrayLike) -> Floats:
    """Return (n, 4, 4) poses at points, all turned alike; whether that is a turn, the arm checks."""
    turned = np.asarray(tool, dtype=np.float64)
    if turned.shape != (3, 3):
        raise ParameterError(f"tool is a (3, 3) rotation in the base frame, got shape {turned.shape}")
    poses = np.tile(np.eye(4), (len(points), 1, 1))
    poses[:, :3, :3], poses[:, :3, 3] = turned, points
    return poses


def _choices(arm: Arm, poses: Floats, waypoints: NDArray[np.int64], margin: float) -> list[Floats]:
    """Return the (c, j) angles among which every sample can choose; ReachError where one has none."""
    within = arm.solutions(poses)
    clear = [angles[(arm.margins(angles) >= margin).all(axis=1)] for angles in within]
    lacking = [i for i, angles in enumerate(clear) if not len(angles)]
    if not lacking:
        return clear
    excesses = arm.excess(poses[lacking])
    reasons = {i: _reason(arm, within[i], e, margin) for i, e in zip(lacking, excesses, strict=True)}
    stretches = [
        f"{_named(samples, waypoints, poses[:, :3, 3])}: {reasons[samples[0]]}"
        for samples in _stretches(reasons)
    ]
    more = "" if len(stretches) <= 3 else f"; and {len(stretches) - 3} more stretches"
    raise ReachError(
        f"{arm.name} cannot follow {len(lacking)} of {len(poses)} samples: {'; '.join(stretches[:3])}{more} "
        f"({arm.reach}); move the base or the map (at, --at), or hold the tool another way"
    )


def _reason(arm: Arm, within: Floats, excess: Floats, margin: float) -> str:
    """Return why a pose cannot be used, given its solutions within the limits, and the excess of all."""
    if len(within):
        margins = arm.margins(within)
        best = margins[margins.min(axis=1).argmax()]
        name = arm.singularities[int(best.argmin())]
        return f"too near the {name} singularity for margin {margin:g}"
    excess = excess[np.isfinite(excess).all(axis=1)]
    if not len(excess):
        return "out of reach"
    least = excess[np.abs(excess).max(axis=1).argmin()]
    return f"past the limit of joint {int(np.abs(least).argmax()) + 1}"


def _stretches(reasons: dict[int, str]) -> Iterator[list[int]]:
    """Yield runs of samples one behind the other that fail for one reason."""
    for _, run in groupby(enumerate(reasons), lambda pair: (pair[1] - pair[0], reasons[pair[1]])):
        yield [sample for _, sample in run]


def _named(samples: list[int], waypoints: NDArray[np.int64], points: Floats) -> str:
    first, last = samples[0], samples[-1]
    where = ", ".join(f"{c:.4g}" for c in points[first])
    ends = sorted({int(waypoints[first]), int(waypoints[last])})
    return f"way-point{'s' if len(ends) > 1 else ''} {' to '.join(map(str, ends))}, from ({where}) m on"
