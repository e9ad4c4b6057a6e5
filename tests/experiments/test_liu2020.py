"""liu2020 replayed: draws that stay, verdicts that follow from the numbers, a replay that is stopped and goes on."""

import json

import numpy as np
import pytest

pytest.importorskip("matplotlib")
pytest.importorskip("pymoo")

from agents.static import StaticSetting
from antgym.errors import LedgerError, ParameterError
from antgym.planners.parameters import ColonyParameters
from experiments.tables import liu2020
from experiments.tables.liu2020 import archive, draw, report
from experiments.tables.liu2020.draw import Answer, Draw, six_maps
from experiments.tables.liu2020.findings import find, worse_than_copy
from experiments.tables.liu2020.methods import COPY, METHODS, RANDOM, RUNS, TRANSFER
from experiments.tables.liu2020.report import to_text

OTHERS = [method.label for method in METHODS if method not in (TRANSFER, COPY)]
FIRST_SIX = [
    *("2e9979ddff3fb1e3", "4dd9b7ef97f92ee1", "c271b9ea14dc1d75"),
    *("6c987b66fe4736ca", "76ff5290071c6e32", "5f775307b51e6732"),
]


def drawn(number, gaps, seconds=None):
    """A draw whose methods arrive at these gaps, {label: gap}, 0.3 where none is given, in 1 s or as given."""
    answers = [
        Answer(
            m.label,
            (1.0, 8.0, 0.4, 100.0),
            m.trials,
            0,
            (seconds or {}).get(m.label, 0.01 if m is TRANSFER else 1.0),
            (400.0,) * RUNS,
            (gaps.get(m.label, 0.3),) * RUNS,
            (),
            (None,) * draw.ITERATIONS,
            (),
        )
        for m in METHODS
    ]
    table = ((0.0,) * 5,) * 5
    return Draw(number, ("",) * 6, 390.0, table, (0.0,) * 5, 1_000, 0.5, "a machine", tuple(answers))


def ahead(margins, **changes):
    """Draws on which every method of the paper is behind transfer by these margins of gap."""
    return [
        drawn(i, {TRANSFER.label: 0.2, **{label: 0.2 + margin for label in OTHERS}}, **changes)
        for i, margin in enumerate(margins, start=1)
    ]


def test_the_first_six_maps_stay_and_every_draw_has_six_of_its_own():
    first, second = ([scenario.digest[:16] for scenario in six_maps(number)] for number in (1, 2))
    assert first == FIRST_SIX
    assert len({*first, *second}) == 12
    assert second[0] == "eaae8f6a6e003f36"  # map 7


@pytest.mark.parametrize(
    ("margins", "verdict"),
    [
        ([0.1, 0.1, 0.2, 0.1, 0.1], "reproduced"),
        ([0.3, -0.1, 0.2, -0.1, 0.1], "direction only"),
        ([-0.1, 0.1, -0.1, -0.1, 0.1], "not reproduced"),
        ([-0.1, -0.1, -0.2, -0.1, -0.1], "not reproduced"),
    ],
)
def test_the_verdict_follows_from_paired_intervals(margins, verdict):
    draws = ahead(margins)
    findings = find(draws)
    assert findings.verdict == verdict
    assert f"**Verdict: {verdict}.**" in to_text(draws, findings, liu2020.Arguments())


def test_one_rival_that_is_shorter_refutes_the_paper():
    draws = [drawn(i, {TRANSFER.label: 0.2, RANDOM.label: 0.1}) for i in range(1, 6)]
    findings = find(draws)
    assert [str(claim) for claim in findings.claims if "is refuted" in str(claim)] == [
        "Transfer's path is shorter than that of one random set: **is refuted**. The other's gap is "
        "-10.0 [-10.0, -10.0] points from transfer's."
    ]
    assert findings.verdict == "not reproduced"


def test_a_shorter_path_in_half_the_time_is_no_small_part():
    findings = find(ahead([0.1] * 4, seconds={TRANSFER.label: 0.5}))
    assert [claim.holds for claim in findings.claims] == [True] * 4 + [False] * 3
    assert "50.0 [50.0, 50.0] % of it (the paper: 0.5), 100.0" in findings.claims[4].figures


def test_what_differs_between_draws_is_paired_away():
    """Targets are far more different than methods are; an unpaired interval would contain 0."""
    hard = np.linspace(0.1, 0.8, 6)
    draws = [
        drawn(i, {TRANSFER.label: gap, **{label: gap + 0.02 for label in OTHERS}})
        for i, gap in enumerate(hard, start=1)
    ]
    assert find(draws).verdict == "reproduced"


def test_rows_are_sorted_and_negative_transfer_is_counted_by_draw():
    draws = [drawn(i, {TRANSFER.label: gap, COPY.label: 0.25}) for i, gap in enumerate((0.2, 0.3, 0.4), 1)]
    findings = find(draws)
    assert findings.standings[0].method is COPY
    assert findings.standings[0].difference.mean == pytest.approx(-0.05)
    assert worse_than_copy(TRANSFER, draws) == 2
    assert "transfer (14) as printed 2 of 3, 67 %" in to_text(draws, findings, liu2020.Arguments())


def test_one_draw_has_no_fourth_table_and_no_verdict():
    text = to_text([drawn(1, {})], None, liu2020.Arguments(draws=1))
    assert "**Verdict: none.** 1 draw says nothing" in text
    assert "Table 3" in text
    assert "Table 4" not in text


