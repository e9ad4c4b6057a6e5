"""Published policies as agents: asked once in OneShot, trial by trial in Trials, shown what the environment shows."""

import json
from dataclasses import replace

import gymnasium
import numpy as np
import pytest

pytest.importorskip("sb3_contrib", reason="needs the extra rl")
pytest.importorskip("safetensors", reason="needs the extra rl")

from blank_models import SIZE, blank_model

import agents
import agents.policy
from agents.choosing import Committee, digest_of
from agents.committee import CommitteeAgent
from agents.networks import export
from agents.policy import PolicyAgent
from antgym.errors import ParameterError
from antgym.tuning import Session, incumbent, observe, observe_with_map, settings_of, tune
from antgym.tuning.features import TASK_FEATURES
from antgym.tuning.observation import bounds
from antgym.tuning.problem import TuningProblem
from antgym.tuning.run_features import CONTROL_FEATURES

WINDOW = 3
TRIALS = len(bounds(4, window=WINDOW)[0])


def test_a_policy_recommends_its_deterministic_action_and_runs_nothing(tmp_path, bowl):
    model, session = blank_model("TD3"), bowl(5)
    export(model, tmp_path / "p")
    result = tune(PolicyAgent(tmp_path / "p.safetensors"), session, seed=0)
    action, _ = model.predict(observe(session.task), deterministic=True)
    np.testing.assert_allclose(result.recommendation, (action + 1) / 2, atol=1e-6)
    assert session.left == 5


@pytest.mark.parametrize(("kind", "picture"), [("map2d", (3, 32, 32)), ("map3d", (3, 16, 16, 16))])
def test_a_policy_trained_on_maps_looks_at_the_map(tmp_path, valley, kind, picture):
    model, session = blank_model(picture=picture), Session(TuningProblem(valley), 1)
    export(model, tmp_path / "p")
    result = tune(PolicyAgent(tmp_path / "p"), session, seed=0)
    action, _ = model.predict(observe_with_map(session.task, flat=kind == "map2d"), deterministic=True)
    np.testing.assert_allclose(result.recommendation, np.clip((action + 1) / 2, 0, 1), atol=1e-6)


@pytest.mark.parametrize("algorithm", ["PPO", "RecurrentPPO"])
@pytest.mark.parametrize("kind", ["features", "map"])
def test_a_policy_of_trials_sees_what_the_environment_shows_and_pays_for_the_same_trials(
    tmp_path, algorithm, kind
):
    """Observation by observation, action by action; the recommendation is the setting that the last reward judged."""
    picture = (3, 16, 16, 16) if kind == "map" else None
    model = blank_model(algorithm, size=TRIALS, picture=picture)
    export(model, tmp_path / "p", regime="Trials", window=WINDOW)
    env = gymnasium.make("antgym/MountainTrials-v0", budget=6, window=WINDOW, effort=[3, 5], observation=kind)
    seen, _ = env.reset(seed=0, options={"scenario": 2})
    problem = env.unwrapped._episodes.problem(0)
    agent, session = PolicyAgent(tmp_path / "p"), Session(problem, 6)
    agent.reset(session.task, seed=0)
    over = False
    while not over:
        ours = agent._observe()
        for one, other in [(ours[k], seen[k]) for k in seen] if picture else [(ours, seen)]:
            assert one.tolist() == other.tolist()
        asked = agent.ask()
        seen, _, over, _, info = env.step((2 * asked[0] - 1).astype(np.float32))
        agent.tell(session.evaluate(asked))
        assert session.trials[-1] == env.unwrapped.session.trials[-1]
    assert session.left == 0
    natural = problem.space.decode(agent.recommend())[0]
    assert natural.tolist() == pytest.approx(list(info["parameters"].values()))
    assert tuple(agent.recommend()) == incumbent(session.trials)[0]


def test_a_policy_of_trials_proposes_what_its_network_says(tmp_path, bowl):
    model = blank_model(size=TRIALS)
    export(model, tmp_path / "p", regime="Trials", window=WINDOW)
    session = bowl(4)
    tune(PolicyAgent(tmp_path / "p"), session, seed=0)
    action, _ = model.predict(observe(session.task, session.trials[:2], window=WINDOW), deterministic=True)
    np.testing.assert_allclose(session.trials[2].unit, settings_of(action), atol=1e-6)
    assert session.left == 0


