"""Suites: pure functions of their names, disjoint, and unchanged since they were published."""

import importlib.util

import pytest

from antgym.errors import MissingExtraError, ParameterError
from antgym.maps import suites
from antgym.maps.suites import SPLITS, SUITES, Suite, load_suite

needs_matplotlib = pytest.mark.skipif(
    importlib.util.find_spec("matplotlib") is None, reason="matplotlib is absent"
)
DIGESTS = {
    "train": "8d65ff2bce1256a4",
    "validation": "b2fffbedcc5e4123",
    "test": "535c7146fef40893",
    "ood": "e7be8c3868023b22",
}


@pytest.mark.parametrize("split", [*SPLITS[:3], pytest.param("ood", marks=needs_matplotlib)])
def test_a_published_suite_never_changes(split):
    """Whoever means to change a world makes a new version of its suite; results name the old one."""
    assert load_suite("mountain-v0", split).digest[:16] == DIGESTS[split]


def test_splits_have_the_promised_sizes_and_share_no_scenario():
    splits = [load_suite("mountain-v0", split) for split in SPLITS[:3]]
    assert [len(split) for split in splits] == [200, 50, 100]
    assert len({item.scenario.digest for split in splits for item in split}) == 350
    assert len({item.name for split in splits for item in split}) == 350


def test_items_depend_neither_on_the_order_of_access_nor_on_the_object():
    forwards, backwards = Suite("mountain-v0", "test"), Suite("mountain-v0", "test")
    late = [backwards[i] for i in (5, 2, 0)]
    early = [forwards[i] for i in (0, 2, 5)]
    for one, other in zip(early, reversed(late), strict=True):
        assert one.scenario.digest == other.scenario.digest
        assert one[2:] == other[2:]


def test_items_keep_to_the_announced_sizes_and_efforts():
    items = load_suite("mountain-v0", "train")
    assert {item.scenario.world.shape[0] for item in items} == {15, 17, 19, 21, 23, 25, 27}
    assert {item.rules for item in items} == {"liu2020"}
    for values, low, high in (([i.ants for i in items], 5, 40), ([i.iterations for i in items], 10, 100)):
        assert low <= min(values) <= 1.2 * low
        assert high / 1.2 <= max(values) <= high


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
    with pytest.raises(ParameterError, match=r"unknown suite 'mountains'; did you mean 'mountain-v0'\?"):
        load_suite("mountains", "train")
    with pytest.raises(ParameterError, match=r"unknown split 'valid'; did you mean 'validation'\?"):
        load_suite("mountain-v0", "valid")


@needs_matplotlib
def test_the_first_real_items_are_different_windows():
    suite = load_suite("mountain-v0", "ood")
    assert len(suite) == 64
    assert len({item.name.rsplit("-", 1)[0] for item in suite[:16]}) == 16
    assert {(item.ants, item.iterations, item.rules) for item in suite} == {(20, 50, "liu2020")}
    assert suite[17].name == "jacksboro-r0c1-90"


def test_only_the_real_maps_need_matplotlib(monkeypatch):
    suites._real_terrain.cache_clear()
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    assert Suite("mountain-v0", "train")[0].ants > 0
    with pytest.raises(MissingExtraError, match="matplotlib"):
        len(Suite("mountain-v0", "ood"))


@pytest.mark.parametrize("name", SUITES)
def test_recipes_name_known_families(name):
    assert SUITES[name].family in suites.FAMILIES
