"""The native batch: what single environments give with the seeds of its slots, in one planner call."""

import pickle
import warnings
from copy import deepcopy

import gymnasium
import numpy as np
import pytest
from efforts import ENTRIES, quick, some_steps
from gymnasium.utils.env_checker import data_equivalence
from gymnasium.vector import AutoresetMode

import antgym
from antgym.envs.catalogue import CATALOGUE
from antgym.envs.vector import NativeVectorEnv, env_seeds
from antgym.errors import ParameterError
from antgym.planners import pausing
from antgym.tuning import problem as problems

IDS = [entry.id for entry in CATALOGUE]
ONE_SHOT, TRIALS, CONTROL = (f"antgym/Mountain{regime}-v0" for regime in ("OneShot", "Trials", "Control"))
MODES = list(AutoresetMode)
with_and_without_map = pytest.mark.parametrize("observation", ["features", "map"])
N, ROOT = 3, 5


def settings(env_id):
    few = {"window": 2} if "Trials" in env_id else {}
    return {**quick(ENTRIES[env_id]), **few}


def native(env_id, count=N, **kwargs):
    return gymnasium.make_vec(env_id, num_envs=count, **{**settings(env_id), **kwargs})


def singles(env_id, mode, **kwargs):
    return gymnasium.make_vec(
        env_id,
        num_envs=N,
        vectorization_mode="sync",
        vector_kwargs={"autoreset_mode": mode},
        **{**settings(env_id), **kwargs},
    )


def assert_same(one, other):
    """Same observations, rewards, ends and infos, to the bit."""
    for a, b in zip(one, other, strict=True):
        assert data_equivalence(a, b, exact=True), (a, b)


@pytest.mark.parametrize("env_id", IDS)
@pytest.mark.parametrize(
    ("mode", "observation"), [(AutoresetMode.SAME_STEP, "map"), (AutoresetMode.NEXT_STEP, "features")]
)
def test_a_batch_repeats_single_environments_with_its_seeds(env_id, mode, observation):
    batch = native(env_id, autoreset_mode=mode, observation=observation)
    alone = singles(env_id, mode, observation=observation)
    assert_same(batch.reset(seed=ROOT), alone.reset(seed=env_seeds(ROOT, N)))
    rng = np.random.default_rng(0)
    for _ in range(some_steps(ENTRIES[env_id])):
        actions = rng.uniform(-1, 1, batch.action_space.shape).astype(np.float32)
        assert_same(batch.step(actions), alone.step(actions))
    assert_same(batch.reset(), alone.reset())


@pytest.mark.parametrize("env_id", IDS)
def test_a_batch_that_waits_for_resets_repeats_single_environments(env_id):
    batch = native(env_id, autoreset_mode=AutoresetMode.DISABLED)
    alone = singles(env_id, AutoresetMode.DISABLED)
    assert_same(batch.reset(seed=ROOT), alone.reset(seed=env_seeds(ROOT, N)))
    rng, over = np.random.default_rng(0), np.zeros(N, bool)
    for _ in range(some_steps(ENTRIES[env_id])):
        if over.any():
            options = {"reset_mask": over}
            assert_same(batch.reset(options=options), alone.reset(options=options))
        actions = rng.uniform(-1, 1, batch.action_space.shape).astype(np.float32)
        results = batch.step(actions), alone.step(actions)
        assert_same(*results)
        over = results[0][2]


