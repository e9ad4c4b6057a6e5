"""Fitting a transfer graph: what is run on the sources' maps, in which order, and what it costs."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from agents.judgement import cap_failures
from agents.laplacian import regrets, sound_weights
from antgym.errors import BudgetError, ParameterError
from antgym.tuning import Agent, ParameterSpace, Session

if TYPE_CHECKING:
    from agents.graph import TransferGraph

Floats = NDArray[np.float64]
DEFAULT_TAU, DEFAULT_GAMMA = 0.02, 0.1
TAUS, GAMMAS = (DEFAULT_TAU, 0.01, 0.05, 0.1, 0.3), (DEFAULT_GAMMA, 0.5)
RIVALS = (
    3  # run on a source that is left out: what is transferred, the best of the others, the published default
)


def trials_needed(sources: int, search: int = 32, repeats: int = 5, check: int = 2) -> int:
    """Return the trials that :meth:`TransferGraph.fit` spends in each source's session, at most."""
    left_out = check * len(TAUS) * len(GAMMAS) + RIVALS * repeats if sources >= 3 and check else 0
    return search + repeats * sources + left_out


def check_fit(
    sessions: Sequence[Session], names: Sequence[str] | None, search: int, repeats: int, check: int
) -> None:
    """Raise ParameterError or BudgetError where sessions and numbers do not allow a fit."""
    if not sessions:
        raise ParameterError("a transfer graph needs at least one source session")
    if names is not None and len(names) != len(sessions):
        raise ParameterError(f"{len(names)} names for {len(sessions)} sessions")
    if search < 1 or repeats < 1 or check < 0:
        raise ParameterError(f"search = {search} and repeats = {repeats} must be ≥ 1, check = {check} ≥ 0")
    needed = trials_needed(len(sessions), search, repeats, check)
    for i, session in enumerate(sessions):
        if session.task.space.names != sessions[0].task.space.names:
            raise ParameterError(
                f"session {i}: has other parameters than session 0: {session.task.space.names}"
            )
        if session.left < needed:
            raise BudgetError(
                f"session {i}: {session.left} trials left, fitting {len(sessions)} sources needs {needed}"
            )


def spent(sessions: Sequence[Session]) -> int:
    """Return the trials spent by sessions."""
    return sum(len(session.trials) for session in sessions)


def search_set(searcher: Agent, session: Session, trials: int, seed: int, index: int) -> Floats:
    """Return a source's own set, (d,), for at most ``trials`` of its session."""
    child = int(np.random.SeedSequence(seed, spawn_key=(index,)).generate_state(1, np.uint64)[0])
    searcher.reset(replace(session.task, budget=trials), seed=child)
    while trials and len(units := searcher.ask()[:trials]):
        searcher.tell(session.evaluate(units))
        trials -= len(units)
    return searcher.recommend()


def run_repeatedly(session: Session, units: Floats, repeats: int) -> Floats:
    """Return the costs of k settings, (k, repeats), in one batch."""
    trials = session.evaluate(np.tile(units, (repeats, 1)))
    return np.array([trial.cost for trial in trials]).reshape(repeats, len(units)).T


def choose_scales(graph: "TransferGraph", sessions: Sequence[Session], repeats: int) -> tuple[float, float]:
    """Return the (tau, gamma) whose predictions for left-out sources cost least.

    The default stays unless another beats it by more than a standard error over the sources: with a few sources and
    a few runs the best of many is mostly a lucky one.
    """
    grid = list(product(TAUS, GAMMAS))
    losses = np.empty((len(sessions), len(grid)))
    for left_out, session in enumerate(sessions):
        space = session.task.space
        predictions = np.array([_predict_left_out(graph, space, left_out, *scales) for scales in grid])
        losses[left_out] = regrets(cap_failures(run_repeatedly(session, predictions, repeats)).mean(axis=1))
    gains = losses[:, :1] - losses
    clear = gains.mean(axis=0) > gains.std(axis=0, ddof=1) / len(sessions) ** 0.5
    return grid[int(np.argmax(np.where(clear, gains.mean(axis=0), 0.0)))]


def _predict_left_out(
    graph: "TransferGraph", space: ParameterSpace, left_out: int, tau: float, gamma: float
) -> Floats:
    others = np.delete(np.arange(len(graph.names)), left_out)
    costs = graph.judged[others]
    weights = sound_weights(costs[:, others], costs[:, left_out], tau, gamma)
    return space.mean(graph.settings[others], weights)


def run_left_out(graph: "TransferGraph", sessions: Sequence[Session], repeats: int) -> Any:
    """Return fresh costs on each source's map of what the other sources hand over, (n, RIVALS, repeats).

    The rivals are what the graph transfers without the source, the one of the other sets that did best on its map
    (the copy), and the published default: with transfer, with the plainest transfer, and without.
    """
    costs = []
    for left_out, session in enumerate(sessions):
        space = session.task.space
        others = np.delete(np.arange(len(graph.names)), left_out)
        copied = graph.settings[others[int(np.argmin(graph.judged[others, left_out]))]]
        transferred = _predict_left_out(graph, space, left_out, graph.tau, graph.gamma)
        rivals = np.array([transferred, copied, np.full(len(space), 0.5)])
        costs.append(run_repeatedly(session, rivals, repeats))
    return np.array(costs)
