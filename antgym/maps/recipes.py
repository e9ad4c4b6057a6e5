"""Recipes: what every suite is made of.

A suite is a mixture of strands. A strand says which families its scenarios come from, which rules plan them, and how
large and how long; what it lists is drawn evenly, efforts log-uniformly.
"""

from itertools import chain
from typing import NamedTuple

import numpy as np

from antgym.maps.discs import DiscScenario
from antgym.maps.fleet import Fleet
from antgym.maps.generators import FAMILIES
from antgym.maps.generators.company import in_company
from antgym.maps.generators.discs import DISC_FAMILIES
from antgym.maps.world import Scenario

LAYERED = ("mountains", "ridges", "forest", "boxes", "caves", "pockets")
FLAT = ("rooms", "mazes", "clutter", "warehouse")
TEXTBOOK = ("ant_system", "elitist", "rank_based", "max_min", "ant_colony_system")
LONGEST = 5.0  # straight lines: twice as long is what a session shows at most, and no gap above 1 counts
# What keeps a plan below 0.25 s. Ants without the goal in their heuristic walk half of a floor's cells on their way, at
# up to 0.2 µs each; a step along the potential field takes up to 0.5 µs in a large world. No other rule needs a bound.
WANDERING, FIELD = 2e6, 2.5e7


class Strand(NamedTuple):
    """One kind of item.

    Attributes:
        families: names in ``generators.FAMILIES``, or in ``DISC_FAMILIES``.
        rules: names of rules of ants, or of bees.
        sizes: cells a side, or discs.
        ants: fewest and most.
        iterations: fewest and most.
        weight: how often it comes, relative to the suite's other strands.
        most: ants × iterations × size² at most; an effort above is drawn again.
        robots: that share a world; more than one are a fleet.
    """

    families: tuple[str, ...]
    rules: tuple[str, ...]
    sizes: tuple[int, ...]
    ants: tuple[int, int]
    iterations: tuple[int, int]
    weight: float = 1.0
    most: float = np.inf
    robots: int = 1

    def effort(self, rng: np.random.Generator, size: int) -> tuple[int, int]:
        """Draw (ants, iterations)."""
        while True:
            ants, iterations = _log_uniform(rng, *self.ants), _log_uniform(rng, *self.iterations)
            if ants * iterations * size**2 <= self.most:
                return ants, iterations


class Recipe(NamedTuple):
    """What a suite is made of.

    Attributes:
        strands: of train, validation and test.
        counts: generated items per split.
        ood: strands of the split ``ood``: larger worlds, and families that the other splits do not have.
        terrain: rules that plan the windows of real terrain that ``ood`` begins with, in turn; no windows without.
        rotations: in how many directions each window is crossed.
    """

    strands: tuple[Strand, ...]
    counts: dict[str, int]
    ood: tuple[Strand, ...] = ()
    terrain: tuple[str, ...] = ()
    rotations: int = 1

    @property
    def flat(self) -> bool:
        """Whether every world is one cell high, or lies in the plane."""
        return not self.terrain and set(self.families) <= {*FLAT, *DISC_FAMILIES}

    @property
    def discs(self) -> bool:
        """Whether every world holds discs; else, all are grids."""
        return set(self.families) <= set(DISC_FAMILIES)

    @property
    def families(self) -> tuple[str, ...]:
        """The families of train, validation and test."""
        return tuple(dict.fromkeys(chain(*(strand.families for strand in self.strands))))

    @property
    def rules(self) -> tuple[str, ...]:
        """The rules of train, validation and test."""
        return tuple(dict.fromkeys(chain(*(strand.rules for strand in self.strands))))

    def pick(self, split: str, rng: np.random.Generator) -> tuple[Strand, str, str]:
        """Draw a strand of a split, and a family and rules from it."""
        strands = self.ood if split == "ood" else self.strands
        weights = np.array([strand.weight for strand in strands])
        strand = strands[rng.choice(len(strands), p=weights / weights.sum())]
        return strand, str(rng.choice(strand.families)), str(rng.choice(strand.rules))


def draw(
    family: str, rng: np.random.Generator, size: int, robots: int = 1
) -> Scenario | DiscScenario | Fleet:
    """Draw a scenario whose shortest path is at most five straight lines long; or a fleet of such ones on one grid.

    A few mazes are longer. All that an agent sees of a run is its length, ten straight lines at most: there, a good
    path could not be told from a bad one, nor from none.
    """
    generate = FAMILIES.get(family) or DISC_FAMILIES[family]
    while True:
        scenario = generate(rng, size)
        if scenario.optimum > LONGEST * scenario.straight_line:
            continue
        if robots == 1:
            return scenario
        fleet = in_company(rng, scenario, robots, LONGEST)
        if fleet is not None:
            return fleet


def _log_uniform(rng: np.random.Generator, low: int, high: int) -> int:
    return round(float(np.exp(rng.uniform(np.log(low), np.log(high)))))


def _odd(low: int, high: int) -> tuple[int, ...]:
    return tuple(range(low, high + 1, 2))