@pytest.mark.parametrize("env_id", [TRIALS, CONTROL])
@pytest.mark.parametrize("mode", MODES)
@with_and_without_map
def test_slots_out_of_step_end_each_on_its_own(env_id, mode, observation):
    batch = native(env_id, autoreset_mode=mode, observation=observation)
    alone = singles(env_id, mode, observation=observation)
    assert_same(batch.reset(seed=ROOT), alone.reset(seed=env_seeds(ROOT, N)))
    actions, over = np.zeros((N, 4), np.float32), np.array([False, True, False])
    assert_same(batch.step(actions), alone.step(actions))
    ends = []
    for _ in range(22 if env_id == CONTROL else 8):
        if over.any() and (mode is AutoresetMode.DISABLED or not ends):
            assert_same(batch.reset(options={"reset_mask": over}), alone.reset(options={"reset_mask": over}))
        results = batch.step(actions), alone.step(actions)
        assert_same(*results)
        over = results[0][2]
        ends.append(over.sum())
    assert set(ends) == {0, 1, 2}


def test_same_step_shows_the_end_apart_from_the_new_beginning():
    batch, alone = native(ONE_SHOT), gymnasium.make(ONE_SHOT, **settings(ONE_SHOT))
    batch.reset(seed=ROOT)
    observations, rewards, ends, _, infos = batch.step(np.zeros((N, 4), np.float32))
    last, _ = alone.reset(seed=env_seeds(ROOT, N)[1])
    _, reward, _, _, info = alone.step(np.zeros(4, np.float32))
    begun, _ = alone.reset()
    assert ends.all()
    assert (rewards[1], infos["final_info"]["gap"][1]) == (reward, info["gap"])
    assert infos["final_obs"][1].tolist() == last.tolist()
    assert observations[1].tolist() == begun.tolist()


def test_next_step_answers_the_step_after_the_end_with_a_new_episode():
    batch = native(ONE_SHOT, autoreset_mode="NextStep")
    batch.reset(seed=ROOT)
    actions = np.zeros((N, 4), np.float32)
    batch.step(actions)
    runs = batch.planner_runs
    _, rewards, ends, _, _ = batch.step(actions)
    assert (rewards.tolist(), ends.any(), batch.planner_runs) == ([0.0] * N, False, runs)


def test_disabled_refuses_to_step_what_is_over():
    batch = native(ONE_SHOT, autoreset_mode="Disabled")
    batch.reset(seed=ROOT)
    batch.step(np.zeros((N, 4), np.float32))
    batch.reset(options={"reset_mask": np.array([True, False, True])})
    with pytest.raises(ParameterError, match=r"slots \[1\] are over; reset them by reset_mask"):
        batch.step(np.zeros((N, 4), np.float32))


def test_a_batch_makes_one_planner_call_a_step(monkeypatch):
    calls, plan_many = [], problems.plan_many

    def counted(scenarios, *args, **kwargs):
        calls.append(len(scenarios))
        return plan_many(scenarios, *args, **kwargs)

    monkeypatch.setattr(problems, "plan_many", counted)
    for env_id, expected in ((ONE_SHOT, [8]), (TRIALS, [8, 8])):
        batch = native(env_id, 8)
        batch.reset(seed=0)
        calls.clear()
        batch.step(np.zeros((8, 4), np.float32))
        assert calls == expected
        assert batch.planner_runs == sum(expected)


def test_a_batch_of_control_walks_all_blocks_of_a_step_in_one_call(monkeypatch):
    calls, run_ranges = [], pausing.run_ranges
    monkeypatch.setattr(pausing, "run_ranges", lambda *call: (calls.append(call[1]), run_ranges(*call)))
    batch = native(CONTROL, 8)
    batch.reset(seed=0)
    for _ in range(3):
        batch.step(np.zeros((8, 4), np.float32))
    assert calls == [8] * 3
    assert batch.planner_runs == 8


@pytest.mark.parametrize("env_id", IDS)
def test_threads_change_nothing(env_id, monkeypatch):
    seen = []
    for threads in "12":
        monkeypatch.setenv("ANTGYM_THREADS", threads)
        batch = native(env_id, 5)
        batch.reset(seed=1)
        seen.append([batch.step(np.full(batch.action_space.shape, 0.3, np.float32)) for _ in range(3)])
    for one, other in zip(*seen, strict=True):
        assert_same(one, other)


