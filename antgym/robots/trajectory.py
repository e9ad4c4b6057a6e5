"""Trajectories: the angles of an arm's joints over time, and what they ask of it."""

from dataclasses import dataclass, field

import numpy as np

from antgym.robots.arms import Arm
from antgym.robots.chain import Floats


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Joint angles over time; between two samples all joints turn together, in proportion.

    Attributes:
        arm: whose joints they are.
        times: (n,) seconds, from 0.
        joints: (n, j) radians, within the arm's limits.
        points: (n, 3) metres in the base frame, where the tool is.
        speeds: (n,) metres per second of the tool; 0 at both ends.
        deviation: metres that the tool is from the path half-way between two samples, at most.
        margin: the nearest that it comes to a singularity, in (0, 1].
    """

    arm: Arm
    times: Floats = field(repr=False)
    joints: Floats = field(repr=False)
    points: Floats = field(repr=False)
    speeds: Floats = field(repr=False)
    deviation: float
    margin: float

    @property
    def seconds(self) -> float:
        """How long it takes."""
        return float(self.times[-1])

    @property
    def length(self) -> float:
        """Metres that the tool travels."""
        return float(np.linalg.norm(np.diff(self.points, axis=0), axis=1).sum())

    @property
    def motion(self) -> float:
        """Radians that the joints travel, in the Euclidean norm: what the choice of branches made least."""
        return float(np.linalg.norm(np.diff(self.joints, axis=0), axis=1).sum())

    @property
    def load(self) -> Floats:
        """(j,) the highest speed of every joint over its limit, in [0, 1]."""
        fastest = np.maximum(self.speeds[:-1], self.speeds[1:])[:, None]
        return np.asarray((rates(self.points, self.joints) * fastest / self.arm.speeds).max(axis=0))

    def csv(self) -> str:
        """Return rows of seconds, radians of every joint, and metres of the tool, under a header."""
        names = ["t", *(f"joint_{i + 1}" for i in range(self.arm.joints)), "x", "y", "z"]
        table = np.column_stack([self.times, self.joints, self.points])
        rows = (",".join(map(repr, row)) for row in table.tolist())
        return "\n".join([",".join(names), *rows, ""])


def rates(points: Floats, joints: Floats) -> Floats:
    """Return the (n - 1, j) radians per metre that joints turn on every step."""
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    return np.asarray(np.abs(np.diff(joints, axis=0)) / steps[:, None])
