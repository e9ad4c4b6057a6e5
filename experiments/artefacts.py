"""What trained agents need before a board can run: made once on the train split, kept in the board's folder.

    python -m experiments.artefacts neighbours transfer_graph --out out/trained

makes what these agents need, for ``experiments.tune`` and ``experiments.transfer``; a board makes its own. Beside
the files ``made.json`` says for which suite and with which sizes of a preset each was made, so that none is taken for
another.
"""

import hashlib
import json
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, TypeVar

import numpy as np
import tyro
from numpy.typing import NDArray

import agents
from agents import ensemble
from agents.ensemble import Ensemble
from agents.experience import Experience
from agents.fitting import trials_needed
from agents.graph import TransferGraph
from agents.static import race, race_by_rules
from antgym.console import main, parse, progress, write_whole
from antgym.envs.catalogue import world_of
from antgym.envs.scenarios import find_items
from antgym.errors import ParameterError
from antgym.maps.suites import SuiteItem
from antgym.planners.planning import are_bees
from antgym.tuning.features import task_table
from antgym.tuning.problem import TuningProblem
from antgym.tuning.session import Session
from experiments import train
from experiments.artefact_files import MADE, TRAINED, files_needed, require_there, spent
from experiments.presets import PRESETS, Preset
from experiments.watching import WatchedSession

Floats = NDArray[np.float64]
_T = TypeVar("_T")
SIZES = (
    "policy_evaluations",
    "sources",
    "source_search",
    "race_maps",
    "race_settings",
    "experience_maps",
    "experience_trials",
)
"""What of a preset decides what training makes."""
REPEATS = 5  # runs of each set of the transfer graph on each of its maps
EXPERIENCE_REPEATS = 2  # runs of each setting of the experience: maps teach more than repeats
MOST_SETTINGS = 256  # of the experience


@dataclass(frozen=True)
class Arguments:
    """Make the files that trained agents need, on the train split of a suite; what is there already stays."""

    agents: tyro.conf.Positional[tuple[str, ...]]
    """Names in the catalogue of agents."""
    suite: str = "mountain-v0"
    """Suite whose train maps are learnt from."""
    preset: Literal["smoke", "quick", "full"] = "quick"
    """How much is spent: smoke for tests, quick minutes, full an hour."""
    out: Path = TRAINED
    """Folder of the files."""


def prepare(folder: Path, suite: str, preset: Preset, names: Sequence[str]) -> dict[str, int]:
    """Make the files that these agents need and that are missing; return what each file's training spent.

    Raises:
        ParameterError: where a file was made for another suite or with other sizes than the preset's; one that was put
            there by hand is taken as it is.
    """
    steps: dict[str, Callable[[Path], Any]] = {
        "static.json": lambda path: _race(race, suite, preset).save(path),
        "static_by_rules.json": lambda path: _race(race_by_rules, suite, preset).save(path),
        "graph.json": lambda path: _fit(suite, preset).save(path),
        "experience.json": lambda path: _gather(suite, preset).save(path),
        "neural.json": lambda path: _fit_nets(_experience(folder, suite, preset)).save(path),
        "policy.json": lambda path: _train(path, suite, preset),
    }
    wanted = files_needed(names)
    require_there(names, folder, suite, makes=steps)
    _require_made(folder, wanted, _origin(suite, preset))
    folder.mkdir(parents=True, exist_ok=True)
    for name, make in steps.items():
        if name in wanted and not (folder / name).exists():
            _note_made(folder, name, _origin(suite, preset))
            make(folder / name)
    return spent(folder, names)


def _origin(suite: str, preset: Preset) -> dict[str, str | int]:
    """Return what a file is made from, as ``made.json`` has it."""
    return {"suite": suite, **{name: getattr(preset, name) for name in SIZES}}


def read_made(folder: Path) -> dict[str, dict[str, str | int]]:
    """Return the suite and the sizes that files were made with, by name; ParameterError where that is damaged."""
    path = folder / MADE
    try:
        made = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
        return {name: dict(origin) for name, origin in made.items()}
    except (OSError, ValueError, TypeError, AttributeError) as error:
        raise ParameterError(f"{path} is damaged ({error}); use another folder") from None


def _note_made(folder: Path, name: str, origin: dict[str, str | int]) -> None:
    """Note what a file is made from, before it is: one that was made never goes without."""
    write_whole(folder / MADE, (json.dumps({**read_made(folder), name: origin}, indent=2) + "\n").encode())


def _require_made(folder: Path, names: Iterable[str], origin: dict[str, str | int]) -> None:
    made = read_made(folder)
    for name in names:
        then = made.get(name, origin)
        if (folder / name).exists() and then != origin:
            keys = [key for key in origin if then.get(key) != origin[key]]
            told = ", ".join(f"{key} {then.get(key)}, now {origin[key]}" for key in keys)
            raise ParameterError(
                f"{folder / name} was made with {told}; remove it, use another folder, or ask for the suite and the "
                "preset that it was made with"
            )


