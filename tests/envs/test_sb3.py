"""The stable-baselines3 face of the native batch."""

import gymnasium
import numpy as np
import pytest

pytest.importorskip("stable_baselines3", reason="needs the extra rl")

import torch
from stable_baselines3 import PPO

from antgym.envs.sb3 import ChangingVecEnv, FeatureExtractor, MapExtractor, ScaledRewards, make_sb3_vec
from antgym.envs.vector import env_seeds
from antgym.errors import ParameterError

ID, N = "antgym/MountainOneShot-v0", 3
EFFORT = {"effort": [3, 5]}


@pytest.fixture
def envs():
    return make_sb3_vec(ID, N, seed=4, **EFFORT)


def test_it_gives_what_the_native_batch_gives(envs):
    native = gymnasium.make_vec(ID, num_envs=N, **EFFORT)
    observations, _ = native.reset(seed=4)
    assert envs.reset().tolist() == observations.tolist()
    rng = np.random.default_rng(0)
    for _ in range(4):
        actions = rng.uniform(-1, 1, (N, 4)).astype(np.float32)
        theirs, ours = native.step(actions), envs.step(actions)
        assert ours[0].tolist() == theirs[0].tolist()
        assert ours[1].tolist() == theirs[1].astype(np.float32).tolist()
        assert ours[2].tolist() == theirs[2].tolist()


def test_a_finished_slot_shows_its_last_observation_and_its_own_info(envs):
    envs.reset()
    observations, rewards, ends, infos = envs.step(np.zeros((N, 4), np.float32))
    alone = gymnasium.make(ID, **EFFORT)
    last, _ = alone.reset(seed=env_seeds(4, N)[2])
    _, _, _, _, info = alone.step(np.zeros(4, np.float32))
    assert ends.all()
    assert infos[2]["terminal_observation"].tolist() == last.tolist()
    assert {k: v for k, v in infos[2].items() if k in info} == info
    assert infos[2]["TimeLimit.truncated"] is False
    assert observations[2].tolist() == alone.reset()[0].tolist()
    assert rewards.dtype == np.float32


def test_a_later_reset_goes_on_with_the_next_episodes(envs):
    first, again = envs.reset(), envs.reset()
    assert first.tolist() != again.tolist()


def test_seeding_begins_anew(envs):
    first = envs.reset()
    envs.seed(4)
    assert envs.reset().tolist() == first.tolist()


def test_info_of_each_slot_is_plain(envs):
    envs.reset()
    *_, infos = envs.step(np.zeros((N, 4), np.float32))
    for info in (*infos, *envs.reset_infos):
        assert all(type(v) in (int, float, str, bool, dict, np.ndarray) for v in info.values())
    assert {type(v) for v in infos[0]["parameters"].values()} == {float}


def test_attributes_and_methods_of_the_slots_are_reached(envs):
    envs.reset()
    assert envs.get_attr("planner_runs") == [0] * N
    envs.set_attr("planner_runs", 5, indices=[1])
    assert envs.get_attr("planner_runs", indices=[0, 1]) == [0, 5]
    values = {"alpha": 1.0, "beta": 5.0, "rho": 0.9, "Q": 100.0}
    assert [a.shape for a in envs.env_method("encode", **values)] == [(4,)] * N
    assert envs.env_is_wrapped(gymnasium.Wrapper) == [False] * N


def test_a_map_comes_beside_the_features_and_so_does_the_last_one():
    envs = make_sb3_vec(ID, N, seed=4, observation="map", **EFFORT)
    native = gymnasium.make_vec(ID, num_envs=N, observation="map", **EFFORT)
    begun, first = envs.reset(), native.reset(seed=4)[0]
    actions = np.zeros((N, 4), np.float32)
    (observations, _, _, infos), (theirs, *_) = envs.step(actions), native.step(actions)
    for name in ("features", "map"):
        assert (begun[name] == first[name]).all()
        assert (observations[name] == theirs[name]).all()
        assert (infos[1]["terminal_observation"][name] == begun[name][1]).all()


