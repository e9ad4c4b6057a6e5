"""The greedy order of settings: each next one helps most where those before it do badly."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def greedy_portfolio(regrets: Floats, size: int | None = None, weights: Floats | None = None) -> list[int]:
    """Return settings in the order in which each most reduces the mean over maps of the portfolio's best regret.

    The gain is submodular, so the first m settings reach at least 1 - 1/e of what the best m would gain. Settings
    that gain nothing any more follow by their own mean regret.

    Args:
        regrets: (n, k) regret of setting j on map i.
        size: how many to return; all where None.
        weights: (n,) weights of the maps, adding up to 1; all alike where None.
    """
    shares = np.full(len(regrets), 1 / len(regrets)) if weights is None else weights
    best = np.full(len(regrets), np.finfo(float).max)
    order: list[int] = []
    means = shares @ regrets
    for _ in range(regrets.shape[1] if size is None else min(size, regrets.shape[1])):
        together = shares @ np.minimum(best[:, None], regrets)
        together[order] = np.inf
        order.append(int(np.lexsort((means, together))[0]))
        best = np.minimum(best, regrets[:, order[-1]])
    return order
