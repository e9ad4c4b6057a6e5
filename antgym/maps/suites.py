"""Suites: named, versioned sets of scenarios, split by map into train, validation, test and ood.

An item is a pure function of (suite, split, index), by way of a hash, so that neither the order of access
nor the size of another split matters. A suite never changes; another world is another version.
"""

import hashlib
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any, overload

import numpy as np

from antgym.errors import ParameterError, nearest
from antgym.maps.folders import load_folder
from antgym.maps.formats.elevation import jacksboro
from antgym.maps.generators import terrain_windows
from antgym.maps.items import SPLITS, OwnSuite, SuiteItem, digest_of
from antgym.maps.recipes import SUITES, draw
from antgym.maps.world import Scenario

__all__ = ["SPLITS", "Items", "OwnSuite", "Suite", "SuiteItem", "digest_of", "load_suite"]

OOD_ANTS, OOD_ITERATIONS = 20, 50  # on real terrain


@lru_cache
def _real_terrain(rotations: int) -> tuple[Scenario, ...]:
    return terrain_windows(jacksboro(), rotations=(0, 90, 180, 270)[:rotations])


class Suite(Sequence[SuiteItem]):
    """One split of a suite: a sequence of items made when first asked for; get it by ``load_suite``.

    Attributes:
        name: the suite, for example ``"mountain-v0"``.
        split: one of ``SPLITS``.
    """

    def __init__(self, name: str, split: str) -> None:
        if name not in SUITES:
            hint = nearest(name, tuple(SUITES))
            raise ParameterError(f"unknown suite {name!r}, nor is it a folder; {hint}")
        if split not in SPLITS:
            raise ParameterError(f"unknown split {split!r}; {nearest(split, SPLITS)}")
        self.name, self.split = name, split
        self._recipe = SUITES[name]
        self._items: dict[int, SuiteItem] = {}

    def __repr__(self) -> str:
        return f"Suite({self.name!r}, {self.split!r})"

    def __reduce__(self) -> tuple[Any, tuple[str, str]]:
        return _named, (self.name, self.split)  # items are made again where they are needed

    def __len__(self) -> int:
        return self._recipe.counts[self.split] + len(self._windows)

    @property
    def flat(self) -> bool:
        """Whether every world of the suite is one cell high, or lies in the plane, in every split."""
        return self._recipe.flat

    @property
    def rules(self) -> tuple[str, ...]:
        """The rules that plan its scenarios, in every split; all of ants, or all of bees."""
        return self._recipe.rules

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
        return digest_of(self)

    @property
    def _windows(self) -> tuple[Scenario, ...]:
        recipe = self._recipe
        return _real_terrain(recipe.rotations) if self.split == "ood" and recipe.terrain else ()

    def _item(self, index: int) -> SuiteItem:
        if index not in self._items:
            real = len(self._windows)
            self._items[index] = self._real(index) if index < real else self._generated(index - real)
        return self._items[index]

    def _generated(self, index: int) -> SuiteItem:
        name = f"{self.name}/{self.split}/{index}"
        root = np.random.SeedSequence(int(hashlib.sha256(f"antgym/{name}".encode()).hexdigest(), 16))
        # the kind comes from a stream of its own, so that mountain-v0, which has but one, is what it was before kinds
        strand, family, rules = self._recipe.pick(self.split, np.random.default_rng(root.spawn(1)[0]))
        rng = np.random.default_rng(root)
        size = int(rng.choice(strand.sizes))
        effort = strand.effort(rng, size)
        return SuiteItem(
            name, replace(draw(family, rng, size, strand.robots), name=name), *effort, rules, family
        )

    def _real(self, index: int) -> SuiteItem:
        scenario, rules = self._windows[index], self._recipe.terrain
        return SuiteItem(
            scenario.name, scenario, OOD_ANTS, OOD_ITERATIONS, rules[index % len(rules)], "terrain"
        )


Items = Suite | OwnSuite


def load_suite(name: str, split: str) -> Items:
    """Return a split of a suite, or what a folder of maps of one's own gives in the place of one.

    The same names give the same object, so that optima are computed once; a folder does until a file in it changes.
    Maps of a folder that have a scenario file beside them give rows of it, others places that are drawn. Its splits are
    folders in it, or shares of its maps. A ``suite.toml`` in it may say, for all maps or, in a table, for those whose
    names a pattern matches: how they are read (any option of :func:`antgym.read_map`), ``start``, ``goal`` and
    ``unit``, ``rules``, ``ants``, ``iterations``, how many ``scenarios``, the ``longest`` row and the ``seed`` that
    draws rows; and ``split``, the shares. :mod:`antgym.maps.suite_file` shows one.

    Args:
        name: of a suite, or the path of a folder.
        split: one of ``SPLITS``.

    Raises:
        ParameterError: if there is no such suite, folder or split, the message names the nearest; or if ``suite.toml``
            says what cannot be used, with its key; whether there are rules of a name, who plans by them finds out.
        MapError: if a map of the folder cannot be read or used.
        MissingExtraError: on first use of ``ood``, if the package with the real maps is not installed.
    """
    folder = Path(name)
    if name not in SUITES and folder.is_dir():
        return load_folder(folder, split)
    if len(folder.parts) > 1:
        raise ParameterError(f"suite = {name!r}: no such folder (looked in {Path.cwd()})")
    return _named(name, split)


@lru_cache
def _named(name: str, split: str) -> Suite:
    return Suite(name, split)
