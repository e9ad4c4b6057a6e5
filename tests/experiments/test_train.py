"""Training: what fits what, what is spent and counted, and that being stopped changes nothing."""

import json
from dataclasses import replace
from itertools import product

import numpy as np
import pytest

pytest.importorskip("sb3_contrib", reason="needs the extra rl")
pytest.importorskip("safetensors", reason="needs the extra rl")

from blank_models import blank_model

from agents.algorithms import ALGORITHMS
from agents.networks import export, load
from agents.policy import PolicyAgent
from agents.published import read_card
from agents.static import StaticSetting, StaticSettings
from agents.steering import PolicyController
from antgym.errors import ParameterError
from antgym.maps.suites import load_suite
from antgym.tuning.problem import TuningProblem
from experiments import learners, train
from experiments.train import Arguments

ON_POLICY = "num_envs = 4\nn_steps = 10\n"
OFF_POLICY = "num_envs = 4\nlearning_starts = 8\nbatch_size = 8\ntrain_freq = 2\n"
CONFIG = {
    "PPO": ON_POLICY + "batch_size = 20\nn_epochs = 2\nreward_scale = 3.0\n",
    "RecurrentPPO": ON_POLICY + "batch_size = 20\nn_epochs = 2\n",
    "TRPO": ON_POLICY + "batch_size = 20\n",
    "A2C": ON_POLICY,
    "ARS": "num_envs = 1\nn_delta = 2\nn_eval_episodes = 2\n",
    **dict.fromkeys(("SAC", "TQC", "CrossQ", "DQN", "QRDQN"), OFF_POLICY),
    **dict.fromkeys(("TD3", "DDPG"), OFF_POLICY + "action_noise = 0.2\n"),
}
EFFORT = {"OneShot": [5, 3], "Trials": [5, 3], "Control": [3, 40]}
EVALUATIONS = {"OneShot": 160, "Trials": 160, "Control": 16}
FITTING = [
    (name, regime, action)
    for name, regime in product(ALGORITHMS, EFFORT)
    for action in learners.ACTIONS[regime]
    if action in ALGORITHMS[name].actions and action != "moved"  # which is a setting plus a constant
]


@pytest.fixture
def asked(tmp_path, monkeypatch):
    """A function that returns arguments of a tiny training."""
    monkeypatch.setattr(learners, "STANDARD_MAPS", 3)
    config = tmp_path / "tiny.toml"
    config.write_text("\n".join(f"[{name}]\n{text}" for name, text in CONFIG.items()))

    def made(algorithm="PPO", regime="OneShot", out="policy", kwargs=None, **others):
        given = {"effort": EFFORT[regime], **({"budget": 5} if regime == "Trials" else {}), **(kwargs or {})}
        return Arguments(
            algorithm,
            f"antgym/Mountain{regime}-v0",
            **{"evaluations": EVALUATIONS[regime], "validation": 3, **others},
            out=tmp_path / out,
            config=config,
            kwargs=json.dumps(given),
        )

    return made


def weights(path):
    """What there is to compare of a published policy: weights, and all that was counted."""
    card = json.loads(path.with_name(path.name + ".json").read_text())
    return {name: value for name, value in card.items() if name != "seconds"}


def check(arguments, told, regime):
    """A training that was whole: counted, published, playable, and nothing left behind."""
    card, _ = load(arguments.out)
    assert (card.regime, card.algorithm) == (regime, arguments.algorithm)
    assert 0 < card.evaluations == told["evaluations"] <= arguments.evaluations
    per_map = {"OneShot": 1, "Trials": 10, "Control": 1}[regime]
    assert card.validation_runs == 3 * per_map * len(card.history) > 0
    assert card.validation_gap == min(gap for _, gap in card.history)
    assert not list(arguments.out.parent.glob("*.checkpoints"))
    if regime != "Control":
        item = load_suite("mountain-v0", "test")[0]
        agent = PolicyAgent(arguments.out)
        agent.reset(TuningProblem(item.scenario, item.rules, 5, 3).task(5), seed=0)
        assert ((agent.recommend() >= 0) & (agent.recommend() <= 1)).all()


