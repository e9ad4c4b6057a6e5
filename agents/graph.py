"""A fitted transfer graph: what source tasks taught, as data that a target's agent starts from."""

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields, replace
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from agents.controls import RandomSearch
from agents.judgement import cap_failures
from agents.laplacian import regrets, sound_weights
from antgym.errors import BudgetError, ParameterError
from antgym.tuning import Agent, ParameterSpace, Session

Floats = NDArray[np.float64]
DEFAULT_TAU, DEFAULT_GAMMA = 0.02, 0.1
TAUS, GAMMAS = (DEFAULT_TAU, 0.01, 0.05, 0.1, 0.3), (DEFAULT_GAMMA, 0.5)
FORMAT = "antgym transfer graph 1"


@dataclass(frozen=True)
class TransferGraph:
    """Source tasks, their parameter sets, and what each set costs on each source's map.

    Settings are kept in the unit cube, where Q stands for κ, its only meaning across maps: the target's own
    space turns it back into a Q. All sources and targets of a graph share one rule's ranges.

    Attributes:
        names: the n source tasks.
        parameters: names of the d parameters.
        units: n settings, each of d values in [0, 1].
        costs: ``costs[i][j]`` holds the costs of set i on map j, one a run; the same number of runs
            everywhere.
        tau: scale of regrets that predicted left-out sources best.
        gamma: weight of smoothness that did.
        evaluations: trials that fitting spent, all sources together.
        provenance: what it was fitted from, plain JSON values.

    Raises:
        ParameterError: where shapes disagree, a setting leaves the unit cube or a cost is not positive.
    """

    names: tuple[str, ...]
    parameters: tuple[str, ...]
    units: tuple[tuple[float, ...], ...]
    costs: tuple[tuple[tuple[float, ...], ...], ...]
    tau: float = DEFAULT_TAU
    gamma: float = DEFAULT_GAMMA
    evaluations: int = 0
    provenance: Mapping[str, Any] = field(default_factory=dict, hash=False)

    def __post_init__(self) -> None:
        n, d = len(self.names), len(self.parameters)
        units, costs = _array(self.units, "units"), _array(self.costs, "costs")
        if (
            n < 1
            or units.shape != (n, d)
            or costs.shape[:2] != (n, n)
            or costs.ndim != 3
            or costs.shape[2] < 1
        ):
            shapes = f"units {units.shape} and costs {costs.shape}"
            raise ParameterError(
                f"{n} sources with {d} parameters need units ({n}, {d}), costs ({n}, {n}, runs); got {shapes}"
            )
        if not ((units >= 0) & (units <= 1)).all():
            raise ParameterError("a transfer graph's settings must lie in [0, 1]")
        if not (np.isfinite(costs) & (costs > 0)).all():
            raise ParameterError("a transfer graph's costs must be positive numbers")
        if not (self.tau > 0 and self.gamma > 0):
            raise ParameterError(f"tau = {self.tau}, gamma = {self.gamma}: both must be positive")

    @property
    def settings(self) -> Floats:
        """The sources' settings, (n, d) in [0, 1]."""
        return np.array(self.units)

    @property
    def table(self) -> Floats:
        """Mean cost of set i on map j, (n, n), failures at their full cost: what liu2020's (9) takes."""
        return np.array(self.costs).mean(axis=2)

    @property
    def judged(self) -> Floats:
        """Mean cost of set i on map j, (n, n), no run counted as more than twice the best on its map."""
        return cap_failures(np.array(self.costs), axis=(0, 2)).mean(axis=2)

    @property
    def ranking(self) -> list[int]:
        """Indices of the sets by mean regret over the maps, best first."""
        return np.argsort(regrets(self.judged).mean(axis=1), kind="stable").tolist()

    @classmethod
    def fit(
        cls,
        sessions: Sequence[Session],
        *,
        names: Sequence[str] | None = None,
        searcher: Agent | None = None,
        search: int = 32,
        repeats: int = 5,
        check: int = 2,
        seed: int = 0,
        provenance: Mapping[str, Any] | None = None,
    ) -> "TransferGraph":
        """Learn a graph from one session per source task; every run is paid through them.

        First each source's own set is searched, then every set is run on every map, then (tau, gamma) is
        chosen: each source in turn plays the target, and what the others predict for it is run on its map.

        Args:
            sessions: one per source, each with :func:`trials_needed` trials left.
            names: names of the sources; numbered where None.
            searcher: agent that searches a source's own set; random search where None.
            search: trials of that search, ≥ 1.
            repeats: runs of each set on each map, ≥ 1.
            check: runs of each prediction; 0, or fewer than three sources, keeps the default tau and gamma.
            seed: root of the searches' seeds.
            provenance: what to note in the graph beside the arguments.

        Raises:
            BudgetError: where a session has fewer trials left than fitting needs; nothing is spent.
        """
        n, before = len(sessions), _spent(sessions)
        _check_fit(sessions, names, search, repeats, check)
        searcher = searcher or RandomSearch()
        units = np.array([_search(searcher, s, search, seed, i) for i, s in enumerate(sessions)])
        costs = np.stack([_run(s, units, repeats) for s in sessions], axis=1)
        noted = {"search": search, "repeats": repeats, "check": check, "seed": seed, **(provenance or {})}
        graph = cls(
            names=tuple(names) if names is not None else tuple(f"source-{i + 1}" for i in range(n)),
            parameters=sessions[0].task.space.names,
            units=_tuples(units),
            costs=_tuples(costs),
            evaluations=_spent(sessions) - before,
            provenance=noted,
        )
        if check < 1 or n < 3:
            return graph
        tau, gamma = _choose_scales(graph, sessions, check)
        return replace(graph, tau=tau, gamma=gamma, evaluations=_spent(sessions) - before)

    def save(self, path: str | Path) -> None:
        """Write the graph as JSON; a file of that name is replaced at once or not at all."""
        path = Path(path)
        draft = path.with_name(f"{path.name}.{os.getpid()}.tmp")
        draft.write_text(json.dumps({"format": FORMAT, **asdict(self)}, indent=1), encoding="utf-8")
        draft.replace(path)

    @classmethod
    def load(cls, path: str | Path) -> "TransferGraph":
        """Read a graph; ParameterError names the file and what is wrong with it."""
        path = Path(path)
        try:
            content = json.loads(path.read_text(encoding="utf-8"))
        except FileNotFoundError:
            raise ParameterError(f"{path}: no such transfer graph") from None
        except (UnicodeDecodeError, json.JSONDecodeError) as error:
            raise ParameterError(f"{path}: no JSON ({error})") from None
        known = {f.name for f in fields(cls)}
        if not isinstance(content, dict) or content.pop("format", None) != FORMAT or set(content) != known:
            raise ParameterError(f"{path}: not an {FORMAT!r} with the fields {', '.join(sorted(known))}")
        try:
            return cls(**{name: _tuples(value) for name, value in content.items()})
        except (ParameterError, TypeError) as error:
            raise ParameterError(f"{path}: {error}") from None


