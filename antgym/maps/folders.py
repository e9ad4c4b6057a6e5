"""Folders: a folder of map files of one's own in the place of a suite.

Every map in it that has a scenario file beside it (``.scen``, ``.3dscen``) gives rows of that, evenly spaced; any other
gives pairs of its places (:mod:`antgym.maps.pairs`). Folders in it that are called ``train``, ``validation``, ``test``
or ``ood`` are its splits. What a ``suite.toml`` in the folder sets holds for all of them::

    rules = ["ant_colony_system", "wei2018"]  # in turn; by default what suits the motion
    ants = 20
    iterations = 100
    scenarios = 10                            # of every map
"""

import tomllib
from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache
from itertools import cycle
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from antgym.errors import MapError, ParameterError, ScenarioError, is_count, nearest
from antgym.maps.formats.files import text
from antgym.maps.formats.movingai import Rows
from antgym.maps.formats.ros import picture_of
from antgym.maps.generators.draws import has_path
from antgym.maps.pairs import drawn
from antgym.maps.readers import KINDS, read_map, read_scenarios, suffix_of
from antgym.maps.suites import SPLITS, SuiteItem
from antgym.maps.world import Scenario

SETTINGS = "suite.toml"
SCENARIOS = (".scen", ".3dscen")
MOST_SETTINGS = 64_000  # bytes
LAYERED_RULES, GRID_RULES = "liu2020", "ant_colony_system"  # what finds its way on maps as they come


class Terms(NamedTuple):
    """What a folder's settings say."""

    rules: tuple[str, ...] = ()
    ants: int = 20
    iterations: int = 100
    scenarios: int = 10


def rules_for(scenario: Scenario) -> str:
    """Return the name of the rules that plan a map of one's own unless others are named."""
    return LAYERED_RULES if scenario.motion.layered else GRID_RULES


def load_folder(path: Path, split: str = "train") -> tuple[SuiteItem, ...]:
    """Return the items of a folder of maps; the same objects until a file in it changes.

    Args:
        path: the folder.
        split: a folder in it of this name; ``"train"`` is the folder itself where it has none.

    Raises:
        MapError: if there are no maps, or one cannot be read, or no two places of it are joined.
        ParameterError: if there is no such split, or ``suite.toml`` says what cannot be used.
    """
    folder = path / split
    if not folder.is_dir():
        if split != "train":
            found = [name for name in SPLITS if (path / name).is_dir()]
            raise ParameterError(f"{path} has no folder {split!r}; it has {', '.join(found) or 'no splits'}")
        folder = path
    files = sorted(file for file in (*folder.iterdir(), path / SETTINGS) if file.is_file())
    return _load(folder, path / SETTINGS, tuple((file, file.stat().st_mtime_ns) for file in files))


@lru_cache(maxsize=16)
def _load(folder: Path, settings: Path, files: tuple[tuple[Path, int], ...]) -> tuple[SuiteItem, ...]:
    terms = _terms(settings)
    rules, items = cycle(terms.rules or ("",)), []
    for scenario in _scenarios([file for file, _ in files], terms.scenarios):
        chosen = next(rules) or rules_for(scenario)
        items.append(SuiteItem(scenario.name, scenario, terms.ants, terms.iterations, chosen))
    if not items:
        raise MapError(f"{folder} holds no map; it needs files that end in {', '.join(KINDS)}")
    return tuple(items)


def _scenarios(files: list[Path], count: int) -> Iterator[Scenario]:
    """Yield what the maps of a folder give, scenario files first."""
    rows = [read_scenarios(file) for file in files if file.suffix.lower() in SCENARIOS]
    for part in rows:
        yield from _spaced(part, count)
    told = {part.map_path for part in rows}
    told |= {picture_of(file) for file in files if file.suffix.lower() in (".yaml", ".yml")}
    for file in files:
        if suffix_of(file) in KINDS and file not in told:
            scenarios = drawn(read_map(file), count)
            if not scenarios:
                raise MapError(
                    f"{file}: no two places that are joined were found; put a scenario file beside it"
                )
            yield from (replace(scenario, name=f"{file.name}#{i}") for i, scenario in enumerate(scenarios))


def _spaced(rows: Rows, count: int) -> Iterator[Scenario]:
    """Yield the scenarios of rows that lie evenly over a file; those that cannot be planned are passed over."""
    for i in np.unique(np.linspace(0, len(rows) - 1, count).round().astype(int)).tolist():
        try:
            scenario = rows.scenario(i)
        except ScenarioError:
            continue
        if has_path(scenario):
            yield scenario


def _terms(path: Path) -> Terms:
    if not path.is_file():
        return Terms()
    try:
        given = tomllib.loads(text(path, MOST_SETTINGS))
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise ParameterError(f"{path}: not TOML ({error})") from None
    terms = Terms()
    for name, value in given.items():
        if name not in Terms._fields:
            raise ParameterError(f"{path}: unknown setting {name!r}; {nearest(name, Terms._fields)}")
        if name == "rules" and isinstance(value, list) and value:
            terms = terms._replace(rules=tuple(value))
        elif name != "rules" and is_count(value):
            numbers: dict[str, Any] = {name: int(value)}
            terms = terms._replace(**numbers)
        else:
            needed = "a list of names" if name == "rules" else "a whole number, 1 or more"
            raise ParameterError(f"{path}: {name} = {value!r}: needs {needed}")
    return terms
