"""What every environment of the catalogue keeps to: Gymnasium's contract, and ours on top of it."""

import pickle
import warnings

import gymnasium
import numpy as np
import pytest
from efforts import flown_by_bees, quick, small
from gymnasium.envs.registration import EnvSpec, load_env_creator
from gymnasium.utils.env_checker import check_env

from antgym.envs.catalogue import CATALOGUE
from antgym.envs.manual import ranges_table
from antgym.errors import ParameterError
from antgym.maps.features import feature_table
from antgym.maps.occupancy import occupancy, picture_shape
from antgym.maps.suites import SUITES, load_suite
from antgym.maps.world import Scenario
from antgym.planners.planning import are_bees
from antgym.planners.swarms import space_of
from antgym.tuning import COST_CAP
from antgym.tuning.features import BEE_RULES_SHOWN, RULES_SHOWN, task_table

pytestmark = pytest.mark.parametrize("entry", CATALOGUE, ids=lambda entry: entry.id)
with_and_without_map = pytest.mark.parametrize("observation", ["features", "map"])


def zero(env):
    """The action of the published default."""
    return np.zeros(env.action_space.shape, np.float32)


def make(entry, **kwargs):
    return gymnasium.make(entry.id, **{**quick(entry), **kwargs})


def frozen(observation):
    """The bytes of an observation, of each part by name where it has several."""
    if isinstance(observation, dict):
        return {name: part.tobytes() for name, part in observation.items()}
    return observation.tobytes()


def rollout(env, episodes=2, seed=None, actions=0):
    """Every observation, reward, end and info of some episodes."""
    rng, seen = np.random.default_rng(actions), []
    for episode in range(episodes):
        observation, info = env.reset(seed=seed if episode == 0 else None)
        seen.append((frozen(observation), info))
        over = False
        while not over:
            action = rng.uniform(-1, 1, env.action_space.shape).astype(np.float32)
            observation, reward, over, truncated, info = env.step(action)
            seen.append((frozen(observation), reward, over, truncated, info))
    return seen


def moderate(env):
    """Natural values within the ranges of every rule."""
    problem = env.unwrapped.session.problem
    if are_bees(problem.rules):
        values = {"limit": 50.0, "xi_max": 1.2, "xi_min": 0.5, "tabu_radius": 2.0}
        return {name: values[name] for name in problem.space.names}
    return {"alpha": 0.1, "beta": 0.6, "rho": 0.9, "Q": problem.scenario.straight_line}


def finish(env):
    env.reset(seed=0)
    while not env.step(zero(env))[2]:
        pass


def test_gymnasium_finds_nothing_to_warn_of(entry):
    env = make(entry, observation="features" if entry.regime == "Trials" else "map")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(env.unwrapped)


def test_the_same_seed_gives_the_same_rollout(entry):
    assert rollout(make(entry), seed=7) == rollout(make(entry), seed=7)


def test_another_seed_gives_another_episode(entry):
    env = make(entry)
    infos = [env.reset(seed=seed)[1] for seed in range(6)]
    assert len({info["seed"] for info in infos}) == 6
    assert len({info["scenario"] for info in infos}) > 1


def test_without_a_seed_the_root_is_random(entry):
    seeds = {make(entry).reset()[1]["seed"] for _ in range(3)}
    assert len(seeds) == 3


def test_episodes_are_a_function_of_root_and_index_alone(entry):
    """Not of what was done in the episodes before, and not of whether they were played at all."""
    played, skipped = make(entry), make(entry, reward="improvement")
    rollout(played, episodes=3, seed=11)
    skipped.reset(seed=11)
    for _ in range(2):
        skipped.reset()
    assert rollout(played, 1, actions=5)[0] == rollout(skipped, 1, actions=5)[0]


def test_seeding_again_begins_anew(entry):
    env = make(entry)
    first = rollout(env, episodes=3, seed=4)
    assert rollout(env, episodes=3, seed=4) == first


@with_and_without_map
@pytest.mark.parametrize("begun", [False, True])
def test_a_pickled_environment_goes_on_like_the_original(entry, begun, observation):
    env = make(entry, observation=observation)
    env.reset(seed=3)
    if begun:
        env.step(zero(env))
    copy = pickle.loads(pickle.dumps(env))
    assert rollout(copy) == rollout(env)


def test_an_environment_pickles_before_its_first_reset(entry):
    env = make(entry)
    assert rollout(pickle.loads(pickle.dumps(env)), seed=3) == rollout(env, seed=3)


@with_and_without_map
def test_the_spec_makes_the_same_environment_after_json(entry, observation):
    env = make(entry, split="validation", reward="length", observation=observation)
    again = gymnasium.make(EnvSpec.from_json(env.spec.to_json()))
    assert rollout(again, seed=2) == rollout(env, seed=2)