def trials_needed(sources: int, search: int = 32, repeats: int = 5, check: int = 2) -> int:
    """Return the trials that :meth:`TransferGraph.fit` spends in each source's session, at most."""
    checked = check * len(TAUS) * len(GAMMAS) if sources >= 3 else 0
    return search + repeats * sources + checked


def _check_fit(
    sessions: Sequence[Session], names: Sequence[str] | None, search: int, repeats: int, check: int
) -> None:
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


def _spent(sessions: Sequence[Session]) -> int:
    return sum(len(session.trials) for session in sessions)


def _search(searcher: Agent, session: Session, trials: int, seed: int, index: int) -> Floats:
    """Return a source's own set, (d,), for at most ``trials`` of its session."""
    child = int(np.random.SeedSequence(seed, spawn_key=(index,)).generate_state(1, np.uint64)[0])
    searcher.reset(replace(session.task, budget=trials), seed=child)
    while trials and len(units := searcher.ask()[:trials]):
        searcher.tell(session.evaluate(units))
        trials -= len(units)
    return searcher.recommend()


def _run(session: Session, units: Floats, repeats: int) -> Floats:
    """Return the costs of k settings, (k, repeats), in one batch."""
    trials = session.evaluate(np.tile(units, (repeats, 1)))
    return np.array([trial.cost for trial in trials]).reshape(repeats, len(units)).T


def _choose_scales(graph: TransferGraph, sessions: Sequence[Session], repeats: int) -> tuple[float, float]:
    """Return the (tau, gamma) whose predictions for left-out sources cost least.

    The default stays unless another beats it by more than a standard error over the sources: with a few sources and
    a few runs the best of many is mostly a lucky one.
    """
    grid = list(product(TAUS, GAMMAS))
    losses = np.empty((len(sessions), len(grid)))
    for left_out, session in enumerate(sessions):
        space = session.task.space
        predictions = np.array([_predict_left_out(graph, space, left_out, *scales) for scales in grid])
        losses[left_out] = regrets(cap_failures(_run(session, predictions, repeats)).mean(axis=1))
    gains = losses[:, :1] - losses
    clear = gains.mean(axis=0) > gains.std(axis=0, ddof=1) / len(sessions) ** 0.5
    return grid[int(np.argmax(np.where(clear, gains.mean(axis=0), 0.0)))]


def _predict_left_out(
    graph: TransferGraph, space: ParameterSpace, left_out: int, tau: float, gamma: float
) -> Floats:
    others = np.delete(np.arange(len(graph.names)), left_out)
    costs = graph.judged[others]
    weights = sound_weights(costs[:, others], costs[:, left_out], tau, gamma)
    return space.mean(graph.settings[others], weights)


def _array(values: Any, label: str) -> Floats:
    try:
        return np.array(values, dtype=np.float64)
    except (ValueError, TypeError):
        raise ParameterError(f"{label} of a transfer graph must be numbers in a regular table") from None


def _tuples(values: Any) -> Any:
    """Return nested lists or an array as nested tuples; anything else as it is."""
    if isinstance(values, np.ndarray):
        values = values.tolist()
    return tuple(_tuples(v) for v in values) if isinstance(values, list) else values
