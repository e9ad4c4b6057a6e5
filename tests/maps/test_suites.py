"""Suites: pure functions of their names, disjoint, and unchanged since they were published."""

import hashlib
import importlib.util
from itertools import chain, combinations

import pytest

from antgym.errors import MissingExtraError, ParameterError
from antgym.maps import suites
from antgym.maps.discs import DiscWorld
from antgym.maps.recipes import SUITES
from antgym.maps.suites import SPLITS, Suite, load_suite

needs_matplotlib = pytest.mark.skipif(
    importlib.util.find_spec("matplotlib") is None, reason="matplotlib is absent"
)
DIGESTS = {
    "bee-v0": ("4818a3bef935ae20", "1b3552f406aa1226", "b7e429f233c0a457", "1f20a054167146e8"),
    "tabu-bee-v0": ("ccc615a5062978d9", "60dba9af14283cd5", "f9d82453a279da84", "1fdae5d62ab5c328"),
    "mountain-v0": ("8d65ff2bce1256a4", "b2fffbedcc5e4123", "535c7146fef40893", "13a4ca42b75295c9"),
    "potential-field-v0": ("a1d8918db1e3dae8", "b7e7a182abc23a99", "31d1023a482decf1", "91450621e4cf9caa"),
    "room-v0": ("1b4be16eb54b0654", "fb7b6baa4ffff767", "a06b691a744881dc", "53a06421d6fb4c91"),
    "fleet-v0": ("3b3d671150984ee3", "93f1902a7dabd5ba", "fe526fb29d6ebcc5", "be7b5acad088d188"),
    "pallet-v0": ("ccef443a4d25029c", "8fabfb96a6088e52", "341c4c95502a8c56", "d8af024c9c88d896"),
    "open-v0": ("53d0994d1058bb0c", "6b245e08dce1951d", "c13f841fe1bf78d4", "e9d2f8065b5b87f5"),
}
COUNTS = {
    "bee-v0": (200, 50, 100, 180),
    "tabu-bee-v0": (200, 50, 100, 180),
    "mountain-v0": (200, 50, 100, 112),
    "potential-field-v0": (200, 50, 100, 112),
    "room-v0": (200, 50, 100, 112),
    "fleet-v0": (200, 50, 100, 112),
    "pallet-v0": (200, 50, 100, 112),
    "open-v0": (1600, 100, 200, 104),
}
every_suite = pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow) if name == "open-v0" else name for name in SUITES]
)


def some(name, split):
    """The items of a split; of the 1,600 that open-v0 trains on, the first 200 and every 40th of the others."""
    items = load_suite(name, split)
    return [*items[:200], *items[200::40]]


def digest(items):
    """What ``Suite.digest`` is of a whole split."""
    lines = (f"{item.scenario.digest} {item.ants} {item.iterations} {item.rules}\n" for item in items)
    return hashlib.sha256("".join(lines).encode()).hexdigest()


def world_digest(item):
    """Of the cells, or the discs, alone: another start in the same world would be a leak too."""
    world = item.scenario.world
    held = world.discs if isinstance(world, DiscWorld) else world.free
    return hashlib.sha256(repr(held.shape).encode() + held.tobytes()).hexdigest()


@needs_matplotlib
@every_suite
def test_a_published_suite_never_changes(name):
    """Whoever means to change a world makes a new version of its suite; results name the old one."""
    assert tuple(digest(some(name, split))[:16] for split in SPLITS) == DIGESTS[name]


def test_the_digest_of_a_suite_is_that_of_its_items():
    suite = load_suite("mountain-v0", "validation")
    assert suite.digest == digest(suite)


@needs_matplotlib
@every_suite
def test_no_world_occurs_in_two_splits(name):
    worlds = [{world_digest(item) for item in some(name, split)} for split in SPLITS]
    assert all(not one & other for one, other in combinations(worlds, 2))


@needs_matplotlib
@pytest.mark.slow
def test_what_is_trained_on_in_one_suite_is_in_no_other_split_of_any():
    """A policy of Open is tested on Mountain, too. Windows of real terrain are in several suites, and there in ood."""
    for hashed in (world_digest, lambda item: item.scenario.digest):
        found = {split: {hashed(item) for name in SUITES for item in some(name, split)} for split in SPLITS}
        assert all(not found[one] & found[other] for one, other in combinations(SPLITS, 2))


