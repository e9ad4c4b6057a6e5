"""Learners of other libraries on the environments, unchanged: they run, they are told what is true, and they learn."""

from itertools import product

import gymnasium
import numpy as np
import pytest
from two_settings import items, oracle, share, shares

import antgym  # noqa: F401 - registers the environments
from antgym.envs.catalogue import REGIMES
from antgym.planners.rules import PAPERS
from antgym.tuning.features import TASK_FEATURES

SETTINGS = {  # what each algorithm needs to update its networks within some hundred steps
    "PPO": {"n_steps": 30, "batch_size": 30, "n_epochs": 2},
    "TD3": {"learning_starts": 40, "batch_size": 16},
    "SAC": {"learning_starts": 40, "batch_size": 16},
}
SLOTS, STEPS, BUDGET = 4, 120, 10
STEPS_AN_EPISODE = dict(zip(REGIMES, (1, BUDGET, 10), strict=True))
RUNS_AN_EPISODE = dict(zip(REGIMES, (1, 2 * BUDGET, 1), strict=True))
LEFT = len(TASK_FEATURES)  # where Trials shows the share of the budget left


@pytest.fixture
def sb3():
    torch = pytest.importorskip("torch", reason="needs the extra rl")
    torch.set_num_threads(1)
    return pytest.importorskip("stable_baselines3", reason="needs the extra rl")


@pytest.fixture
def plain_ppo():
    torch = pytest.importorskip("torch", reason="needs the extra rl")
    torch.set_num_threads(1)
    import plain_ppo

    return plain_ppo


@pytest.fixture(params=["make", "make_sb3_vec"])
def face(request, sb3):
    """Makes (what stable-baselines3 takes, its slots) in either of the two ways."""

    def made(name, **kwargs):
        kwargs = {"effort": [3, 40 if "Control" in name else 5], **kwargs}
        if request.param == "make":
            env = gymnasium.make(f"antgym/{name}-v0", **kwargs)
            return env, [env.unwrapped]
        from antgym.envs.sb3 import make_sb3_vec

        envs = make_sb3_vec(f"antgym/{name}-v0", SLOTS, seed=0, **kwargs)
        return envs, envs.native.envs

    return made


def learn(model, steps=STEPS):
    """Learn some steps; return (action, reward, end, info) of each."""
    seen, before = [], [value.clone() for value in model.policy.parameters()]

    def after_step(known, _):
        actions = known.get("clipped_actions", known["actions"])
        seen.extend(zip(actions, known["rewards"], known["dones"], known["infos"], strict=True))
        return True

    model.learn(steps, callback=after_step)
    after = list(model.policy.parameters())
    assert all(value.isfinite().all() for value in after)
    assert any((one != other).any() for one, other in zip(before, after, strict=True))
    return seen


def ppo(sb3, env, policy="MlpPolicy"):
    return sb3.PPO(policy, env, seed=0, device="cpu", **SETTINGS["PPO"])


@pytest.mark.parametrize(
    ("algorithm", "regime"),
    [
        pytest.param(
            algorithm, regime, marks=[] if "PPO" in algorithm or regime == "OneShot" else pytest.mark.slow
        )
        for algorithm, regime in product(SETTINGS, REGIMES)
    ],
)
def test_a_learner_sees_finite_rewards_and_every_planner_run_is_counted(sb3, face, algorithm, regime):
    env, slots = face(f"Mountain{regime}")
    seen = learn(getattr(sb3, algorithm)("MlpPolicy", env, seed=0, device="cpu", **SETTINGS[algorithm]))
    episodes = STEPS // STEPS_AN_EPISODE[regime]
    assert len(seen) == STEPS
    assert sum(slot.planner_runs for slot in slots) == RUNS_AN_EPISODE[regime] * episodes
    assert sum(end for _, _, end, _ in seen) == episodes
    assert all((np.abs(action) <= 1).all() for action, *_ in seen)
    assert all(np.isfinite(reward) and -1 <= reward <= 1 for _, reward, *_ in seen)


def test_a_reward_is_the_gap_of_the_run_of_the_learners_own_action(sb3, face):
    env, _ = face("MountainOneShot")
    space = PAPERS["liu2020"].ranges.space(1.0)
    for action, reward, end, info in learn(ppo(sb3, env)):
        assert end
        assert reward == pytest.approx(-info["gap"])
        chosen = space.decode((action.astype(float) + 1) / 2)[
            0, :3
        ]  # Q depends on the scenario's straight line
        assert list(info["parameters"].values())[:3] == pytest.approx(chosen)


def test_the_observation_that_ends_an_episode_is_its_own_and_not_the_next_ones(sb3, face):
    env, _ = face("RoomTrials", budget=BUDGET)
    model = ppo(sb3, env)
    seen = learn(model)
    assert {info["terminal_observation"][LEFT] for _, _, end, info in seen if end} == {0.0}
    assert set(model.rollout_buffer.observations[::BUDGET, LEFT]) == {
        1.0
    }  # flat by now, a slot after the other
    assert not any(info.get("TimeLimit.truncated") for *_, info in seen)