def scenarios(infos):
    return [int(info["scenario"].rpartition("/")[2]) for info in infos]


def test_options_pick_the_scenarios_of_the_next_reset_alone(envs):
    envs.set_options({"scenario": 7})
    envs.reset()
    assert scenarios(envs.reset_infos) == [7] * N
    drawn = make_sb3_vec(ID, N, seed=4, **EFFORT)
    assert [envs.reset().tolist() for _ in range(2)][1] == [drawn.reset().tolist() for _ in range(3)][2]
    assert scenarios(envs.reset_infos) == scenarios(drawn.reset_infos)


def test_options_may_differ_from_slot_to_slot_and_leave_seeds_as_they_are(envs):
    envs.set_options([{"scenario": 7}, {}, {"scenario": 9}])
    observations = envs.reset()
    drawn = make_sb3_vec(ID, N, seed=4, **EFFORT)
    untouched = drawn.reset()
    assert scenarios(envs.reset_infos) == [7, scenarios(drawn.reset_infos)[1], 9]
    assert observations[1].tolist() == untouched[1].tolist()
    assert [info["seed"] for info in envs.reset_infos] == [info["seed"] for info in drawn.reset_infos]
    alone = gymnasium.make(ID, **EFFORT)
    assert observations[2].tolist() == alone.reset(options={"scenario": 9})[0].tolist()


def test_options_can_be_taken_back(envs):
    first = envs.reset().tolist()
    envs.seed(4)
    envs.set_options({"scenario": 7})
    envs.set_options(None)
    assert envs.reset().tolist() == first


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ([{"scenario": 1}], "needs one dict, or a list of 3, one for every slot"),
        (["scenario"] * N, "needs one dict, or a list of 3"),
        ({"reset_mask": [True] * N}, "reset_mask: a VecEnv is reset as a whole"),
        ({"scnario": 1}, "unknown reset option 'scnario'"),
        ({"scenario": 10_000}, "scenario 10000: this split holds 0 to 199"),
    ],
)
def test_options_that_cannot_be_honoured_are_refused_and_forgotten(envs, options, message):
    def refused():
        envs.set_options(options)
        envs.reset()

    with pytest.raises(ParameterError, match=message):
        refused()
    envs.reset()


@pytest.mark.parametrize(
    ("env_id", "kwargs", "message"),
    [
        ("CartPole-v1", {}, "'CartPole-v1'.* did you mean 'antgym/"),
        ("antgym/MountainOneShott-v0", {}, "did you mean 'antgym/MountainOneShot-v0'"),
        (ID, {"effortt": [3, 5]}, "unknown environment argument 'effortt'; did you mean 'effort'"),
        (
            ID,
            {"num_envs": 3},
            r"make_sb3_vec\('antgym/MountainOneShot-v0', n=3, num_envs=\.\.\.\): .*'num_envs'",
        ),
        (ID, {"autoreset_mode": "NextStep"}, "multiple values for keyword argument 'autoreset_mode'"),
        (
            "antgym/MountainTrials-v0",
            {"bugdet": 3},
            "unknown environment argument 'bugdet'; did you mean 'budget'",
        ),
    ],
)
def test_what_cannot_be_made_is_refused_with_a_hint(env_id, kwargs, message):
    with pytest.raises(ParameterError, match=message):
        make_sb3_vec(env_id, N, **kwargs)


@pytest.mark.parametrize(("kind", "layer"), [("map2d", torch.nn.Conv2d), ("map3d", torch.nn.Conv3d)])
def test_ppo_learns_through_convolutions_over_the_map(kind, layer):
    torch.set_num_threads(1)
    envs = make_sb3_vec(ID, N, seed=4, observation=kind, **EFFORT)
    model = PPO(
        "MultiInputPolicy",
        envs,
        n_steps=4,
        batch_size=6,
        seed=0,
        device="cpu",
        policy_kwargs={"features_extractor_class": MapExtractor, "features_extractor_kwargs": {"width": 5}},
    )
    extractor = model.policy.features_extractor
    (first, *_) = [each for each in extractor.modules() if isinstance(each, layer)]
    before = first.weight.clone()
    model.learn(24)
    assert (first.weight != before).any()
    seen = {name: torch.as_tensor(part) for name, part in envs.reset().items()}
    out = extractor(seen)
    assert out.shape == (N, extractor.features_dim) == (N, 5 + seen["features"].shape[1])
    assert (out[:, 5:] == seen["features"]).all()