@with_and_without_map
def test_observations_lie_in_the_space(entry, observation):
    env = make(entry, observation=observation)
    for _ in range(3):
        observation, _ = env.reset()
        over = False
        while not over:
            assert observation in env.observation_space
            observation, _, over, _, _ = env.step(env.action_space.sample())
        assert observation in env.observation_space


@with_and_without_map
def test_earlier_observations_are_not_written_over(entry, observation):
    env = make(entry, observation=observation)
    first, _ = env.reset(seed=0)
    kept = frozen(first)
    env.step(zero(env))
    env.reset()
    assert frozen(first) == kept


@pytest.mark.parametrize("observation", ["map", "map2d", "map3d"])
def test_a_map_comes_beside_the_features_and_changes_nothing_else(entry, observation):
    plain, mapped = (rollout(make(entry, observation=kind), seed=5) for kind in ("features", observation))
    assert [(step[0]["features"], *step[1:]) for step in mapped] == plain


def test_the_map_is_that_of_the_scenario(entry):
    env = make(entry, observation="map", split="test")
    for picked in (3, 4):
        seen, _ = env.reset(seed=0, options={"scenario": picked})
        scenario = load_suite(entry.kwargs["suite"], "test")[picked].scenario
        assert (seen["map"] == occupancy(scenario, env.unwrapped._terms.problems.flat)).all()


@pytest.mark.parametrize("kind", ["map2d", "map3d"])
def test_a_map_has_the_shape_asked_for(entry, kind):
    spaces = make(entry, observation=kind).observation_space
    assert list(spaces) == ["features", "map"]
    assert spaces["map"] == gymnasium.spaces.Box(0, 1, picture_shape(kind == "map2d"), np.float32)
    assert spaces["features"] == make(entry).observation_space


def test_a_map_has_one_shape_in_all_splits_flat_where_the_suite_is(entry):
    flat = load_suite(entry.kwargs["suite"], "train").flat
    for split in ("train", "validation", "test", "ood"):
        space = make(entry, observation="map", split=split).observation_space
        assert space["map"].shape == picture_shape(flat)


def test_what_is_drawn_on_a_map_shows_nowhere_else(entry):
    env = make(entry, observation="map")
    seen, _ = env.reset(seed=0)
    seen["map"][:] = 7
    assert env.step(zero(env))[0] in env.observation_space
    assert 7 not in env.reset(seed=0)[0]["map"]


def test_info_holds_plain_values(entry):
    def plain(value):
        if isinstance(value, dict):
            return all(type(key) is str and plain(item) for key, item in value.items())
        return type(value) in (int, float, str, bool)

    env = make(entry)
    assert plain(env.reset(seed=0)[1])
    assert plain(env.step(zero(env))[4])


def test_info_tells_what_was_run(entry):
    env = make(entry)
    _, begun = env.reset(seed=0)
    info = env.step(zero(env))[4]
    assert info.items() >= begun.items()
    assert (begun["ants"], begun["iterations"]) == tuple(small(entry))
    assert begun["rules"] in SUITES[entry.kwargs["suite"]].rules
    assert info["length"] >= info["optimum"] > 0
    assert info["gap"] == pytest.approx(min(info["length"] / info["optimum"] - 1, 1))


@pytest.mark.parametrize(
    ("reward", "low", "high"), [("gap", -1, 0), ("improvement", -1, 1), ("length", -1e5, 0)]
)
def test_the_return_lies_in_its_documented_range(entry, reward, low, high):
    env = make(entry, reward=reward)
    for seed in range(4):
        rewards = [step[1] for step in rollout(env, episodes=1, seed=seed, actions=seed)[1:]]
        assert all(type(value) is float for value in rewards)
        assert low - 1e-9 <= sum(rewards) <= high + 1e-9


def test_an_episode_ends_by_termination_alone(entry):
    ends = [step[2:4] for step in rollout(make(entry), episodes=1, seed=0)[1:]]
    assert ends == [(False, False)] * (len(ends) - 1) + [(True, False)]


def before_and_after_a_path(entry, mode):
    """Two pictures of the first episode in which an ant or a bee arrives: as it begins, and once one has."""
    env = make(entry, render_mode=mode)
    for seed in range(20):
        env.reset(seed=seed)
        before, over = env.render(), False
        while not over:
            _, _, over, _, info = env.step(env.unwrapped.encode(**moderate(env)))
            if info["cost"] < COST_CAP if "cost" in info else info["solved"]:
                return before, env.render()
    return pytest.fail("nobody arrived in twenty episodes")


