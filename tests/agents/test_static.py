"""The best static setting: raced over maps, kept as JSON."""

import numpy as np
import pytest

from agents.static import StaticAgent, StaticSetting, race
from antgym.errors import ParameterError


def test_a_race_finds_the_candidate_at_the_optimum_and_counts_what_it_spent(bowl):
    sessions = [bowl(1000, noise=0.05) for _ in range(40)]
    candidates = np.vstack([np.random.default_rng(0).random((31, 4)), [(0.3, 0.7, 0.6, 0.4)]])
    winner = race(sessions, candidates, first=4)
    assert winner.unit == (0.3, 0.7, 0.6, 0.4)
    assert winner.evaluations == sum(len(session.trials) for session in sessions)


def test_later_rounds_are_run_by_fewer_settings_on_more_maps(bowl):
    sessions = [bowl(1000) for _ in range(4 + 16 + 3)]
    race(sessions, np.random.default_rng(1).random((32, 4)), first=4)
    assert [len(s.trials) for s in sessions] == [32] * 4 + [8] * 16 + [2] * 3


def test_a_map_on_which_everything_fails_decides_nothing(bowl):
    sessions = [bowl(1000, fails=True), *(bowl(1000) for _ in range(8))]
    candidates = np.array([(0.9, 0.1, 0.1, 0.9), (0.3, 0.7, 0.6, 0.4)])
    assert race(sessions, candidates).unit == (0.3, 0.7, 0.6, 0.4)


def test_a_setting_survives_its_file(tmp_path):
    setting = StaticSetting((0.1, 0.25, 1 / 3, 0.9), 77, ("alpha", "beta", "rho", "Q"))
    setting.save(tmp_path / "static.json")
    assert StaticAgent(tmp_path / "static.json").setting == setting


@pytest.mark.parametrize("text", ["", "[]", '{"format": "another"}', '{"format": "antgym static setting 1"}'])
def test_a_file_that_is_no_setting_is_named(tmp_path, text):
    (tmp_path / "static.json").write_text(text)
    with pytest.raises(ParameterError, match=r"static\.json"):
        StaticAgent(tmp_path / "static.json")


def test_a_race_without_maps_or_settings_is_refused(bowl):
    with pytest.raises(ParameterError, match="0 and 4"):
        race([], np.zeros((4, 4)))
