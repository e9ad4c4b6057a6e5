"""Sanity of learned agents: misled about the map, those that look at it do something else, and nobody else does."""

import numpy as np
import pytest

from agents.search import ZeroShot
from antgym.errors import ParameterError
from antgym.maps.suites import SuiteItem, load_suite
from antgym.tuning.features import TASK_FEATURES
from experiments.artefacts import prepare, problem
from experiments.presets import PRESETS
from experiments.sanity import Arguments, Misled, compare, misleading, partners

EFFORT = [i for i, feature in enumerate(TASK_FEATURES) if feature.name in ("ants", "iterations")]


def test_a_partner_is_another_map_of_the_same_rules_and_the_next_in_effort():
    rules = ["a", "b", "a", "a", "c", "b", "a", "a"]
    items = [
        SuiteItem(str(i), None, 10, effort, rules[i])
        for i, effort in enumerate((5, 9, 900, 7, 3, 8, 40, 800))
    ]
    assert partners(items) == {0: 3, 3: 0, 6: 7, 7: 2, 2: 6, 1: 5, 5: 1}


def test_what_misleads_is_another_map_with_the_effort_and_the_parameters_of_this_one():
    items = load_suite("open-v0", "validation")[:40]
    items = [items[i] for i in sorted(partners(items))][:4]
    shown = misleading(items)
    for i, other in partners(items).items():
        task, theirs = problem(items[i]).task(0), problem(items[other]).task(0)
        seen = shown[task.features.tobytes()]
        kept = np.delete(theirs.features, EFFORT)
        assert np.delete(seen.features, EFFORT).tolist() == kept.tolist()
        assert seen.features[EFFORT].tolist() == task.features[EFFORT].tolist()
        assert (seen.space, seen.map) == (task.space, theirs.map)
        assert (kept != np.delete(task.features, EFFORT)).any()


class Looker(ZeroShot):
    """Recommends what the first features are."""

    def _choose(self, task, seed):
        return task.features[:4].astype(float)


def test_an_agent_is_misled_and_left_as_it_was(valley):
    items = load_suite("mountain-v0", "validation")[:2]
    tasks = [problem(item).task(0) for item in items]
    looker = Looker()
    looker.reset(tasks[0], seed=0)
    misled = Misled(looker, misleading(items))
    misled.reset(tasks[0], seed=0)
    assert misled.recommend().tolist() == tasks[1].features[:4].tolist()
    assert looker.recommend().tolist() == tasks[0].features[:4].tolist()


@pytest.fixture
def asked(tmp_path):
    """A function that returns arguments of a comparison on a few maps, with an experience of next to nothing."""
    tiny = PRESETS["smoke"]._replace(experience_trials=48)
    prepare(tmp_path / "trained", "mountain-v0", tiny, ["portfolio"])

    def made(*agents, **others):
        given = {"suite": "mountain-v0", "maps": 3, "fresh": 2, "against": "published_default", **others}
        return Arguments(agents, **given, artefacts=tmp_path / "trained", out=tmp_path / "out")

    return made


def test_who_looks_at_no_map_loses_nothing_and_the_same_command_goes_on(asked):
    text = compare(asked("portfolio", "neighbours"))
    cells = {row.split(" | ")[0]: row.split(" | ") for row in text.splitlines() if row.startswith("| `")}
    assert cells["| `portfolio`"][4:6] == ["+0.0", "+0.0 to +0.0"]
    assert cells["| `portfolio`"][6:8] == [cell.removesuffix(" |") for cell in cells["| `portfolio`"][8:10]]
    assert list(cells) == ["| `portfolio`", "| `neighbours`"]
    assert compare(asked("portfolio", "neighbours")) == text


@pytest.mark.parametrize(
    "others", [{"maps": 1}, {"fresh": 0}, {"suite": "open-v0", "maps": 2, "split": "ood"}]
)
def test_what_cannot_be_compared_is_one_clear_error(asked, others):
    with pytest.raises(ParameterError, match="--maps"):
        compare(asked("portfolio", **others))


def test_shipped_policies_take_part_by_name_and_maps_left_out_are_counted(tmp_path):
    pytest.importorskip("sb3_contrib")
    pytest.importorskip("safetensors")
    given = {
        "maps": 3,
        "fresh": 1,
        "against": "published_default",
        "artefacts": tmp_path,
        "out": tmp_path / "out",
    }
    text = compare(Arguments(("rl:open-one-shot", "open-one-shot-2"), **given))
    assert "Of 3 maps 1 are left out" in text
    assert [row.split("`")[1] for row in text.splitlines() if row.startswith("| `")] == [
        "rl:open-one-shot",
        "open-one-shot-2",
    ]


@pytest.mark.parametrize(
    ("agents", "message"),
    [
        (("rl",), r"policy\.json is not there; .*rl:open-one-shot"),
        (("best_static_by_rules",), r"experiments\.artefacts best_static_by_rules --suite open-v0"),
        (("rl:open-trials",), "budgets are 1 or more"),
        (("open-trials",), "budgets are 1 or more"),
        (("rl:open-committee",), "it is rl_committee:open-committee"),
        (("rll",), "did you mean 'rl'"),
    ],
)
def test_who_cannot_be_asked_is_named_and_nothing_is_written(tmp_path, agents, message):
    pytest.importorskip("sb3_contrib")
    pytest.importorskip("safetensors")
    given = {"maps": 3, "against": "published_default", "artefacts": tmp_path, "out": tmp_path / "out"}
    with pytest.raises(ParameterError, match=message):
        compare(Arguments(agents, **given))
    assert not list(tmp_path.iterdir())
