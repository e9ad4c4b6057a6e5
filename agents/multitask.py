"""A multi-task Gaussian process: what settings cost on a new map, learnt from what they cost on all train maps.

Regrets on a map are one draw of a process whose covariance is a product, likeness of maps × likeness of settings
(Bonilla et al. 2008). The first factor is a kernel over features, fitted by marginal likelihood; the second is what the
train maps show, with no shape assumed (as in pre-trained processes: Wang et al. 2024, arXiv 2109.08215).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from agents.experience import RULE, Experience
from antgym.tuning import Task

Floats = NDArray[np.float64]
ELL, JITTER = 0.2, 0.3
"""Width in the unit cube, and relative noise, by which tables are smoothed over settings. Chosen on the 400 train maps
of open-v0, each left out in turn: the best predicted setting lost 12.3 % to the map's best, 13.0 % unsmoothed."""
START = 0.15  # of every feature's inverse length, in standard deviations of the train maps, and where its prior peaks
PRIOR = 0.01  # weight of that prior, per setting, on squared logs
MAPS = 3  # that the smooth prior of the covariance between settings is worth
MOST = 400  # maps that the kernel is fitted to: the time is cubic in them
LOGS, OWN = (-6.0, 4.0), (-2.0, 4.0)  # of what is fitted; a map is never quite what others promise
DECIMALS = 2  # of fitted logs: the last bits differ between machines, and must not decide a trial


class MapKernel(NamedTuple):
    """How alike two maps are: logs of what is fitted, all scalars but the first.

    Attributes:
        scales: (f,) inverse lengths of the features.
        shared: share of the likeness that maps under different rules keep, as a logit.
        near: variance of what changes with the features.
        rules: variance of what all maps under the same rules have in common.
        common: variance of what all maps have in common.
        own: variance of what a map has with no other.
    """

    scales: Floats
    shared: float
    near: float
    rules: float
    common: float
    own: float

    @classmethod
    def of(cls, flat: Floats) -> "MapKernel":
        """Return the kernel of a flat vector, (f + 5,)."""
        return cls(flat[:-5], *flat[-5:].tolist())

    def parts(self, a: Floats, b: Floats, same: Floats) -> tuple[Floats, Floats]:
        """Return likeness by features and by rules, (n, m) both; see :meth:`__call__`."""
        left, right = a * np.exp(self.scales), b * np.exp(self.scales)
        squares = (left**2).sum(axis=1)[:, None] + (right**2).sum(axis=1) - 2 * left @ right.T
        shared = 1 / (1 + np.exp(-self.shared))
        return np.exp(-np.maximum(squares, 0.0) / 2), shared + (1 - shared) * same

    def __call__(self, a: Floats, b: Floats, same: Floats) -> Floats:
        """Return the covariances of maps a, (n, f), and b, (m, f); ``same``, (n, m), is 1 where rules are the same."""
        features, rules = self.parts(a, b, same)
        return np.exp(self.near) * features * rules + np.exp(self.rules) * same + np.exp(self.common)


class Prediction(NamedTuple):
    """What is expected of s settings on a map, before any run there.

    Attributes:
        mean: (s + 1,) log regrets of the settings, and last the log cost of the map's best.
        covariance: (s + 1, s + 1).
        noise: (s,) variance of the log cost of a run.
    """

    mean: Floats
    covariance: Floats
    noise: Floats