@pytest.mark.parametrize("algorithm", ["TD3", "SAC"])
def test_what_is_replayed_ends_in_the_same_scenario_as_it_began(sb3, face, algorithm):
    """In OneShot the features of a scenario are all there is to see, before its one step and after."""
    env, slots = face("MountainOneShot")
    model = getattr(sb3, algorithm)("MlpPolicy", env, seed=0, device="cpu", **SETTINGS[algorithm])
    learn(model)
    kept, filled = model.replay_buffer, STEPS // len(slots)
    assert (kept.observations[:filled] == kept.next_observations[:filled]).all()
    assert kept.dones[:filled].all()
    assert len(np.unique(kept.observations[:filled], axis=0)) > filled / 2


@pytest.mark.parametrize(
    ("world", "kind"), [("Mountain", "map"), ("Room", "map"), ("Room", "map3d"), ("Mountain", "map2d")]
)
def test_ppo_learns_from_maps(sb3, face, world, kind):
    env, slots = face(f"{world}OneShot", observation=kind)
    learn(ppo(sb3, env, "MultiInputPolicy"))
    assert sum(slot.planner_runs for slot in slots) == STEPS


def test_a_monitor_around_the_batch_counts_ten_steps_an_episode_of_control(sb3):
    from stable_baselines3.common.vec_env import VecMonitor

    from antgym.envs.sb3 import make_sb3_vec

    envs = make_sb3_vec("antgym/MountainControl-v0", SLOTS, seed=0, effort=[3, 40])
    model = ppo(sb3, VecMonitor(envs))
    learn(model)
    assert [info["l"] for info in model.ep_info_buffer] == [10] * (STEPS // 10)


def test_optuna_tunes_natural_values_through_an_environment():
    """By ask and tell; each reward is one paid run, and what was tried is what the planner was given."""
    optuna = pytest.importorskip("optuna", reason="needs the extra agents")
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    env = gymnasium.make("antgym/MountainOneShot-v0", suite=items())
    study = optuna.create_study(direction="maximize", sampler=optuna.samplers.TPESampler(seed=0))
    for i in range(40):
        env.reset(seed=0 if i == 0 else None, options={"scenario": 1})
        space, trial = env.unwrapped.session.problem.space, study.ask()
        for p in space.parameters:
            trial.suggest_float(p.name, p.low, p.high, log=p.scale == "log")
        _, reward, _, _, info = env.step(env.unwrapped.encode(**trial.params))
        assert info["parameters"] == pytest.approx(trial.params, rel=1e-4)
        study.tell(trial, reward)
    assert env.unwrapped.planner_runs == len(study.trials) == 40
    env.reset(options={"scenario": 1})
    assert env.step(np.zeros(4, np.float32))[1] == -1, "the published default walks into the cup"
    assert study.best_value > -0.05


def test_the_two_scenarios_want_different_settings():
    """No single setting of the oracle's grid earns in both what chance earns, half the way to the best at least."""
    means, chance, best = oracle()
    assert (best > [-0.01, -0.05]).all()
    assert (chance < [-0.05, -0.5]).all()
    assert share(means).min(axis=1).max() < 0.5


@pytest.mark.parametrize("seed", [0])
def test_ppo_of_sb3_closes_the_way_from_chance_to_the_best_in_both_scenarios(sb3, seed):
    from antgym.envs.sb3 import make_sb3_vec

    envs = make_sb3_vec("antgym/MountainOneShot-v0", 64, seed=seed, suite=items())
    settings = {"n_steps": 8, "batch_size": 128, "n_epochs": 10, "learning_rate": 1e-3}
    model = sb3.PPO("MlpPolicy", envs, seed=seed, device="cpu", **settings)

    def policy(features):
        return model.predict(features, deterministic=True)[0]

    while model.num_timesteps < 50_000 and shares(policy).min() < 0.97:
        model.learn(512, reset_num_timesteps=False)
    assert shares(policy, runs=1000, first=10_000).min() >= 0.95, "on runs that did not decide when to stop"


def test_a_plain_ppo_does_so_too_on_the_native_batch(plain_ppo):
    envs = gymnasium.make_vec("antgym/MountainOneShot-v0", num_envs=64, suite=items())
    policy, returns = plain_ppo.train(envs, 15, plain_ppo.Settings(steps=8))
    assert envs.planner_runs == 15 * 8 * 64
    assert np.isfinite(returns).all()
    assert shares(policy.act, runs=1000).min() >= 0.95


@pytest.mark.slow
def test_a_plain_ppo_learns_to_steer_a_run(plain_ppo):
    """Of one ant alone: more of them find the way under any setting."""
    alone = [item._replace(ants=1) for item in items(40)]
    envs = gymnasium.make_vec(
        "antgym/MountainControl-v0", num_envs=32, suite=alone, autoreset_mode="SameStep"
    )
    _, returns = plain_ppo.train(envs, 16, plain_ppo.Settings(steps=20))
    assert envs.planner_runs == 16 * 2 * 32
    assert np.isfinite(returns).all()
    assert np.mean(returns[-4:]) > 0.5 * np.mean(returns[:4])
