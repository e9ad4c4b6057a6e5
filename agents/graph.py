"""A fitted transfer graph: what source tasks taught, as data that a target's agent starts from."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from agents import artefact
from agents.artefact import as_array, as_tuples
from agents.controls import RandomSearch
from agents.fitting import (
    DEFAULT_GAMMA,
    DEFAULT_TAU,
    RIVALS,
    check_fit,
    choose_scales,
    run_left_out,
    run_repeatedly,
    search_set,
    spent,
)
from agents.judgement import cap_failures
from agents.laplacian import laplacian, map_affinities, regrets
from agents.ordering import greedy_portfolio
from antgym.errors import ParameterError
from antgym.tuning import Agent, Session

Floats = NDArray[np.float64]
FORMAT = "antgym transfer graph 2"


class LeftOut(NamedTuple):
    """What a source would have got from the others: fresh mean costs on its map, failures capped.

    Transfer is negative where doing without it is cheaper: Eaton et al. (2008) measure transferability as the change in
    performance between learning with and without transfer. Without any, there is the published default; the plainest
    transfer is to copy the best set. What lies within two standard errors of the difference counts as equal.

    Attributes:
        name: the source.
        transferred: mean cost of what the graph transfers; ``copied``: of the best of the other sets; ``default``: of
            the published default.
        doubt: two standard errors of transferred - copied, and of transferred - default.
    """

    name: str
    transferred: float
    copied: float
    default: float
    doubt: tuple[float, float]

    @property
    def worse_than_copy(self) -> bool:
        """Whether blending clearly cost more than copying the best of the other sets."""
        return self.transferred - self.copied > self.doubt[0]

    @property
    def worse_than_default(self) -> bool:
        """Whether transfer clearly cost more than no transfer."""
        return self.transferred - self.default > self.doubt[1]


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
        left_out: ``left_out[j]`` holds fresh costs on map j of what the other sources transfer, of the best of their
            sets, and of the published default, one list a rival; empty where none was run.
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
    left_out: tuple[tuple[tuple[float, ...], ...], ...] = ()
    provenance: Mapping[str, Any] = field(default_factory=dict, hash=False)

    def __post_init__(self) -> None:
        n, d = len(self.names), len(self.parameters)
        units, costs = as_array(self.units, "units"), as_array(self.costs, "costs")
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
        tested = as_array(self.left_out, "left_out")
        if len(tested) and not (
            tested.ndim == 3
            and tested.shape[:2] == (n, RIVALS)
            and tested.shape[2]
            and (np.isfinite(tested) & (tested > 0)).all()
        ):
            raise ParameterError(f"left_out must be ({n}, {RIVALS}, runs) positive costs; got {tested.shape}")

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

    @property
    def order(self) -> list[int]:
        """Indices of the sets as a greedy portfolio of the maps: a set comes early where the earlier ones do badly."""
        return greedy_portfolio(regrets(self.judged).T)

    @property
    def affinities(self) -> Floats:
        """The edges between maps in the sound version, (n, n) in (0, 1], 0 on the diagonal."""
        return map_affinities(self.judged, self.tau)

    @property
    def spectrum(self) -> Floats:
        """Eigenvalues of the Laplacian of these edges, (n,), ascending; as many are 0 as the graph has parts."""
        return np.asarray(np.linalg.eigvalsh(laplacian(self.affinities)), dtype=np.float64)

    @property
    def negative_transfer(self) -> tuple[LeftOut, ...]:
        """What each source would have got from the others, by its own fresh runs; empty where none was run."""
        if not self.left_out:
            return ()
        runs = cap_failures(np.array(self.left_out), axis=(1, 2))
        means, variances = runs.mean(axis=2), runs.var(axis=2, ddof=min(1, runs.shape[2] - 1)) / runs.shape[2]
        doubt = 2 * np.sqrt(variances[:, :1] + variances[:, 1:])
        rows = zip(self.names, means.tolist(), doubt.tolist(), strict=True)
        return tuple(
            LeftOut(name, transferred, copied, default, (doubts[0], doubts[1]))
            for name, (transferred, copied, default), doubts in rows
        )

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
        chosen: each source in turn plays the target, and what the others predict for it is run on its map. Last, what
        they predict with the chosen scales is run again, beside a copy and the default, for ``negative_transfer``.

        Args:
            sessions: one per source, each with :func:`trials_needed` trials left.
            names: names of the sources; numbered where None.
            searcher: agent that searches a source's own set; random search where None.
            search: trials of that search, ≥ 1.
            repeats: runs of each set on each map, ≥ 1.
            check: runs of each prediction; 0, or fewer than three sources, keeps the default tau and gamma and leaves
                ``left_out`` empty.
            seed: root of the searches' seeds.
            provenance: what to note in the graph beside the arguments.

        Raises:
            BudgetError: where a session has fewer trials left than fitting needs; nothing is spent.
        """
        n, before = len(sessions), spent(sessions)
        check_fit(sessions, names, search, repeats, check)
        searcher = searcher or RandomSearch()
        units = np.array([search_set(searcher, s, search, seed, i) for i, s in enumerate(sessions)])
        costs = np.stack([run_repeatedly(s, units, repeats) for s in sessions], axis=1)
        noted = {"search": search, "repeats": repeats, "check": check, "seed": seed, **(provenance or {})}
        graph = cls(
            names=tuple(names) if names is not None else tuple(f"source-{i + 1}" for i in range(n)),
            parameters=sessions[0].task.space.names,
            units=as_tuples(units),
            costs=as_tuples(costs),
            provenance=noted,
        )
        if check >= 1 and n >= 3:
            tau, gamma = choose_scales(graph, sessions, check)
            graph = replace(graph, tau=tau, gamma=gamma)
            graph = replace(graph, left_out=as_tuples(run_left_out(graph, sessions, repeats)))
        return replace(graph, evaluations=spent(sessions) - before)

    def save(self, path: str | Path) -> None:
        """Write the graph as JSON; a file of that name is replaced at once or not at all."""
        artefact.save(path, FORMAT, asdict(self))

    @classmethod
    def load(cls, path: str | Path) -> "TransferGraph":
        """Read a graph; ParameterError names the file and what is wrong with it."""
        return artefact.load(path, FORMAT, cls)

    def plot(self, path: str | Path) -> Path:
        """Draw the graph as a PNG, see :func:`agents.graph_picture.draw`; MissingExtraError without matplotlib."""
        from agents.graph_picture import draw

        return draw(self, Path(path))
