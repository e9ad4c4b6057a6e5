"""The 4-axis palletizer of wei2018: base, two arms on a parallelogram, wrist; forward chain, inverse, singularities.

The paper's rows (0, 90°, l₁), (l₂, 0, 0), (l₃, 0, 0) end at the wrist, and its position is the paper's (6). The
parallelogram is a fourth row that turns by -(θ₂ + θ₃), so that the tool always points straight down; the wrist is the
fifth. The inverse is ours. The tool's yaw is θ₁ + θ₄, so the wrist makes up for what the base turns: θ₄ = yaw - θ₁.
"""

import numpy as np

from antgym.errors import ParameterError
from antgym.robots.chain import Chain, Floats

SINGULARITIES = ("shoulder", "elbow")
UPRIGHT = 1e-9  # how far the tool's axis may be from straight down, as 1 - cosine
STRAIGHT = 1e-12  # a cosine this far above 1 is one that rounding pushed there


def chain_of(height: float, upper: float, forearm: float) -> Chain:
    """Return the chain of a palletizer; joints are θ₁ … θ₄, positive θ₂ lifts the upper arm from the horizontal.

    Args:
        height: l₁, the shoulder's above the base, metres.
        upper: l₂, from shoulder to elbow, metres.
        forearm: l₃, from elbow to wrist, metres.

    Raises:
        ParameterError: if a length is not finite, or an arm's not positive.
    """
    if not (np.isfinite([height, upper, forearm]).all() and upper > 0 and forearm > 0):
        raise ParameterError(
            f"l₁, l₂, l₃ = {height}, {upper}, {forearm}: lengths in metres, of the arms above 0"
        )
    right, coupling = np.pi / 2, np.zeros((5, 4))
    coupling[0, 0] = coupling[1, 1] = coupling[2, 2] = 1.0
    coupling[3, 1:3], coupling[4, 3] = (
        -1.0,
        -1.0,
    )  # the wrist's axis points down, its angle counts as the base's does
    return Chain(
        [0, upper, forearm, 0, 0], [right, 0, 0, right, 0], [height, 0, 0, 0, 0], coupling, np.zeros(5)
    )


def inverse(chain: Chain, poses: Floats) -> Floats:
    """Return the joint angles that reach poses with the base turned to them, limits ignored.

    Args:
        chain: the arm.
        poses: (m, 4, 4) of the tool in the base frame.

    Returns:
        (m, 2, 4) radians in (-π, π], elbow below and above the line from shoulder to wrist; NaN where out of reach, or
        where the tool does not point straight down.
    """
    upper, forearm = chain.a[1], chain.a[2]
    x, y, z = poses[:, :3, 3].T
    out, up = np.hypot(x, y), z - chain.d[0]
    cosine = (out * out + up * up - upper * upper - forearm * forearm) / (2 * upper * forearm)
    reached = (np.abs(cosine) <= 1 + STRAIGHT) & (poses[:, 2, 2] <= UPRIGHT - 1)
    third = np.arccos(np.where(reached, np.clip(cosine, -1, 1), np.nan))[:, None] * np.array([1.0, -1.0])
    second = np.arctan2(up, out)[:, None] - np.arctan2(
        forearm * np.sin(third), upper + forearm * np.cos(third)
    )
    first = np.broadcast_to(np.arctan2(y, x)[:, None], third.shape)
    yaw = np.arctan2(poses[:, 1, 0], poses[:, 0, 0])[:, None]
    q = np.stack([first, second, third, yaw - first], axis=-1)
    q[~reached] = np.nan
    return np.pi - np.remainder(np.pi - q, 2 * np.pi)


def margins(chain: Chain, q: Floats) -> Floats:
    """Return how far joints are from the two singularities, each in [0, 1], in the order of ``SINGULARITIES``.

    The wrist's distance from axis 1 over the longest there is, and the sine of the elbow's angle; 0 is singular.

    Args:
        chain: the arm.
        q: (..., 4) radians.
    """
    upper, forearm = chain.a[1], chain.a[2]
    out = upper * np.cos(q[..., 1]) + forearm * np.cos(q[..., 1] + q[..., 2])
    return np.abs(np.stack([out / (upper + forearm), np.sin(q[..., 2])], axis=-1))
