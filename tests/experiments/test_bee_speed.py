"""How fast the bees are: the table, its reasons, and the ratio that must not be lost."""

import sys

import pytest

from antgym.errors import ParameterError
from experiments import bee_speed


def test_a_peer_that_is_absent_says_how_to_get_it(monkeypatch, capsys):
    for package in ("mealpy", "beecolpy"):
        monkeypatch.setitem(sys.modules, package, None)
    monkeypatch.setattr(bee_speed, "CYCLES", 3)
    monkeypatch.setattr(bee_speed, "plain_port", lambda scenario: lambda seed: 1)  # compiles for seconds
    rows = bee_speed.run(bee_speed.Arguments(repeats=1))
    skipped = {row["code"]: row["skipped"] for row in rows if row["skipped"]}
    assert set(skipped) == {"mealpy", "beecolpy"}
    assert 'pip install "antgym[bench]"' in capsys.readouterr().out
    measured = [row for row in rows if row["skipped"] is None]
    assert [row["code"] for row in measured] == ["antgym, abc_standard", "antgym, wu2018", "plain numba port"]
    assert all(row["ns_per_path"] > 0 for row in measured)


def test_no_turns_are_refused():
    with pytest.raises(ParameterError, match="repeats = 0"):
        bee_speed.run(bee_speed.Arguments(repeats=0))


@pytest.mark.slow
def test_bees_are_three_times_as_fast_as_the_plain_port():
    rows = {row["code"]: row for row in bee_speed.measure(repeats=7, peers=False)}
    assert rows["plain numba port"]["ratio"] > 3
