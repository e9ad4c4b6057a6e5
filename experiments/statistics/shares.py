"""Shares of a count, which need no resampling."""

from statistics import NormalDist

import numpy as np

from antgym.errors import AntgymError


def wilson_interval(hits: int, count: int, *, level: float = 0.95) -> tuple[float, float]:
    """Return the (low, high) interval of a share, ``hits`` of ``count`` (Wilson 1927); inside [0, 1] for every count.

    Raises:
        AntgymError: if there is nothing to count, or more hits than that.
    """
    if not 0 <= hits <= count or count < 1:
        raise AntgymError(f"a share needs 0 <= hits <= count and count >= 1, got {hits} of {count}")
    z, share = NormalDist().inv_cdf((1 + level) / 2), hits / count
    centre = share + z * z / (2 * count)
    reach = z * float(np.sqrt(share * (1 - share) / count + (z / (2 * count)) ** 2))
    return max(0.0, (centre - reach) / (1 + z * z / count)), min(1.0, (centre + reach) / (1 + z * z / count))