def _unseen(strands: tuple[Strand, ...]) -> tuple[Strand, ...]:
    """Return what lies outside of strands among discs: a third of it more discs, the rest rings."""
    more = tuple(strand._replace(sizes=(48, 64)) for strand in strands)
    return more + tuple(
        strand._replace(families=("rings",), sizes=(16, 24, 32), weight=2 * strand.weight)
        for strand in strands
    )


_LADDER = (11, 13, 15, 17, 19, 23, 27, 31, 37, 43, 51, 61)  # each about a sixth more than the one before
_LARGER = (67, 75)  # beyond, hardly a draw is worthwhile, and hardly an ant of the textbook's arrives
_SOLIDS = ("ridges", "forest", "boxes", "caves", "pockets")
_COUNTS = {"train": 200, "validation": 50, "test": 100}

_MOUNTAIN = Strand(("mountains",), ("liu2020",), _odd(15, 27), (5, 40), (10, 100))
_FIELD = Strand(_SOLIDS, ("zhang_apf",), _odd(15, 27), (5, 40), (10, 200))
_ROOM = Strand(("rooms",), ("zhang2011",), _odd(15, 31), (5, 40), (10, 150), most=WANDERING)
_PALLET = Strand(("clutter",), ("wei2018",), (20,), (5, 40), (10, 150), most=WANDERING)
# A fleet takes five runs in the mean, up to a dozen where robots are in each other's way.
_FLEET = _ROOM._replace(sizes=_odd(15, 25), ants=(5, 30), iterations=(5, 60), most=WANDERING / 8, robots=3)
_ANY = Strand(LAYERED, TEXTBOOK, _LADDER, (5, 50), (3, 200))
# Way-points settle round scattered discs whatever the parameters; between walls these matter. With twelve way-points,
# fewer than a hundred cycles find nothing; with four, tens of them do.
_DISCS = Strand(("corridors",), ("wu2018",), (16, 20, 24, 32), (10, 60), (100, 2000), weight=2)
_SCATTERED = _DISCS._replace(families=("wu2018", "scatter"), sizes=(12, 20, 32), weight=1)
_TABU_BEE = (
    _DISCS,
    _SCATTERED,
    *(
        strand._replace(rules=("wu2018-4",), ants=(5, 80), iterations=(20, 1000))
        for strand in (_DISCS, _SCATTERED)
    ),
)
_PLAIN = {
    "wu2018": ("wu2018-basic", "abc_standard", "abc_gbest"),
    "wu2018-4": ("abc_standard-4", "abc_gbest-4"),
}
_BEE = tuple(strand._replace(rules=_PLAIN[strand.rules[0]]) for strand in _TABU_BEE)
# Weights add up to two for every rule, to nine for layered worlds and to nine for flat ones.
_OPEN = (
    _ANY._replace(weight=2, rules=("liu2020",)),
    _ANY._replace(weight=2, rules=("zhang_apf",), most=FIELD),
    _ANY._replace(weight=4, families=FLAT, rules=("zhang2011", "wei2018"), most=WANDERING),
    _ANY._replace(weight=5),
    _ANY._replace(weight=5, families=FLAT),
)

SUITES: dict[str, Recipe] = {
    "mountain-v0": Recipe(
        (_MOUNTAIN,),
        {**_COUNTS, "ood": 48},
        ood=(
            _MOUNTAIN._replace(sizes=(33, 39, 45)),
            _MOUNTAIN._replace(families=_SOLIDS),
        ),
        terrain=("liu2020",),
        rotations=4,
    ),
    "potential-field-v0": Recipe(
        (_FIELD,),
        {**_COUNTS, "ood": 96},
        ood=(_FIELD._replace(sizes=(33, 39, 45)), _FIELD._replace(families=("mountains",))),
        terrain=_FIELD.rules,
    ),
    "room-v0": Recipe(
        (_ROOM,),
        {**_COUNTS, "ood": 112},
        ood=(_ROOM._replace(sizes=(37, 43, 51)), _ROOM._replace(families=("mazes", "clutter", "warehouse"))),
    ),
    "fleet-v0": Recipe(
        (_FLEET,),
        {**_COUNTS, "ood": 112},
        ood=(_FLEET._replace(sizes=(33, 39)), _FLEET._replace(families=("clutter", "warehouse"))),
    ),
    "pallet-v0": Recipe(
        (_PALLET,),
        {**_COUNTS, "ood": 112},
        ood=(_PALLET._replace(sizes=(30, 40)), _PALLET._replace(families=("rooms", "mazes", "warehouse"))),
    ),
    "open-v0": Recipe(
        _OPEN,
        {"train": 1600, "validation": 100, "test": 200, "ood": 88},
        ood=tuple(strand._replace(sizes=_LARGER) for strand in _OPEN),
        terrain=("liu2020", "zhang_apf", *TEXTBOOK),
    ),
    "bee-v0": Recipe(
        _BEE,
        {**_COUNTS, "ood": 180},
        ood=_unseen(_BEE),
    ),
    "tabu-bee-v0": Recipe(
        _TABU_BEE,
        {**_COUNTS, "ood": 180},
        ood=_unseen(_TABU_BEE),
    ),
}
