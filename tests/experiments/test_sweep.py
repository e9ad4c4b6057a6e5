"""Sweeps: whatever plays the runs of a board, and in how many parts, the ledger is that of one process."""

import json
import shutil
from dataclasses import fields, replace

import pytest

pytest.importorskip("joblib")
pytest.importorskip("plotly")  # the page
pytest.importorskip("matplotlib")  # the real terrain

from antgym.errors import LedgerError, ParameterError
from antgym.tuning.ledger import MANIFEST, TRIALS, Ledger
from antgym.tuning.traces import read_trace
from experiments import leaderboard
from experiments.artefacts import MADE, prepare
from experiments.orders import ask, asked
from experiments.presets import PRESETS, Preset
from experiments.status import survey, to_lists
from experiments.sweep import Arguments, Sweep, sweep
from experiments.tracks import ALWAYS
from experiments.units import UNITS, Shard, units

AGENTS = ("uniform_random", "random_search")
TINY = Preset(2, 1, 5, 2, 0, 3, 1, 2, 2, 8, 32)
RUNS = 2 * len({*AGENTS, *ALWAYS})
BACKENDS = ("loky", "dask")


@pytest.fixture(scope="module")
def trained(tmp_path_factory):
    """Files of the agents that are on every board, as small as they come, for boards of any preset."""
    folder = tmp_path_factory.mktemp("trained")
    prepare(folder, "mountain-v0", TINY, ALWAYS)
    (folder / MADE).unlink()
    return folder


@pytest.fixture
def arguments(tmp_path, trained):
    """A function that gives the arguments of a sweep into a folder of the given name, with everybody trained."""

    def make(name, **changes):
        out = tmp_path / name
        if not out.exists():
            shutil.copytree(trained, out / "trained")
        return Arguments("smoke", out, AGENTS, **{"budgets": (5,), "jobs": 2, **changes})

    return make


@pytest.fixture
def tiny(monkeypatch, arguments):
    """The same of a tiny board, in threads."""
    monkeypatch.setitem(PRESETS, "smoke", TINY)
    return lambda name, **changes: arguments(name, **{"backend": "threading", "unit": 3, **changes})


def in_one_process(given):
    """The ledger's lines of the leaderboard itself."""
    board = {field.name: getattr(given, field.name) for field in fields(leaderboard.Arguments)}
    leaderboard.run_board(leaderboard.Arguments(**board))
    return sorted_lines(given.out)


def sorted_lines(folder):
    return sorted((folder / TRIALS).read_text().splitlines())


def in_shards(given, count):
    for number in range(1, count + 1):
        sweep(replace(given, shard=f"{number}/{count}"))
    return sweep(replace(given, merge=True))


def test_units_in_threads_and_shards_give_the_ledger_of_one_process(tiny, tmp_path):
    tracks = ("A", "C")
    whole = in_one_process(tiny("whole", track=tracks))
    assert sweep(tiny("threads", track=tracks, traces=True)).endswith("threads/index.html")
    in_shards(tiny("shards", track=tracks, unit=1), 3)
    for name in ("threads", "shards"):
        assert sorted_lines(tmp_path / name) == whole
        assert not (tmp_path / name / UNITS).exists()
        (standing,) = survey([tmp_path / name])
        assert standing.whole
        assert standing.finished == set(standing.asked) == set(asked(tmp_path / "whole"))
        assert not standing.twice
    outcome = next(json.loads(line) for line in whole if '"outcome"' in line and "random_search" in line)
    best = read_trace(tmp_path / "threads", outcome["run"])
    assert len(best) == TINY.fresh
    assert best[:, -1].tolist() == pytest.approx([float(length or "inf") for length in outcome["lengths"]])
    assert (best[:, 1:] <= best[:, :-1]).all()


def test_what_broke_off_is_listed_with_its_reason_and_made_up_for(tiny, tmp_path):
    given = tiny("board", unit=100)
    (tmp_path / "board" / UNITS).write_text("in the way of every unit's folder")
    with pytest.raises(LedgerError, match=rf"{RUNS} of {RUNS} runs are missing.*board lists them"):
        sweep(given)
    (standing,) = survey([tmp_path / "board"])
    assert not standing.whole
    assert len(standing.missing) == RUNS
    assert "broke off: LedgerError: " in to_lists(standing, 1)
    assert to_lists(standing, 1).endswith(f"missing: {RUNS - 1} more; --every lists them\n")
    (tmp_path / "board" / UNITS).unlink()
    sweep(given)
    (standing,) = survey([tmp_path / "board"])
    assert standing.whole


def test_a_unit_that_was_cut_off_goes_on_and_one_taken_in_before_its_end_counts_once(tiny, tmp_path):
    """The killed sweep left a ledger with a unit's first runs, and that unit's folder as if nobody had heard of it."""
    given = tiny("board", unit=4)
    sweep(given)
    whole = (tmp_path / "board" / TRIALS).read_text().splitlines(keepends=True)
    keys = asked(tmp_path / "board")
    (unit, *_) = units(keys, range(len(keys)), 4, set(), tmp_path / "board")
    unit.folder.mkdir(parents=True)
    shutil.copy(tmp_path / "board" / MANIFEST, unit.folder)
    mine = [line for line in whole if json.loads(line)["run"] in keys[:4]]
    (unit.folder / TRIALS).write_text("".join(mine[:-1]) + mine[-1][:9])
    (tmp_path / "board" / TRIALS).write_text("".join(mine[:2]))
    sweep(given)
    assert sorted_lines(tmp_path / "board") == sorted(line.rstrip("\n") for line in whole)