@pytest.mark.slow
@pytest.mark.parametrize(("algorithm", "regime", "action"), FITTING)
def test_every_algorithm_trains_and_is_published_where_it_fits(asked, algorithm, regime, action):
    arguments = asked(algorithm, regime, action=action)
    check(arguments, train.train(arguments), regime)


@pytest.mark.parametrize(
    ("algorithm", "regime"), [("PPO", "OneShot"), ("RecurrentPPO", "Trials"), ("DQN", "Control")]
)
def test_a_training_is_counted_and_published(asked, algorithm, regime):
    arguments = asked(algorithm, regime)
    check(arguments, train.train(arguments), regime)


def test_a_policy_learns_from_maps(asked):
    arguments = asked(kwargs={"observation": "map2d"})
    check(arguments, train.train(arguments), "OneShot")
    assert load(arguments.out)[0].observation == "map2d"


def test_settings_are_changed_from_a_start_that_is_published_with_the_policy(asked):
    arguments = asked("PPO", "Control", start=(0.25, 0.5, 0.75, 0.5))
    train.train(arguments)
    card, _ = load(arguments.out)
    assert (card.action, card.start) == ("each", [0.25, 0.5, 0.75, 0.5])


def test_changes_begin_from_settings_by_rules_that_a_file_holds(asked, tmp_path):
    setting = StaticSetting((0.25, 0.5, 0.75, 0.5), 7, ("alpha", "beta", "rho", "Q"))
    StaticSettings({"liu2020": setting}).save(tmp_path / "by_rules.json")
    arguments = asked("DQN", "Control", start_by_rules=tmp_path / "by_rules.json")
    train.train(arguments)
    card, _ = load(arguments.out)
    assert (card.start, card.start_evaluations) == ({"liu2020": [0.25, 0.5, 0.75, 0.5]}, 7)
    assert "finished" in train.train(arguments)


@pytest.mark.parametrize(("algorithm", "regime"), [("PPO", "Trials"), ("SAC", "OneShot"), ("PPO", "Control")])
def test_what_is_learnt_may_correct_the_choice_of_another_policy(asked, tmp_path, algorithm, regime):
    export(blank_model(), tmp_path / "first", evaluations=9)
    arguments = asked(algorithm, regime, action="moved", start_by_policy=str(tmp_path / "first"))
    check(arguments, train.train(arguments), regime)
    card, _ = load(arguments.out)
    assert (card.action, card.follows, card.start_evaluations) == ("moved", "first", 9)
    assert (card.history[0][0] == 0) == (algorithm == "PPO")  # an untrained SAC moves from its start
    assert "finished" in train.train(arguments)
    export(blank_model(seed=1), tmp_path / "first")
    play = PolicyController if regime == "Control" else PolicyAgent
    with pytest.raises(
        ParameterError, match=r"corrects what 'first' chooses, and .*first\.json is another one"
    ):
        play(arguments.out)


class StoppedError(Exception):
    """Stands in for kill -9."""


def stop_in(monkeypatch, validation):
    """Stop trainings in a validation, the first being 1, and no more after it."""
    gap, calls = train.Validation.gap, []

    def stopping(self, model):
        calls.append(1)
        if len(calls) == validation:
            raise StoppedError
        return gap(self, model)

    monkeypatch.setattr(train.Validation, "gap", stopping)


RESUMED = [
    pytest.param(*case, marks=[] if case[0] in ("PPO", "TD3") else pytest.mark.slow)
    for case in (
        ("PPO", "OneShot"),
        ("TD3", "OneShot"),
        ("SAC", "Trials"),
        ("CrossQ", "OneShot"),
        ("TQC", "OneShot"),
        ("RecurrentPPO", "Trials"),
        ("DQN", "Control"),
        ("QRDQN", "Control"),
        ("A2C", "Control"),
        ("TRPO", "OneShot"),
        ("ARS", "OneShot"),
    )
]


@pytest.mark.parametrize(("algorithm", "regime"), RESUMED)
def test_a_training_that_was_stopped_gives_the_policy_of_one_that_was_not(
    asked, monkeypatch, algorithm, regime
):
    whole, cut = asked(algorithm, regime, out="whole"), asked(algorithm, regime, out="cut")
    train.train(whole)
    stop_in(monkeypatch, 2)
    with pytest.raises(StoppedError):
        train.train(cut)
    assert not cut.out.with_suffix(".json").exists()
    train.train(cut)
    assert weights(whole.out) == weights(cut.out)


