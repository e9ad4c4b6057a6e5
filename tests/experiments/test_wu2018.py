"""The table of wu2018: whole and the same again, and verdicts that follow from the numbers."""

import json

import numpy as np
import pytest

pytest.importorskip("matplotlib")

from antgym.errors import ParameterError
from experiments.tables import wu2018
from experiments.tables.wu2018 import hives, report
from experiments.tables.wu2018.hives import Outcome


def outcome(value):
    return Outcome(*(np.full((4, 3), value) + np.arange(4)[:, None] / 100 for _ in Outcome._fields))


def test_it_writes_its_table_its_numbers_and_its_figure_the_same_each_time(tmp_path, monkeypatch):
    monkeypatch.setattr(hives, "CYCLES", 30)
    monkeypatch.setattr(hives, "SEEDS", 2)
    paths = [wu2018.replay(wu2018.Arguments(tmp_path / name, share=0.02)) for name in "ab"]
    assert paths[0].read_text() == paths[1].read_text()
    numbers = json.loads(paths[0].with_suffix(".json").read_text())
    entered = hives.hives(40.0)
    assert list(numbers["hives"]) == [hive.label for hive in entered]
    assert np.shape(numbers["hives"]["wu2018"]["length"]) == (2, 2)
    assert all(f"| {hive.label} |" in paths[0].read_text() for hive in entered)
    assert paths[0].with_suffix(".png").stat().st_size > 10_000


@pytest.mark.parametrize(("ours", "holds"), [(0.4, True), (0.5, False), (0.6, False)])
def test_a_claim_holds_where_the_whole_interval_is_below_nothing(ours, holds):
    outcomes = {"wu2018": outcome(ours), "wu2018-basic": outcome(0.5)}
    claims = [report._judge(measure, outcomes, report.PAIRS[0]) for measure in report.MEASURES]
    assert [claim.holds for claim in claims] == [holds] * 3
    assert "in print 400 against 600" in claims[0].figures


@pytest.mark.parametrize(
    ("best", "cycles"),
    [
        ([9, 5, 5, 5], 2),
        ([5, 5, 5, 5], 1),
        ([np.inf, 9, 5.01, 5], 3),
        ([np.inf] * 4, 4),
        ([5, 9, 5, 5], 3),
    ],
)
def test_a_path_is_steady_once_it_stays_within_one_per_cent_of_the_last(best, cycles):
    assert hives._steady(np.array(best, dtype=float)) == cycles


def test_published_settings_are_those_in_print():
    found = {hive.label: hive.parameters for hive in hives.hives(40.0)}
    assert found["wu2018"] == pytest.approx((40, 0.7, 0.2, 1.0))
    assert found["wu2018-basic"][:3] == pytest.approx((40, 1.0, 1.0))


@pytest.mark.parametrize("share", [0.0, 1.5])
def test_a_share_beyond_all_worlds_is_refused(share):
    with pytest.raises(ParameterError, match=f"share = {share}"):
        wu2018.replay(wu2018.Arguments(share=share))
