"""Ledgers of parts: one takes in what others hold, once; older schemas are read and gone on with; damage is said."""

import json
import logging

import pytest
from full_disk import most_bytes

from antgym.errors import LedgerError
from antgym.tuning.ledger import MANIFEST, TIMING, TRIALS, Ledger, Outcome, read_runs
from antgym.tuning.session import Record, Trial

CONFIG, VERSIONS = {"budget": 3}, {"antgym": "1"}
OUTCOME = Outcome((0.1, 1 / 3), (130.5, float("inf")), (0.25, 1.0))
SEED = 2**64 - 1  # no double is this number

SCHEMA_1 = """\
{"run":"ga/3/valley/0","kind":"trial","index":0,"unit":[0.1,0.25],"cost":1.5,"work":77,"length":123.4,"seed":18446744073709551615}
{"run":"ga/3/valley/0","kind":"trial","index":1,"unit":[0.1,0.5],"cost":10.0,"work":9,"length":null,"seed":5}
{"run":"ga/3/valley/0","kind":"outcome","unit":[0.1,0.25],"lengths":[130.5,null],"gaps":[0.25,1.0]}
{"run":"ga/3/valley/1","kind":"trial","index":0,"unit":[0.7,0.25],"cost":1.5,"work":77,"length":123.4,"seed":7}
"""
"""What antgym wrote before schema 2."""


def record(index, length=123.4):
    return Record(Trial(index, (0.1, 1 / 3), 1.5, 77), length, SEED - index)


def opened(folder, config=CONFIG, facts=None):
    return Ledger(folder, config, VERSIONS, facts)


def lines(folder, file=TRIALS):
    return (folder / file).read_text().splitlines()


def write_part(folder, key="a/3/valley/0", trials=3, finished=True, facts=None):
    with opened(folder, facts=facts) as ledger:
        run = ledger.run(key)
        run.append([record(i) for i in range(trials)])
        if finished:
            run.finish(OUTCOME)
            run.time(tuner=1.0)
    return folder


@pytest.fixture
def old(tmp_path):
    """A folder of schema 1."""
    (tmp_path / TRIALS).write_text(SCHEMA_1)
    (tmp_path / MANIFEST).write_text(json.dumps({"schema": 1, "config": CONFIG, "versions": VERSIONS}))
    return tmp_path


def test_seeds_are_kept_to_the_bit_by_readers_that_round_numbers(tmp_path):
    write_part(tmp_path, trials=1)
    assert json.loads(lines(tmp_path)[0], parse_int=float)["seed"] == "0xffffffffffffffff"
    assert read_runs(tmp_path)["a/3/valley/0"].records == [record(0)]


def test_trials_without_a_manifest_are_nobodys(tmp_path):
    """Any config could take them for its own."""
    write_part(tmp_path)
    (tmp_path / MANIFEST).unlink()
    with pytest.raises(LedgerError, match=r"holds trials\.jsonl without the manifest\.json"):
        opened(tmp_path, {"budget": 100})
    (tmp_path / TRIALS).write_text("")  # as where a crash came before the manifest
    with opened(tmp_path, {"budget": 100}) as ledger:
        assert not list(ledger.runs())


def test_a_ledger_of_schema_1_is_read(old):
    runs = read_runs(old)
    first, second = runs["ga/3/valley/0"], runs["ga/3/valley/1"]
    assert [r.seed for r in first.records] == [SEED, 5]
    assert first.records[1].length == float("inf")
    assert first.outcome == Outcome((0.1, 0.25), (130.5, float("inf")), (0.25, 1.0))
    assert (len(second.records), second.outcome) == (1, None)


def test_a_ledger_of_schema_1_goes_on_in_schema_1(old):
    with opened(old) as ledger:
        ledger.run("ga/3/valley/1").append([record(1)])
    assert lines(old)[:-1] == SCHEMA_1.splitlines()
    assert json.loads(lines(old)[-1])["seed"] == SEED - 1
    assert json.loads((old / MANIFEST).read_text())["schema"] == 1


def test_parts_merged_in_any_order_and_twice_are_the_whole(tmp_path):
    whole = write_part(write_part(tmp_path / "whole"), "b/3/valley/0")
    parts = [write_part(tmp_path / key[0], key) for key in ("b/3/valley/0", "a/3/valley/0")]
    with opened(tmp_path / "merged") as ledger:
        for part in parts * 2:
            ledger.absorb(part)
    for file in (TRIALS, TIMING):
        assert sorted(lines(tmp_path / "merged", file)) == sorted(lines(whole, file))


def test_a_part_that_goes_on_is_taken_in_again(tmp_path):
    part = write_part(tmp_path / "part", trials=2, finished=False)
    with opened(tmp_path / "merged") as ledger:
        ledger.absorb(part)
        assert len(ledger.run("a/3/valley/0").records) == 2
        with opened(part) as more:
            more.run("a/3/valley/0").append([record(2)])
            more.run("a/3/valley/0").finish(OUTCOME)
            ledger.absorb(part)  # while it is open
        assert ledger.run("a/3/valley/0").outcome == OUTCOME
    assert lines(tmp_path / "merged") == lines(part)


