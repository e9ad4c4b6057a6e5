"""Draws: maps in place of those that a paper does not publish, from hashed seeds."""

from collections.abc import Callable
from typing import Any

import numpy as np

from antgym.maps.generators import FAMILIES
from antgym.maps.generators.discs import DISC_FAMILIES
from antgym.maps.world import Scenario
from experiments.artefacts import derived_seed


def draw(
    paper: str, count: int, family: str, size: int, wanted: Callable[[Scenario], bool], first: int = 1
) -> list[Scenario]:
    """Return ``count`` maps of a paper from map ``first`` on, each the first of its own seed that is wanted."""
    return [
        _first(np.random.default_rng(derived_seed(paper, "map", i)), family, size, wanted)
        for i in range(first, first + count)
    ]


def _first(rng: np.random.Generator, family: str, size: int, wanted: Callable[[Scenario], bool]) -> Scenario:
    generate: Any = FAMILIES.get(family) or DISC_FAMILIES[family]
    while True:
        scenario: Scenario = generate(rng, size)
        if wanted(scenario):
            return scenario
