"""Folders: a folder of map files of one's own in the place of a suite.

Every map in it that has a scenario file beside it (``.scen``, ``.3dscen``) gives rows of that, evenly spaced; any other
gives pairs of its places (:mod:`antgym.maps.pairs`). Folders in it that are called ``train``, ``validation``, ``test``
or ``ood`` are its splits. What its :mod:`antgym.maps.suite_file` says, holds for all of them.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import cycle
from pathlib import Path

import numpy as np

from antgym.errors import MapError, ParameterError, ScenarioError
from antgym.maps import suite_file
from antgym.maps.formats.ros import picture_of
from antgym.maps.formats.rows import Rows
from antgym.maps.generators.draws import has_path
from antgym.maps.items import SPLITS, OwnSuite, SuiteItem
from antgym.maps.pairs import drawn
from antgym.maps.readers import KINDS, read_map, read_scenarios, suffix_of
from antgym.maps.suite_file import SuiteFile, Terms, read_suite_file
from antgym.maps.world import Scenario

SCENARIOS = (".scen", ".3dscen")
LAYERED_RULES, GRID_RULES = "liu2020", "ant_colony_system"  # what finds its way on maps as they come


def rules_for(scenario: Scenario) -> str:
    """Return the name of the rules that plan a map of one's own unless others are named."""
    return LAYERED_RULES if scenario.motion.layered else GRID_RULES


def load_folder(path: Path, split: str = "train") -> OwnSuite:
    """Return the items of a folder of maps; the same objects until a file in it changes.

    Args:
        path: the folder.
        split: a folder in it of this name, or the share of its maps that its settings give to it; ``"train"`` is the
            folder itself where it has neither.

    Raises:
        MapError: if there are no maps, or one cannot be read, or no two places of it are joined.
        ParameterError: if there is no such split, or ``suite.toml`` says what cannot be used.
    """
    splits = tuple(name for name in SPLITS if (path / name).is_dir())
    folders = (path, *(path / name for name in splits))
    files = sorted(file for folder in folders for file in folder.iterdir() if file.is_file())
    return _load(path, split, splits, tuple((file, file.stat().st_mtime_ns) for file in files))


@lru_cache(maxsize=16)
def _load(path: Path, split: str, splits: tuple[str, ...], files: tuple[tuple[Path, int], ...]) -> OwnSuite:
    settings = read_suite_file(path / suite_file.NAME)
    folder = _folder(path, split, splits, settings)
    here = [file for file, _ in files if file.parent == folder]
    rows = [read_scenarios(file) for file in here if file.suffix.lower() in SCENARIOS]
    maps = _maps(here, rows)
    if not maps:
        if folder == path and splits:
            raise MapError(
                f"{path} has no train split: its maps are all in {', '.join(f'{name}/' for name in splits)}, and "
                f"agents learn from others; put some into {path / 'train'}"
            )
        raise MapError(f"{folder} holds no map; it needs files that end in {', '.join(KINDS)}")
    settings.require_matches([file.name for file, _ in files if suffix_of(file) in KINDS])
    if settings.shares:
        maps = settings.part(maps, split)
    terms = {map_path: settings.terms(map_path) for map_path in maps}
    turns = {each.rules: cycle(each.rules or ("",)) for each in terms.values()}
    items = []
    for map_path, scenario in _scenarios(terms, rows):
        chosen = next(turns[terms[map_path].rules]) or rules_for(scenario)
        effort = terms[map_path].ants, terms[map_path].iterations
        items.append(SuiteItem(scenario.name, scenario, *effort, chosen))
    if not items:
        raise MapError(f"{folder}: no row of its scenario files can be planned under its {suite_file.NAME}")
    return OwnSuite(items)


def _folder(path: Path, split: str, splits: tuple[str, ...], settings: SuiteFile) -> Path:
    """Return the folder of a split, of those that have one."""
    if splits and settings.shares:
        raise ParameterError(
            f"{settings.path}: split gives shares, but {path} has a folder {splits[0]!r}; keep one of both"
        )
    if split in splits:
        return path / split
    if split != "train" and not settings.shares:
        raise ParameterError(
            f"{path} has no folder {split!r}; it has {', '.join(splits) or 'no splits'}; "
            f"{suite_file.NAME} may give shares to splits"
        )
    return path


def _maps(files: Sequence[Path], rows: Sequence[Rows]) -> list[Path]:
    """Return the maps among files: those of scenario files, and others that are no picture of a map."""
    pictures = {picture_of(file) for file in files if file.suffix.lower() in (".yaml", ".yml")}
    others = {file for file in files if suffix_of(file) in KINDS and file not in pictures}
    return sorted({part.map_path for part in rows} | others)


def _scenarios(terms: dict[Path, Terms], rows: Sequence[Rows]) -> Iterator[tuple[Path, Scenario]]:
    """Yield what maps give, each with its map; rows of scenario files first."""
    told = set()
    for part in rows:
        if part.map_path in terms and not terms[part.map_path].start:
            told.add(part.map_path)
            yield from ((part.map_path, scenario) for scenario in _rows(part, terms[part.map_path]))
    for map_path, each in terms.items():
        if map_path not in told:
            yield from ((map_path, scenario) for scenario in _places(map_path, each))


def _places(map_path: Path, terms: Terms) -> Iterator[Scenario]:
    """Yield the one scenario that is named for a map, or those that are drawn on it."""
    map_ = read_map(map_path, **dict(terms.reading))
    if terms.start:
        start, goal = (
            map_.end(getattr(terms, end), f"{map_path}: {end}", terms.unit) for end in ("start", "goal")
        )
        try:
            yield replace(map_.scenario(start, goal), name=map_path.name)
        except ScenarioError as error:
            raise ScenarioError(f"{map_path}: what {suite_file.NAME} says of its ends: {error}") from None
        return
    scenarios = drawn(map_, terms.scenarios)
    if not scenarios:
        raise MapError(f"{map_path}: no two places that are joined were found; put a scenario file beside it")
    yield from (replace(scenario, name=f"{map_path.name}#{i}") for i, scenario in enumerate(scenarios))


def _rows(rows: Rows, terms: Terms) -> Iterator[Scenario]:
    """Yield scenarios of a file, in its order; those that cannot be planned are passed over."""
    if terms.reading:
        raise ParameterError(
            f"{rows.source} says what is where on {rows.map_path.name} as it is; "
            f"{', '.join(name for name, _ in terms.reading)} would make it another map: name its start and goal"
        )
    for i in _chosen(rows, terms):
        try:
            scenario = rows.scenario(i)
        except ScenarioError:
            continue
        if has_path(scenario):
            yield scenario


def _chosen(rows: Rows, terms: Terms) -> list[int]:
    """Return which rows are taken: evenly spaced, or drawn where there is a seed."""
    fit = np.flatnonzero([row.start != row.goal and row.length <= terms.longest for row in rows])
    count = min(terms.scenarios, len(fit))
    if terms.seed is not None:
        rng = np.random.default_rng([terms.seed, *rows.source.name.encode()])
        return sorted(rng.choice(fit, count, replace=False).tolist())
    places = np.linspace(0, len(fit) - 1, count).round().astype(int)
    return np.unique(fit[places]).tolist() if count else []
