"""Controllers: constants stay, schedules switch once, policies steer as they do in their environment."""

import gymnasium
import numpy as np
import pytest

pytest.importorskip("sb3_contrib", reason="needs the extra rl")
pytest.importorskip("safetensors", reason="needs the extra rl")

from blank_models import blank_model

from agents.controls import PublishedDefault, RandomSearch
from agents.networks import export
from agents.static import StaticAgent, StaticSetting
from agents.steering import ConstantController, PolicyController, Schedule, ScheduleController
from antgym.errors import ParameterError
from antgym.tuning import Session
from antgym.tuning.run_features import CONTROL_FEATURES, observe_run
from antgym.tuning.session import steer_together

UNIT = (0.6, 0.9, 0.4, 0.5)
NAMES = ("alpha", "beta", "rho", "Q")


@pytest.fixture
def static():
    return StaticAgent(StaticSetting(UNIT, 0, NAMES))


@pytest.mark.parametrize("agent", [PublishedDefault(), RandomSearch()])
def test_a_constant_is_what_the_agent_recommends_without_a_trial(bowl, agent):
    controller = ConstantController(agent)
    controller.reset(bowl(1).task, seed=0)
    assert controller.act(None).tolist() == [0.5] * 4
    assert not hasattr(agent, "_setting"), "it was a copy that was asked"


def test_a_schedule_multiplies_natural_values_and_stays_within_their_ranges(bowl, static):
    task = bowl(1).task
    controller = ScheduleController(static, Schedule((1.0, 0.5), (1.0, 4.0), 3))
    controller.reset(task, seed=0)
    walked = [controller.act(None) for _ in range(10)]
    assert [unit.tolist() for unit in walked[:3]] == [list(UNIT)] * 3
    assert len({tuple(unit) for unit in walked[3:]}) == 1
    before, after, high = (task.space.decode(unit)[0] for unit in (UNIT, walked[3], np.ones(4)))
    assert after[0] == pytest.approx(before[0] / 2)
    assert after[1] == pytest.approx(min(4 * before[1], high[1]))
    assert after[2:].tolist() == pytest.approx(before[2:].tolist())


@pytest.mark.parametrize(
    ("algorithm", "action", "start", "observation"),
    [
        ("PPO", "each", None, "features"),
        ("RecurrentPPO", "each", [0.25, 0.5, 0.75, 0.5], "features"),
        ("DQN", "one", [0.25, 0.5, 0.75, 0.5], "features"),
        ("SAC", "setting", None, "features"),
        ("PPO", "moved", {"liu2020": [0.25, 0.5, 0.75, 0.5]}, "features"),
        ("A2C", "each", {"liu2020": [0.25, 0.5, 0.75, 0.5]}, "features"),
        ("PPO", "each", None, "map3d"),
    ],
)
def test_a_policy_steers_as_it_does_in_its_environment(tmp_path, algorithm, action, start, observation):
    """The batch that it was trained in and the controller walk the same blocks."""
    from antgym.envs.sb3 import ChangingVecEnv, MovedVecEnv, make_sb3_vec

    picture = None if observation == "features" else (3, 16, 16, 16)
    model = blank_model(algorithm, size=len(CONTROL_FEATURES), picture=picture, action=action)
    export(model, tmp_path / "p", regime="Control", action=action, start=start)
    envs = make_sb3_vec("antgym/MountainControl-v0", 1, seed=3, effort=[3, 40], observation=observation)
    native = envs.native.envs[0]
    if action == "moved":
        envs = MovedVecEnv(envs, start)
    elif action != "setting":
        envs = ChangingVecEnv(envs, action, start)
    seen, state, ends = envs.reset(), None, np.ones(1, bool)
    session = Session(native._episodes.problem(0), 1)
    session.open(10)
    controller = PolicyController(tmp_path / "p")
    controller.reset(session.task, seed=0)
    for _ in range(10):
        picked, state = model.policy.predict(seen, state=state, episode_start=ends, deterministic=True)
        unit = controller.act(observe_run(session.task, session.opened))
        seen, _, ends, infos = envs.step(picked)
        steer_together([(session, unit)])
        assert session.opened.parameters == pytest.approx(tuple(infos[0]["parameters"].values()))
        assert session.opened.length == infos[0]["length"] or not infos[0]["solved"]
    assert ends.all()


def test_a_policy_of_another_regime_steers_nothing(tmp_path):
    export(blank_model(), tmp_path / "p")
    with pytest.raises(ParameterError, match="a policy of OneShot steers no run"):
        PolicyController(tmp_path / "p")


def test_a_constant_controller_in_the_environment_is_one_shot(static):
    env = gymnasium.make("antgym/MountainControl-v0", effort=[3, 40])
    one = gymnasium.make("antgym/MountainOneShot-v0", effort=[3, 40])
    seen, _ = env.reset(seed=5)
    one.reset(seed=5)
    controller = ConstantController(static)
    controller.reset(env.unwrapped.session.task, seed=0)
    for _ in range(10):
        seen, _, _, _, info = env.step((2 * controller.act(seen) - 1).astype(np.float32))
    assert info["length"] == one.step((2 * np.array(UNIT) - 1).astype(np.float32))[-1]["length"]
