"""Suites: named, versioned sets of scenarios, split by map into train, validation, test and ood.

An item is a pure function of (suite, split, index), by way of a hash, so that neither the order of access
nor the size of another split matters. A suite never changes; another world is another version.
"""

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property, lru_cache
from typing import Any, NamedTuple, overload

import numpy as np

from antgym.errors import ParameterError, nearest
from antgym.maps.generators import FAMILIES, terrain_windows
from antgym.maps.readers import jacksboro
from antgym.maps.world import Scenario

SPLITS = ("train", "validation", "test", "ood")
SIZES = (15, 27)
ANTS, ITERATIONS = (5, 40), (10, 100)
OOD_ANTS, OOD_ITERATIONS = 20, 50


class SuiteItem(NamedTuple):
    """A scenario and the effort and rules it is planned with."""

    name: str
    scenario: Scenario
    ants: int
    iterations: int
    rules: str


class Recipe(NamedTuple):
    """What a suite is made of.

    Attributes:
        family: name in ``generators.FAMILIES`` of the scenarios of train, validation and test.
        rules: name of the colony rules.
        counts: items per generated split.
        ood: returns the scenarios of ``ood``; called once, when it is first needed.
    """

    family: str
    rules: str
    counts: dict[str, int]
    ood: Callable[[], tuple[Scenario, ...]]


@lru_cache
def _real_terrain() -> tuple[Scenario, ...]:
    return terrain_windows(jacksboro(), rotations=(0, 90, 180, 270))


SUITES: dict[str, Recipe] = {
    "mountain-v0": Recipe(
        "mountains", "liu2020", {"train": 200, "validation": 50, "test": 100}, _real_terrain
    ),
}


class Suite(Sequence[SuiteItem]):
    """One split of a suite: a sequence of items made when first asked for; get it by ``load_suite``.

    Attributes:
        name: the suite, for example ``"mountain-v0"``.
        split: one of ``SPLITS``.
    """

    def __init__(self, name: str, split: str) -> None:
        if name not in SUITES:
            raise ParameterError(f"unknown suite {name!r}; {nearest(name, tuple(SUITES))}")
        if split not in SPLITS:
            raise ParameterError(f"unknown split {split!r}; {nearest(split, SPLITS)}")
        self.name, self.split = name, split
        self._recipe = SUITES[name]
        self._items: dict[int, SuiteItem] = {}

    def __repr__(self) -> str:
        return f"Suite({self.name!r}, {self.split!r})"

    def __reduce__(self) -> tuple[Any, tuple[str, str]]:
        return load_suite, (self.name, self.split)  # items are made again where they are needed

    def __len__(self) -> int:
        return len(self._recipe.ood()) if self.split == "ood" else self._recipe.counts[self.split]

    @overload
    def __getitem__(self, index: int) -> SuiteItem: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[SuiteItem, ...]: ...
    def __getitem__(self, index: int | slice) -> SuiteItem | tuple[SuiteItem, ...]:
        numbers = range(len(self))[index]
        return self._item(numbers) if isinstance(numbers, int) else tuple(self._item(i) for i in numbers)

    @cached_property
    def digest(self) -> str:
        """Hash of every scenario, effort and rule in order, 64 hex digits; builds all items."""
        lines = (f"{item.scenario.digest} {item.ants} {item.iterations} {item.rules}\n" for item in self)
        return hashlib.sha256("".join(lines).encode()).hexdigest()

    def _item(self, index: int) -> SuiteItem:
        if index not in self._items:
            make = self._real if self.split == "ood" else self._generated
            self._items[index] = make(index)
        return self._items[index]

    def _generated(self, index: int) -> SuiteItem:
        name = f"{self.name}/{self.split}/{index}"
        rng = np.random.default_rng(np.random.SeedSequence(_hashed(f"antgym/{name}")))
        size = int(rng.choice(np.arange(SIZES[0], SIZES[1] + 1, 2)))
        ants, iterations = (_log_uniform(rng, *bounds) for bounds in (ANTS, ITERATIONS))
        scenario = replace(FAMILIES[self._recipe.family](rng, size), name=name)
        return SuiteItem(name, scenario, ants, iterations, self._recipe.rules)

    def _real(self, index: int) -> SuiteItem:
        scenario = self._recipe.ood()[index]
        return SuiteItem(scenario.name, scenario, OOD_ANTS, OOD_ITERATIONS, self._recipe.rules)


@lru_cache
def load_suite(name: str, split: str) -> Suite:
    """Return a split of a suite; the same object for the same names, so that optima are computed once.

    Raises:
        ParameterError: if there is no such suite or split; the message names the nearest.
        MissingExtraError: on first use of ``ood``, if the package with the real maps is not installed.
    """
    return Suite(name, split)


def _hashed(text: str) -> int:
    return int(hashlib.sha256(text.encode()).hexdigest(), 16)


def _log_uniform(rng: np.random.Generator, low: int, high: int) -> int:
    return round(float(np.exp(rng.uniform(np.log(low), np.log(high)))))