def test_a_policy_may_correct_what_a_committee_chooses(tmp_path, bowl):
    """Its moves begin there; before any trial that is what it recommends."""
    for seed in range(2):
        export(blank_model(seed=seed), tmp_path / f"seed-{seed}")
    Committee(("seed-0", "seed-1")).save(tmp_path / "both.json")
    model, follows = (
        blank_model(size=TRIALS),
        {"follows": "both", "follows_sha256": digest_of(tmp_path / "both")},
    )
    export(model, tmp_path / "p", regime="Trials", window=WINDOW, action="moved", **follows)
    agent, session = PolicyAgent(tmp_path / "p"), bowl(4)
    chosen = tune(CommitteeAgent(tmp_path / "both.json"), bowl(4), seed=0).recommendation
    agent.reset(session.task, seed=0)
    assert agent.recommend() == pytest.approx(chosen, abs=2**-24)
    action, _ = model.predict(observe(session.task, (), window=WINDOW), deterministic=True)
    assert agent.ask()[0] == pytest.approx(np.clip(chosen + action / 2, 0, 1), abs=1e-6)
    (tmp_path / "both.json").unlink()
    with pytest.raises(ParameterError, match="corrects what 'both' chooses, and there is none beside it"):
        PolicyAgent(tmp_path / "p")


def test_a_policy_of_trials_begins_anew_on_every_task(tmp_path, bowl):
    export(blank_model("RecurrentPPO", size=TRIALS), tmp_path / "p", regime="Trials", window=WINDOW)
    agent = PolicyAgent(tmp_path / "p")
    first, again = (tune(agent, bowl(3), seed=0) for _ in range(2))
    assert first.trials == again.trials


@pytest.mark.parametrize(
    ("facts", "change", "message"),
    [
        (
            {},
            {"features": np.zeros(3, np.float32)},
            rf"takes observations of shape \({len(TASK_FEATURES)},\), the task's is \(3,\)",
        ),
        ({"regime": "Trials", "window": 1}, {}, rf"takes observations of shape \({len(TASK_FEATURES)},\)"),
        ({"regime": "Trials"}, {"budget": 0}, "picks trials, but the task's budget is 0"),
        ({"parameters": ["alpha", "beta", "rho", "q0"]}, {}, "picks .*q0"),
    ],
)
def test_a_task_that_a_policy_was_not_trained_for_is_refused(tmp_path, bowl, facts, change, message):
    export(blank_model(size=SIZE), tmp_path / "p")
    file = tmp_path / "p.json"
    file.write_text(json.dumps({**json.loads(file.read_text()), **facts}))  # as of another version of antgym
    agent, session = PolicyAgent(tmp_path / "p"), bowl(5)
    session.task = replace(session.task, **change)
    with pytest.raises(ParameterError, match=message):
        tune(agent, session, seed=0)


def test_a_policy_that_steers_is_no_agent(tmp_path):
    export(blank_model(size=len(CONTROL_FEATURES), action="each"), tmp_path / "p", regime="Control")
    with pytest.raises(ParameterError, match="steers a run"):
        PolicyAgent(tmp_path / "p")


def test_without_a_shipped_policy_rl_asks_for_a_path(tmp_path, monkeypatch):
    for module in (agents.policy, agents.shipped):
        monkeypatch.setattr(module, "SHIPPED", tmp_path)
    with pytest.raises(ParameterError, match="agent 'rl' needs path="):
        agents.make("rl")


def test_a_shipped_policy_needs_no_path(tmp_path, monkeypatch, bowl):
    for module in (agents.policy, agents.shipped):
        monkeypatch.setattr(module, "SHIPPED", tmp_path)
    export(blank_model(), tmp_path / "open-one-shot", env="antgym/OpenOneShot-v0")
    export(blank_model(seed=1), tmp_path / "room-one-shot", env="antgym/RoomOneShot-v0")
    flagship, other = (
        tune(agents.make("rl", **named), bowl(1), seed=0).recommendation
        for named in ({}, {"policy": "room-one-shot"})
    )
    assert flagship.tolist() != other.tolist()
    with pytest.raises(ParameterError, match="'rom-one-shot' is shipped; did you mean 'room-one-shot'"):
        agents.make("rl", policy="rom-one-shot")
