"""What a board costs: counted as it is run, shared runs once, and no faster on many cores than its longest run."""

import pytest

pytest.importorskip("matplotlib")  # the real terrain

from antgym.envs.scenarios import find_items
from antgym.errors import LedgerError
from antgym.tuning.ledger import Ledger
from experiments import costs
from experiments.artefacts import _raced
from experiments.leaderboard import Arguments, names_of, plan_board, untrained_board
from experiments.presets import PRESETS

ASKED = Arguments("smoke", agents=("random_search", "regression"), track=("A", "B", "C"), budgets=(0, 1, 5))
FRESH = PRESETS["smoke"].fresh


@pytest.fixture
def rounds():
    return untrained_board(ASKED, plan_board(ASKED))


def test_runs_that_two_tracks_share_are_counted_once(rounds):
    clock = {(item.name, item.iterations): 1.0 for played in rounds for item in played.items}
    found = costs.shares(rounds, FRESH, clock, {})
    keys = {job.key for played in rounds for job in played.jobs}
    assert sum(share.runs for share in found) == len(keys)
    by_name = {share.name: share for share in found}
    assert list(by_name) == [
        "track A, trials per map: 1",
        "track A, trials per map: 5",
        "track B, trials per map: 0",
        "track C, trials per map: 1",
    ]
    share = by_name["track A, trials per map: 5"]
    runs = 2 * len(names_of(ASKED))
    assert (share.runs, share.trials, share.judging) == (runs, 5 * runs, FRESH * runs)
    assert (share.planner, share.longest) == (share.trials + share.judging, 5 + FRESH)
    assert (by_name["track C, trials per map: 1"].judging, by_name["track C, trials per map: 1"].longest) == (
        0,
        1,
    )


def test_what_agents_think_is_read_from_a_board_and_scaled_to_the_budget(rounds, tmp_path):
    mine = "my/agent.py:Mine"
    with Ledger(tmp_path, {"agents": [mine]}, {}) as ledger:
        for seed in (0, 2):
            ledger.run(f"random_search/10/map/{seed}").time(tuner=1.0 + seed, planner=9.0)
        ledger.run(f"{mine}/10/map/0").time(tuner=4.0)
        ledger.run("regression/map/0").time(tuner=1.0)  # steered
        ledger.run("exact planner/map").time(planner=1.0)
    thought = costs.read_thought(tmp_path)
    assert thought == {("random_search", 10): 2.0, (mine, 10): 4.0}
    clock = {(item.name, item.iterations): 0.0 for played in rounds for item in played.items}
    found = {share.name: share for share in costs.shares(rounds, FRESH, clock, thought)}
    assert found["track A, trials per map: 5"].thinking == pytest.approx(2 * 1.0)  # two maps, half the budget


def test_a_board_without_seconds_is_named(tmp_path):
    with Ledger(tmp_path, {}, {}):
        pass
    with pytest.raises(LedgerError, match=r"there are no seconds of agents in timing\.jsonl"):
        costs.read_thought(tmp_path)


def test_a_dry_run_shows_every_number_of_cores_and_trains_nothing(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = costs.estimate(ASKED, None)
    assert all(f"\n| {cores} | " in text for cores in ("1", "100", "10,000"))
    assert "| experience.json | 96 | " in text
    assert not list(tmp_path.iterdir())


def test_what_training_takes_is_told_whoever_needs_the_file_and_never_too_low():
    preset = PRESETS["smoke"]
    found = {one.name: one.runs for one in costs.trainings(["neural_regression"], preset, 1.0, rules=1)}
    assert found == {"experience.json": preset.experience_trials}
    items = find_items("open-v0", "train")
    (race,) = costs.trainings(["best_static_by_rules"], preset, 1.0, len(set(items.rules)))
    assert race.runs >= len(_raced("open-v0", preset)) * preset.race_settings
    assert race.seconds == race.runs


@pytest.mark.parametrize(
    ("seconds", "text"), [(0.0254, "25 ms"), (1.0, "1.0 s"), (90.0, "1.5 min"), (7200.0, "2.0 h")]
)
def test_seconds_are_written_as_people_read_them(seconds, text):
    assert costs.duration(seconds) == text
