"""Boards, their order and ties, and their faces in a terminal and in Markdown."""

from dataclasses import replace
from io import StringIO

import numpy as np
import pytest
from boards import board, fake_board, row
from rich.console import Console

from antgym.errors import AntgymError
from antgym.maps.suites import load_suite
from experiments import contest, steering
from experiments.board import EXACT, SBS, VBS
from experiments.board_table import to_markdown, to_table
from experiments.budgets import budgets_to_markdown, by_budget
from experiments.columns import COLUMNS, percent


def constant(name, gap, maps=4, **changes):
    return row(name, np.full((maps, 2), gap), **changes)


def printed(table, width=200):
    console = Console(width=width, file=StringIO())
    console.print(table)
    return console.file.getvalue()


def test_rows_are_ranked_by_mean_gap_and_references_get_no_place():
    shown = board(constant("b", 0.3), constant("ref", 0.2, kind="reference"), constant("a", 0.1))
    assert [r.name for r in shown.ranked] == ["a", "ref", "b"]
    assert {name: str(place) for name, place in shown.places.items()} == {"a": "1", "b": "2"}


def test_an_agent_that_is_not_told_apart_from_the_one_above_is_marked_as_a_tie():
    noise = np.array([[0.1, 0.1], [-0.1, -0.1]] * 5)
    rows = [constant("a", 0.4, maps=10), row("b", 0.401 + noise), constant("c", 0.9, maps=10)]
    assert [str(place) for place in board(*rows).places.values()] == ["1", "2 ≈", "3"]


def test_ties_are_told_for_all_places_together():
    """A difference that two agents show is none among twelve: somebody may well be so far ahead by chance."""
    noise = np.random.default_rng(0).normal(0, 0.03, (12, 1))
    pair = [constant("a", 0.2, maps=12), row("b", 0.222 + noise - noise.mean())]
    others = [constant(f"c{i}", 0.3, maps=12) for i in range(10)]
    assert not board(*pair).places["b"].tied
    assert board(*pair, *others).places["b"].tied


def test_equal_agents_tie():
    assert board(constant("a", 0.4), constant("b", 0.4)).places["b"].tied


def test_one_map_has_no_interval_and_tells_nobody_apart():
    shown = board(constant("a", 0.1, maps=1), constant("b", 0.9, maps=1))
    assert shown.rows[0].interval is None
    assert shown.rows[0].interquartile_ends is None
    assert shown.places["b"].tied
    assert "[" not in to_markdown(shown).splitlines()[2]


def test_statistics_of_a_row():
    one = row(gaps=[[0.0, 0.1], [0.3, 1.0]])
    assert one.mean == pytest.approx(0.35)
    assert one.interquartile == pytest.approx(0.2)
    assert one.scenario_means == pytest.approx((0.05, 0.65))
    assert one.interval[0] < one.mean < one.interval[1]
    assert one.interquartile_ends[0] < one.interquartile < one.interquartile_ends[1]


def test_total_is_training_plus_deployment_on_every_map():
    total = {column.heading: column for column in COLUMNS}["trials in total"]
    one = constant("a", 0.1, deploy=2.5, training=100)
    assert total.value(one, board(one)) == 110


def test_every_row_is_in_table_and_markdown():
    shown = fake_board()
    table, markdown = printed(to_table(shown)), to_markdown(shown)
    for one in shown.rows:
        assert one.name in table
        assert one.name in markdown
        assert percent(one.mean) in table
        assert percent(one.mean) in markdown
    assert "12 maps × 3 tuner seeds" in table
    assert "Without #: references." in " ".join(table.split())
    assert "12 maps × 3 tuner seeds" in markdown


def test_table_fits_eighty_columns_without_losing_one():
    lines = printed(to_table(fake_board()), width=80).splitlines()
    assert any("optimism" in line for line in lines)
    assert not any("…" in line for line in lines)


def test_rows_are_measured_by_the_best_static_setting_and_the_virtual_best():
    bounds = constant(SBS, 0.4, kind="reference"), constant(VBS, 0.2, kind="reference", training=None)
    shown = board(constant("half", 0.3), constant("worse", 0.5), *bounds)
    assert {name: round(found.mean, 9) for name, found in shown.closed.items()} == {
        **{"half": 0.5, "worse": -0.5, SBS: 0.0, VBS: 1.0}
    }
    assert {name: found.mean for name, found in shown.better.items()} == {"half": 1, "worse": 0, VBS: 1}
    lines = {line.split(" | ")[1]: line for line in to_markdown(shown).splitlines() if line.count("|") > 9}
    assert "| 50 [50–50] | 100 [100–100] |" in lines["half"]
    assert "| −50 [−50 to −50] | 0 [0–0] |" in lines["worse"]
    assert "| 0 | – | 0.00 |" in lines[f"*{VBS}*"]