@every_suite
def test_no_scenario_occurs_twice(name):
    items = list(chain.from_iterable(some(name, split) for split in SPLITS[:3]))
    assert len({item.scenario.digest for item in items}) == len(items)
    assert len({item.name for item in items}) == len(items)


@needs_matplotlib
@pytest.mark.parametrize("name", SUITES)
def test_splits_have_the_promised_sizes(name):
    assert tuple(len(load_suite(name, split)) for split in SPLITS) == COUNTS[name]


@pytest.mark.parametrize("name", SUITES)
def test_items_depend_neither_on_the_order_of_access_nor_on_the_object(name):
    forwards, backwards = Suite(name, "test"), Suite(name, "test")
    late = [backwards[i] for i in (5, 2, 0)]
    early = [forwards[i] for i in (0, 2, 5)]
    for one, other in zip(early, reversed(late), strict=True):
        assert one.scenario.digest == other.scenario.digest
        assert one[2:] == other[2:]


def test_items_keep_to_the_announced_sizes_and_efforts():
    items = load_suite("mountain-v0", "train")
    assert {item.scenario.world.shape[0] for item in items} == {15, 17, 19, 21, 23, 25, 27}
    assert {(item.rules, item.family) for item in items} == {("liu2020", "mountains")}
    for values, low, high in (([i.ants for i in items], 5, 40), ([i.iterations for i in items], 10, 100)):
        assert low <= min(values) <= 1.2 * low
        assert high / 1.2 <= max(values) <= high


@pytest.mark.parametrize("name", SUITES)
def test_a_suite_is_flat_where_all_its_worlds_are(name):
    items = load_suite(name, "validation")[:20]
    worlds = [item.scenario.world for item in items]
    flat = all(isinstance(world, DiscWorld) or world.shape[2] == 1 for world in worlds)
    assert load_suite(name, "train").flat == flat


def test_a_suite_is_a_sequence_of_items_made_once():
    suite = load_suite("mountain-v0", "validation")
    assert load_suite("mountain-v0", "validation") is suite
    assert suite[3] is suite[3]
    assert suite[-1] is suite[49]
    assert suite[2:4] == (suite[2], suite[3])
    assert suite[3].name == suite[3].scenario.name == "mountain-v0/validation/3"
    assert repr(suite) == "Suite('mountain-v0', 'validation')"
    with pytest.raises(IndexError):
        suite[50]


def test_unknown_names_are_answered_with_the_nearest():
    with pytest.raises(
        ParameterError, match=r"'mountains', nor is it a folder; did you mean 'mountain-v0'\?"
    ):
        load_suite("mountains", "train")
    with pytest.raises(ParameterError, match=r"unknown split 'valid'; did you mean 'validation'\?"):
        load_suite("mountain-v0", "valid")


@needs_matplotlib
def test_the_first_real_items_are_different_windows():
    suite = load_suite("mountain-v0", "ood")
    assert len({item.name.rsplit("-", 1)[0] for item in suite[:16]}) == 16
    assert {(item.ants, item.iterations, item.rules) for item in suite[:64]} == {(20, 50, "liu2020")}
    assert [item.family == "terrain" for item in suite[:65]] == [True] * 64 + [False]
    assert suite[17].name == "jacksboro-r0c1-90"


@needs_matplotlib
@pytest.mark.parametrize("name", ["potential-field-v0", "open-v0"])
def test_ood_begins_with_real_terrain(name):
    suite = load_suite(name, "ood")
    assert [item.family == "terrain" for item in suite[:17]] == [True] * 16 + [False]
    assert {item.rules for item in suite[:16]} == set(SUITES[name].terrain)
    assert suite[0].name == "jacksboro-r0c0-0"


@needs_matplotlib
@every_suite
def test_every_claim_can_stand_on_a_hundred_maps(name):
    assert all(len(load_suite(name, split)) >= 100 for split in ("test", "ood"))


def test_only_the_real_maps_need_matplotlib(monkeypatch):
    suites._real_terrain.cache_clear()
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    assert Suite("mountain-v0", "train")[0].ants > 0
    assert len(Suite("room-v0", "ood")) == 112
    with pytest.raises(MissingExtraError, match="matplotlib"):
        len(Suite("mountain-v0", "ood"))
