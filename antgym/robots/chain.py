"""Chains: an arm as Denavit–Hartenberg rows, and where its joint angles put the tool."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antgym.errors import ParameterError

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, init=False)
class Chain:
    """Denavit–Hartenberg rows, each the transform Rz(θ) · Tz(d) · Tx(a) · Rx(α), and what turns them.

    The angles of the rows are ``θ = coupling · q + offset``, q the joints: a joint that counts the other way has a -1
    there, and a row that a parallelogram keeps level has an entry for every joint that it makes up for.

    Args:
        a: (k,) metres.
        alpha: (k,) radians.
        d: (k,) metres.
        coupling: (k, n), or (k,) for a chain in which every row is a joint.
        offset: (k,) radians.
    """

    a: Floats
    alpha: Floats
    d: Floats
    coupling: Floats
    offset: Floats
    _cos: Floats = field(repr=False)
    _sin: Floats = field(repr=False)

    def __init__(
        self, a: ArrayLike, alpha: ArrayLike, d: ArrayLike, coupling: ArrayLike, offset: ArrayLike
    ) -> None:
        turned = np.asarray(coupling, dtype=np.float64)
        coupling = np.diag(turned) if turned.ndim == 1 else turned
        rows = {"a": a, "alpha": alpha, "d": d, "coupling": coupling, "offset": offset}
        rows |= {"_cos": np.cos(alpha), "_sin": np.sin(alpha)}
        for name, values in rows.items():
            array = np.array(values, dtype=np.float64)
            array.setflags(write=False)
            object.__setattr__(self, name, array)

    @property
    def joints(self) -> int:
        """Number of joints."""
        return int(self.coupling.shape[1])

    def frames(self, q: ArrayLike) -> Floats:
        """Return where joints put every frame: (..., k + 1, 4, 4) in the base frame, the base first, the tool last.

        Args:
            q: (..., n) radians, within limits or not.

        Raises:
            ParameterError: if there are not n joints.
        """
        angles = np.asarray(q, dtype=np.float64)
        if angles.ndim == 0 or angles.shape[-1] != self.joints:
            raise ParameterError(f"joint angles of shape {angles.shape}: this arm has {self.joints} joints")
        rows = self._rows(angles @ self.coupling.T + self.offset)
        frames = np.empty((*angles.shape[:-1], len(self.a) + 1, 4, 4))
        frames[..., 0, :, :] = np.eye(4)
        for i in range(len(self.a)):
            frames[..., i + 1, :, :] = frames[..., i, :, :] @ rows[..., i, :, :]
        return frames

    def forward(self, q: ArrayLike) -> Floats:
        """Return the pose of the tool, (..., 4, 4) in the base frame, of (..., n) joints; errors as ``frames``."""
        return self.frames(q)[..., -1, :, :]

    def _rows(self, theta: Floats) -> Floats:
        """Return the (..., k, 4, 4) transform of every row."""
        c, s = np.cos(theta), np.sin(theta)
        rows = np.zeros((*theta.shape, 4, 4))
        rows[..., 0, 0], rows[..., 0, 1], rows[..., 0, 2] = c, -s * self._cos, s * self._sin
        rows[..., 1, 0], rows[..., 1, 1], rows[..., 1, 2] = s, c * self._cos, -c * self._sin
        rows[..., 0, 3], rows[..., 1, 3] = self.a * c, self.a * s
        rows[..., 2, 1], rows[..., 2, 2], rows[..., 2, 3] = self._sin, self._cos, self.d
        rows[..., 3, 3] = 1.0
        return rows
