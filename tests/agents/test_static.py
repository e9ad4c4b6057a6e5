"""The best static setting: raced over maps, kept as JSON."""

import numpy as np
import pytest

from agents.static import StaticAgent, StaticByRules, StaticSetting, StaticSettings, race, race_by_rules
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


OTHERS = ["", "[]", '{"format": "another"}', '{"format": "antgym static setting 1"}', '{"by_rules": {}}']


@pytest.mark.parametrize("agent", [StaticAgent, StaticByRules])
@pytest.mark.parametrize("text", OTHERS)
def test_a_file_that_is_no_setting_is_named(tmp_path, text, agent):
    (tmp_path / "static.json").write_text(text)
    with pytest.raises(ParameterError, match=r"static\.json: no 'antgym static"):
        agent(tmp_path / "static.json")


def test_a_race_without_maps_or_settings_is_refused(bowl):
    with pytest.raises(ParameterError, match="0 and 4"):
        race([], np.zeros((4, 4)))


def test_every_rule_has_a_race_of_its_own(bowl):
    optima = {"liu2020": (0.1, 0.1, 0.9, 0.9), "max_min": (0.8, 0.8, 0.2, 0.2)}
    sessions = [
        bowl(100, rules=rules, optimum=optimum) for _ in range(3) for rules, optimum in optima.items()
    ]
    candidates = np.vstack([np.random.default_rng(0).random((6, 4)), *optima.values()])
    settings = race_by_rules(sessions, candidates, first=2)
    assert {rules: setting.unit for rules, setting in settings.by_rules.items()} == optima
    assert settings.evaluations == sum(len(session.trials) for session in sessions)


def test_settings_by_rules_survive_their_file_and_go_to_the_tasks_of_their_rules(tmp_path, bowl):
    names = bowl(1).space.names
    settings = StaticSettings(
        {r: StaticSetting((u,) * 4, 5, names) for r, u in (("liu2020", 0.1), ("elitist", 0.9))}
    )
    settings.save(tmp_path / "static.json")
    agent = StaticByRules(tmp_path / "static.json")
    assert agent.settings == settings
    for rules, unit in (("elitist", 0.9), ("liu2020", 0.1)):
        agent.reset(bowl(1, rules=rules).task, seed=0)
        assert agent.recommend().tolist() == [unit] * 4


def test_rules_that_were_not_raced_are_refused(bowl):
    agent = StaticByRules(StaticSettings({"liu2020": StaticSetting((0.5,) * 4, 5, bowl(1).space.names)}))
    with pytest.raises(ParameterError, match="'max_min', only for liu2020"):
        agent.reset(bowl(1, rules="max_min").task, seed=0)


def test_a_task_that_shows_no_published_rules_is_refused(bowl):
    unshown = bowl(5)
    unshown.task.features[:] = 0
    with pytest.raises(ParameterError, match="rules of its own"):
        race_by_rules([unshown], np.zeros((2, 4)))


def test_a_setting_for_other_parameters_is_refused(bowl):
    with pytest.raises(ParameterError, match="the setting is for"):
        StaticAgent(StaticSetting((0.5,), 5, ("limit",))).reset(bowl(1).task, seed=0)
