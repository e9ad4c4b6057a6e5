"""Agents on a transfer graph: run the sources' sets on the target, then combine them.

liu2020, eqs 9-14, as printed (``paper``), with |Λ̂| (``abs``), in a sound version (``sound``), and the two
controls that the paper lacks: copy the best source (``copy``) and take the mean of all (``mean``).
"""

from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path
from typing import Literal, cast, get_args

import numpy as np
from numpy.typing import NDArray

from agents.fitting import trials_needed
from agents.graph import TransferGraph
from agents.judgement import cap_failures
from agents.laplacian import affinities, eq14, paper_weights, sound_weights, transfers
from antgym.errors import ParameterError, nearest
from antgym.tuning import Task, Trial

__all__ = [
    "Mode",
    "TransferAgent",
    "TransferGraph",
    "eq14",
    "paper_weights",
    "sound_weights",
    "trials_needed",
]

Floats = NDArray[np.float64]
Mode = Literal["sound", "paper", "abs", "copy", "mean"]
REFERENCE, BLEND, DEFAULT = "reference", "blend", "default"
PROBING = 0.4  # share of the budget that sound mode spends on the sources' sets
FEWEST_PROBES = 3  # sets, where the budget has room for them and the blend


class TransferAgent:
    """Transfer parameters from source tasks to a target.

    * ``"sound"``: runs sets on two fifths of the budget; weighs them (:func:`sound_weights`) and averages them on each
      parameter's own scale, α, β, κ on a log and ρ on a logit scale. The blend is never believed untested: the guard
      runs it, the best source and the published default, then again and again the better two, and keeps the winner.
      A budget below three has no room for that and copies.
    * ``"paper"``, ``"abs"``: runs every source's set and one random set, the reference of (11), and solves
      (14) in natural values. Q is transferred as κ: the target's space decodes all settings, so every Q is
      scaled to the target's straight line. What leaves the box is clipped and noted.
    * ``"copy"``: runs every source's set and recommends the best. ``"mean"``: the mean setting, with no
      trial.

    Every set is run equally often, as often as the budget allows, ``repeats`` at most; what is then left is not spent
    (in ``"sound"`` mode, it goes to the guard). With fewer trials than sets, those come first that together serve the
    source maps (:attr:`TransferGraph.order`), in the printed modes, which weigh all alike, those that do best on
    average; only sets that were run are weighed. With one trial or none, the set that does best on average decides.

    Args:
        graph: a fitted graph or its file.
        mode: see above.
        repeats: runs of each source's set at most, ≥ 1 (liu2020: 10).
        tau: scale of regrets in ``"sound"``; None takes the graph's.
        gamma: weight of smoothness in ``"sound"``; None takes the graph's.
    """

    def __init__(
        self,
        graph: TransferGraph | str | Path,
        mode: Mode = "sound",
        repeats: int = 10,
        tau: float | None = None,
        gamma: float | None = None,
    ) -> None:
        if mode not in get_args(Mode):
            raise ParameterError(f"unknown mode {mode!r}; {nearest(mode, get_args(Mode))}")
        if repeats < 1:
            raise ParameterError(f"repeats = {repeats}: needs at least 1")
        self.graph = graph if isinstance(graph, TransferGraph) else TransferGraph.load(graph)
        self.mode, self.repeats = mode, repeats
        self.tau = self.graph.tau if tau is None else tau
        self.gamma = self.graph.gamma if gamma is None else gamma
        if not (self.tau > 0 and self.gamma > 0):
            raise ParameterError(f"tau = {self.tau}, gamma = {self.gamma}: both must be positive")

    def reset(self, task: Task, *, seed: int) -> None:
        """Start anew on a target; ParameterError where it has other parameters than the graph's sources."""
        if task.space.names != self.graph.parameters:
            raise ParameterError(
                f"the graph transfers {self.graph.parameters}, the task has {task.space.names}"
            )
        self._task = task
        self._settings: dict[int | str, Floats] = dict(enumerate(self.graph.settings))
        self._settings[DEFAULT] = np.full(len(task.space), 0.5)
        self._settings[REFERENCE] = np.random.default_rng(seed).random(len(task.space))
        self._costs: defaultdict[int | str, list[float]] = defaultdict(list)
        self._left = task.budget
        self._stage = 0
        self._asked: list[int | str] = []
        self._rivals: list[int | str] = []

    def ask(self) -> Floats:
        """Return the sources' sets, then the guard's candidates, then nothing; (k, d)."""
        self._stage += 1
        if self._stage == 1:
            self._asked = self._probes()
        else:
            self._asked = self._guard() if self.mode == "sound" else []
        return np.array([self._settings[key] for key in self._asked]).reshape(-1, len(self._task.space))

    def tell(self, trials: Sequence[Trial]) -> None:
        """Note the costs of the last ask's first settings."""
        for key, trial in zip(self._asked, trials, strict=False):
            self._costs[key].append(trial.cost)
        self._left -= len(trials)

    def recommend(self) -> Floats:
        """Return the (d,) setting that the mode arrives at with what was run so far."""
        return self._judge()[0]

    @property
    def notes(self) -> tuple[str, ...]:
        """What a reader of the recommendation should know: a reversed sign, a clipped value, a fallback."""
        return self._judge()[1]

    def _probes(self) -> list[int | str]:
        """Return which settings to run on the target, in order: whole rounds, best sources first."""
        if self.mode == "mean":
            return []
        if self.mode == "sound":
            return self._sound_probes()
        if self.mode == "copy":
            wanted: list[int | str] = list(self.graph.order)
        else:
            wanted = [*([REFERENCE] if self._left > 1 else []), *self.graph.ranking]
        wanted = wanted[: self._left]
        return wanted * max(1, min(self.repeats, self._left // max(1, len(wanted))))

    def _sound_probes(self) -> list[int | str]:
        room = self._left - 1 if self._left > 2 else self._left  # one for the blend
        share = int(PROBING * self._left)
        wanted: list[int | str] = list(self.graph.order[: min(room, max(FEWEST_PROBES, share))])
        return wanted * max(1, min(self.repeats, share // max(1, len(wanted))))

    def _guard(self) -> list[int | str]:
        """Return the rivals to run next: blend, best source and default once, then the better two of them."""
        if not self._left or self._task.budget <= 2:
            return []
        if not self._rivals:
            self._settings[BLEND] = self._blend()
            best = self._best_source()
            self._rivals = [BLEND, best, DEFAULT]
            if np.array_equal(self._settings[BLEND], self._settings[best]):
                self._rivals.remove(BLEND)
            return self._rivals[: self._left]
        run = [key for key in self._rivals if self._costs.get(key)]
        means = dict(zip(run, self._means(run).tolist(), strict=True))
        return sorted(run, key=means.__getitem__)[: min(2, self._left)]

    def _judge(self) -> tuple[Floats, tuple[str, ...]]:
        if self.mode == "mean":
            n = len(self.graph.names)
            return self._task.space.mean(self.graph.settings, np.full(n, 1 / n)), ()
        if self.mode == "copy" or not self._measured():
            return self._settings[self._best_source()].copy(), ()
        if self.mode == "sound":
            return self._guarded(), ()
        return self._printed()

    def _measured(self) -> list[int]:
        return [i for i in range(len(self.graph.names)) if self._costs.get(i)]

    def _best_source(self) -> int:
        """Return the source with the lowest mean cost on the target; before any run, on all sources' maps."""
        ranking = self.graph.ranking
        measured = [i for i in ranking if self._costs.get(i)]
        means = self._means(measured) if measured else np.zeros(0)
        return measured[int(np.argmin(means))] if measured else ranking[0]

    def _means(self, keys: Sequence[int | str]) -> Floats:
        """Return mean costs of settings that were run, failures capped by the best run of all."""
        best = min(min(runs) for runs in self._costs.values() if runs)
        return np.array([cap_failures(np.array([best, *self._costs[key]]))[1:].mean() for key in keys])

    def _blend(self) -> Floats:
        """Return the sound mean of the sources that were run, (d,)."""
        measured = self._measured()
        weights = sound_weights(self.graph.judged[measured], self._means(measured), self.tau, self.gamma)
        return self._task.space.mean(self.graph.settings[measured], weights)

    def _guarded(self) -> Floats:
        """Return the rival that ran best; the best source where the blend was not run."""
        rivals = [key for key in self._rivals if self._costs.get(key)] or [self._best_source()]
        return self._settings[rivals[int(np.argmin(self._means(rivals)))]].copy()

    def _printed(self) -> tuple[Floats, tuple[str, ...]]:
        """Return (14)'s parameters as a setting, with notes; the best source where (14) has no answer."""
        measured = self._measured()
        if not self._costs.get(REFERENCE):
            return self._settings[self._best_source()].copy(), ("no reference run: copied the best source",)
        reference = np.mean(self._costs[REFERENCE])
        transfer = 1 - np.array([np.mean(self._costs[i]) for i in measured]) / reference
        edges = affinities(transfers(self.graph.table))[np.ix_(measured, measured)]
        naturals = self._task.space.decode(self.graph.settings[measured])
        notes = (
            []
            if transfer.sum() > 0
            else ["the sources' transfers add up to at most 0: worse sources weigh more"]
        )
        try:
            values = eq14(edges, transfer, naturals, cast(Literal["paper", "abs"], self.mode))
        except np.linalg.LinAlgError:
            values = np.full(naturals.shape[1], np.nan)
        if not np.isfinite(values).all():
            return self._settings[self._best_source()].copy(), (
                *notes,
                "(14) has no solution: copied the best source",
            )
        setting, clipped = self._into_box(values)
        return setting, (*notes, *clipped)

    def _into_box(self, values: Floats) -> tuple[Floats, list[str]]:
        parameters = self._task.space.parameters
        inside = np.clip(values, [p.low for p in parameters], [p.high for p in parameters])
        notes = [
            f"{p.name} = {value:g} left its range and was clipped to {kept:g}"
            for p, value, kept in zip(parameters, values, inside, strict=True)
            if value != kept
        ]
        return self._task.space.encode(inside)[0], notes