def test_merging_says_what_is_missing_and_counts_once_what_two_shards_hold(tiny, tmp_path):
    given = tiny("board")
    sweep(replace(given, shard="1/2"))
    with pytest.raises(LedgerError, match=f"{RUNS // 2} of {RUNS} runs are missing"):
        sweep(replace(given, merge=True))
    sweep(replace(given, shard="1/1"))  # as if somebody had given all of it again, not the other half
    (standing,) = survey([tmp_path / "board"])
    assert (len(standing.finished), len(standing.twice), standing.whole) == (RUNS, RUNS // 2, True)
    assert sweep(replace(given, merge=True)).startswith("page: ")
    assert sorted_lines(tmp_path / "board") == sorted_lines(tmp_path / "board" / "shards" / "1-of-1")


def test_a_shard_that_is_done_stands_whole_and_its_sweep_lacks_the_others(tiny, tmp_path):
    given = tiny("board")
    sweep(replace(given, shard="1/2"))
    (shard,) = survey([Shard(1, 2).folder(tmp_path / "board")])
    assert (shard.whole, len(shard.asked)) == (True, RUNS // 2)
    (standing,) = survey([tmp_path / "board"])  # where no ledger is
    assert (len(standing.finished), len(standing.missing)) == (RUNS // 2, RUNS // 2)
    assert standing.finished == shard.finished


def test_orders_of_other_settings_are_forgotten_and_those_of_this_sweep_are_not(tiny, tmp_path):
    """Nothing ran under the settings of before; then a shard that was begun with them comes after one that ran."""
    out, given = tmp_path / "board", tiny("board")
    with Ledger(Shard(2, 2).folder(out), {"of": "before"}, {}):
        ask(out, ["old/1/map/0"])
    sweep(replace(given, shard="1/2"))
    known = asked(out)
    assert len(known) == RUNS
    ask(out, ["another/1/map/0"])
    with Sweep(given).ledger(Shard(2, 2).folder(out), known[:1]) as ledger:
        assert ledger.renewed
    assert asked(out) == [*known, "another/1/map/0"]
    assert asked(Shard(2, 2).folder(out)) == known[:1]


@pytest.mark.parametrize("count", [1, 2, 7, 50])
def test_shards_share_every_run_out_once(count):
    keys = [f"agent-{i % 4}/100/map/{i}" for i in range(40)]
    shares = [Shard(i + 1, count).share(keys) for i in range(count)]
    assert sorted(place for share in shares for place in share) == list(range(40))
    assert max(map(len, shares)) - min(map(len, shares)) <= 1


def test_units_are_the_same_whatever_of_them_is_done(tmp_path):
    keys = list("abcdefg")
    before = units(keys, range(7), 3, set(), tmp_path)
    after = units(keys, range(7), 3, {"a", "b", "c", "e"}, tmp_path)
    assert [unit.places for unit in before] == [(0, 1, 2), (3, 4, 5), (6,)]
    assert [unit.places for unit in after] == [(3, 5), (6,)]
    assert [unit.folder for unit in after] == [unit.folder for unit in before[1:]]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"shard": "0/3"}, "--shard 0/3: needs a number from 1"),
        ({"shard": "2"}, "such as 2/8"),
        ({"shard": "1/2", "merge": True}, "give one of them"),
        ({"jobs": 0}, "--jobs 0: needs a whole number"),
        ({"unit": -1}, "--unit -1: needs"),
        ({"scheduler": "tcp://there:8786"}, "add --backend dask"),
        ({"backend": "lokyy"}, "--backend lokyy: "),
    ],
)
def test_options_that_do_not_fit_are_named(tiny, changes, message):
    with pytest.raises(ParameterError, match=message):
        sweep(tiny("board", **changes))


def test_what_cannot_be_played_is_told_before_anything_is_written(tmp_path):
    with pytest.raises(ParameterError, match="did you mean 'random_search'"):
        sweep(Arguments("smoke", tmp_path / "board", ("random_serch",)))
    assert not list(tmp_path.iterdir())
    (tmp_path / "file").write_text("")
    with pytest.raises(LedgerError, match="file cannot hold a sweep: "):
        sweep(Arguments("smoke", tmp_path / "file", AGENTS))


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::Warning:distributed.*", "ignore::ResourceWarning")
def test_processes_a_dask_cluster_and_three_merged_shards_give_the_ledger_of_one_process(arguments, tmp_path):
    pytest.importorskip("distributed")
    whole = in_one_process(arguments("whole"))
    for backend in BACKENDS:
        sweep(arguments(backend, backend=backend, unit=4, shard="1/1"))  # whose pages nobody needs
        assert sorted_lines(Shard(1, 1).folder(tmp_path / backend)) == whole
    in_shards(arguments("shards", backend="threading"), 3)
    assert sorted_lines(tmp_path / "shards") == whole
