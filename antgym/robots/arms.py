"""Arms: a chain with joint limits, joint speeds and a closed-form inverse, by name."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from itertools import product

import numpy as np
from numpy.typing import ArrayLike

from antgym.errors import ParameterError, nearest
from antgym.robots import palletizer, spherical
from antgym.robots.chain import Chain, Floats

ROUNDING = 1e-9  # radians past a limit that a closed form may be off by
ORTHONORMAL = 1e-6  # what a rotation may be off by
TURN = 2 * np.pi


@dataclass(frozen=True, eq=False)
class Arm:
    """An arm whose inverse kinematics has a closed form.

    Attributes:
        name: how commands call it.
        chain: its Denavit–Hartenberg rows.
        limits: (n, 2) lowest and highest angle of every joint, radians.
        speeds: (n,) the fastest that every joint turns, radians per second.
        singularities: their names.
        reach: what a pose must be like to be reached, in words; ends an error message.
        invert: (m, 4, 4) poses → (m, b, n) angles of every branch in (-π, π], NaN where one does not exist.
        measure: (..., n) angles → (..., s) how far each singularity is, in [0, 1], 0 being singular.
    """

    name: str
    chain: Chain = field(repr=False)
    limits: Floats = field(repr=False)
    speeds: Floats = field(repr=False)
    singularities: tuple[str, ...]
    reach: str
    invert: Callable[[Floats], Floats] = field(repr=False)
    measure: Callable[[Floats], Floats] = field(repr=False)

    @property
    def joints(self) -> int:
        """Number of joints."""
        return self.chain.joints

    def forward(self, q: ArrayLike) -> Floats:
        """Return the pose of the tool, (..., 4, 4) in the base frame, metres, of (..., n) angles."""
        return self.chain.forward(q)

    def margins(self, q: ArrayLike) -> Floats:
        """Return how far (..., n) angles are from each of ``singularities``, (..., s) in [0, 1], 0 being singular."""
        return self.measure(np.asarray(q, dtype=np.float64))

    def branches(self, poses: ArrayLike) -> Floats:
        """Return the angles of every branch of the inverse, limits ignored.

        Args:
            poses: (m, 4, 4), or (4, 4) for one, of the tool in the base frame; the rotation orthonormal.

        Returns:
            (m, b, n) radians in (-π, π], NaN where a branch does not exist.

        Raises:
            ParameterError: if these are no poses.
        """
        return self.invert(_checked_poses(poses))

    def solutions(self, poses: ArrayLike) -> list[Floats]:
        """Return, for every pose, all (c, n) angles within the limits that reach it, whole turns of a joint included.

        Poses and errors as in ``branches``; c is 0 where there are none.
        """
        branches, turns = self.branches(poses), self._turns()
        turned = (branches[:, :, None, :] + turns).reshape(len(branches), -1, self.joints)
        low, high = self.limits.T
        within = ((turned >= low - ROUNDING) & (turned <= high + ROUNDING)).all(axis=2)
        return [np.clip(turned[i, kept], low, high) for i, kept in enumerate(within)]

    def excess(self, poses: ArrayLike) -> Floats:
        """Return how far every branch, turned as suits best, leaves the limits.

        Returns:
            (m, b, n) radians, 0 within the limits, negative below, positive above them; NaN as in ``branches``.
        """
        turned = self.branches(poses)[..., None] + self._whole_turns()
        low, high = self.limits[:, :1], self.limits[:, 1:]
        over = np.maximum(turned - high, 0) + np.minimum(turned - low, 0)
        best = np.abs(over).argmin(axis=-1)  # a NaN is the least of all, and they are all or none
        return np.take_along_axis(over, best[..., None], axis=-1)[..., 0]

    def _turns(self) -> Floats:
        """Return (t, n) whole turns that lead from (-π, π] to other angles within the limits."""
        turns = self._whole_turns()
        fits = (turns - np.pi < self.limits[:, 1:]) & (self.limits[:, :1] < turns + np.pi)
        return np.array(list(product(*(turns[some] for some in fits))), dtype=np.float64)

    def _whole_turns(self) -> Floats:
        """Return the whole turns that some joint may make, radians."""
        most = np.ceil(np.abs(self.limits).max() / TURN)
        return np.asarray(TURN * np.arange(-most, most + 1))


def lr_mate_200id() -> Arm:
    """Return the FANUC LR Mate 200iD: six joints, spherical wrist.

    Geometry, limits and speeds are those of ROS-Industrial's description (fanuc_lrmate200id_support, BSD), and so are
    zero and sign of the joints, its base_link and its tool0: joint 3 counts from the upper arm, not as on FANUC's own
    pendant from the horizontal.
    """
    right = np.pi / 2
    chain = Chain(
        a=[0.05, 0.33, 0.035, 0, 0, 0],
        alpha=[-right, 0, -right, right, -right, 0],
        d=[0.33, 0, 0, 0.335, 0, 0.08],
        coupling=[1, 1, -1, -1, -1, -1],
        offset=[0, -right, 0, 0, 0, 0],
    )
    return Arm(
        "lr_mate_200id",
        chain,
        np.radians([(-170, 170), (-100, 145), (-70, 205), (-190, 190), (-125, 125), (-360, 360)]),
        np.radians([450, 380, 520, 550, 545, 1000]),
        spherical.SINGULARITIES,
        f"its wrist, {chain.d[5]:g} m behind the tool, reaches {spherical.reach(chain):.3f} m from axis 2",
        partial(spherical.inverse, chain),
        partial(spherical.margins, chain),
    )


def wei2018_palletizer(height: float = 0.8, upper: float = 1.0, forearm: float = 1.0) -> Arm:
    """Return the 4-axis palletizer of wei2018: base, upper arm, forearm, wrist.

    The paper gives no numbers: the default lengths, the limits and the speeds are ours, of the size that such machines
    have.

    Args:
        height: l₁, metres.
        upper: l₂, metres.
        forearm: l₃, metres.

    Raises:
        ParameterError: if a length is not finite, or an arm's not positive.
    """
    chain = palletizer.chain_of(height, upper, forearm)
    return Arm(
        "wei2018_palletizer",
        chain,
        np.radians([(-165, 165), (-45, 135), (-150, 150), (-360, 360)]),
        np.radians([130, 110, 130, 350]),
        palletizer.SINGULARITIES,
        f"its wrist reaches {upper + forearm:g} m from axis 2, and its tool points straight down",
        partial(palletizer.inverse, chain),
        partial(palletizer.margins, chain),
    )


ARMS: dict[str, Callable[[], Arm]] = {
    "lr_mate_200id": lr_mate_200id,
    "wei2018_palletizer": wei2018_palletizer,
}


def find_arm(name: str) -> Arm:
    """Return an arm by name; ParameterError with the valid ones where there is none."""
    if name not in ARMS:
        raise ParameterError(f"unknown arm {name!r}; {nearest(name, tuple(ARMS))}")
    return ARMS[name]()


def _checked_poses(poses: ArrayLike) -> Floats:
    array = np.asarray(poses, dtype=np.float64)
    array = array[None] if array.ndim == 2 else array
    if array.ndim != 3 or array.shape[1:] != (4, 4) or not np.isfinite(array).all():
        raise ParameterError(f"poses are (m, 4, 4) finite transforms in metres, got shape {array.shape}")
    turned = array[:, :3, :3]
    square = np.abs(turned @ np.swapaxes(turned, 1, 2) - np.eye(3)).max(initial=0.0) < ORTHONORMAL
    if not (square and (np.linalg.det(turned) > 0).all()):
        raise ParameterError(
            "a pose's rotation has no three unit vectors at right angles, right-handed, as columns"
        )
    return array