@pytest.fixture
def replay(monkeypatch, tmp_path):
    """A function that replays in ``tmp_path``, shows nothing and returns what the JSON file would hold."""
    monkeypatch.setattr(report, "to_figure", lambda draws, findings: None)
    monkeypatch.setattr(report, "publish", lambda folder, paper, text, numbers, figure: numbers)
    (tmp_path / "trained").mkdir()
    names = ColonyParameters._fields
    StaticSetting((0.6, 0.2, 0.6, 0.6), 7, names).save(tmp_path / "trained" / "static.json")

    def run(**changes):
        return report.replay(liu2020.Arguments(tmp_path, **{"draws": 2, "share": 0.002, **changes}))

    return run


@pytest.fixture
def played(monkeypatch):
    """Numbers of the draws that were played, all at once, to made-up answers."""
    numbers = []

    def play(number, *_):
        numbers.append(number)
        return drawn(number, {})

    monkeypatch.setattr(report, "play", play)
    return numbers


def timeless(values):
    """What does not depend on the machine."""
    if isinstance(values, dict):
        dropped = ("machine", "claims", "verdict", "ratio")
        return {k: timeless(v) for k, v in values.items() if k not in dropped and "seconds" not in k}
    return [timeless(value) for value in values] if isinstance(values, list | tuple) else values


def test_a_draw_that_is_played_again_comes_to_the_same_but_for_seconds(replay, monkeypatch, tmp_path):
    for name, value in (("SIDE", 8), ("ANTS", 2), ("RUNS", 2)):
        monkeypatch.setattr(draw, name, value)
    numbers, files = replay(), [tmp_path / "liu2020" / f"draw-0{i}.json" for i in (1, 2)]
    before = [file.read_text() for file in files]
    files[1].unlink()  # killed before it was finished
    again = replay()
    after = [file.read_text() for file in files]
    assert before[0] == after[0]
    assert timeless(json.loads(before[1])) == timeless(json.loads(after[1]))
    assert timeless(numbers) == timeless(again)
    random = [next(a for a in d["answers"] if a["method"] == RANDOM.label) for d in numbers["draws"]]
    assert random[0]["values"][:3] != random[1]["values"][:3]


def test_a_stopped_replay_keeps_what_is_finished_and_goes_on_from_there(
    replay, played, monkeypatch, tmp_path
):
    play = report.play

    def stop(number, *rest):
        if number == 2:
            raise KeyboardInterrupt
        return play(number, *rest)

    monkeypatch.setattr(report, "play", stop)
    with pytest.raises(KeyboardInterrupt):
        replay(draws=3)
    assert [path.name for path in (tmp_path / "liu2020").iterdir()] == ["draw-01.json"]
    monkeypatch.setattr(report, "play", play)
    assert [each["number"] for each in replay(draws=3)["draws"]] == [1, 2, 3]
    assert played == [1, 2, 3]


def test_more_draws_are_added_and_fewer_are_read_back(replay, played):
    assert "methods" not in replay(draws=1)
    assert len(replay(draws=3)["draws"]) == 3
    assert len(replay(draws=2)["draws"]) == 2
    assert played == [1, 2, 3]


def test_draws_of_another_origin_are_refused_and_stay(replay, played, monkeypatch, tmp_path):
    replay(draws=1)
    before = (tmp_path / "liu2020" / "draw-01.json").read_bytes()
    for changes, words in (
        ({"seed": 1}, "seed: 0, now 1"),
        ({"share": 0.003}, "share: 0.002, now 0.003"),
        ({"rules": "liu2020-paper"}, "rules: liu2020, now liu2020-paper"),
    ):
        with pytest.raises(LedgerError, match=f"{words}.*use another --out, or remove"):
            replay(draws=1, **changes)
    monkeypatch.setattr(archive, "CODE", ())
    with pytest.raises(LedgerError, match="code: "):
        replay(draws=1)
    assert played == [1]
    assert (tmp_path / "liu2020" / "draw-01.json").read_bytes() == before


def test_a_damaged_draw_is_named(replay, played, tmp_path):
    replay(draws=1)
    path = tmp_path / "liu2020" / "draw-01.json"
    for damage in ("{", "[]", json.dumps({**json.loads(path.read_text()), "answers": [{}]})):
        path.write_text(damage)
        with pytest.raises(LedgerError, match=r"draw-01.json is damaged .* remove it"):
            replay(draws=1)


@pytest.mark.parametrize(("changes", "words"), [({"draws": 0}, "draws = 0"), ({"share": 1.5}, "share = 1.5")])
def test_an_argument_that_cannot_be_used_is_named(replay, changes, words):
    with pytest.raises(ParameterError, match=words):
        replay(**changes)


@pytest.mark.slow
@pytest.mark.parametrize("rules", ["liu2020", "liu2020-paper"])
def test_two_draws_write_four_tables_and_the_figure(tmp_path, rules):
    path = liu2020.replay(liu2020.Arguments(tmp_path, rules, draws=2, share=0.01))
    text, numbers = path.read_text(), json.loads((tmp_path / "liu2020.json").read_text())
    assert all(f"## Table {i}" in text for i in (1, 2, 3, 4))
    assert f"**Verdict: {numbers['verdict']}.**" in text
    assert [np.shape(each["transfers"]) for each in numbers["draws"]] == [(5, 5)] * 2
    assert {row["method"] for row in numbers["methods"]} == {method.label for method in METHODS}
    means = [row["gap"]["mean"] for row in numbers["methods"]]
    assert means == sorted(means)
    assert all(0 <= row["gap"]["low"] <= row["gap"]["high"] <= 1 for row in numbers["methods"])
    assert (tmp_path / "liu2020.png").stat().st_size > 10_000
