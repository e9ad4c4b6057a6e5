"""How a board stands: what is missing, broken off, failed, held twice or told differently, over all its ledgers."""

import sys

import pytest

from antgym.errors import LedgerError
from antgym.tuning.ledger import MANIFEST, TIMING, TRIALS, Ledger, Outcome
from antgym.tuning.session import Record, Trial
from experiments import status
from experiments.orders import BROKEN, ask, asked, broken, note_broken
from experiments.rows import read_clocks
from experiments.status import survey, to_lists

KEYS = [f"ga/3/map-{i}/0" for i in range(4)]
OUTCOME = Outcome((0.5,), (1.0,), (0.0,))


def write(folder, finished=(), begun=(), orders=KEYS, outcome=OUTCOME, config=None, cost=1.5):
    with Ledger(folder, config or {"budget": 3}, {}) as ledger:
        ask(folder, orders)
        for key in (*finished, *begun):
            ledger.run(key).append([Record(Trial(0, (0.5,), cost, 7), 3.0, 5)])
        for key in finished:
            ledger.run(key).finish(outcome)
    return folder


def standing_of(*folders):
    (standing,) = survey(folders)
    return standing


def test_what_was_asked_and_is_not_finished_is_missing_begun_or_not(tmp_path):
    standing = standing_of(write(tmp_path, KEYS[:2], KEYS[2:3]))
    assert standing.finished == set(KEYS[:2])
    assert list(standing.missing) == KEYS[2:]
    assert not standing.whole


def test_orders_add_up_and_keep_their_order(tmp_path):
    write(tmp_path, orders=KEYS[:2])
    write(tmp_path, orders=[KEYS[3], KEYS[0]])
    assert asked(tmp_path) == [KEYS[0], KEYS[1], KEYS[3]]


def test_shards_and_units_below_a_folder_are_part_of_it(tmp_path):
    write(tmp_path / "shards" / "1-of-2", KEYS[:2])
    write(tmp_path / "shards" / "2-of-2", KEYS[2:3])
    write(tmp_path / "shards" / "2-of-2" / "units" / "abc", KEYS[3:], orders=KEYS[3:])
    standing = standing_of(tmp_path)
    assert standing.whole
    assert len(standing.holdings) == 3
    assert standing.asked == KEYS


def test_a_shard_that_was_never_begun_is_named(tmp_path):
    shards = [write(tmp_path / "shards" / f"{number}-of-3", KEYS[number : number + 1]) for number in (1, 2)]
    assert status.shards_not_begun(standing_of(tmp_path)) == [str(tmp_path / "shards" / "3-of-3")]
    assert f"not begun: {tmp_path / 'shards' / '3-of-3'}\n" in to_lists(standing_of(*shards), None)


def test_a_merged_board_holds_what_its_shards_hold_and_nothing_twice(tmp_path):
    shards = [
        write(tmp_path / "shards" / n, keys) for n, keys in (("1-of-2", KEYS[:2]), ("2-of-2", KEYS[2:]))
    ]
    write(tmp_path, KEYS)
    assert (standing_of(tmp_path).twice, standing_of(tmp_path).whole) == ([], True)
    standing = standing_of(*shards, write(tmp_path / "elsewhere", KEYS[1:3]))
    assert (standing.twice, standing.whole) == (KEYS[1:3], True)


def test_ledgers_that_tell_of_a_run_differently_are_no_whole(tmp_path):
    standing = standing_of(write(tmp_path / "a", KEYS), write(tmp_path / "b", begun=KEYS[:1], cost=9.0))
    assert (standing.differing, standing.missing, standing.whole) == (KEYS[:1], {}, False)


def test_a_run_whose_agent_failed_is_finished_and_listed(tmp_path):
    standing = standing_of(write(tmp_path, KEYS, outcome=OUTCOME._replace(failure="it hung")))
    assert standing.whole
    assert to_lists(standing, 1) == (
        f"failed by its agent: {KEYS[0]}  it hung\nfailed by its agent: 3 more; --every lists them\n"
    )


def test_why_a_run_broke_off_is_told_until_it_has_ended(tmp_path):
    write(tmp_path, KEYS[1:])
    for reason in ("no memory", "no disk"):
        note_broken(tmp_path, KEYS[:2], reason)
    assert broken(tmp_path) == dict.fromkeys(KEYS[:2], "no disk")
    assert to_lists(standing_of(tmp_path), None) == f"missing: {KEYS[0]}  broke off: no disk\n"


def test_a_damaged_ledger_is_named_beside_the_others(tmp_path):
    write(tmp_path / "a", KEYS)
    write(tmp_path / "b")
    (tmp_path / "b" / TRIALS).write_text("{\n")
    standing = standing_of(tmp_path)
    assert not standing.whole
    assert "line 1 is damaged" in standing.holdings[1].damage


@pytest.mark.parametrize("manifest", ["{", '{"schema": 2}', "[]"])
def test_a_damaged_manifest_ends_no_survey(tmp_path, manifest):
    write(tmp_path / "a", KEYS)
    (write(tmp_path / "b") / MANIFEST).write_text(manifest)
    whole, damaged = survey([tmp_path])
    assert (whole.whole, damaged.whole) == (True, False)
    assert "manifest.json is damaged" in damaged.holdings[0].damage


@pytest.mark.parametrize("line", ["{", "7", '{"run": "a"}'])
def test_a_damaged_line_of_what_broke_off_is_named_beside_the_runs(tmp_path, line):
    write(tmp_path, KEYS[1:])
    (tmp_path / BROKEN).write_text(f"{line}\n")
    standing = standing_of(tmp_path)
    assert "broken.jsonl, line 1 is damaged" in standing.holdings[0].damage
    assert (standing.finished, standing.whole) == (set(KEYS[1:]), False)


@pytest.mark.parametrize("line", ["{", '{"tuner": 1.0}'])
def test_a_damaged_line_of_seconds_is_named(tmp_path, line):
    write(tmp_path, KEYS[1:])
    (tmp_path / TIMING).write_text(f'{{"run":"a","tuner":1.0}}\n{line}\n')
    with pytest.raises(LedgerError, match=r"timing\.jsonl, line 2 is damaged"):
        read_clocks(tmp_path)


def test_boards_of_different_configs_stand_apart(tmp_path):
    write(tmp_path / "a", KEYS)
    write(tmp_path / "b", config={"budget": 4})
    assert [standing.whole for standing in survey([tmp_path])] == [True, False]


def test_a_ledger_that_does_not_say_what_was_asked_is_judged_by_what_it_holds(tmp_path):
    write(tmp_path, KEYS[:1], KEYS[1:2], orders=())
    assert list(standing_of(tmp_path).missing) == KEYS[1:2]


@pytest.mark.parametrize(("finished", "code"), [(KEYS, 0), (KEYS[1:], 1)])
def test_the_exit_code_says_whether_all_is_there(tmp_path, monkeypatch, capsys, finished, code):
    monkeypatch.setattr(sys, "argv", ["status", str(write(tmp_path / "board", finished))])
    with pytest.raises(SystemExit) as ended:
        status.script()
    assert ended.value.code == code
    told = " ".join(capsys.readouterr().out.split())
    assert f"{len(finished)} of 4 runs finished" in told
    assert ("missing: ga/3/map-0/0" in told) == bool(code)


def test_a_folder_without_a_ledger_is_named(tmp_path):
    with pytest.raises(LedgerError, match=rf"holds no ledger: no {MANIFEST} beside a {TRIALS}"):
        survey([tmp_path])
