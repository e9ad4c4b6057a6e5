"""Cards of worlds: read from the package, absent until they are measured."""

import json
from pathlib import Path

import pytest

from antgym.envs import cards
from antgym.envs.catalogue import WORLDS

CARD = {
    "gap": {"published default": [0.6349, 0.5, 0.7], "SBS": [0.28, 0.2, 0.3], "VBS": [0.17, 0.1, 0.2]},
    "headroom": {"over SBS by rule": [0.41, 0.33, 0.5]},
}


@pytest.mark.parametrize("world", WORLDS)
def test_every_world_has_a_line_with_a_card_or_without(world):
    line = cards.summary(cards.load_card(world))
    assert line == "no card yet" or "headroom" in line


def test_the_line_of_a_card_tells_gaps_and_headroom():
    assert cards.summary(CARD) == "gap: default 63%, SBS 28%; headroom 41% [33%, 50%]"


def test_where_a_run_is_steered_the_line_tells_what_schedules_add():
    card = {**CARD, "dynamic": {"headroom": [0.1522, 0.0836, 0.2256]}}
    assert cards.summary(card, steered=True) == "gap: default 63%, SBS 28%; schedules add 15% [8%, 23%]"
    assert cards.summary(card) == cards.summary(CARD)


@pytest.mark.parametrize("without", [CARD, {**CARD, "dynamic": None}])
def test_a_card_without_schedules_says_so(without):
    assert cards.summary(without, steered=True) == "gap: default 63%, SBS 28%; schedules not measured"


def test_a_card_is_what_its_file_says(tmp_path, monkeypatch):
    (tmp_path / "Moon.json").write_text(json.dumps(CARD), encoding="utf-8")
    monkeypatch.setattr(cards, "files", lambda _: tmp_path)
    assert cards.load_card("Moon") == CARD
    assert cards.load_card("Sun") is None


def test_cards_go_into_the_wheel():
    assert '"envs/cards/*.json"' in (Path(__file__).parents[2] / "pyproject.toml").read_text(encoding="utf-8")
