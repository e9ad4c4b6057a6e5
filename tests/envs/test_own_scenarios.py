"""Scenarios of one's own in the place of a suite: drawn, planned and shown like any other."""

import pickle

import gymnasium
import numpy as np
import pytest
from discs import scattered
from scenarios import drawn
from two_settings import ANTS, items

import antgym
from antgym.envs.catalogue import REGIMES
from antgym.envs.checking import check_vector_env
from antgym.errors import ParameterError, ScenarioError
from antgym.maps.motion import Motion
from antgym.maps.occupancy import picture_shape

ZERO = np.zeros(4, np.float32)


def make(regime="OneShot", **kwargs):
    return gymnasium.make(f"antgym/Mountain{regime}-v0", **{"suite": items(), **kwargs})


def episodes(env, count=6, seed=0):
    """Every observation and info of some first steps."""
    seen = []
    for episode in range(count):
        observation, begun = env.reset(seed=seed if episode == 0 else None)
        after, reward, _, _, info = env.step(ZERO)
        seen.append((observation.tolist(), begun, after.tolist(), reward, info))
    return seen


@pytest.mark.parametrize("regime", REGIMES)
def test_episodes_are_drawn_from_them_with_their_own_rules_and_efforts(regime):
    given = [items(50)[0], items(60)[1]._replace(rules="max_min")]
    seen = {info["scenario"]: info for _, info, *_ in episodes(make(regime, suite=given), 12)}
    assert set(seen) == {item.scenario.name for item in given}
    for item in given:
        info = seen[item.scenario.name]
        assert (info["rules"], info["ants"], info["iterations"]) == (item.rules, ANTS, item.iterations)


@pytest.mark.parametrize("regime", REGIMES)
def test_a_batch_of_them_repeats_single_environments(regime):
    check_vector_env(f"antgym/Mountain{regime}-v0", steps=12, suite=items(40))


def test_a_split_of_a_suite_is_as_good_as_its_name():
    suite = antgym.load_suite("room-v0", "validation")
    named = gymnasium.make("antgym/RoomOneShot-v0", split="validation", effort=[3, 5])
    assert episodes(make(suite=suite, effort=[3, 5])) == episodes(named)


def test_an_effort_and_other_arguments_hold_as_for_any_suite():
    info = make(effort=[2, 3], reward="length").reset(seed=0)[1]
    assert (info["ants"], info["iterations"]) == (2, 3)


def test_one_that_was_pickled_goes_on_like_the_original():
    env = make()
    env.reset(seed=3)
    copy = pickle.loads(pickle.dumps(env))
    assert episodes(copy, seed=None) == episodes(env, seed=None)


def test_the_map_is_flat_where_all_their_worlds_are(valley):
    tall = antgym.SuiteItem("valley", valley)
    for given, flat in ((items(), True), ([*items(), tall], False)):
        space = make(suite=given, observation="map").observation_space
        assert space["map"].shape == picture_shape(flat)


def test_an_item_needs_no_more_than_a_name_and_a_scenario(valley):
    _, info = make(suite=[antgym.SuiteItem("valley", valley)]).reset(seed=0)
    assert info["scenario"] == "valley"
    assert (info["rules"], info["ants"], info["iterations"]) == ("liu2020", 20, 50)


def test_infos_show_the_name_of_the_item_whatever_its_scenario_is_called():
    given = [item._replace(name=f"mine-{i}") for i, item in enumerate(items())]
    env = make(suite=given)
    assert [env.reset(options={"scenario": i})[1]["scenario"] for i in range(2)] == ["mine-0", "mine-1"]
    assert [item.scenario.name for item in given] == ["open", "cup"], "what was passed keeps its own"
    unnamed = make().reset(seed=0)
    assert make(suite=given).reset(seed=0)[0].tolist() == unnamed[0].tolist()


def test_a_scenario_under_another_name_is_not_worked_out_again(monkeypatch):
    given = [item._replace(name="mine") for item in items()]
    known = [item.scenario.optimum for item in given]
    monkeypatch.setattr("antgym.maps.optimum.shortest_length", lambda _: pytest.fail("worked out again"))
    envs = gymnasium.make_vec("antgym/MountainOneShot-v0", num_envs=3, suite=given)
    envs.reset(seed=0)
    infos = envs.step(np.zeros((3, 4), np.float32))[-1]["final_info"]
    assert set(infos["optimum"]) <= set(known)


def test_a_list_that_is_changed_afterwards_changes_no_environment():
    given = items()
    env = make(suite=given)
    first = episodes(env)
    given.clear()
    assert episodes(env) == first


def test_such_a_spec_is_refused_as_json_rather_than_written_in_part():
    with pytest.raises(TypeError, match="is not JSON serializable"):
        make().spec.to_json()


CLOSED = drawn(["S..", "###", "###", "..G"], Motion("grid4"))


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ([], r"suite = \[\]: needs the name of a suite, or SuiteItems, at least one"),
        (5, "suite = 5: needs the name"),
        (None, "suite = None: needs the name"),
        ([items()[0], CLOSED], r"suite\[1\] = Scenario\(.* needs a SuiteItem"),
        ([items()[0]._replace(rules="liu2021")], "liu2021.* did you mean 'liu2020'"),
        ([items()[0]._replace(ants=0)], "ants = 0: a run needs a whole number"),
    ],
)
def test_what_cannot_be_drawn_from_is_named_when_the_environment_is_made(given, message):
    with pytest.raises(ParameterError, match=message):
        make(suite=given)


def test_a_scenario_without_a_path_is_refused_before_anything_is_paid_for():
    with pytest.raises(ScenarioError, match="no path leads from"):
        make(suite=[*items(), antgym.SuiteItem("closed", CLOSED)])


@pytest.mark.parametrize("split", ["test", "ood"])
def test_they_have_no_splits(split):
    with pytest.raises(ParameterError, match=f"split '{split}' of scenarios of your own: they have none"):
        make(split=split)


@pytest.mark.parametrize(("rules", "dimension"), [("wu2018", 4), ("abc_gbest", 3)])
def test_discs_of_ones_own_are_flown_by_bees(rules, dimension):
    given = [antgym.SuiteItem(f"mine-{seed}", scattered(seed), 10, 50, rules) for seed in (1, 2)]
    env = gymnasium.make("antgym/RoomOneShot-v0", suite=given, observation="map")
    shown, info = env.reset(seed=0)
    assert (env.action_space.shape, shown["map"].shape) == ((dimension,), (3, 32, 32))
    assert info["rules"] == rules
    assert env.step(env.action_space.sample())[4]["gap"] >= 0


def test_swarms_that_choose_different_parameters_do_not_mix(valley):
    tabu, plain = (antgym.SuiteItem(rules, scattered(1), 10, 50, rules) for rules in ("wu2018", "abc_gbest"))
    for given in ([tabu, plain], [plain, antgym.SuiteItem("valley", valley)]):
        with pytest.raises(ParameterError, match="an environment has one action space"):
            gymnasium.make("antgym/RoomOneShot-v0", suite=given)
