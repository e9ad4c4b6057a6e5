"""What trained agents need before a board can run: made once on the train split, kept in the board's folder."""

import hashlib
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from agents.graph import TransferGraph, trials_needed
from agents.static import StaticSetting, race
from antgym.maps.suites import SuiteItem, load_suite
from antgym.tuning.problem import TuningProblem
from antgym.tuning.session import Session, Trial
from experiments.console import progress
from experiments.presets import Preset
from experiments.train import Arguments, train

REPEATS = 5


class Artefacts(NamedTuple):
    """Files of the trained agents and the planner runs that each cost."""

    policy: Path
    graph: Path
    static: Path
    spent: dict[str, int]


def prepare(folder: Path, suite: str, preset: Preset) -> Artefacts:
    """Make what is missing; a file that lies there already is used as it is."""
    folder.mkdir(parents=True, exist_ok=True)
    policy, graph, static = folder / "policy", folder / "graph.json", folder / "static.json"
    steps: tuple[tuple[Path, Callable[[], Any]], ...] = (
        (static, lambda: _race(suite, preset).save(static)),
        (graph, lambda: _fit(suite, preset).save(graph)),
        (policy.with_suffix(".json"), lambda: _train(policy, preset)),
    )
    for file, make in steps:
        if not file.exists():
            make()
    spent = {
        "policy": int(json.loads(policy.with_suffix(".json").read_text())["evaluations"]),
        "graph": TransferGraph.load(graph).evaluations,
        "static": StaticSetting.load(static).evaluations,
    }
    return Artefacts(policy, graph, static, spent)


def derived_seed(*parts: str | int) -> int:
    """Return the 63-bit seed that a purpose gets; other parts give an unrelated one."""
    return int.from_bytes(hashlib.sha256("/".join(map(str, parts)).encode()).digest()[:8], "big") >> 1


def problem(item: SuiteItem, *parts: str | int) -> TuningProblem:
    """Return an item as a tuning problem, its planner seeds derived from the item and the parts."""
    seed = derived_seed(item.scenario.digest, *parts)
    return TuningProblem(item.scenario, item.rules, item.ants, item.iterations, seed)


class _Watched(Session):
    """A session that moves a progress bar."""

    def __init__(self, task: TuningProblem, budget: int, advance: Callable[[int], None]) -> None:
        super().__init__(task, budget)
        self._advance = advance

    def evaluate(self, units: ArrayLike) -> tuple[Trial, ...]:
        trials = super().evaluate(units)
        self._advance(len(trials))
        return trials


def _race(suite: str, preset: Preset) -> StaticSetting:
    from scipy.stats import qmc

    items = load_suite(suite, "train")[: preset.race_maps]
    candidates = qmc.Sobol(4, seed=0).random(preset.race_settings)
    with progress("racing for the best static setting", None) as advance:
        sessions = [_Watched(problem(item, "race"), preset.race_settings, advance) for item in items]
        return race(sessions, np.clip(candidates, 0, 1))


def _fit(suite: str, preset: Preset) -> TransferGraph:
    items = load_suite(suite, "train")[: preset.sources]
    budget = trials_needed(len(items), preset.source_search, REPEATS)
    with progress(f"fitting the transfer graph on {len(items)} maps", budget * len(items)) as advance:
        sessions = [_Watched(problem(item, "graph"), budget, advance) for item in items]
        names = [item.name for item in items]
        return TransferGraph.fit(sessions, names=names, search=preset.source_search, repeats=REPEATS)


def _train(policy: Path, preset: Preset) -> None:
    train(Arguments("TD3", evaluations=preset.policy_evaluations, out=policy))