def test_what_is_finished_is_not_done_again(asked, monkeypatch):
    arguments = asked()
    first = train.train(arguments)
    monkeypatch.setattr(train, "_run", None)
    assert train.train(arguments) == {"finished": str(arguments.out.with_suffix(".json")), **first}
    with pytest.raises(
        ParameterError, match=r"made with other settings \(seed: 0, now 1\); use another --out"
    ):
        train.train(asked(seed=1))


def test_a_folder_of_another_training_is_refused(asked, monkeypatch):
    monkeypatch.setattr(train, "export", None)
    with pytest.raises(TypeError):
        train.train(asked())
    with pytest.raises(
        ParameterError, match=r"checkpoints was made with other settings \(evaluations: 160, now 80\)"
    ):
        train.train(asked(evaluations=80))


def test_the_published_policy_is_the_checkpoint_that_did_best(asked, monkeypatch):
    gaps = iter([0.5, 0.1, 0.9, 0.8])
    seen = []

    def gap(self, model):
        seen.append(np.concatenate([v.detach().numpy().ravel() for v in model.policy.actor.parameters()]))
        return next(gaps)

    monkeypatch.setattr(train.Validation, "gap", gap)
    arguments = asked("TD3", evaluations=32)
    train.train(arguments)
    card, network = load(arguments.out)
    ours = np.concatenate([v.detach().numpy().ravel() for v in network.actor.parameters()])
    assert card.validation_gap == 0.1
    assert (ours == seen[1]).all()
    assert (seen[1] != seen[2]).any()


def test_where_learning_only_harms_what_is_published_is_the_start(asked, monkeypatch, tmp_path):
    export(blank_model(), tmp_path / "first")
    gaps = iter([0.1, 0.5, 0.4])
    seen = []

    def gap(self, model):
        seen.append(model.policy.action_net.weight.detach().numpy().copy())
        return next(gaps)

    monkeypatch.setattr(train.Validation, "gap", gap)
    arguments = asked(action="moved", start_by_policy=str(tmp_path / "first"), evaluations=80)
    train.train(arguments)
    card, network = load(arguments.out)
    assert card.history == [[0, 0.1], [40, 0.5], [80, 0.4]]
    assert (network.action_net.weight.detach().numpy() == seen[0]).all()
    assert (seen[0] != seen[1]).any()
    item = load_suite("mountain-v0", "test")[0]
    settings = []
    for path in (tmp_path / "first", arguments.out):
        agent = PolicyAgent(path)
        agent.reset(TuningProblem(item.scenario, item.rules, 5, 3).task(0), seed=0)
        settings.append(agent.recommend())
    assert settings[1] == pytest.approx(settings[0], abs=0.01)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            {"algorithm": "DQN"},
            "DQN does not fit antgym/MountainOneShot-v0, which takes settings, a Box; what fits: PPO",
        ),
        (
            {"algorithm": "SAC", "regime": "Control", "action": "each"},
            "SAC does not fit .*'each'; what fits: PPO, A2C",
        ),
        ({"algorithm": "PPPO"}, "unknown algorithm 'PPPO'; did you mean 'PPO'"),
        ({"action": "each"}, "in Control alone"),
        ({"start": (0.5,) * 4}, "only where settings are changed"),
        ({"action": "moved"}, "moved from where"),
        (
            {"action": "moved", "start": (0.5,) * 4, "start_by_policy": "open-committee"},
            "--start and --start-by-policy",
        ),
        (
            {"action": "moved", "start_by_policy": "first"},
            "first.json: no such policy; did you mean",
        ),
        (
            {"action": "moved", "start_by_policy": "open-control"},
            "open-control: is a policy of Control that sees features; .* one of OneShot",
        ),
        ({"regime": "Control", "start": (0.5,)}, "needs 4 values"),
        ({"algorithm": "CrossQ", "kwargs": {"observation": "map"}}, "CrossQ reads no maps"),
        ({"kwargs": {"sweet": 1}}, "unknown environment argument 'sweet'"),
        ({"kwargs": {"split": "test"}}, "a policy is trained on train maps"),
        ({"evaluations": 0}, "at least one planner run"),
        ({"validation": 0}, "on one map at least"),
        ({"seed": 1 << 32}, "seed = "),
    ],
)
def test_what_makes_no_sense_is_one_clear_error(asked, arguments, message):
    with pytest.raises(ParameterError, match=message):
        train.train(asked(**arguments))