def test_ansi_shows_ends_and_path(entry):
    before, after = before_and_after_a_path(entry, "ansi")
    for picture, lines in ((before, 1), (after, 3)):
        drawn = picture.split("\n", lines)[lines]
        assert "S" in drawn
        assert "G" in drawn
        assert ("o" in drawn) == (picture is after)
    assert "optimum" in after


def test_rgb_array_is_a_picture_of_bytes(entry):
    before, after = before_and_after_a_path(entry, "rgb_array")
    for picture in (before, after):
        assert (picture.dtype, picture.ndim, picture.shape[2]) == (np.uint8, 3, 3)
    assert before.shape == after.shape
    assert (before != after).any()


def test_rendering_costs_and_changes_nothing(entry):
    drawn, quiet = make(entry, render_mode="rgb_array"), make(entry)
    for env in (drawn, quiet):
        env.reset(seed=1)
        env.step(zero(env))
    drawn.render()
    assert drawn.unwrapped.planner_runs == quiet.unwrapped.planner_runs
    assert rollout(drawn, 1) == rollout(quiet, 1)


def test_rendering_without_a_mode_says_how_to_get_one(entry):
    env = make(entry).unwrapped
    env.reset(seed=0)
    with pytest.raises(ParameterError, match="pass 'ansi' or 'rgb_array' to make"):
        env.render()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"splt": "train"}, "unknown environment argument 'splt'; did you mean 'split'"),
        ({"split": "trein"}, "unknown split 'trein'; did you mean 'train'"),
        ({"split": None}, "unknown split None"),
        ({"reward": "gaps"}, "unknown reward 'gaps'; did you mean 'gap'"),
        ({"observation": "mpa"}, "unknown observation 'mpa'; did you mean 'map'"),
        ({"observation": "map4d"}, "unknown observation 'map4d'; did you mean 'map"),
        ({"observation": None}, "unknown observation None"),
        ({"render_mode": "ansii"}, "unknown render_mode 'ansii'; did you mean 'ansi'"),
        (
            {"suite": "mountains-v0"},
            "unknown suite 'mountains-v0', nor is it a folder; did you mean 'mountain-v0'",
        ),
        ({"effort": [0, 10]}, r"effort = \[0, 10\]: needs \(ants, iterations\)"),
        ({"effort": [10]}, "effort = "),
        ({"effort": 10}, "effort = 10"),
        ({"effort": "10"}, "effort = '10'"),
        ({"effort": [10, 2.5]}, r"effort = \[10, 2.5\]"),
        ({"effort": [10, float("nan")]}, "effort = "),
    ],
)
def test_a_bad_argument_is_named(entry, arguments, message):
    create = load_env_creator(entry.entry_point)
    with pytest.raises(ParameterError, match=message):
        create(**{**entry.kwargs, **arguments})


def test_gymnasium_passes_our_errors_on(entry):
    with pytest.raises(ParameterError, match="did you mean 'split'"):
        make(entry, splt="train")


@pytest.mark.parametrize(
    "spoil",
    [
        lambda zero: np.where(np.arange(len(zero)) == 0, 1.001, zero),
        lambda zero: np.where(np.arange(len(zero)) == 2, float("nan"), zero),
        lambda zero: np.where(np.arange(len(zero)) == 1, float("inf"), zero),
        lambda zero: zero[1:],
        lambda zero: zero[None],
        lambda _: 0.5,
        lambda _: [],
    ],
)
def test_an_action_outside_the_space_is_refused_and_costs_nothing(entry, spoil):
    env = make(entry).unwrapped
    env.reset(seed=0)
    with pytest.raises(ParameterError, match="is no point of Box"):
        env.step(np.array(spoil(zero(env))))
    assert env.planner_runs == 0
    env.step(zero(env))


def test_a_step_before_reset_is_refused(entry):
    with pytest.raises(ParameterError, match=r"call reset\(\) first"):
        make(entry).unwrapped.step([0.0])


def test_a_step_after_the_end_is_refused(entry):
    env = make(entry)
    finish(env)
    runs = env.unwrapped.planner_runs
    with pytest.raises(ParameterError, match=r"the episode is over; call reset\(\)"):
        env.step(zero(env))
    assert env.unwrapped.planner_runs == runs


def test_natural_values_come_back_in_info(entry):
    env = make(entry)
    for seed in range(5):
        env.reset(seed=seed)
        values = moderate(env)
        info = env.step(env.unwrapped.encode(**values))[4]
        assert info["parameters"] == pytest.approx(values, rel=1e-5)


def test_action_zero_is_the_published_default_of_the_scenarios_rules(entry):
    env = make(entry)
    for seed in range(5):
        env.reset(seed=seed)
        info, problem = env.step(zero(env))[4], env.unwrapped.session.problem
        default = space_of(info["rules"], problem.scenario, info["ants"]).default
        assert list(info["parameters"].values()) == default.tolist()


