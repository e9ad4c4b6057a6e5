"""Branches: which solution of the inverse an arm takes at every sample, so that it moves least and never jumps."""

import numpy as np

from antgym.errors import ReachError
from antgym.robots.arms import Arm
from antgym.robots.chain import Floats

TOLERANCE = 1e-4  # metres that the tool may leave the path half-way between two samples
LARGEST_STEP = 0.5  # radians that a joint may turn between two samples
HAIR = 1e-9  # radians of motion that a radian away from 0 at the start counts for: it only decides between equals


def least_motion(arm: Arm, points: Floats, choices: list[Floats]) -> Floats:
    """Return the angles, one of the choices at every sample, that move the arm least: a shortest path over them.

    What nearest-first would do is not enough: a branch that begins well may run into a joint's limit.

    Args:
        arm: whose angles they are.
        points: (n, 3) metres, where the tool is at every sample.
        choices: n arrays (c, j) of angles that put it there, none empty.

    Returns:
        (n, j) radians, of least sum of the steps' Euclidean norms; of equals, the one that begins nearest to 0.

    Raises:
        ReachError: if no choice leads from one sample to the next.
    """
    total, before = HAIR * np.linalg.norm(choices[0], axis=1), []
    for i in range(1, len(points)):
        reached = total[:, None] + _motion(arm, choices[i - 1], choices[i], (points[i - 1] + points[i]) / 2)
        if not np.isfinite(reached).any():
            raise ReachError(_broken(arm, choices[i - 1][np.isfinite(total)], choices[i], points[i]))
        before.append(reached.argmin(axis=0))
        total = reached.min(axis=0)
    picked = [int(total.argmin())]
    for came_from in reversed(before):
        picked.append(int(came_from[picked[-1]]))
    return np.stack([angles[k] for angles, k in zip(choices, reversed(picked), strict=True)])


def deviation(arm: Arm, here: Floats, there: Floats, middle: Floats) -> Floats:
    """Return how far the tool is from points half-way between (m, j) and (m, j) angles, (m,) metres."""
    return np.asarray(np.linalg.norm(arm.forward((here + there) / 2)[:, :3, 3] - middle, axis=1))


def _motion(arm: Arm, here: Floats, there: Floats, middle: Floats) -> Floats:
    """Return what each pair of (a, j) and (b, j) angles moves, (a, b).

    inf where a joint would turn too far at once or the tool would leave the path: there the branches are not joined.
    """
    apart = there[None] - here[:, None]
    joined = np.abs(apart).max(axis=2) <= LARGEST_STEP
    a, b = np.nonzero(joined)
    joined[a, b] = deviation(arm, here[a], there[b], middle) <= TOLERANCE
    return np.where(joined, np.linalg.norm(apart, axis=2), np.inf)


def _broken(arm: Arm, here: Floats, there: Floats, point: Floats) -> str:
    """Return what to say where no branch leads on."""
    turned = np.degrees(np.abs(there[None] - here[:, None]).max(axis=2).min())
    return (
        f"{arm.name} has no continuous motion to ({', '.join(f'{c:.4g}' for c in point)}) m: some joint would turn "
        f"{turned:.3g}° or more at once, or the tool leave the path by over {TOLERANCE * 1e3:g} mm; sample more "
        "densely (spacing, --spacing), move the base or the map (at, --at), or hold the tool another way"
    )