def test_the_choice_of_another_swarm_is_told_by_its_parameters(asked):
    arguments = replace(asked(action="moved", start_by_policy="open-committee"), env="antgym/BeeOneShot-v0")
    with pytest.raises(
        ParameterError, match=r"chooses alpha, .* for ants, and antgym/BeeOneShot-v0 has limit"
    ):
        train.train(arguments)


def test_an_unknown_environment_is_named(tmp_path):
    with pytest.raises(ParameterError, match="did you mean 'antgym/OpenOneShot-v0'"):
        train.train(Arguments("PPO", "antgym/OpenOneshot-v0", out=tmp_path / "p"))


def test_the_files_hold_settings_for_every_algorithm_that_fits():
    for name, regime, action in FITTING:
        learner = learners.Learner(name, f"antgym/Open{regime}-v0", action, {}, None, None)
        assert learner.settings["num_envs"] >= 1


def drawn(folder):
    """(step, value) of every curve that TensorBoard draws of the one run in a folder."""
    from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

    (run,) = folder.iterdir()
    events = EventAccumulator(str(run)).Reload()
    return {tag: [(e.step, e.value) for e in events.Scalars(tag)] for tag in events.Tags()["scalars"]}


def test_curves_are_of_returns_gaps_and_planner_runs_and_a_training_that_was_stopped_draws_none_twice(
    asked, monkeypatch, tmp_path
):
    pytest.importorskip("tensorboard")
    arguments = asked(action="moved", start=(0.25, 0.5, 0.75, 0.5), tensorboard=tmp_path / "curves")
    stop_in(monkeypatch, 3)
    with pytest.raises(StoppedError):
        train.train(arguments)
    stopped = drawn(tmp_path / "curves")
    assert [step for step, _ in stopped["rollout/ep_rew_mean"]] == [40, 80]
    train.train(arguments)
    curves, history = drawn(tmp_path / "curves"), read_card(arguments.out).history
    assert curves["validation/gap"] == [(runs, pytest.approx(gap)) for runs, gap in history]
    assert history[0][0] == 0  # of the start, before it is changed
    assert curves["time/planner_runs"] == [(runs, runs) for runs in (0, 40, 40, 80, 80, 120, 120, 160, 160)]
    assert curves["rollout/ep_len_mean"] == [(step, 1) for step in (40, 80, 120, 160)]
    assert curves["rollout/ep_rew_mean"][0] == stopped["rollout/ep_rew_mean"][0]
    assert all(
        -1 <= value < 0 for _, value in curves["rollout/ep_rew_mean"]
    )  # not times 3, as PPO learns from


def test_a_training_that_costs_more_than_was_asked_for_says_so(asked, capsys):
    told = train.train(asked(evaluations=10))
    assert "--evaluations 10: PPO spends 40, its least: one update\n" in capsys.readouterr().err
    assert told["evaluations"] == 40
    train.train(asked(evaluations=79, out="enough"))
    assert "--evaluations" not in capsys.readouterr().err


@pytest.mark.parametrize(("regime", "size"), [("OneShot", 36), ("Control", 48)])
def test_a_policy_for_bees_names_their_parameters_and_features(asked, regime, size):
    arguments = replace(asked(kwargs={"effort": [6, 40]}), env=f"antgym/Bee{regime}-v0")
    train.train(arguments)
    card = read_card(arguments.out.with_suffix(".json"))
    assert card.parameters == ["limit", "xi_max", "xi_min"]
    assert len(card.features) == card.size == size
    if regime == "OneShot":
        item = load_suite("bee-v0", "test")[0]
        agent = PolicyAgent(arguments.out)
        agent.reset(TuningProblem(item.scenario, item.rules, 6, 40).task(0), seed=0)
        assert agent.recommend().shape == (3,)