@pytest.mark.parametrize("gaps", [{SBS: 0.2, VBS: 0.2}, {SBS: 0.2}, {VBS: 0.1}])
def test_nothing_is_closed_where_the_two_are_not_apart(gaps):
    shown = board(constant("a", 0.3), *(constant(name, gap, kind="reference") for name, gap in gaps.items()))
    assert shown.closed == {}
    assert bool(shown.better) == (SBS in gaps)


def test_a_track_at_a_glance_by_eye():
    one = constant("a", 0.3), constant("b", 0.2)
    many = constant("a", 0.1), constant("b", 0.2), constant(EXACT, 0.0, kind="reference")
    boards = [board(*one, budget=1), board(*many, budget=100)]
    assert budgets_to_markdown(boards).splitlines() == [
        "| mean gap % at | 1 | 100 |",
        "| :-- | --: | --: |",
        "| *exact planner* | – | 0.0 [0.0–0.0] |",
        "| a | 30.0 [30.0–30.0] | 10.0 [10.0–10.0] |",
        "| b | 20.0 [20.0–20.0] | 20.0 [20.0–20.0] |",
    ]
    assert "30.0 [30.0–30.0]" in printed(by_budget(boards))


def test_markdown_by_eye():
    shown = board(constant("a", 0.1, deploy=3), constant(EXACT, 0.0, kind="reference"))
    assert to_markdown(shown).splitlines()[:4] == [
        "| # | agent | mean gap % | IQM % | success % | closed % | P(better) % | trials per map | trials in total "
        "| tuner s | planner s | optimism |",
        f"| --: | :-- |{' --: |' * 10}",
        "|  | *exact planner* | 0.0 [0.0–0.0] | 0.0 [0.0–0.0] | 100 | – | – | 0 | 0 | 0.00 | 0.00 | – |",
        "| 1 | a | 10.0 [10.0–10.0] | 10.0 [10.0–10.0] | 100 | – | – | 3 | 12 | 0.00 | 0.00 | – |",
    ]


def test_names_cannot_break_out_of_a_cell():
    shown = board(constant("a|b\n[bold]<i>*", 0.1))
    assert r"| a\|b \[bold\]\<i\>\* |" in to_markdown(shown)
    assert "[bold]" in printed(to_table(shown))


def test_optimism_has_a_sign():
    shown = board(constant("a", 0.3, optimism=0.021), constant("b", 0.5, optimism=-0.013))
    assert "+2.1 |" in to_markdown(shown)
    assert "−1.3 |" in to_markdown(shown)


@pytest.mark.parametrize(
    ("gaps", "words"),
    [
        ([], "maps × seeds"),
        ([[]], "maps × seeds"),
        ([[0.1], [0.1, 0.2]], "equally many"),
        ([[0.1], [-0.2]], "scenario 1"),
        ([[np.nan]], "bug"),
    ],
)
def test_impossible_gaps_are_refused(gaps, words):
    with pytest.raises(AntgymError, match=words):
        row(gaps=gaps)


def test_boards_that_do_not_fit_together_are_refused():
    with pytest.raises(AntgymError, match="names of their own"):
        board(constant("a", 0.1), constant("a", 0.2))
    with pytest.raises(AntgymError, match="b has gaps on 3 of 4 scenarios"):
        board(constant("a", 0.1), constant("b", 0.1, maps=3))


@pytest.mark.parametrize("track", ["A", "B", "C"])
def test_a_board_finds_its_runs_in_the_ledger_under_the_keys_they_were_played_with(track):
    item = load_suite("mountain-v0", "test")[3]
    if track == "C":
        job = steering.Job(steering.Entrant("ga", None, 0), item, 2)
    else:
        job = contest.Job(contest.Entrant("ga", "agent", "", None, 0), item, 2, 20)
    assert board(row(), track=track, budget=20).key("ga", item.name, 2) == job.key


def test_pictures_that_do_not_fit_their_world_are_refused():
    (picture,) = fake_board().pictures
    with pytest.raises(AntgymError, match=r"heights \(2, 2\)"):
        replace(picture, heights=np.zeros((2, 2)))
    with pytest.raises(AntgymError, match="path of exact planner"):
        replace(picture, lengths={})
    with pytest.raises(AntgymError, match="nx, ny, nz"):
        replace(picture, free=np.ones((2, 2)))
