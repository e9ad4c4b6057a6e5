"""Tables of power from ledgers, from files and from deviations; what they cannot be made of is said."""

import json

import numpy as np
import pytest
from gaps import drawn

from antgym.errors import AntgymError
from antgym.tuning.ledger import Ledger, Outcome
from experiments.power import Arguments, read_gaps, read_ledger, report
from experiments.statistics.replication import Components, maps_needed

GAPS = {"good": 0.1 * drawn(6, 2, 1), "bad": 0.2 * drawn(6, 2, 2), "worst": 0.4 * drawn(6, 2, 3)}


def write_ledger(folder, gaps, budget="20/", missing=(), maps="suite-v0/test/"):
    """A ledger of runs that ended with these gaps; a run is judged by two fresh ones."""
    with Ledger(folder, {"agents": list(gaps)}, {}) as ledger:
        for name, values in gaps.items():
            for (m, s), gap in np.ndenumerate(values):
                key = f"{name}/{budget}{maps}{m}/{s}"
                if key not in missing:
                    ledger.run(key).finish(Outcome((0.5,), (1.0, 1.0), (gap - 0.01, gap + 0.01)))
    return folder


def cells(line):
    return [cell.strip() for cell in line.strip("|").split("|")]


def test_a_ledger_says_what_its_agents_reached(tmp_path):
    measured = read_ledger(write_ledger(tmp_path, GAPS), None)
    assert (measured.budget, list(measured.gaps)) == (20, ["good", "bad", "worst"])
    for name, values in GAPS.items():
        assert measured.gaps[name] == pytest.approx(values)


def test_the_largest_budget_is_taken_or_the_one_that_is_asked_for(tmp_path):
    write_ledger(tmp_path, GAPS, "1/")
    write_ledger(tmp_path, {name: GAPS["good"] for name in GAPS}, "20/")
    assert read_ledger(tmp_path, None).gaps["bad"] == pytest.approx(GAPS["good"])
    assert read_ledger(tmp_path, 1).gaps["bad"] == pytest.approx(GAPS["bad"])
    with pytest.raises(AntgymError, match=r"--budget 5 was not measured in .*; there are 1, 20"):
        read_ledger(tmp_path, 5)


def test_a_race_of_controllers_has_no_budget_and_an_agents_file_may_lie_in_a_folder(tmp_path):
    assert list(read_ledger(write_ledger(tmp_path / "a", GAPS, budget=""), None).gaps) == list(GAPS)
    stranger = {"my/agent.py:Mine": GAPS["good"]}
    assert list(read_ledger(write_ledger(tmp_path / "b", stranger), None).gaps) == list(stranger)


@pytest.mark.parametrize("budget", ["20/", ""])
def test_agents_and_maps_may_lie_in_folders_and_maps_begin_with_a_digit(tmp_path, budget):
    gaps = {"my/agent.py:Mine": GAPS["good"], "/home/me/agent.py:Mine": GAPS["bad"], "ga": GAPS["worst"]}
    measured = read_ledger(write_ledger(tmp_path, gaps, budget, maps="32room_000.map.scen:"), None)
    assert measured.budget == (20 if budget else None)
    for name, values in gaps.items():
        assert measured.gaps[name] == pytest.approx(values)


def test_an_agent_without_all_of_its_runs_is_left_out_and_named(tmp_path):
    write_ledger(tmp_path, GAPS, missing=["bad/20/suite-v0/test/3/1"])
    text = report(Arguments(ledger=tmp_path))
    assert "`worst` − `good`" in text
    assert text.strip().endswith("Left out, since runs are missing: bad.")


def test_neighbours_are_compared_or_all_with_one(tmp_path):
    path = tmp_path / "gaps.json"
    path.write_text(json.dumps({name: values.tolist() for name, values in GAPS.items()}))
    lines = report(Arguments(gaps=path)).splitlines()
    assert [cells(line)[0] for line in lines[4:7]] == ["`bad` − `good`", "`worst` − `bad`", "*median*"]
    lines = report(Arguments(gaps=path, against="bad", out=tmp_path / "power.md")).splitlines()
    assert [cells(line)[0] for line in lines[4:6]] == ["`bad` − `good`", "`worst` − `bad`"]
    assert (tmp_path / "power.md").read_text().splitlines() == lines