def test_natural_values_outside_their_range_are_named(entry):
    env = make(entry).unwrapped
    env.reset(seed=0)
    name, values = ("limit", moderate(env)) if flown_by_bees(entry) else ("rho", moderate(env))
    with pytest.raises(ParameterError, match=rf"{name} = 1e\+09 lies outside its range"):
        env.encode(**{**values, name: 1e9})


def test_natural_values_are_named_all_of_them_and_no_other(entry):
    env = make(entry).unwrapped
    env.reset(seed=0)
    first, *rest = moderate(env).items()
    for values in (dict(rest), {**dict(rest), first[0]: first[1], "gamma": 1.0}):
        with pytest.raises(ParameterError, match=rf"encode\(\) takes {first[0]}, "):
            env.encode(**values)


def test_a_scenario_can_be_picked(entry):
    env = make(entry, split="test")
    _, info = env.reset(seed=0, options={"scenario": np.int64(17)})
    assert info["scenario"] == load_suite(entry.kwargs["suite"], "test")[17].name


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"scenario": 100}, "scenario 100: this split holds 0 to "),
        ({"scenario": -1}, "scenario -1"),
        ({"scenario": 1.5}, "scenario 1.5"),
        ({"scenario": "1"}, "scenario '1'"),
        ({"scenari": 1}, "unknown reset option 'scenari'"),
    ],
)
def test_a_bad_reset_option_is_named_and_skips_no_episode(entry, options, message):
    env, other = make(entry, split="validation"), make(entry, split="validation")
    for each in (env, other):
        each.reset(seed=0)
    with pytest.raises(ParameterError, match=message):
        env.reset(options=options)
    assert rollout(env, 1) == rollout(other, 1)


def test_each_scenario_comes_with_its_own_effort_and_rules(entry):
    _, info = gymnasium.make(entry.id).reset(seed=0, options={"scenario": 5})
    item = load_suite(entry.kwargs["suite"], "train")[5]
    least = load_env_creator(entry.entry_point).least_iterations
    assert (info["ants"], info["iterations"]) == (item.ants, max(item.iterations, least))
    assert info["rules"] == item.rules


def test_the_features_say_which_rules_the_colony_goes_by(entry):
    bees = flown_by_bees(entry)
    env, names = make(entry), BEE_RULES_SHOWN if bees else RULES_SHOWN
    last = len(task_table(bees))
    for seed in range(5):
        seen, info = env.reset(seed=seed)
        shown = seen[last - len(names) : last]
        assert shown.sum() == 1
        assert names[shown.argmax()] == info["rules"]


def test_nothing_that_an_agent_sees_depends_on_the_optimum(entry, monkeypatch):
    env = make(entry, observation="map")

    def seen():
        observations, trials = [], []
        for step in rollout(env, episodes=4, seed=6):
            observations.append(step[0])
            trials.append(repr(env.unwrapped.session.trials))
        return observations, trials, repr(env.unwrapped.session.task.space)

    honest = seen()
    monkeypatch.setattr(Scenario, "optimum", property(lambda scenario: 0.3 * scenario.straight_line))
    assert seen() == honest


def test_the_docstring_holds_the_tables_of_what_the_environment_reads(entry):
    regime = load_env_creator(entry.entry_point)
    doc = regime.__doc__
    assert ranges_table() in doc
    assert ranges_table(BEE_RULES_SHOWN) in doc
    assert feature_table(regime.features) in doc
    assert feature_table(regime.disc_features) in doc
    assert not any(f"{{{table}}}" in doc for table in ("actions", "bee_actions", "observations", "worlds"))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"effort": [10**9, 50]}, "from 1 to 1,000,000"),
        ({"effort": np.array([5, 2.5])}, "effort = "),
        ({"budget": 3}, "Trials has it"),
    ],
)
def test_what_cannot_be_made_is_refused_at_once(entry, arguments, message):
    if "budget" in arguments and "Trials" in entry.id:
        pytest.skip("Trials has a budget")
    with pytest.raises(ParameterError, match=message):
        gymnasium.make(entry.id, **arguments)


def test_an_effort_may_be_an_array_and_no_action_a_word(entry):
    env = gymnasium.make(entry.id, effort=np.array([5, 50])).unwrapped
    assert env.reset(seed=0)[1]["ants"] == 5
    with pytest.raises(ParameterError, match="'abcd'"):
        env.step("abcd")


def test_the_docstring_names_every_argument(entry):
    create = load_env_creator(entry.entry_point)
    shown = create.__doc__ + load_env_creator(CATALOGUE[0].entry_point).__doc__
    assert all(f"| `{name}` |" in shown for name in create.arguments)
