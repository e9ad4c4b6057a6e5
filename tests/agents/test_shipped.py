"""The policies that come with antgym: small, whole, and played by name where their regime is."""

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("sb3_contrib", reason="needs the extra rl")
pytest.importorskip("safetensors", reason="needs the extra rl")

import agents
from agents.networks import load
from agents.published import SHIPPED, beside, read_card
from agents.shipped import find_policy
from agents.steering import PolicyController
from antgym.errors import ParameterError
from antgym.maps.suites import load_suite
from antgym.tuning import Session, tune
from antgym.tuning.problem import TuningProblem
from antgym.tuning.run_features import observe_run
from experiments.artefact_files import trained_argument

POLICIES = sorted(path.with_suffix("") for path in SHIPPED.glob("*.safetensors"))
FLAGSHIPS = {"open-one-shot": "OneShot", "open-trials": "Trials", "open-control": "Control"}


@pytest.fixture(scope="module")
def problem():
    item = load_suite("open-v0", "test")[3]
    return TuningProblem(item.scenario, item.rules, item.ants, max(item.iterations, 40))


def test_there_is_one_for_every_regime():
    assert {name: read_card(SHIPPED / name).regime for name in FLAGSHIPS} == FLAGSHIPS
    assert {read_card(SHIPPED / name).env for name in FLAGSHIPS} == {
        f"antgym/Open{regime}-v0" for regime in FLAGSHIPS.values()
    }


@pytest.mark.parametrize("policy", POLICIES, ids=lambda path: path.name)
def test_each_is_small_and_says_how_it_was_made(policy):
    card, _ = load(policy)
    assert sum(beside(policy, suffix).stat().st_size for suffix in (".json", ".safetensors")) <= 500_000
    assert card.validation_gap == min(gap for _, gap in card.history)
    assert card.settings["asked"]["evaluations"] >= card.evaluations > 0


def test_a_policy_of_trials_is_an_agent_by_name(problem):
    agent = agents.make("rl:open-trials", **trained_argument("rl:open-trials", None))
    session = Session(problem, 3)
    setting, trials = tune(agent, session, seed=0)
    assert len(trials) == 3
    assert ((setting >= 0) & (setting <= 1)).all()


def test_what_is_shipped_is_made_by_its_name_alone():
    assert agents.make("rl:open-trials").card.regime == "Trials"
    assert agents.make("rl", path="open-one-shot-2").path == SHIPPED / "open-one-shot-2"
    for committee in (
        agents.make("rl_committee:open-committee"),
        agents.make("rl_committee", path="open-committee"),
    ):
        assert committee.path == SHIPPED / "open-committee.json"


@pytest.mark.parametrize(
    ("name", "path", "message"),
    [
        ("rl", "open-on-shot", r"open-on-shot\.json: no such policy; did you mean 'open-one-shot'"),
        ("rl:open-trails", None, "did you mean 'open-trials'"),
        ("open-trials", None, "the shipped open-trials is followed as 'rl:open-trials'"),
        (
            str(SHIPPED / "open-trials.json"),
            None,
            "followed as 'rl:open-trials', with the artefacts of the folder",
        ),
        ("rl", "open-committee", "is a committee, .* it is rl_committee:open-committee"),
        ("rl_committee", "open-one-shot", "is a policy, .* it is rl:open-one-shot"),
    ],
)
def test_a_name_that_is_not_meant_so_leads_to_the_one_that_is(name, path, message):
    with pytest.raises(ParameterError, match=message):
        agents.make(name, **({"path": path} if path else {}))


def test_a_misspelt_controller_leads_to_the_nearest():
    with pytest.raises(ParameterError, match="did you mean 'open-control'"):
        PolicyController("open-contrl")


def test_a_policy_that_steers_is_found_by_name(problem):
    controller = PolicyController("open-control")
    session = Session(problem, 1)
    controller.reset(session.task, seed=0)
    session.open(10)
    setting = controller.act(observe_run(session.task, session.opened))
    assert ((setting >= 0) & (setting <= 1)).all()
    assert np.abs(setting - 0.5).max() > 0.01


def test_a_file_of_ones_own_goes_before_a_shipped_one(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert find_policy("open-control") == SHIPPED / "open-control"
    assert find_policy("out/open-control") == Path("out/open-control")
    for name in ("./open-control", "open-control.safetensors"):
        with pytest.raises(ParameterError, match=r"open-control\.json: no such policy"):
            find_policy(name)
    (tmp_path / "open-control.json").write_text("{}")
    for name in ("open-control", "./open-control", "open-control.json"):
        assert find_policy(name) == Path(name)
