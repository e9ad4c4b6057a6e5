"""The race of controllers: the same runs whoever steers, the same ledger however it was stopped."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("sb3_contrib", reason="needs the extra rl")
pytest.importorskip("safetensors", reason="needs the extra rl")

from blank_models import blank_model

from agents.networks import export
from agents.static import StaticSetting, StaticSettings
from antgym.errors import LedgerError, ParameterError
from antgym.tuning.ledger import Ledger
from antgym.tuning.problem import TRIAL
from antgym.tuning.run_features import CONTROL_FEATURES
from experiments import contest, control, orders, steering
from experiments.control import Arguments, race
from experiments.provenance import CONTEST, code_hash

DOCS = Path(control.__file__).parents[1] / "docs"
UNIT, NAMES = (0.6, 0.9, 0.4, 0.5), ("alpha", "beta", "rho", "Q")


@pytest.fixture
def asked(tmp_path):
    """A function that returns arguments of a race on three maps, its best settings written by hand."""
    trained = tmp_path / "trained"
    trained.mkdir()
    setting = StaticSetting(UNIT, 7, NAMES)
    setting.save(trained / "static.json")
    StaticSettings({"liu2020": setting}).save(trained / "static_by_rules.json")

    def made(*controllers, out="race", **others):
        given = {"suite": "mountain-v0", "maps": 3, "seeds": 2, "artefacts": trained, **others}
        return Arguments(controllers, **given, out=tmp_path / out)

    return made


def outcomes(arguments):
    lines = (arguments.out / "trials.jsonl").read_text().splitlines()
    return sorted(line for line in lines if json.loads(line)["kind"] == "outcome")


def test_a_constant_walks_the_runs_of_one_shot(asked):
    arguments = asked()
    table = race(arguments)
    manifest = json.loads((arguments.out / "manifest.json").read_text())
    assert manifest["config"]["code"] == code_hash(*CONTEST)  # under the name that boards have for it
    items = control._items(arguments)
    for line in map(json.loads, outcomes(arguments)):
        name, seed = line["run"].partition("/")[2].rsplit("/", 1)
        item = next(item for item in items if item.name == name)
        problem = steering.problem(item, "control", int(seed))
        alone = problem.run(np.array([UNIT]), TRIAL, 0)
        assert line["lengths"] == [length if (length := float(alone.lengths[0])) < np.inf else None]
        assert line["gaps"] == problem.gap(alone.lengths).tolist()
        assert line["unit"] == list(UNIT) * 10
    assert "`best_static_by_rules`" in table
    assert (arguments.out / "control.md").read_text() == table


def test_a_policy_and_a_schedule_race_against_the_static_setting(asked, tmp_path):
    export(
        blank_model(size=len(CONTROL_FEATURES), action="each"),
        tmp_path / "steer",
        regime="Control",
        evaluations=9,
    )
    export(blank_model(), tmp_path / "once")
    policies = (str(tmp_path / "steer.json"), str(tmp_path / "once"))
    table = race(asked("published_default", "schedule", *policies))
    rows = [line for line in table.splitlines() if line.startswith("| `")]
    assert {row.split("`")[1] for row in rows} == {
        "published_default",
        "schedule",
        "steer",
        "once",
        "best_static_by_rules",
    }
    assert all("[" in row for row in rows if "best_static" not in row)
    assert next(row for row in rows if "`steer`" in row).endswith("| 9 |")
    assert next(row for row in rows if "`schedule`" in row).split("|")[6].strip() == "–"


def test_trainings_that_differ_in_their_seed_are_shown_as_one_too(asked, tmp_path):
    for seed in (1, 2):
        model = blank_model(seed=seed, size=len(CONTROL_FEATURES), action="each")
        export(model, tmp_path / f"steer-{seed}", regime="Control", evaluations=9)
    table = race(asked(*(str(tmp_path / f"steer-{seed}") for seed in (1, 2))))
    means = {line.split("`")[1]: float(line.split("|")[2]) for line in table.splitlines() if "`" in line}
    together = means.pop("steer, 2 trainings")
    assert set(means) == {"steer-1", "steer-2", "best_static_by_rules"}
    assert together == pytest.approx((means["steer-1"] + means["steer-2"]) / 2, abs=0.011)


def test_a_policy_is_raced_against_its_own_first_setting(asked):
    """The same setting for all blocks, that of the policy for the first."""
    arguments = asked("open-control", "open-one-shot", held=True)
    rows = {cells[1]: cells for line in race(arguments).splitlines() if len(cells := line.split("|")) > 3}
    assert rows[" `held:open-control` "][6].strip().endswith("]")
    assert rows[" `open-control` "][6].strip() == "–"
    units = {line["run"]: line["unit"] for line in map(json.loads, outcomes(arguments))}
    steered = [run for run in units if run.startswith("open-control/")]
    assert len(steered) == 6
    for run in steered:
        assert units[f"held:{run}"] == units[run][:4] * 10
    assert any(units[run] != units[run][:4] * 10 for run in steered)
    assert not any(run.startswith("held:") for run in units if "open-control" not in run)


def test_a_race_that_was_stopped_ends_in_the_same_ledger_and_plays_nothing_twice(asked, monkeypatch):
    whole, cut = asked("published_default", out="whole"), asked("published_default", out="cut")
    race(whole)
    monkeypatch.setattr(contest, "TOGETHER", 5)
    play, calls = steering._play_together, []

    def stopping(some, runs):
        calls.append([job.key for job in some])
        if len(calls) == 2:
            raise KeyboardInterrupt
        play(some, runs)

    monkeypatch.setattr(steering, "_play_together", stopping)
    with pytest.raises(KeyboardInterrupt):
        race(cut)
    race(cut)
    assert outcomes(whole) == outcomes(cut)
    del calls[1]
    played = [key for call in calls for key in call]
    assert len(played) == len(set(played)) == 12


def test_a_controller_that_comes_later_is_played_alone(asked, monkeypatch):
    race(asked())
    played = []
    monkeypatch.setattr(steering, "_play_together", lambda some, runs: played.extend(some))
    with pytest.raises(AssertionError):
        race(asked("published_default"))
    assert {job.entrant.name for job in played} == {"published_default"}


def test_a_policy_that_was_changed_meanwhile_is_refused(asked, tmp_path):
    for seed in (0, 1):
        model = blank_model(size=len(CONTROL_FEATURES), action="each", seed=seed)
        export(model, tmp_path / "steer", regime="Control")
        arguments = asked(str(tmp_path / "steer"), maps=2, seeds=1)
        if seed == 0:
            race(arguments)
    with pytest.raises(LedgerError, match="policy steer"):
        race(arguments)


@pytest.mark.parametrize(
    ("controllers", "others", "message"),
    [
        (("nobody",), {}, "nobody.json: no such policy"),
        (("open-contrl",), {}, "did you mean 'open-control'"),
        (("rl:open-contrl",), {}, "did you mean 'rl:open-control'"),
        (("open-committee",), {}, "it is rl_committee:open-committee"),
        (("rl:open-trials",), {}, "policies of Control and OneShot take part"),
        (("rl_committee",), {}, "shipped: rl_committee:open-committee"),
        (("open-control",), {"suite": "tabu-bee-v0"}, r"picks \['alpha'.* the task has \['limit'"),
        (("open-one-shot",), {"held": True}, "--held: no policy of Control is raced"),
        ((), {"seeds": 0}, "--seeds 0"),
        ((), {"maps": 1}, "--suite mountain-v0 --split test: 1 map, .* two at least"),
        ((), {"against": "best_statics"}, "unknown agent 'best_statics'"),
        (("schedule",), {"suite": "no-v0"}, "no-v0"),
        ((), {"suite": "fleet-v0"}, "is a fleet"),
    ],
)
def test_what_cannot_be_raced_is_one_clear_error(asked, controllers, others, message):
    arguments = asked(*controllers, **others)
    with pytest.raises(ParameterError, match=message):
        race(arguments)
    assert not arguments.out.exists()


def test_controllers_of_one_name_are_refused_before_anything_is_written(asked, tmp_path):
    for name in ("a/steer", "b/steer", "a/schedule"):
        export(blank_model(size=len(CONTROL_FEATURES), action="each"), tmp_path / name, regime="Control")
    for names in (("a/steer", "b/steer"), ("a/schedule",)):
        arguments = asked(*(str(tmp_path / name) for name in names))
        with pytest.raises(ParameterError, match="names of their own"):
            race(arguments)
        assert not arguments.out.exists()


def test_a_schedule_on_maps_of_ones_own_is_refused_before_anything_is_written(asked, tmp_path):
    (tmp_path / "own" / "test").mkdir(parents=True)
    for name in ("hills.asc", "flat.yaml", "flat.png"):
        shutil.copy(DOCS / name, tmp_path / "own" / "test")
    arguments = asked("schedule", suite=str(tmp_path / "own"))
    with pytest.raises(ParameterError, match="no card tells of schedules"):
        race(arguments)
    assert not arguments.out.exists()


def test_what_was_asked_under_other_settings_is_forgotten_before_a_training_that_may_be_stopped(
    asked, monkeypatch
):
    arguments = asked()
    with Ledger(arguments.out, {"of": "before"}, {}):
        orders.ask(arguments.out, ["old/map/0"])

    def stopped(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(control, "prepare", stopped)
    with pytest.raises(KeyboardInterrupt):
        race(arguments)
    assert orders.asked(arguments.out) == []


def test_shipped_policies_are_raced_by_the_names_of_agents_too(asked):
    names = ("rl:open-control", "open-control", "rl_committee:open-committee")
    arguments = asked(*names, against="rl:open-one-shot", maps=2, seeds=1)
    rows = [line for line in race(arguments).splitlines() if line.startswith("| `")]
    raced = {row.split("`")[1] for row in rows}
    assert raced == {"open-control", "rl_committee:open-committee", "rl:open-one-shot"}
    pinned = json.loads((arguments.out / "manifest.json").read_text())["pinned"]
    member = "open-committee.json: open-one-shot-5.json"
    assert {"policy open-control.json", "open-committee.json", member} <= set(pinned)
