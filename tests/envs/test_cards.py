"""Cards of worlds: read from the package, absent until they are measured."""

import json

import pytest

from antgym.envs import cards
from antgym.envs.catalogue import WORLDS


@pytest.mark.parametrize("world", WORLDS)
def test_a_world_has_a_card_with_a_one_line_summary_or_none_yet(world):
    card = cards.load_card(world)
    assert card is None or "\n" not in card["summary"]


def test_a_card_is_what_its_file_says(tmp_path, monkeypatch):
    (tmp_path / "Moon.json").write_text(json.dumps({"summary": "ρ matters"}), encoding="utf-8")
    monkeypatch.setattr(cards, "files", lambda _: tmp_path)
    assert cards.load_card("Moon") == {"summary": "ρ matters"}
    assert cards.load_card("Sun") is None


def test_cards_go_into_the_wheel():
    from pathlib import Path

    assert '"envs/cards/*.json"' in (Path(__file__).parents[2] / "pyproject.toml").read_text(encoding="utf-8")
