"""Explanations: what an agent does look at shows, what it does not look at does not."""

import numpy as np
import pytest

pytest.importorskip("matplotlib")

from agents.search import ZeroShot
from antgym.errors import ParameterError
from antgym.maps.suites import load_suite
from antgym.tuning.features import DISC_TASK_FEATURES, TASK_FEATURES
from experiments import explain
from experiments.explain import Arguments, explained

ITEM = load_suite("mountain-v0", "test")[0]
NAMES = [feature.name for feature in explained(ITEM.rules)]
BLOCKED = [feature.name for feature in TASK_FEATURES].index("blocked")


class Looker(ZeroShot):
    """Raises beta where more is blocked, and alpha with the iterations."""

    def _choose(self, task, seed):
        return np.array([min(task.iterations / 1000, 1.0), float(task.features[BLOCKED]), 0.5, 0.5])


@pytest.fixture
def donors():
    values = np.tile(explain._task(ITEM).features, (6, 1))
    values[:, BLOCKED] = np.linspace(0, 1, 6)
    return values


def test_the_feature_that_is_looked_at_moves_the_choice_and_no_other(donors):
    found = explain.explain(Looker(), ITEM, donors)
    row = NAMES.index("blocked")
    assert found.moved[row] > 0.1
    assert np.delete(found.moved, row).tolist() == [0.0] * (len(NAMES) - 1)
    assert found.trends[row] == pytest.approx([0.0, 0.6, 0.0, 0.0])
    assert "| blocked |" in explain.to_markdown(found, "looker")


@pytest.mark.parametrize(
    ("values", "trend"),
    [((0, 0.5, 1, 1, 1, 1), 0.75), ((0, 0, 0, 0, 1, 1), 1.0), ((0.1, 0.1, 0.2, 0.2, 0.3, 0.3), 0.15)],
)
def test_values_that_most_donors_share_still_have_those_above_and_below(donors, values, trend):
    """By hand; of the first, more than half hold the largest value, so that none is above the median."""
    donors[:, BLOCKED] = values
    found = explain.explain(Looker(), ITEM, donors)
    assert found.trends[NAMES.index("blocked")] == pytest.approx([0.0, trend, 0.0, 0.0])


def test_where_all_donors_are_the_same_there_is_no_trend(donors):
    donors[:, BLOCKED] = 0.9
    found = explain.explain(Looker(), ITEM, donors)
    assert found.moved[NAMES.index("blocked")] > 0
    row = next(line for line in explain.to_markdown(found, "looker").splitlines() if "| blocked |" in line)
    assert row.endswith("| – | – | – | – |")


def test_past_discs_it_is_the_features_of_discs_that_move_the_choice():
    class Wary(ZeroShot):
        """Raises the limit with the discs, and ξ_max with the bees."""

        def _choose(self, task, seed):
            discs = [feature.name for feature in DISC_TASK_FEATURES].index("discs")
            return np.array([float(task.features[discs]), min(task.ants / 1000, 1.0), 0.5, 0.5])

    items = load_suite("tabu-bee-v0", "train")[:8]
    found = explain.explain(Wary(), items[0], np.stack([explain._task(item).features for item in items]))
    names = [feature.name for feature in found.features]
    assert set(np.flatnonzero(found.moved)) == {names.index("discs")}
    assert not any(name.startswith("rules_") or name in ("ants", "iterations") for name in names)
    counts = [count for count, _, _ in found.efforts["ants"]]
    assert min(counts) >= 4
    assert "bees" in explain.to_markdown(found, "wary")


def test_effort_moves_the_choice_by_itself(donors):
    found = explain.explain(Looker(), ITEM, donors)
    assert [unit[0] for count, _, unit in found.efforts["iterations"]] == pytest.approx(
        [min(count / 1000, 1.0) for count, _, _ in found.efforts["iterations"]]
    )
    assert len({unit[0] for _, _, unit in found.efforts["ants"]}) == 1


def test_an_agent_that_looks_at_nothing_is_said_to(tmp_path):
    files = explain.run(
        Arguments("published_default", suite="mountain-v0", index=(0, 1), donors=2, out=tmp_path)
    )
    assert len(files) == 2
    for file in files:
        assert "No feature moves it" in file.read_text()
        assert "trials" not in file.read_text()
        assert file.with_suffix(".png").read_bytes().startswith(b"\x89PNG")


def test_an_agent_that_chooses_by_trials_is_explained_as_it_starts_and_that_is_said(donors, tmp_path):
    class Starter(Looker):
        """Looks where to start, and tries that where it can."""

        def ask(self):
            return self._setting[None]

    said = explain.to_markdown(explain.explain(Starter(), ITEM, donors), "starter")
    assert "starter chooses by trials; this is its answer without any, from which it starts." in said
    asked = Arguments("random_search", suite="mountain-v0", donors=2, out=tmp_path)
    (file,) = explain.run(asked)
    assert "random_search chooses by trials; this is its answer without any" in file.read_text()
    assert "from which it starts: the same on every map, for no feature moves it." in file.read_text()


def test_a_published_policy_is_explained_by_its_file(tmp_path):
    pytest.importorskip("sb3_contrib")
    pytest.importorskip("safetensors")
    from blank_models import blank_model

    from agents.networks import export

    export(blank_model(), tmp_path / "p")
    (file,) = explain.run(
        Arguments(str(tmp_path / "p.json"), suite="mountain-v0", donors=3, out=tmp_path / "out")
    )
    assert file.name.startswith("p-")
    assert file.read_text().count("\n| ") > 10
    for name in ("open-one-shot", "rl:open-one-shot"):
        agent, called = explain._find(Arguments(name))
        assert (agent.path.name.removesuffix(".json"), called) == ("open-one-shot", name)


@pytest.mark.parametrize(
    ("others", "message"),
    [({"donors": 1}, "--donors 1"), ({"index": (10**6,)}, "--index 1000000: this split holds 0 to")],
)
def test_what_cannot_be_explained_is_one_clear_error(others, message):
    with pytest.raises(ParameterError, match=message):
        explain.run(Arguments("published_default", suite="mountain-v0", **others))


def test_a_misspelt_name_leads_to_the_nearest_agent_or_policy():
    for name, meant in (
        ("rll", "rl"),
        ("open-on-shot", "open-one-shot"),
        ("rl:open-on-shot", "rl:open-one-shot"),
    ):
        with pytest.raises(ParameterError, match=f"did you mean {meant!r}"):
            explain.run(Arguments(name, suite="mountain-v0"))
