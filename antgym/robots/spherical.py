"""Six joints with a spherical wrist: the closed-form inverse, up to eight branches, and where it is singular.

For chains of the form of the FANUC LR Mate: α = (-90°, 0, -90°, 90°, -90°, 0), offset -90° on the second row, and only
a₁, a₂, a₃, d₁, d₄, d₆ not zero. The wrist's axes meet in one point, which the first three joints place, so position and
orientation are solved one after the other (Pieper 1968).
"""

import numpy as np

from antgym.robots.chain import Chain, Floats

SINGULARITIES = ("shoulder", "elbow", "wrist")
STRAIGHT = 1e-12  # a cosine this far above 1 is one that rounding pushed there
AXES_MEET = 1e-12  # the sine of θ₅ below which the axes 4 and 6 count as one


def inverse(chain: Chain, poses: Floats) -> Floats:
    """Return all joint angles that reach poses, limits ignored.

    Args:
        chain: the arm.
        poses: (m, 4, 4) of the tool in the base frame.

    Returns:
        (m, 8, 6) radians in (-π, π], NaN where a branch does not exist: first the four with the wrist one way, shoulder
        and elbow in turn, then the same with the wrist flipped. Where the axes 4 and 6 coincide any split between them
        would do; joint 4 then takes the whole of 0 or 180°.
    """
    arms = _arm_angles(chain, poses[:, :3, 3] - chain.d[5] * poses[:, :3, 2])
    theta = np.empty((len(poses), 8, 6))
    theta[:, :4, :3] = theta[:, 4:, :3] = arms
    theta[:, :4, 3:], theta[:, 4:, 3:] = _wrist_angles(_turned(arms), poses[:, None, :3, :3])
    q = (theta - chain.offset) @ np.linalg.inv(chain.coupling).T
    return np.pi - np.remainder(np.pi - q, 2 * np.pi)


def margins(chain: Chain, q: Floats) -> Floats:
    """Return how far joints are from the three singularities, each in [0, 1], in the order of ``SINGULARITIES``.

    The shares of the whole that the determinant of the Jacobian is made of: the distance of the wrist from axis 1
    over the longest there is, the sine of the elbow's angle, the sine of θ₅. 0 is singular.

    Args:
        chain: the arm.
        q: (..., 6) radians.
    """
    theta = q @ chain.coupling.T + chain.offset
    forearm, bend = _forearm(chain)
    out = chain.a[0] + chain.a[1] * np.cos(theta[..., 1])
    out = out + forearm * np.cos(theta[..., 1] + theta[..., 2] + bend)
    shares = (out / (chain.a[0] + chain.a[1] + forearm), np.sin(theta[..., 2] + bend), np.sin(theta[..., 4]))
    return np.abs(np.stack(shares, axis=-1))


def reach(chain: Chain) -> float:
    """Return how far from the shoulder, axis 2, the wrist centre can be, in metres."""
    return float(chain.a[1]) + _forearm(chain)[0]


def _forearm(chain: Chain) -> tuple[float, float]:
    """Return the length from elbow to wrist centre, and its angle to the third row's x axis."""
    return float(np.hypot(chain.a[2], chain.d[3])), float(np.arctan2(chain.d[3], chain.a[2]))


def _arm_angles(chain: Chain, wrist: Floats) -> Floats:
    """Return (m, 4, 3) angles θ₁ θ₂ θ₃ that put the wrist centre at (m, 3) points."""
    upper, (forearm, bend) = chain.a[1], _forearm(chain)
    facing = np.arctan2(wrist[:, 1], wrist[:, 0])
    away = np.hypot(wrist[:, 0], wrist[:, 1])
    first = np.stack([facing, facing + np.pi], axis=1)
    out = np.stack([away, -away], axis=1) - chain.a[0]
    down = (chain.d[0] - wrist[:, 2])[:, None]
    cosine = (out * out + down * down - upper * upper - forearm * forearm) / (2 * upper * forearm)
    cosine = np.where(np.abs(cosine) <= 1 + STRAIGHT, np.clip(cosine, -1, 1), np.nan)
    elbow = np.arccos(cosine)[:, :, None] * np.array([1.0, -1.0])
    second = np.arctan2(down, out)[:, :, None] - np.arctan2(
        forearm * np.sin(elbow), upper + forearm * np.cos(elbow)
    )
    first = np.broadcast_to(first[:, :, None], elbow.shape)
    return np.stack([first, second, elbow - bend], axis=-1).reshape(-1, 4, 3)


def _turned(arms: Floats) -> Floats:
    """Return (m, 4, 3, 3): how (m, 4, 3) angles turn the third frame."""
    (c1, s1), (c, s) = (
        (np.cos(angle), np.sin(angle)) for angle in (arms[..., 0], arms[..., 1] + arms[..., 2])
    )
    nought = np.zeros_like(c)
    rows = ((c1 * c, s1, -c1 * s), (s1 * c, -c1, -s1 * s), (-s, nought, -c))
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def _wrist_angles(third: Floats, tool: Floats) -> tuple[Floats, Floats]:
    """Return (m, 4, 3) angles θ₄ θ₅ θ₆ between the third frame and the tool, and those of the flipped wrist.

    The wrist is Rz(θ₄) · Ry(-θ₅) · Rz(θ₆).
    """
    wrist = np.swapaxes(third, -1, -2) @ tool
    sine = np.hypot(wrist[..., 0, 2], wrist[..., 1, 2])
    meet = sine < AXES_MEET
    fourth = np.where(meet, 0.0, np.arctan2(wrist[..., 1, 2], wrist[..., 0, 2]))
    fifth = -np.arctan2(sine, wrist[..., 2, 2])
    sixth = np.where(
        meet,
        np.arctan2(wrist[..., 1, 0], wrist[..., 1, 1]),
        np.arctan2(wrist[..., 2, 1], -wrist[..., 2, 0]),
    )
    one = np.stack([fourth, fifth, sixth], axis=-1)
    return one, np.stack([fourth + np.pi, -fifth, sixth + np.pi], axis=-1)
