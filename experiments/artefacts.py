"""What trained agents need before a board can run: made once on the train split, kept in the board's folder."""

import hashlib
import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

import agents
from agents.graph import TransferGraph, trials_needed
from agents.static import StaticSetting, StaticSettings, race, race_by_rules
from antgym.console import progress
from antgym.maps.suites import SuiteItem, load_suite
from antgym.tuning.problem import TuningProblem
from antgym.tuning.session import Session, Trial
from experiments.presets import Preset
from experiments.train import Arguments, train

Floats = NDArray[np.float64]
_T = TypeVar("_T")
REPEATS = 5

ARGUMENTS = {
    "agents.static:StaticAgent": ("setting", "static.json"),
    "agents.static:StaticByRules": ("settings", "static_by_rules.json"),
    "agents.transfer:TransferAgent": ("graph", "graph.json"),
    "agents.policy:PolicyAgent": ("path", "policy.json"),
}
"""Which argument of a trained agent takes which file."""


def prepare(folder: Path, suite: str, preset: Preset, names: Sequence[str]) -> dict[str, int]:
    """Make the files that these agents need and that are missing; return what each file's training spent."""
    folder.mkdir(parents=True, exist_ok=True)
    steps: dict[str, tuple[Callable[[Path], Any], Callable[[Path], int]]] = {
        "static.json": (
            lambda path: _race(race, suite, preset).save(path),
            lambda p: StaticSetting.load(p).evaluations,
        ),
        "static_by_rules.json": (
            lambda path: _race(race_by_rules, suite, preset).save(path),
            lambda p: StaticSettings.load(p).evaluations,
        ),
        "graph.json": (
            lambda path: _fit(suite, preset).save(path),
            lambda p: TransferGraph.load(p).evaluations,
        ),
        "policy.json": (lambda path: _train(path, preset), _policy_evaluations),
    }
    wanted = {ARGUMENTS[card.entry_point][1] for card in map(agents.find_card, names) if card.trained}
    spent = {}
    for name, (make, evaluations) in steps.items():
        if name in wanted:
            if not (folder / name).exists():
                make(folder / name)
            spent[name] = evaluations(folder / name)
    return spent


def trained_argument(name: str, folder: Path) -> dict[str, Path]:
    """Return the keyword argument by which an agent finds its file; empty where it needs none."""
    card = agents.find_card(name)
    if not card.trained:
        return {}
    argument, file = ARGUMENTS[card.entry_point]
    return {argument: folder / file}


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


def _race(by: Callable[[Sequence[Session], Floats], _T], suite: str, preset: Preset) -> _T:
    from scipy.stats import qmc

    items = load_suite(suite, "train")[: preset.race_maps]
    candidates = qmc.Sobol(4, seed=0).random(preset.race_settings)
    with progress("racing for the best static settings", None) as advance:
        sessions = [_Watched(problem(item, "race"), preset.race_settings, advance) for item in items]
        return by(sessions, np.clip(candidates, 0, 1))


def _fit(suite: str, preset: Preset) -> TransferGraph:
    items = load_suite(suite, "train")[: preset.sources]
    budget = trials_needed(len(items), preset.source_search, REPEATS)
    with progress(f"fitting the transfer graph on {len(items)} maps", budget * len(items)) as advance:
        sessions = [_Watched(problem(item, "graph"), budget, advance) for item in items]
        names = [item.name for item in items]
        return TransferGraph.fit(sessions, names=names, search=preset.source_search, repeats=REPEATS)


def _train(card: Path, preset: Preset) -> None:
    train(Arguments("PPO", evaluations=preset.policy_evaluations, out=card.with_suffix("")))


def _policy_evaluations(card: Path) -> int:
    return int(json.loads(card.read_text(encoding="utf-8"))["evaluations"])
