"""``antgym arm``: from the way-points of a file to the joint angles of an arm over time."""

import csv
import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from antgym import plan_file
from antgym.console import write_whole
from antgym.errors import MapError, ParameterError
from antgym.robots import Trajectory, find_arm, follow, place

if TYPE_CHECKING:
    from antgym.commands import ArmFile

AXES = ("x", "y", "z")


def arm_file(command: "ArmFile") -> int:
    """Read the way-points, let the arm follow them, print, write; return 0.

    Raises:
        ReachError: if the arm cannot follow them; it names those that it cannot reach.
        AntgymError: if the file, an option or the place to write to cannot be used.
    """
    if command.out is not None and command.picture:
        plan_file.require_matplotlib()
    arm = find_arm(command.arm)
    points = place(read_points(command.file), command.scale, command.at, math.radians(command.turn))
    trajectory = follow(
        arm,
        points,
        tool=tool_rotation(command.tool),
        spacing=command.spacing,
        margin=command.margin,
        speed=command.speed,
        acceleration=command.acceleration,
    )
    print(report(command, trajectory))
    for path, data in files(command, trajectory).items():
        write_whole(path, data)
        print(f"wrote    {path}")
    return 0


def read_points(file: Path) -> NDArray[np.float64]:
    """Return the (n, 3) way-points of a CSV file with columns x, y, z among others, as ``antgym plan`` writes it.

    Raises:
        MapError: if it is not there, lacks a column, or holds what is no number; it names the line.
    """
    try:
        lines = file.read_text(encoding="utf-8").splitlines()
    except OSError as error:
        raise MapError(f"{file}: {(error.strerror or str(error)).lower()}") from None
    except UnicodeDecodeError:
        raise MapError(f"{file}: not a text file; way-points are a CSV file with columns x, y, z") from None
    rows = csv.DictReader(lines, strict=True)
    points = []
    try:
        if missing := [axis for axis in AXES if axis not in (rows.fieldnames or ())]:
            raise MapError(f"{file}:1: no column {', '.join(missing)}; a header names x, y, z")
        for row in rows:
            points.append([float(row[axis]) for axis in AXES])
    except (csv.Error, TypeError, ValueError) as error:
        if isinstance(error, MapError):
            raise
        raise MapError(f"{file}:{rows.line_num}: a way-point is three numbers, x, y, z") from None
    return np.array(points).reshape(-1, 3)


def tool_rotation(angles: tuple[float, float, float]) -> NDArray[np.float64]:
    """Return the (3, 3) rotation of roll, pitch, yaw in degrees, about the base's x, then y, then z."""
    if not np.isfinite(angles).all():
        raise ParameterError(f"tool = {angles}: roll, pitch and yaw are finite numbers of degrees")
    return np.asarray(Rotation.from_euler("xyz", angles, degrees=True).as_matrix())


def report(command: "ArmFile", trajectory: Trajectory) -> str:
    """Return the lines that the terminal shows."""
    busiest = int(trajectory.load.argmax())
    return (
        f"arm      {trajectory.arm.name}, {trajectory.arm.joints} joints\n"
        f"path     {trajectory.length:.4g} m, {len(trajectory.times)} samples, off by "
        f"{1e3 * trajectory.deviation:.2g} mm at most between two of them\n"
        f"seconds  {trajectory.seconds:.4g}\n"
        f"joints   travel {np.degrees(trajectory.motion):.4g}°; the busiest, joint {busiest + 1}, at "
        f"{trajectory.load[busiest]:.0%} of its speed\n"
        f"margin   {trajectory.margin:.2g} to the nearest singularity, {command.margin:g} asked for"
    )


def files(command: "ArmFile", trajectory: Trajectory) -> dict[Path, bytes]:
    """Return what is written, by path; nothing without ``--out``."""
    if command.out is None:
        return {}
    written = {command.out.with_name(command.out.name + ".csv"): trajectory.csv().encode()}
    if command.picture:
        from antgym.robots.picture import draw

        title = f"{command.file.name}: {trajectory.arm.name}, {trajectory.seconds:.3g} s"
        written[command.out.with_name(command.out.name + ".png")] = draw(trajectory, title)
    return written
