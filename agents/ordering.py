"""The greedy order of settings: each next one helps most where those before it do badly."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def greedy_portfolio(regrets: Floats, size: int | None = None) -> list[int]:
    """Return settings in the order in which each most reduces the mean over maps of the portfolio's best regret.

    The gain is submodular, so the first m settings reach at least 1 - 1/e of what the best m would gain. Settings
    that gain nothing any more follow by their own mean regret.

    Args:
        regrets: (n, k) regret of setting j on map i.
        size: how many to return; all where None.
    """
    best = np.full(len(regrets), np.inf)
    order: list[int] = []
    means = regrets.mean(axis=0)
    for _ in range(regrets.shape[1] if size is None else min(size, regrets.shape[1])):
        together = np.minimum(best[:, None], regrets).mean(axis=0)
        together[order] = np.inf
        order.append(int(np.lexsort((means, together))[0]))
        best = np.minimum(best, regrets[:, order[-1]])
    return order
