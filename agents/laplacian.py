"""The mathematics of the parameter-transfer graph: liu2020's eqs 9-14 as printed, and the sound version.

Notation: n source tasks, each with a parameter set of d values; ``costs[i, j]`` is the mean cost of set i on map j.
The printed version compares costs with a reference and lets edges be negative, so its graph Laplacian may be
indefinite; the sound one turns regrets into positive affinities, so its answer is a weighted mean of the sources.
"""

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from antgym.errors import ParameterError

Floats = NDArray[np.float64]
Spectrum = Literal["paper", "abs"]


def transfers(costs: Floats) -> Floats:
    """Return the (n, n) transfers of set i to map j (eq 9).

    Positive where set i beats map j's own set. Not symmetric.
    """
    return 1 - costs / np.diag(costs)


def affinities(transfer: Floats) -> Floats:
    """Return the symmetric (n, n) edge weights: the lower of both directions, 0 on the diagonal (eq 10)."""
    edges = np.minimum(transfer, transfer.T)
    np.fill_diagonal(edges, 0.0)
    return edges


def eq14(affinity: Floats, transfer: Floats, parameters: Floats, mode: Spectrum = "paper") -> Floats:
    """Return the target's parameters (eqs 11-14), with the full basis of eigenvectors.

    In ``"paper"`` mode Λ̂ is taken as printed, negative eigenvalues and all; the answer then equals the
    target row of the solution f of (S + L̂) f = S y, S = diag(1, ..., 1, 0). ``"abs"`` takes |Λ̂|: a variant
    of ours that hides the explosion where the transfers nearly cancel, not the reversal where their sum is
    negative.

    Args:
        affinity: (n, n) edge weights between sources, symmetric, zero diagonal.
        transfer: (n,) transfer of each source to the target.
        parameters: (n, d) parameters of the sources.
        mode: ``"paper"`` or ``"abs"``.

    Raises:
        numpy.linalg.LinAlgError: where the target hangs on no source and nothing determines its parameters.
    """
    if mode not in ("paper", "abs"):
        raise ParameterError(f"unknown mode {mode!r}; valid: paper, abs")
    n = len(transfer)
    values, vectors = np.linalg.eigh(laplacian(_bordered(affinity, transfer)))
    if mode == "abs":
        values = np.abs(values)
    sources = vectors[:n]  # liu2020's Q, not the pheromone constant
    weights = np.linalg.solve(sources.T @ sources + np.diag(values), sources.T @ parameters)
    return vectors[n] @ weights


def paper_weights(affinity: Floats, transfer: Floats, mode: Spectrum = "paper") -> Floats:
    """Return the (n,) weights that :func:`eq14` gives the sources; they add up to 1 and may be negative."""
    return eq14(affinity, transfer, np.eye(len(transfer)), mode)


def relabel(costs: Floats) -> NDArray[np.intp]:
    """Return for each of n maps the index of the set that does best on it, (n,); often not the map's own."""
    return costs.argmin(axis=0)


def regrets(costs: Floats) -> Floats:
    """Return costs over the lowest of their column (or of the vector), minus 1; ≥ 0."""
    return costs / costs.min(axis=0) - 1


def map_affinities(costs: Floats, tau: float) -> Floats:
    """Return the (n, n) edge weights between maps in the sound version, in (0, 1], 0 on the diagonal.

    Every map is labelled with the set that does best on it; two maps are joined by exp(-mean regret / tau), the mean
    over each one's label on the other.

    Args:
        costs: (k, n) mean cost of set i on map j.
        tau: scale of the regrets, > 0.
    """
    regret = regrets(costs)[relabel(costs)]
    edges = np.exp(-(regret + regret.T) / (2 * tau))
    np.fill_diagonal(edges, 0.0)
    return edges


def sound_weights(costs: Floats, target: Floats, tau: float, gamma: float) -> Floats:
    """Return the weights of k sets for a target, (k,): non-negative, adding up to 1.

    Maps are joined as in :func:`map_affinities`, a map and the target by exp(-regret of the map's label on the target
    / tau); the target's value is that of the smoothest function on the graph, (S + gamma L) z = S u. tau → 0 copies
    the best source, tau → ∞ takes the mean of the maps' labels. Of a graph of which only some sets were run on the
    target, hand over their rows alone: every map is then labelled with the best of them.

    Args:
        costs: (k, n) mean cost of set i on map j.
        target: (k,) mean cost of each set on the target.
        tau: scale of the regrets, > 0.
        gamma: weight of smoothness against the sources' own labels, > 0.
    """
    labels, maps = relabel(costs), costs.shape[1]
    towards = np.exp(-regrets(target[labels]) / tau)
    system = gamma * laplacian(_bordered(map_affinities(costs, tau), towards))
    system[np.arange(maps), np.arange(maps)] += 1.0
    row = np.linalg.solve(system, np.eye(maps + 1)[:, :-1])[-1]
    weights = np.zeros(len(target))
    np.add.at(weights, labels, row)  # a set may label several maps
    return weights


def _bordered(affinity: Floats, transfer: Floats) -> Floats:
    """Return the (n + 1, n + 1) edge weights with the target as last vertex (eq 11)."""
    n = len(transfer)
    edges = np.zeros((n + 1, n + 1))
    edges[:n, :n] = affinity
    edges[n, :n] = edges[:n, n] = transfer
    return edges


def laplacian(edges: Floats) -> Floats:
    """Return D - A of a graph's (n, n) edge weights, D the diagonal of their row sums."""
    matrix = -edges
    matrix[np.diag_indices_from(edges)] += edges.sum(axis=1)
    return matrix
