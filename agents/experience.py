"""Experience: what many settings cost on many train maps, one table for every agent that learns from maps.

The portfolio, the nearest neighbours, the regression and the warm start all read this table and none of them
runs anything on a train map itself: it is paid once, and its price stands on the card of each.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from agents import artefact
from agents.artefact import as_array, as_tuples
from agents.fitting import run_repeatedly
from agents.judgement import cap_failures
from antgym.errors import BudgetError, ParameterError
from antgym.tuning import Session, Task

Floats = NDArray[np.float64]
FORMAT = "antgym experience 1"
RULE = "rules_"  # how the features begin that show a map's rules
FEW = 8  # maps under one rule below which all maps speak
FAR = 5.0  # standard deviations from the train maps at which a feature is cut off


class Spread(NamedTuple):
    """Variances of log costs: of runs of one setting on one map, and of a setting's rank from map to map."""

    noise: float
    between: float


@dataclass(frozen=True)
class Experience:
    """Costs of k settings on n train maps.

    Settings are kept in the unit cube, where 1/2 is the published default of a map's own rules and Q stands for κ: a
    setting means the same under any rule, as far as anything does.

    Attributes:
        names: the n maps.
        parameters: names of the d parameters.
        described: names of the f features.
        features: n maps, f features each.
        units: k settings, each of d values in [0, 1].
        costs: ``costs[i][j]`` holds the costs of setting j on map i, one a run; equally many everywhere.
        evaluations: trials that it took.
        provenance: where it is from, plain JSON values.

    Raises:
        ParameterError: where shapes disagree, a setting leaves the unit cube or a cost is not positive.
    """

    names: tuple[str, ...]
    parameters: tuple[str, ...]
    described: tuple[str, ...]
    features: tuple[tuple[float, ...], ...]
    units: tuple[tuple[float, ...], ...]
    costs: tuple[tuple[tuple[float, ...], ...], ...]
    evaluations: int = 0
    provenance: Mapping[str, Any] = field(default_factory=dict, hash=False)

    def __post_init__(self) -> None:
        n, d, f, k = len(self.names), len(self.parameters), len(self.described), len(self.units)
        features, units = as_array(self.features, "features"), as_array(self.units, "units")
        costs = as_array(self.costs, "costs")
        right = features.shape == (n, f) and units.shape == (k, d) and costs.shape[:2] == (n, k)
        if not right or min(n, d, k) < 1 or costs.ndim != 3 or costs.shape[2] < 1:
            raise ParameterError(
                f"{n} maps with {f} features and {k} settings of {d} parameters need features ({n}, {f}), units "
                f"({k}, {d}) and costs ({n}, {k}, runs); got {features.shape}, {units.shape} and {costs.shape}"
            )
        if not np.isfinite(features).all():
            raise ParameterError("features of an experience must be finite numbers")
        if not ((units >= 0) & (units <= 1)).all():
            raise ParameterError("settings of an experience must lie in [0, 1]")
        if not (np.isfinite(costs) & (costs > 0)).all():
            raise ParameterError("costs of an experience must be positive numbers")

    @cached_property
    def settings(self) -> Floats:
        """The settings, (k, d) in [0, 1]."""
        return np.array(self.units)

    @cached_property
    def _capped(self) -> Floats:
        """Log costs, (n, k, runs), no run counted as more than twice the best on its map."""
        return np.log(cap_failures(np.array(self.costs), axis=(1, 2)))

    @cached_property
    def regrets(self) -> Floats:
        """Log of mean cost over the best mean cost of the map, (n, k), within [0, log 2]."""
        means = np.log(np.exp(self._capped).mean(axis=2))
        return means - means.min(axis=1, keepdims=True)

    @cached_property
    def lowest(self) -> Floats:
        """Log of the lowest mean cost on every map, (n,)."""
        return np.asarray(np.log(np.exp(self._capped).mean(axis=2)).min(axis=1), dtype=np.float64)

    @cached_property
    def variances(self) -> Floats:
        """Variances of the log costs of runs, (n, k); zeros in a table with one run a cell."""
        runs = self._capped.shape[2]
        return self._capped.var(axis=2, ddof=1) if runs > 1 else np.zeros(self._capped.shape[:2])

    @cached_property
    def spread(self) -> Spread:
        """How far runs and maps differ; a table with one run a cell cannot tell them apart: its noise is 0."""
        runs, noise = self._capped.shape[2], float(self.variances.mean())
        rest = self.regrets - self.regrets.mean(axis=0) - self.regrets.mean(axis=1, keepdims=True)
        return Spread(noise, max(float(rest.var()) - noise / runs, 0.05 * float(rest.var()), 1e-12))

    @cached_property
    def scales(self) -> tuple[Floats, Floats]:
        """Mean and standard deviation of every feature, (f,) both; infinite where all maps are alike."""
        features = np.array(self.features)
        deviation = features.std(axis=0)
        return features.mean(axis=0), np.where(deviation > 1e-9, deviation, np.inf)

    @cached_property
    def described_maps(self) -> Floats:
        """Standardised features of the maps, (n, f)."""
        return self.standardise(np.array(self.features))

    def standardise(self, features: Floats) -> Floats:
        """Return features in standard deviations from the mean map, cut at ±5; 0 where all maps are alike."""
        mean, deviation = self.scales
        return np.clip((features - mean) / deviation, -FAR, FAR)

    def check(self, task: Task) -> None:
        """Raise ParameterError where a task has other parameters or other features than the maps had."""
        require_alike(task, self.parameters, self.described)

    def akin(self, task: Task) -> NDArray[np.intp]:
        """Return the maps under the task's own rules; all of them where there are fewer than eight."""
        shown = [i for i, name in enumerate(self.described) if name.startswith(RULE)]
        rules = np.array(self.features)[:, shown]
        found = np.flatnonzero((np.abs(rules - task.features[shown]) < 0.5).all(axis=1))
        return found if len(found) >= FEW else np.arange(len(self.names))

    def distances(self, task: Task) -> Floats:
        """Return the squared distance of every map to a task, (n,), in standardised features."""
        away = self.described_maps - self.standardise(task.features.astype(np.float64))
        return (away**2).sum(axis=1)

    @classmethod
    def gather(
        cls,
        sessions: Sequence[Session],
        units: Floats,
        *,
        described: Sequence[str],
        names: Sequence[str] | None = None,
        repeats: int = 2,
        provenance: Mapping[str, Any] | None = None,
    ) -> "Experience":
        """Run every setting on every map; every run is paid through the maps' sessions.

        Args:
            sessions: one per map, each with k × repeats trials left.
            units: (k, d) settings in [0, 1].
            described: names of the features.
            names: names of the maps; numbered where None.
            repeats: runs of each setting on each map, ≥ 1.
            provenance: what to note in the artefact.

        Raises:
            ParameterError: on no maps, no settings, no repeats or maps with different parameters.
            BudgetError: where a session has too few trials left; nothing is spent.
        """
        needed = len(units) * repeats
        if not sessions or needed < 1:
            raise ParameterError(
                f"an experience needs maps, settings and repeats; got {len(sessions)}, {len(units)} and {repeats}"
            )
        parameters = sessions[0].task.space.names
        for i, session in enumerate(sessions):
            if session.task.space.names != parameters:
                raise ParameterError(
                    f"session {i}: has other parameters than session 0: {session.task.space.names}"
                )
            if session.left < needed:
                raise BudgetError(f"session {i}: {session.left} trials left, {needed} are needed")
        table = [run_repeatedly(session, units, repeats) for session in sessions]
        return cls(
            names=tuple(names) if names is not None else tuple(f"map-{i + 1}" for i in range(len(sessions))),
            parameters=parameters,
            described=tuple(described),
            features=as_tuples(np.array([session.task.features for session in sessions], dtype=np.float64)),
            units=as_tuples(np.asarray(units, dtype=np.float64)),
            costs=as_tuples(np.array(table)),
            evaluations=needed * len(sessions),
            provenance={"repeats": repeats, **(provenance or {})},
        )

    def save(self, path: str | Path) -> None:
        """Write it as JSON; a file of that name is replaced at once or not at all."""
        artefact.save(path, FORMAT, asdict(self))

    @classmethod
    def load(cls, path: str | Path) -> "Experience":
        """Read it; ParameterError names the file and what is wrong with it."""
        return artefact.load(path, FORMAT, cls)


def require_alike(task: Task, parameters: tuple[str, ...], described: tuple[str, ...]) -> None:
    """Raise ParameterError where a task has other parameters or other features than an experience has."""
    if task.space.names != parameters:
        raise ParameterError(f"the experience is of {parameters}, the task has {task.space.names}")
    if len(task.features) != len(described):
        raise ParameterError(
            f"the experience knows {len(described)} features a map, the task has {len(task.features)}: "
            "it was gathered by another version; gather it anew"
        )


def as_experience(source: Experience | str | Path) -> Experience:
    """Return an experience, or the one in a file."""
    return source if isinstance(source, Experience) else Experience.load(source)
