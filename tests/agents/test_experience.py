"""The experience: one table, paid once, saved and read without running anything of it."""

import dataclasses
import json

import numpy as np
import pytest

from agents.experience import Experience
from antgym.errors import BudgetError, ParameterError
from antgym.tuning.features import TASK_FEATURES

NAMES = tuple(feature.name for feature in TASK_FEATURES)


def small(costs=(((1.0, 1.0), (1.5, 1.5)), ((2.0, 2.0), (1.0, 1.0))), features=((0.0, 1.0), (1.0, 1.0))):
    """Two maps, two settings, two runs, one feature that tells them apart and one that does not."""
    return Experience(("a", "b"), ("x", "y"), ("f", "g"), features, ((0.1, 0.2), (0.3, 0.4)), costs)


def test_gathering_pays_for_every_run(experience):
    assert np.shape(experience.costs) == (10, 32, 2)
    assert experience.evaluations == 10 * 32 * 2


def test_gathering_stops_before_spending_where_a_session_is_too_short(bowl):
    sessions = [bowl(8), bowl(7)]
    with pytest.raises(BudgetError, match="session 1: 7 trials left, 8 are needed"):
        Experience.gather(sessions, np.full((4, 4), 0.5), described=NAMES)
    assert sessions[0].left == 8


def test_an_experience_of_nothing_is_refused():
    with pytest.raises(ParameterError, match="needs maps, settings and repeats"):
        Experience.gather([], np.full((4, 4), 0.5), described=NAMES)


def test_regrets_are_logs_of_means_over_the_best_of_the_map():
    np.testing.assert_allclose(small().regrets, [[0, np.log(1.5)], [np.log(2), 0]])


def test_a_failure_counts_as_twice_the_best_of_its_map():
    found = small(costs=(((1.0, 1.0), (10.0, 10.0)), ((10.0, 10.0), (1.0, 1.0))))
    np.testing.assert_allclose(found.regrets, [[0, np.log(2)], [np.log(2), 0]])


def test_noise_is_the_variance_between_runs_of_one_setting():
    found = small(costs=(((1.0, 1.2), (1.5, 1.5)), ((1.0, 1.0), (1.0, 1.0))))
    assert found.spread.noise == pytest.approx(np.log(1.2) ** 2 / 2 / 4)
    assert small().spread.noise == 0


def test_features_are_standardised_and_those_that_never_differ_are_nothing():
    assert small().standardise(np.array([[1.0, 7.0], [1e9, 0.0]])).tolist() == [[1.0, 0.0], [5.0, 0.0]]


def test_maps_under_the_tasks_own_rules_speak_where_there_are_enough(bowl, experience):
    shown = NAMES.index("rules_max_min")
    features = np.array(experience.features)
    features[:8, shown] = 1
    mixed = dataclasses.replace(experience, features=tuple(map(tuple, features.tolist())))
    task = bowl(1).task
    assert mixed.akin(task).tolist() == list(range(10))  # two maps without a rule are too few
    rules = task.features.copy()
    rules[shown] = 1
    assert mixed.akin(dataclasses.replace(task, features=rules)).tolist() == list(range(8))


def test_a_task_with_other_parameters_or_features_is_refused(bowl, experience):
    with pytest.raises(ParameterError, match="the experience is of"):
        small().check(bowl(1).task)
    short = dataclasses.replace(bowl(1).task, features=np.zeros(3, np.float32))
    with pytest.raises(ParameterError, match="gather it anew"):
        experience.check(short)


def test_an_experience_comes_back_as_it_was(tmp_path, experience):
    experience.save(tmp_path / "experience.json")
    assert Experience.load(tmp_path / "experience.json") == experience


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", '{"format": "antgym transfer graph 2"}', "\xff", "[" * 100_000, "null"]
)
def test_a_file_that_is_no_experience_is_named(tmp_path, text):
    path = tmp_path / "experience.json"
    path.write_bytes(text.encode("latin-1"))
    with pytest.raises(ParameterError, match=r"experience\.json") as caught:
        Experience.load(path)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("path", ["absent.json", ""])
def test_a_file_that_cannot_be_read_is_named(tmp_path, path):
    with pytest.raises(ParameterError, match=r"no (such )?experience"):
        Experience.load(tmp_path / path)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("names", ["a"]),
        ("names", 3),
        ("parameters", ["a"]),
        ("features", [[1]]),
        ("features", [["x"]]),
        ("units", []),
        ("units", [[2.0] * 4] * 32),
        ("costs", [[[1.0]]]),
        ("costs", [[[-1.0, 1.0]] * 32] * 10),
        ("costs", [[[1.0], [1.0, 2.0]]]),
        ("costs", {"a": 1}),
    ],
)
def test_a_damaged_experience_is_one_line_with_its_file(tmp_path, experience, name, value):
    path = tmp_path / "experience.json"
    experience.save(path)
    path.write_text(json.dumps({**json.loads(path.read_text()), name: value}))
    with pytest.raises(ParameterError, match=r"experience\.json") as caught:
        Experience.load(path)
    assert "\n" not in str(caught.value)