@pytest.mark.parametrize(
    ("env_id", "mode"),
    [
        (ONE_SHOT, AutoresetMode.SAME_STEP),
        (TRIALS, AutoresetMode.NEXT_STEP),
        (CONTROL, AutoresetMode.NEXT_STEP),
    ],
)
def test_make_vec_picks_the_native_batch_and_warns_of_nothing(env_id, mode):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        batch = gymnasium.make_vec(env_id, num_envs=2)
    assert isinstance(batch, NativeVectorEnv)
    assert batch.metadata["autoreset_mode"] is mode
    assert batch.num_envs == 2
    assert batch.observation_space.shape == (2, *batch.single_observation_space.shape)
    batch.close()


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("spell", [lambda mode: mode, lambda mode: mode.value])
def test_every_autoreset_mode_can_be_asked_for_by_name(mode, spell):
    assert native(ONE_SHOT, 1, autoreset_mode=spell(mode)).metadata["autoreset_mode"] is mode


def test_one_batchs_mode_is_not_anothers():
    first = native(ONE_SHOT, 1, autoreset_mode="Disabled")
    native(ONE_SHOT, 1, autoreset_mode="NextStep")
    assert first.metadata["autoreset_mode"] is AutoresetMode.DISABLED


def test_an_unknown_mode_is_named():
    with pytest.raises(ParameterError, match="unknown autoreset_mode 'same_step'; did you mean 'SameStep'"):
        native(ONE_SHOT, autoreset_mode="same_step")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"seed": [1, 2]}, "2 seeds"),
        ({"seed": []}, "0 seeds"),
        ({"options": {"reset_mask": [True]}}, r"a mask of \(1,\)"),
        ({"options": {"scenari": 1}}, "unknown reset option 'scenari'"),
    ],
)
def test_seeds_and_masks_that_do_not_fit_are_refused(arguments, message):
    with pytest.raises(ParameterError, match=message):
        native(ONE_SHOT).reset(**arguments)


def test_actions_of_the_wrong_number_are_refused():
    batch = native(ONE_SHOT)
    batch.reset(seed=0)
    for actions in (np.zeros((N + 1, 4)), np.zeros((N - 1, 4)), np.zeros(4)):
        with pytest.raises(ParameterError, match="3 environments"):
            batch.step(actions)
    assert batch.planner_runs == 0


def test_one_bad_action_changes_nothing_for_anybody():
    """Slot 0 waits for its next episode, slot 1 is told nonsense, slot 2 could go on."""
    batch = native(TRIALS)
    batch.reset(seed=0)
    actions = np.zeros((N, 4), np.float32)
    batch.step(actions)
    batch.reset(options={"reset_mask": np.array([False, True, True])})
    for _ in range(2):
        batch.step(actions)
    runs = batch.planner_runs
    actions[1, 2] = np.nan
    with pytest.raises(ParameterError, match="is no point of Box"):
        batch.step(actions)
    assert batch.planner_runs == runs
    assert [env.session.left for env in batch.envs] == [0, 1, 1]


def test_numpy_seeds_are_seeds():
    batch = native(ONE_SHOT)
    expected = batch.reset(seed=5)
    assert_same(batch.reset(seed=np.int64(5)), expected)
    assert_same(batch.reset(seed=np.array(env_seeds(5, N))), expected)


@pytest.mark.parametrize("env_id", [ONE_SHOT, TRIALS, CONTROL])
def test_a_pickled_batch_goes_on_as_it_would_have(env_id):
    batch, rng = native(env_id), np.random.default_rng(0)
    batch.reset(seed=ROOT)
    batch.step(rng.uniform(-1, 1, (N, 4)))
    again = pickle.loads(pickle.dumps(batch))
    for _ in range(4):
        actions = rng.uniform(-1, 1, (N, 4))
        assert_same(again.step(actions), batch.step(actions))
    assert [env.session.trials for env in again.envs] == [env.session.trials for env in batch.envs]


