"""Pictures of a trajectory: the arm along its path, its joints over time, and how busy they are."""

import io
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from antgym.errors import MissingExtraError
from antgym.robots.chain import Floats
from antgym.robots.trajectory import Trajectory, rates

POSTURES = 5
Ground = tuple[ArrayLike, ArrayLike, ArrayLike]


def draw(trajectory: Trajectory, title: str = "", ground: Ground | None = None) -> bytes:
    """Return a PNG.

    Args:
        trajectory: what is shown.
        title: above it.
        ground: (n, m) x, y, z in metres in the base frame, of a surface to draw below the path; none by default.

    Raises:
        MissingExtraError: if matplotlib is not installed.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise MissingExtraError("matplotlib", "viz") from None
    figure: Any = Figure(figsize=(12, 6), layout="constrained")
    left, right = figure.subfigures(1, 2, width_ratios=(1, 1))
    _draw_arm(left.add_subplot(projection="3d"), trajectory, ground)
    angles, busy = right.subplots(2, 1, sharex=True)
    _draw_joints(angles, busy, trajectory)
    figure.suptitle(title)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=110)
    return buffer.getvalue()


def _draw_arm(axes: Any, trajectory: Trajectory, ground: Ground | None) -> None:
    """Draw the arm at some moments, equally far apart in time, the path, and the ground."""
    moments = np.linspace(0, trajectory.seconds, POSTURES)
    shown = np.searchsorted(trajectory.times, moments).clip(max=len(trajectory.times) - 1)
    links = trajectory.arm.chain.frames(trajectory.joints[shown])[:, :, :3, 3]
    drawn = [links.reshape(-1, 3), trajectory.points]
    if ground is not None:
        surface = [np.asarray(part, dtype=np.float64) for part in ground]
        axes.plot_surface(*surface, color="tan", alpha=0.5, linewidth=0)
        drawn.append(np.stack(surface, axis=-1).reshape(-1, 3))
    for i, posture in enumerate(links):
        axes.plot(*posture.T, color="steelblue", marker="o", ms=3, lw=3, alpha=0.35 + 0.65 * i / POSTURES)
    axes.plot(*trajectory.points.T, color="crimson", lw=2)
    low, high = _box(np.concatenate(drawn))
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]", box_aspect=high - low)
    axes.locator_params(nbins=4)
    axes.view_init(elev=22, azim=-60)


def _draw_joints(angles: Any, busy: Any, trajectory: Trajectory) -> None:
    """Draw all angles within their limits, and speeds as a share of theirs."""
    arm, middles = trajectory.arm, (trajectory.times[:-1] + trajectory.times[1:]) / 2
    speeds = (trajectory.speeds[:-1] + trajectory.speeds[1:]) / 2
    shares = rates(trajectory.points, trajectory.joints) * speeds[:, None] / arm.speeds
    low, high = arm.limits.T
    for joint in range(arm.joints):
        name = f"joint {joint + 1}, {np.degrees(low[joint]):.0f} to {np.degrees(high[joint]):.0f}°"
        angles.plot(trajectory.times, np.degrees(trajectory.joints[:, joint]), label=name)
        busy.plot(middles, 100 * shares[:, joint])
    angles.set(ylabel="angle [°]")
    angles.legend(fontsize="small", loc="center left", bbox_to_anchor=(1, 0.5))
    busy.set(ylabel="speed [% of limit]", xlabel="time [s]")


def _box(points: Floats) -> tuple[Floats, Floats]:
    """Return the corners of a box around points and the base, no side of it shorter than half the longest."""
    low, high = np.minimum(points.min(axis=0), 0.0), np.maximum(points.max(axis=0), 0.0)
    sides = np.maximum(high - low, (high - low).max() / 2) * 1.05
    middle = (low + high) / 2
    return middle - sides / 2, middle + sides / 2
