"""Recipes: what suites are mixed of, and that the mixture is what it says."""

import math
from collections import Counter

import numpy as np
import pytest

from antgym.maps.generators import FAMILIES
from antgym.maps.generators.discs import DISC_FAMILIES
from antgym.maps.recipes import FLAT, LAYERED, LONGEST, SUITES, TEXTBOOK, Strand, draw
from antgym.maps.suites import SPLITS, load_suite
from antgym.planners.bee_rules import BEE_PAPERS
from antgym.planners.rules import PAPERS

STRANDS = [
    pytest.param(strand, id=f"{name}-{i}")
    for name, recipe in SUITES.items()
    for i, strand in enumerate((*recipe.strands, *recipe.ood))
]
NEW = [name for name in SUITES if name != "mountain-v0"]


def picks(split, count=3000):
    """What kinds of items the flagship draws, without drawing their worlds."""
    return [SUITES["open-v0"].pick(split, np.random.default_rng([7, i])) for i in range(count)]


def size_of(item):
    """Cells a side, or discs."""
    world = item.scenario.world
    return len(world.discs) if SUITES[item.name.split("/")[0]].discs else world.shape[0]


def test_every_family_is_flat_or_layered():
    assert sorted((*LAYERED, *FLAT)) == sorted(FAMILIES)
    for family in FAMILIES:
        scenario = FAMILIES[family](np.random.default_rng(0), 11)
        assert scenario.motion.layered == (family in LAYERED)
        assert (scenario.world.shape[2] == 1) == (family in FLAT)


@pytest.mark.parametrize("strand", STRANDS)
def test_strands_name_known_families_and_keep_to_one_motion(strand):
    assert any(set(strand.families) <= set(kind) for kind in (LAYERED, FLAT, DISC_FAMILIES))


@pytest.mark.parametrize("recipe", SUITES.values(), ids=SUITES)
def test_bees_fly_among_discs_and_ants_walk_on_grids(recipe):
    rules = {rule for strand in (*recipe.strands, *recipe.ood) for rule in strand.rules}
    assert rules <= set(BEE_PAPERS if recipe.discs else PAPERS)
    assert len({rule in BEE_PAPERS and BEE_PAPERS[rule].tabu > 0 for rule in rules}) == 1, "one space a suite"


@pytest.mark.parametrize("strand", STRANDS)
def test_efforts_lie_in_their_ranges_and_under_the_cap(strand):
    rng = np.random.default_rng(0)
    for size in strand.sizes:
        efforts = np.array([strand.effort(rng, size) for _ in range(50)])
        for column, (low, high) in zip(efforts.T, (strand.ants, strand.iterations), strict=True):
            assert low <= column.min() <= column.max() <= high
        assert efforts.prod(axis=1).max() * size**2 <= strand.most


def test_efforts_are_log_uniform():
    strand, rng = Strand(FLAT, ("wei2018",), (11,), (5, 50), (3, 200)), np.random.default_rng(0)
    ants, iterations = np.log([strand.effort(rng, 11) for _ in range(4000)]).T
    assert np.median(ants) == pytest.approx((math.log(5) + math.log(50)) / 2, abs=0.08)
    assert np.median(iterations) == pytest.approx((math.log(3) + math.log(200)) / 2, abs=0.12)
    assert abs(np.corrcoef(ants, iterations)[0, 1]) < 0.06


@pytest.mark.parametrize("split", ["train", "ood"])
def test_every_rule_is_a_ninth_of_the_flagship_and_every_dimension_a_half(split):
    kinds = picks(split)
    rules = Counter(rules for _, _, rules in kinds)
    assert set(rules) == {"liu2020", "zhang_apf", "zhang2011", "wei2018", *TEXTBOOK}
    assert max(abs(count / len(kinds) - 1 / 9) for count in rules.values()) < 0.02
    assert np.mean([family in FLAT for _, family, _ in kinds]) == pytest.approx(0.5, abs=0.03)


def test_rules_meet_the_families_that_they_are_for():
    pairs = {(rules, family) for _, family, rules in picks("train")}
    assert pairs == {
        *((rules, family) for rules in ("liu2020", "zhang_apf", *TEXTBOOK) for family in LAYERED),
        *((rules, family) for rules in ("zhang2011", "wei2018", *TEXTBOOK) for family in FLAT),
    }


@pytest.mark.slow
@pytest.mark.parametrize("split", SPLITS[:3])
def test_every_split_of_the_flagship_shows_every_rule_and_family(split):
    items = load_suite("open-v0", split)[:400]
    assert len({item.rules for item in items}) == 9
    assert len({item.family for item in items}) == 10


@pytest.mark.parametrize("name", NEW)
def test_ood_is_larger_or_of_other_families(name):
    recipe = SUITES[name]
    largest = max(max(strand.sizes) for strand in recipe.strands)
    for strand in recipe.ood:
        assert min(strand.sizes) > largest or not set(strand.families) & set(recipe.families)


@pytest.mark.parametrize("name", NEW)
def test_items_are_what_their_strands_say(name):
    for item in load_suite(name, "validation")[:30]:
        assert any(
            item.family in strand.families and item.rules in strand.rules and size_of(item) in strand.sizes
            for strand in SUITES[name].strands
        )


def test_no_shortest_path_is_longer_than_five_straight_lines():
    seeds = range(400)
    first = [FAMILIES["mazes"](np.random.default_rng(seed), 21) for seed in seeds]
    long = [seed for seed, s in zip(seeds, first, strict=True) if s.optimum > LONGEST * s.straight_line]
    assert long
    for seed in long:
        scenario = draw("mazes", np.random.default_rng(seed), 21)
        assert scenario.optimum <= LONGEST * scenario.straight_line
    assert draw("mazes", np.random.default_rng(0), 21).digest == first[0].digest