def test_convolutions_want_a_map(envs):
    with pytest.raises(ParameterError, match="no map is observed"):
        MapExtractor(envs.observation_space)


@pytest.mark.parametrize(("how", "keep"), [("each", [[2, 2, 2, 2]] * N), ("one", [0] * N)])
def test_keeping_everything_steers_as_the_start_throughout(how, keep):
    """Factorised changes are another face of the same runs, and what is shown at first is where they begin."""
    start, effort = [0.25, 0.75, 0.5, 0.375], {"effort": [3, 40]}
    ours = ChangingVecEnv(make_sb3_vec("antgym/MountainControl-v0", N, seed=1, **effort), how, start)
    plain = make_sb3_vec("antgym/MountainControl-v0", N, seed=1, **effort)
    shown, _ = ours.reset(), plain.reset()
    assert shown[:, -4:].tolist() == [start] * N
    for block in range(10):
        shown, rewards, ends, infos = ours.step(np.array(keep))
        theirs = plain.step(np.tile(2 * np.float32(start) - 1, (N, 1)))
        assert rewards.tolist() == theirs[1].tolist()
        assert [info["gap"] for info in infos] == [info["gap"] for info in theirs[3]]
        assert ends.tolist() == [block == 9] * N
    assert shown[:, -4:].tolist() == [start] * N, "the next run begins there again"


def test_a_change_moves_the_last_blocks_setting():
    ours = ChangingVecEnv(make_sb3_vec("antgym/MountainControl-v0", N, seed=1, effort=[3, 40]), "each")
    ours.reset()
    assert ours.step(np.array([[0, 1, 2, 4]] * N))[0][0, -4:].tolist() == [0.25, 0.375, 0.5, 0.75]
    assert ours.step(np.array([[4, 4, 4, 4]] * N))[0][0, -4:].tolist() == [0.5, 0.625, 0.75, 1.0]


@pytest.mark.parametrize(
    ("env_id", "start", "message"),
    [(ID, None, "in Control alone"), ("antgym/MountainControl-v0", [0.5, 2.0], "needs 4 values from 0 to 1")],
)
def test_changes_that_make_no_sense_are_refused(env_id, start, message):
    with pytest.raises(ParameterError, match=message):
        ChangingVecEnv(make_sb3_vec(env_id, N), "each", start)


def test_scaled_rewards_are_rewards_times_a_constant(envs):
    scaled = ScaledRewards(make_sb3_vec(ID, N, seed=4, **EFFORT), 3.0)
    assert (envs.reset() == scaled.reset()).all()
    actions = np.zeros((N, 4), np.float32)
    np.testing.assert_allclose(scaled.step(actions)[1], 3 * envs.step(actions)[1])


def test_features_are_standardised_and_held_within_five_deviations(envs):
    size = envs.observation_space.shape[0]
    extractor = FeatureExtractor(envs.observation_space, [0.5] * size, [0.25] * (size - 1) + [1e-3])
    out = extractor(torch.zeros(2, size))
    assert out[0].tolist() == [-2.0] * (size - 1) + [-5.0]
    assert set(extractor.state_dict()) == {"mean", "deviation"}


def test_changes_may_begin_from_a_setting_by_rules():
    envs = make_sb3_vec("antgym/OpenControl-v0", 6, seed=1, effort=[2, 40])
    starts = {"max_min": [0.25] * 4, "elitist": [0.75] * 4}
    shown, infos = (ours := ChangingVecEnv(envs, "each", starts)).reset(), ours.venv.reset_infos
    for row, info in zip(shown, infos, strict=True):
        assert row[-4:].tolist() == starts.get(info["rules"], [0.5] * 4)
    assert len({info["rules"] for info in infos}) > 1