def test_slots_are_rows_of_one_batch_and_each_begins_when_it_is_reset():
    batch = native(ONE_SHOT)
    with pytest.raises(ParameterError, match="no episode yet"):
        batch.step(np.zeros((N, 4), np.float32))
    batch.reset(seed=ROOT, options={"reset_mask": np.array([True, False, True])})
    assert batch.envs[2].session.left == 1
    with pytest.raises(ParameterError, match="no episode yet"):
        _ = batch.envs[1].session
    assert batch.planner_runs == 0


def test_what_was_told_of_an_episode_stays_when_the_next_begins():
    batch = native(TRIALS, autoreset_mode="SameStep")
    batch.reset(seed=ROOT)
    batch.step(np.zeros((N, 4), np.float32))
    before, trials = batch.envs[1].session, batch.envs[1].session.trials
    for _ in range(2):
        batch.step(np.zeros((N, 4), np.float32))
    assert (batch.envs[1].session.trials, before.trials) == ((), trials)


def test_slot_seeds_are_known_by_the_packages_own_name():
    assert antgym.env_seeds is env_seeds


def test_slot_seeds_are_unrelated_and_do_not_depend_on_how_many_there_are():
    seeds = env_seeds(7, 100)
    assert env_seeds(7, 4) == seeds[:4]
    assert len({*seeds, *env_seeds(8, 100)}) == 200
    assert min(np.abs(np.diff(seeds))) > 1e9


@pytest.mark.parametrize("mode", ["ansi", "rgb_array"])
def test_a_batch_shows_a_picture_of_every_slot(mode):
    batch, alone = (
        native(ONE_SHOT, render_mode=mode),
        gymnasium.make(ONE_SHOT, render_mode=mode, **settings(ONE_SHOT)),
    )
    batch.reset(seed=ROOT)
    alone.reset(seed=env_seeds(ROOT, N)[2])
    pictures = batch.render()
    assert len(pictures) == N
    assert np.array_equal(pictures[2], alone.render())


@with_and_without_map
def test_earlier_results_are_not_written_over(observation):
    batch = native(TRIALS, observation=observation)
    observations, _ = batch.reset(seed=0)
    kept = deepcopy(observations)
    batch.step(np.zeros((N, 4), np.float32))
    assert_same([observations], [kept])


def test_maps_are_batched_beside_the_features():
    batch = native(ONE_SHOT, observation="map3d")
    observations, _ = batch.reset(seed=ROOT)
    assert observations in batch.observation_space
    assert observations["map"].shape == (N, 3, 16, 16, 16)
    observations, _, _, _, infos = batch.step(np.zeros((N, 4), np.float32))
    assert observations in batch.observation_space
    assert all(last in batch.single_observation_space for last in infos["final_obs"])


@pytest.mark.parametrize("seed", [1.5, -1, "3", [1, 2.5], [1, -1]])
def test_a_seed_that_is_none_is_named(seed):
    envs = gymnasium.make_vec("antgym/MountainOneShot-v0", num_envs=2, effort=[2, 2])
    with pytest.raises(ParameterError, match="seed = "):
        envs.reset(seed=seed)


def test_a_batch_needs_an_environment():
    with pytest.raises(ParameterError, match="num_envs = 0"):
        gymnasium.make_vec("antgym/MountainOneShot-v0", num_envs=0)


def test_natural_values_are_encoded_for_every_slot():
    envs = gymnasium.make_vec("antgym/OpenOneShot-v0", num_envs=5, effort=[2, 3])
    envs.reset(seed=2)
    values = {"alpha": 1.0, "beta": 2.0, "rho": 0.9, "Q": 50.0}
    told = envs.step(envs.encode(**values))[4]["final_info"]["parameters"]
    for name, value in values.items():
        assert told[name] == pytest.approx([value] * 5, rel=1e-5)