def derived_seed(*parts: str | int) -> int:
    """Return the 63-bit seed that a purpose gets; other parts give an unrelated one."""
    return int.from_bytes(hashlib.sha256("/".join(map(str, parts)).encode()).digest()[:8], "big") >> 1


def problem(item: SuiteItem, *parts: str | int) -> TuningProblem:
    """Return an item as a tuning problem, its planner seeds derived from the item and the parts."""
    seed = derived_seed(item.scenario.digest, *parts)
    return TuningProblem(item.scenario, item.rules, item.ants, item.iterations, seed)


def _race(by: Callable[[Sequence[Session], Floats], _T], suite: str, preset: Preset) -> _T:
    from scipy.stats import qmc

    items = _raced(suite, preset) if by is race_by_rules else find_items(suite, "train")[: preset.race_maps]
    candidates = qmc.Sobol(len(problem(items[0]).space), seed=0).random(preset.race_settings)
    with progress("racing for the best static settings", None) as advance:
        sessions = [WatchedSession(problem(item, "race"), preset.race_settings, advance) for item in items]
        return by(sessions, np.clip(candidates, 0, 1))


def _raced(suite: str, preset: Preset) -> list[SuiteItem]:
    """Return the maps of a race by rules: as those of any race, and where they lack rules, one more for each."""
    train = find_items(suite, "train")
    items = list(train[: preset.race_maps])
    rest = (train[i] for i in range(len(items), len(train)))  # made only as far as they are needed
    while lacking := set(train.rules) - {item.rules for item in items}:
        items.append(next(item for item in rest if item.rules in lacking))
    return items


def _fit(suite: str, preset: Preset) -> TransferGraph:
    items = find_items(suite, "train")[: preset.sources]
    budget = trials_needed(len(items), preset.source_search, REPEATS)
    with progress(f"fitting the transfer graph on {len(items)} maps", budget * len(items)) as advance:
        sessions = [WatchedSession(problem(item, "graph"), budget, advance) for item in items]
        names = [item.name for item in items]
        return TransferGraph.fit(sessions, names=names, search=preset.source_search, repeats=REPEATS)


def _gather(suite: str, preset: Preset) -> Experience:
    """Run the published default and a Sobol design on the first train maps."""
    from scipy.stats import qmc

    items = find_items(suite, "train")[: preset.experience_maps]
    affordable = min(MOST_SETTINGS, preset.experience_trials // (EXPERIENCE_REPEATS * len(items)))
    design = qmc.Sobol(len(problem(items[0]).space), seed=1)
    units = np.clip(design.random_base2(affordable.bit_length() - 1), 0, 1)
    units[0] = 0.5
    runs = len(units) * EXPERIENCE_REPEATS
    with progress(f"gathering experience on {len(items)} maps", runs * len(items)) as advance:
        return Experience.gather(
            [WatchedSession(problem(item, "experience"), runs, advance) for item in items],
            units,
            described=[feature.name for feature in task_table(are_bees(items[0].rules))],
            names=[item.name for item in items],
            repeats=EXPERIENCE_REPEATS,
            provenance={"suite": suite},
        )


def _experience(folder: Path, suite: str, preset: Preset) -> Experience:
    """Return the experience of a folder, gathered now where it is not there."""
    path = folder / "experience.json"
    _require_made(folder, [path.name], _origin(suite, preset))
    if not path.exists():
        _note_made(folder, path.name, _origin(suite, preset))
        _gather(suite, preset).save(path)
    return Experience.load(path)


def _fit_nets(experience: Experience) -> Ensemble:
    with progress("fitting nets to the experience", ensemble.NETS * ensemble.EPOCHS) as advance:
        return Ensemble.fit(experience, advance=advance)


def _train(card: Path, suite: str, preset: Preset) -> None:
    """Train a policy on the world of a suite, its settings those of the regime's file."""
    world = world_of(suite)
    env, kwargs = f"antgym/{world or 'Mountain'}OneShot-v0", json.dumps({} if world else {"suite": suite})
    evaluations, out = preset.policy_evaluations, card.with_suffix("")
    train.train(train.Arguments("PPO", env, evaluations=evaluations, out=out, kwargs=kwargs))


def make_artefacts(arguments: Arguments) -> None:
    """Make the files and say what each cost."""
    if not arguments.agents:
        trained = [card.name for card in agents.CATALOGUE.values() if card.trained]
        raise ParameterError(f"name the agents that need files: {', '.join(trained)}")
    spent = prepare(arguments.out, arguments.suite, PRESETS[arguments.preset], arguments.agents)
    for name, evaluations in spent.items():
        print(f"{arguments.out / name}: {evaluations:,} evaluations")


if __name__ == "__main__":
    main(
        lambda: make_artefacts(parse(Arguments, None, "python -m experiments.artefacts")),
        interrupted="interrupted; files that were done are kept, the one that was being made is not",
    )
