"""The manual: what docstrings, README and ``antgym envs`` say is what the code reads."""

from pathlib import Path

import pytest
from gymnasium.envs.registration import load_env_creator

from antgym.envs import manual
from antgym.envs.catalogue import CATALOGUE, WORLDS
from antgym.envs.manual import (
    arguments,
    cards_table,
    ranges_table,
    section,
    world_facts,
    worlds_table,
)
from antgym.maps.discs import DiscWorld
from antgym.maps.suites import load_suite
from antgym.planners.bee_rules import BEE_PAPERS
from antgym.planners.rules import PAPERS
from antgym.tuning.features import BEE_RULES_SHOWN, RULES_SHOWN


def size_of(world):
    """Cells a side, or discs."""
    return len(world.discs) if isinstance(world, DiscWorld) else world.shape[0]


README = Path(__file__).parents[2] / "README.md"


def test_every_rule_has_its_row_of_ranges():
    rows = ranges_table().splitlines()[2:]
    bees = ranges_table(BEE_RULES_SHOWN).splitlines()[2:]
    assert [row.split(" | ")[0] for row in rows + bees] == [
        f"| {name}" for name in (*RULES_SHOWN, *BEE_RULES_SHOWN)
    ]
    assert "| abc_standard | 0.02083 < 1 < 10 | 0.2 < 1 < 4 | 0.05 < 1 < 4 | – |" in bees
    assert (
        "| liu2020 | 0.01 < 1.303 < 5 | 0.02 < 8.423 < 10 | 0.01 < 0.4152 < 0.999 | 0.001 < 1.171 < 100 |"
        in rows
    )


def test_a_table_of_some_rules_has_theirs_alone():
    assert ranges_table(["wei2018"]).count("\n") == 2


def test_the_readme_shows_the_worlds_as_they_are():
    assert worlds_table() in README.read_text(encoding="utf-8")


def test_the_readme_shows_the_cards_as_they_are():
    assert cards_table() in README.read_text(encoding="utf-8")


def test_a_card_is_a_row_of_the_table(monkeypatch):
    rows = ("uniform random", "published default", "SBS", "SBS by rule", "VBS")
    made = {
        "gap": {row: [0.5 - i / 10, 0.0, 1.0] for i, row in enumerate(rows)},
        "headroom": {"over SBS by rule": [0.25, 0.125, 0.5]},
        "flat": 0.1,
        "variance": {"run": 0.3},
        "dynamic": None,
    }
    monkeypatch.setattr(manual, "load_card", lambda world: made if world == "Room" else None)
    row = "| Room | 50.0 % | 40.0 % | 30.0 % | 20.0 % | 10.0 % | 25 % [12, 50] | 10 % | 30 % | – |"
    assert cards_table().splitlines()[2:] == [row]


@pytest.mark.parametrize("world", WORLDS)
def test_facts_of_a_world_are_those_of_its_scenarios(world):
    facts, items = world_facts(world), load_suite(WORLDS[world], "test")[:30]
    assert {item.rules for item in items} <= set(facts["rules"].split(", ")) <= {*PAPERS, *BEE_PAPERS}
    assert {item.family for item in items} <= set(facts["families"].split(", "))
    for name, values in (
        ("sizes", [size_of(item.scenario.world) for item in items]),
        ("ants", [item.ants for item in items]),
        ("iterations", [item.iterations for item in items]),
    ):
        bounds = [int(number) for number in facts[name].split("–")]
        assert bounds[0] <= min(values) <= max(values) <= bounds[-1]


@pytest.mark.parametrize("entry", CATALOGUE, ids=lambda entry: entry.id)
def test_defaults_are_those_that_an_environment_takes(entry):
    regime = load_env_creator(entry.entry_point)
    defaults = arguments(regime)
    assert set(defaults) == set(regime.arguments) - {"suite"}
    assert defaults["split"] == "train"
    regime(**entry.kwargs, **defaults)


@pytest.mark.parametrize("entry", CATALOGUE, ids=lambda entry: entry.id)
def test_a_section_ends_where_the_next_begins(entry):
    text = section(load_env_creator(entry.entry_point), "Description")
    assert len(text) > 200
    assert "##" not in text


def test_without_docstrings_a_section_is_empty():
    class Bare:
        pass

    assert section(Bare, "Description") == ""
