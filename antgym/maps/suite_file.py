"""``suite.toml``: what a folder of maps says of how its maps are read, planned and split.

A key at the top holds for every map, one in a table for maps whose names the table's name matches, as in a shell::

    rules = ["ant_colony_system", "wei2018"]     # in turn; by default what suits the motion
    ants = 20
    iterations = 100
    scenarios = 10                               # of every map
    longest = 60                                 # rows of scenario files: no declared length above
    seed = 7                                     # rows are drawn at random, and no longer evenly spaced
    split = { train = 0.7, test = 0.3 }          # shares of the maps; without it, all are train

    ["*.png"]
    pixel = 0.05                                 # any option of antgym.read_map
    cell = 0.1

    ["house.png"]
    start = [16, 10.3]                           # the one scenario of this map
    goal = [2.5, 17.5]
    unit = "map"                                 # not "cells"
    radius = 0.15
"""

import hashlib
import math
import tomllib
from collections.abc import Callable, Sequence
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any, NamedTuple

from antgym.errors import AntgymError, ParameterError, nearest
from antgym.maps.formats.files import text
from antgym.maps.items import SPLITS
from antgym.maps.readers import options_of

NAME = "suite.toml"
MOST_BYTES = 64_000
MOST_SCENARIOS, LARGEST = 10_000, 1e12  # no count of scenarios and no number is above
SHARES = "split"


class Need(NamedTuple):
    """What a value must be, in words and as a test."""

    words: str
    fits: Callable[[Any], bool]


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= LARGEST


def _are_numbers(*counts: int) -> Callable[[Any], bool]:
    return lambda value: isinstance(value, list) and len(value) in counts and all(map(_is_number, value))


_COUNT = Need("a whole number, 1 or more", lambda value: type(value) is int and 1 <= value <= LARGEST)
_NUMBER = Need("a number", _is_number)
_NAME = Need("a name", lambda value: isinstance(value, str))
_NAMES = Need(
    "a list of names",
    lambda value: isinstance(value, list) and value != [] and all(isinstance(name, str) for name in value),
)
_PLACE = Need("[x, y] or [x, y, z]", _are_numbers(2, 3))
_UNITS = Need('"cells" or "map"', lambda value: value in ("cells", "map"))

PLANNING = {
    "rules": _NAMES,
    **dict.fromkeys(("ants", "iterations"), _COUNT),
    "scenarios": Need(
        f"a whole number from 1 to {MOST_SCENARIOS:,}",
        lambda value: type(value) is int and 1 <= value <= MOST_SCENARIOS,
    ),
    "longest": Need("a number above 0", lambda value: _is_number(value) and value > 0),
    "seed": Need("a whole number, 0 or more", lambda value: type(value) is int and 0 <= value <= LARGEST),
    **dict.fromkeys(("start", "goal"), _PLACE),
    "unit": _UNITS,
}
READING = {
    **dict.fromkeys(("radius", "rise", "fill", "pixel", "cell", "threshold"), _NUMBER),
    **dict.fromkeys(("levels", "ros"), _COUNT),
    "negate": Need("true or false", lambda value: isinstance(value, bool)),
    "crop": Need(
        "[left, top, right, bottom]",
        lambda value: _are_numbers(4)(value) and all(type(number) is int for number in value),
    ),
    "relief": Need("[height of black, height of white]", _are_numbers(2)),
    "unknown": _NAME,
}
"""The options of :func:`antgym.read_map`."""
_NEEDS = {**PLANNING, **READING}


class Terms(NamedTuple):
    """What holds for one map.

    Attributes:
        rules: names, in turn; none for what suits the motion.
        ants: per iteration, or bees.
        iterations: per run, or cycles.
        scenarios: how many.
        longest: no row of a scenario file is taken that declares more.
        seed: rows are drawn by it; evenly spaced where it is None.
        start: of the one scenario, as :meth:`antgym.maps.map.Map.end` takes it; none for others than one.
        goal: likewise.
        unit: of both.
        reading: options of :func:`antgym.read_map`.
    """

    rules: tuple[str, ...] = ()
    ants: int = 20
    iterations: int = 100
    scenarios: int = 10
    longest: float = math.inf
    seed: int | None = None
    start: tuple[float, ...] = ()
    goal: tuple[float, ...] = ()
    unit: str = "cells"
    reading: tuple[tuple[str, Any], ...] = ()