class MultitaskModel:
    """The process, fitted to an experience; always alike, so that the artefact holds data and no fit.

    Args:
        experience: costs on n train maps.
    """

    def __init__(self, experience: Experience) -> None:
        self.experience = experience
        described = experience.described_maps
        rules = [name.startswith(RULE) for name in experience.described]
        self._rules = np.flatnonzero(rules)
        self._columns = np.flatnonzero(~np.array(rules) & (described.std(axis=0) > 0))
        self._maps = described[:, self._columns]
        self._kinds = self._kind(np.array(experience.features))
        same, some = self._same(self._kinds), slice(None, None, -(-len(described) // MOST))
        self.kernel = _fit(experience.regrets[some], self._maps[some], same[some, some])
        own = np.exp(self.kernel.own) * np.eye(len(same))
        self._precision = np.linalg.inv(self.kernel(self._maps, self._maps, same) + own)
        settings, shown = experience.settings, self._shown()
        self._smoother = np.linalg.inv(_alike(settings, settings) + JITTER * np.eye(len(settings)))
        self._solved = self._precision @ shown
        self._scatter = shown.T @ self._solved

    def predict(self, task: Task, units: Floats) -> Prediction:
        """Return what is expected of settings, (s, d) in [0, 1], on a task; ParameterError where it does not fit."""
        likeness = self._likeness(task)
        variance = np.exp(self.kernel[2:]).sum() - likeness @ self._precision @ likeness
        mean = self._mean(likeness, units)
        return Prediction(mean, variance * self._between(units), self._noise(units, likeness))

    def expect(self, task: Task, units: Floats) -> Floats:
        """Return the expected log regrets of settings alone, (s,); see :meth:`predict`."""
        return self._mean(self._likeness(task), units)[:-1]

    def _likeness(self, task: Task) -> Floats:
        """Return the covariance of a task with every train map, (n,)."""
        self.experience.check(task)
        features = task.features.astype(np.float64)
        here = self.experience.standardise(features)[None, self._columns]
        return self.kernel(self._maps, here, self._same(self._kind(features[None])))[:, 0]

    def _mean(self, likeness: Floats, units: Floats) -> Floats:
        mean: Floats = likeness @ self._solved @ self._spread(units)
        mean[-1] += self.experience.lowest.mean()
        return mean

    def _between(self, units: Floats) -> Floats:
        """Return the covariance between settings, and last the level: what the train maps show, and a smooth prior.

        The mean of an inverse Wishart posterior. Alone, n maps show nothing outside the n shapes that they have.
        """
        spread, n = self._spread(units), len(self._maps)
        shown = spread.T @ self._scatter @ spread
        smooth = np.eye(len(shown)) * shown[-1, -1]
        smooth[:-1, :-1] = _alike(units, units) * np.diag(shown)[:-1].mean()
        return (shown + MAPS * smooth / n) / (n + MAPS)

    def _kind(self, features: Floats) -> NDArray[np.int64]:
        """Return a number for the rules that features show, (n,); rules of one's own show as none."""
        return (features[:, self._rules] > 0.5).astype(np.int64) @ (1 << np.arange(len(self._rules)))

    def _same(self, kinds: NDArray[np.int64]) -> Floats:
        """Return (n, m), 1 where a train map has the rules of a kind, (m,)."""
        return (self._kinds[:, None] == kinds).astype(np.float64)

    def _shown(self) -> Floats:
        """Return log regrets about the map's mean, the mean, and the level about all maps' mean, (n, k + 2)."""
        regrets, level = self.experience.regrets, self.experience.lowest
        mean = regrets.mean(axis=1, keepdims=True)
        return np.hstack([regrets - mean, mean, (level - level.mean())[:, None]])

    def _spread(self, units: Floats) -> Floats:
        """Return what makes of :meth:`_shown` smoothed log regrets of settings, and last the level, (k + 2, s + 1)."""
        k = len(self._smoother)
        spread = np.zeros((k + 2, len(units) + 1))
        spread[:k, :-1] = self._smoother @ _alike(self.experience.settings, units)
        spread[k, :-1] = spread[k + 1, -1] = 1.0
        return spread

    def _noise(self, units: Floats, likeness: Floats) -> Floats:
        near = _alike(self.experience.settings, units)
        variances = likeness @ self.experience.variances / likeness.sum()
        return np.maximum(variances @ near / near.sum(axis=0), 1e-4)


def _alike(a: Floats, b: Floats) -> Floats:
    """Return the likeness of settings, (k, s) in (0, 1]."""
    return np.exp(-((a[:, None] - b[None]) ** 2).sum(axis=2) / (2 * ELL**2))


def _fit(regrets: Floats, maps: Floats, same: Floats) -> MapKernel:
    """Return the kernel of the largest marginal likelihood, settings taken as independent draws."""
    from scipy.optimize import minimize

    values = regrets / max(float(regrets.std()), 1e-12)
    start = np.concatenate([np.full(maps.shape[1], np.log(START)), [0.0, -1.0, -1.0, -2.0, -0.5]])
    options = {"maxiter": 150}
    found = minimize(
        _loss,
        start,
        (values, maps, same),
        "L-BFGS-B",
        True,
        bounds=[*[LOGS] * (len(start) - 1), OWN],
        options=options,
    )
    return MapKernel.of(np.round(found.x, DECIMALS))


def _loss(flat: Floats, values: Floats, maps: Floats, same: Floats) -> tuple[float, Floats]:
    """Return minus the log marginal likelihood and prior, but for constants, and its gradient."""
    kernel, (n, settings) = MapKernel.of(flat), values.shape
    features, rules = kernel.parts(maps, maps, same)
    own = np.exp(kernel.own)
    covariance = kernel(maps, maps, same) + own * np.eye(n)
    precision = np.linalg.inv(covariance)
    solved = precision @ values
    outer = (settings * precision - solved @ solved.T) / 2
    away, weight = kernel.scales - np.log(START), PRIOR * settings
    loss = settings * np.linalg.slogdet(covariance)[1] / 2 + (values * solved).sum() / 2
    near = outer * np.exp(kernel.near) * features
    shared = 1 / (1 + np.exp(-kernel.shared))
    pulled = near * rules
    moved = (maps**2 * pulled.sum(axis=1)[:, None]).sum(axis=0) - (maps * (pulled @ maps)).sum(axis=0)
    gradient = np.concatenate(
        [
            2 * weight * away - 2 * moved * np.exp(2 * kernel.scales),
            [
                (near * (1 - same)).sum() * shared * (1 - shared),
                pulled.sum(),
                (outer * same).sum() * np.exp(kernel.rules),
                outer.sum() * np.exp(kernel.common),
                np.trace(outer) * own,
            ],
        ]
    )
    return float(loss + weight * (away**2).sum()), gradient