def test_one_seed_a_map_says_nothing_of_more_and_equal_agents_nothing_at_all(tmp_path):
    path = tmp_path / "gaps.json"
    ones = {name: values[:, :1].tolist() for name, values in GAPS.items()}
    path.write_text(
        json.dumps({"a/5": ones["good"], "b/5": ones["good"], "c/5": ones["bad"], "c/1": ones["worst"]})
    )
    text = report(Arguments(gaps=path, points=(2.0,)))
    assert "measured on 6 maps × 1 seed, 5 trials a map" in text
    assert cells(text.splitlines()[2])[-1] == "maps for 2 points: 1 seed"
    assert cells(text.splitlines()[4])[-3:] == ["–", "–", "–"]
    assert "With one seed a map" in text
    assert "both agents are the same in every run" in text


def test_no_difference_is_above_the_scale_of_gaps(tmp_path):
    path = tmp_path / "gaps.json"
    path.write_text(json.dumps({"a": [[0, 1], [1, 0], [0, 1]], "b": [[1, 0], [0, 1], [1, 0.1]]}))
    assert "| > 100 |" in report(Arguments(gaps=path))


def test_deviations_are_enough():
    text = report(Arguments(components=(3.0, 5.0), points=(1.0,), seeds=(1, 10)))
    needed = [maps_needed(Components(0, 0.03**2, 0.05**2), 0.01, seeds) for seeds in (1, 10)]
    assert cells(text.splitlines()[-1]) == [f"{needed[0]} / {needed[1]}"]


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("[1]", "is no JSON object of"),
        ("{", "is no JSON object of"),
        ('{"a": [[NaN], [0]], "b": [[0], [0]]}', r", a: the value at \(0, 0\) is nan"),
        ('{"a": [[0], [0]]}', "two agents with all of their runs are needed, got a"),
        ('{"a": [[0], [0]], "b": [[0]]}', r"same maps, two or more, .* got \(1, 1\) and \(2, 1\)"),
        ("{}", "holds no finished run"),
    ],
)
def test_gaps_that_cannot_be_used_are_named(tmp_path, content, words):
    path = tmp_path / "gaps.json"
    path.write_text(content)
    with pytest.raises(AntgymError, match=words):
        report(Arguments(gaps=path))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (Arguments(), "give one of"),
        (Arguments(components=(1, 1), points=()), "--points are above 0"),
        (Arguments(components=(1, 1), seeds=(0,)), "--seeds 1 or more"),
        (Arguments(components=(1, -1)), "two standard deviations in points, got 1, -1"),
    ],
)
def test_arguments_that_cannot_be_used_are_named(arguments, words):
    with pytest.raises(AntgymError, match=words):
        report(arguments)


def test_a_folder_without_a_contest_is_named(tmp_path):
    with pytest.raises(AntgymError, match=str(tmp_path)):
        read_ledger(tmp_path, None)
    with Ledger(tmp_path, {}, {}) as ledger:
        ledger.run("tune").finish(Outcome((0.5,), (1.0,), (0.1,)))
    with pytest.raises(AntgymError, match="run 'tune' is none of a contest"):
        read_ledger(tmp_path, None)


def test_an_agent_that_nobody_measured_is_named(tmp_path):
    with pytest.raises(AntgymError, match="--against nobody was not measured; there are good, bad, worst"):
        report(Arguments(ledger=write_ledger(tmp_path, GAPS), against="nobody"))


def test_budgets_stand_in_order_and_runs_without_one_last(tmp_path):
    for budget in ("20/", "", "5/"):
        write_ledger(tmp_path, GAPS, budget)
    known = "there are 5, 20, runs without one, of track C"
    with pytest.raises(AntgymError, match=f"--budget 7 was not measured in .*; {known}"):
        read_ledger(tmp_path, 7)


@pytest.mark.parametrize(
    ("budget", "said"), [("0/", "0 trials a map, track B\n"), ("5/", "track A or B"), ("", "track C")]
)
def test_the_title_says_in_which_track(tmp_path, budget, said):
    assert said in report(Arguments(write_ledger(tmp_path, GAPS, budget)))


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(AntgymError, match=r"nothing\.json"):
        read_gaps(tmp_path / "nothing.json", None)