class SuiteFile:
    """The settings of a folder; get them by :func:`read_suite_file`.

    Attributes:
        path: the file.
        everywhere: what holds for every map.
        tables: what holds for the maps that a pattern matches, by pattern.
        shares: of the maps, by split; none where the file does not split them.
    """

    def __init__(self, path: Path, given: dict[str, Any]) -> None:
        self.path = path
        self.shares = _shares(path, given.pop(SHARES, None))
        self.tables = {
            name: _checked(value, f"{path}: [{name!r}] ")
            for name, value in given.items()
            if isinstance(value, dict)
        }
        plain = {name: value for name, value in given.items() if not isinstance(value, dict)}
        self.everywhere = _checked(plain, f"{path}: ")

    def terms(self, map_path: Path) -> Terms:
        """Return what holds for a map: what is said of every map as far as its kind takes it, then of it alone.

        Raises:
            ParameterError: if it has a start without a goal, or the reverse.
        """
        known = {*PLANNING, *options_of(map_path)}
        merged = {name: value for name, value in self.everywhere.items() if name in known}
        for pattern, table in self.tables.items():
            if fnmatchcase(map_path.name, pattern):
                merged |= table
        if ("start" in merged) != ("goal" in merged):
            raise ParameterError(f"{self.path}: start and goal of {map_path.name} come together: give both")
        reading = tuple((name, value) for name, value in merged.items() if name in READING)
        planning = {name: value for name, value in merged.items() if name in PLANNING}
        return Terms(**planning, reading=reading)

    def require_matches(self, names: Sequence[str]) -> None:
        """Raise ParameterError where a table matches none of these maps."""
        for pattern in self.tables:
            if not any(fnmatchcase(name, pattern) for name in names):
                hint = nearest(pattern, tuple(names)) if names else "there are none"
                raise ParameterError(f"{self.path}: [{pattern!r}] matches no map; {hint}")

    def part(self, maps: Sequence[Path], split: str) -> list[Path]:
        """Return the maps of a split: shares of them all, in an order that hashes of their names give.

        Raises:
            ParameterError: if the split has no share, or none of the maps falls to it.
        """
        if split not in self.shares:
            raise ParameterError(f"{self.path}: split gives no share to {split!r}, only {dict(self.shares)}")
        mixed = sorted(maps, key=lambda path: hashlib.sha256(path.name.encode()).digest())
        before = sum(self.shares[name] for name in SPLITS[: SPLITS.index(split)] if name in self.shares)
        first, last = (round(share * len(mixed)) for share in (before, before + self.shares[split]))
        if first == last:
            raise ParameterError(
                f"{self.path}: {self.shares[split]:g} of {len(mixed)} maps leave {split} none"
            )
        return sorted(mixed[first:last])


def read_suite_file(path: Path) -> SuiteFile:
    """Read the settings of a folder; where there is no such file, all are the defaults.

    Raises:
        ParameterError: if a key is unknown or a value does not fit; it names the file and the key.
        MapError: if the file is no text, or too long.
    """
    if not path.is_file():
        return SuiteFile(path, {})
    try:
        return SuiteFile(path, tomllib.loads(text(path, MOST_BYTES)))
    except AntgymError:
        raise
    except (ValueError, RecursionError) as error:  # also numbers of more digits than Python reads or writes
        raise ParameterError(f"{path}: not TOML ({error})") from None


def _checked(given: dict[str, Any], place: str) -> dict[str, Any]:
    """Return what is given, lists as tuples; the place begins every message."""
    for name, value in given.items():
        if name not in _NEEDS:
            raise ParameterError(f"{place}unknown setting {name!r}; {nearest(name, (*_NEEDS, SHARES))}")
        if not _NEEDS[name].fits(value):
            raise ParameterError(f"{place}{name} = {value!r}: needs {_NEEDS[name].words}")
    return {name: tuple(value) if isinstance(value, list) else value for name, value in given.items()}


def _shares(path: Path, given: Any) -> dict[str, float]:
    if given is None:
        return {}
    if not isinstance(given, dict) or not all(_is_number(share) and share > 0 for share in given.values()):
        raise ParameterError(
            f"{path}: {SHARES} = {given!r}: needs shares above 0 by split, {{ train = 0.8 }}"
        )
    for name in given:
        if name not in SPLITS:
            raise ParameterError(f"{path}: {SHARES}: unknown split {name!r}; {nearest(name, SPLITS)}")
    if sum(given.values()) > 1 + 1e-9:
        raise ParameterError(f"{path}: {SHARES} = {given!r}: the shares add up to more than 1")
    return dict(given)