@pytest.mark.parametrize(
    ("ours", "theirs"),
    [
        ({"trials": 3}, {"trials": 2}),  # both finished
        ({"trials": 2}, {"trials": 3}),
        ({"trials": 3, "finished": False}, {"trials": 2}),
    ],
)
def test_parts_that_tell_of_a_run_differently_are_refused_and_nothing_is_taken(tmp_path, ours, theirs):
    part = write_part(write_part(tmp_path / "part", **theirs), "b/3/valley/0")
    write_part(tmp_path / "merged", **ours)
    before = lines(tmp_path / "merged")
    with (
        opened(tmp_path / "merged") as ledger,
        pytest.raises(
            LedgerError,
            match=rf"'a/3/valley/0' is another one in .*merged than in {part};",
        ),
    ):
        ledger.absorb(part)
    assert lines(tmp_path / "merged") == before


def test_a_part_of_another_config_or_another_trained_agent_is_refused(tmp_path):
    with opened(tmp_path / "other", {"budget": 4}):
        pass
    with opened(tmp_path / "part") as part:
        part.pin({"graph.json": "bb"})
    with opened(tmp_path / "merged") as ledger:
        with pytest.raises(LedgerError, match=r"other settings .budget: 4, now 3.*cannot be part of"):
            ledger.absorb(tmp_path / "other")
        ledger.pin({"graph.json": "aa"})
        with pytest.raises(LedgerError, match=r"graph\.json is not the file"):
            ledger.absorb(tmp_path / "part")
    with opened(tmp_path / "merged") as ledger, pytest.raises(LedgerError, match="is no ledger"):
        ledger.absorb(tmp_path / "nowhere")


def test_the_manifest_tells_of_every_machine_once(tmp_path):
    parts = [
        write_part(tmp_path / n, n, facts={"cpu": cpu}) for n, cpu in (("1", "x"), ("2", "y"), ("3", "y"))
    ]
    with opened(tmp_path / "merged", facts={"cpu": "z"}) as ledger:
        for part in parts:
            ledger.absorb(part)
        assert ledger.manifest["cpu"] == "z"
        assert ledger.manifest["parts"] == [{"versions": VERSIONS, "cpu": cpu} for cpu in "xy"]


def test_what_is_held_is_written_when_the_outermost_block_ends(tmp_path):
    with opened(tmp_path) as ledger:
        one, other = ledger.run("a"), ledger.run("b")
        with one.hold():
            with other.hold():
                one.append([record(0)])
                other.append([record(0)])
            assert lines(tmp_path) == []
            other.finish(OUTCOME)
            other.time(tuner=1.0)
        assert [json.loads(line)["run"] for line in lines(tmp_path)] == ["a", "b", "b"]
        assert (one.records, other.outcome, lines(tmp_path, TIMING)) == (
            [record(0)],
            OUTCOME,
            ['{"run":"b","tuner":1.0}'],
        )


def paid_and_timed(run):
    with run.hold():
        run.append([record(0)])
        run.time(tuner=1.0)


def test_a_disk_too_full_for_seconds_loses_no_trial(tmp_path):
    with opened(tmp_path) as ledger:
        run = ledger.run("a")
        for _ in range(50):
            run.time(tuner=1.0)
        before = (tmp_path / TIMING).stat().st_size
        with most_bytes(before), pytest.raises(LedgerError, match="the trials of this batch are kept"):
            paid_and_timed(run)
        assert (run.records, (tmp_path / TIMING).stat().st_size) == ([record(0)], before)
    assert read_runs(tmp_path)["a"].records == [record(0)]


def interrupted(run):
    with run.hold():
        run.append([record(0), record(1)])
        raise KeyboardInterrupt


def test_a_block_that_raises_leaves_nothing_and_the_next_one_goes_on(tmp_path):
    with opened(tmp_path) as ledger:
        run = ledger.run("a")
        with pytest.raises(KeyboardInterrupt):
            interrupted(run)
        assert (run.records, lines(tmp_path)) == ([], [])
        run.append([record(0)])
    assert read_runs(tmp_path)["a"].records == [record(0)]


def test_a_line_that_is_dropped_is_said(tmp_path, caplog):
    write_part(tmp_path)
    with (tmp_path / TRIALS).open("a") as file:
        file.write('{"run":"a/3')
    with caplog.at_level(logging.WARNING):
        read_runs(tmp_path)
        assert caplog.messages == [
            f"{tmp_path / TRIALS}: a last line of 11 bytes is not whole; it is left out"
        ]
        caplog.clear()
        with opened(tmp_path):
            pass
        with opened(tmp_path):
            pass
    assert caplog.messages == [
        f"{tmp_path / TRIALS}: a last line of 11 bytes was cut short by a crash; it is dropped"
    ]


@pytest.mark.parametrize("again", [0, -1])
def test_a_run_that_goes_on_after_its_end_is_damage(tmp_path, again):
    """Two writers past the lock, as on file systems without one, would count a run twice."""
    write_part(tmp_path)
    (tmp_path / TRIALS).write_text("\n".join([*lines(tmp_path), lines(tmp_path)[again]]) + "\n")
    with pytest.raises(LedgerError, match=r"line 5 is damaged .*after the one that ends it"):
        opened(tmp_path)


def test_pandas_reads_a_ledger_in_one_line(tmp_path):
    pandas = pytest.importorskip("pandas")
    write_part(tmp_path)
    table = pandas.read_json(tmp_path / TRIALS, lines=True, precise_float=True)
    trials = table[table.kind == "trial"]
    assert [int(seed, 16) for seed in trials.seed] == [SEED, SEED - 1, SEED - 2]
    assert trials.unit.tolist() == [[0.1, 1 / 3]] * 3
    assert trials.groupby("run").cost.mean().tolist() == [1.5]
