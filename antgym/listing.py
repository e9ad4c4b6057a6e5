"""What ``antgym envs`` prints: a table of all environments, or a page on one."""

import json
from typing import Any

import gymnasium
from gymnasium.envs.registration import load_env_creator
from rich.markdown import Markdown
from rich.table import Table

from antgym.envs.cards import load_card, summary
from antgym.envs.catalogue import CATALOGUE, Entry
from antgym.envs.manual import arguments, ranges_note, ranges_table, section, world_facts
from antgym.errors import ParameterError, nearest


def table() -> Table:
    """Return the table of all ids: sizes of action and observation, and what was measured of the world."""
    listed = Table(title="Environments: gymnasium.make(id); antgym envs ID says more")
    for heading in ("id", "action", "observation", "card"):
        listed.add_column(heading, overflow="fold")
    for entry in CATALOGUE:
        env = gymnasium.make(entry.id)
        sizes = (str(space.shape) for space in (env.action_space, env.observation_space))
        listed.add_row(entry.id, *sizes, _summary(entry, load_card(entry.world)))
        env.close()
    return listed


def page(env_id: str) -> Markdown:
    """Return the page of one environment; ParameterError names the nearest where there is no such id."""
    entries = {entry.id: entry for entry in CATALOGUE}
    if env_id not in entries:
        raise ParameterError(f"unknown environment {env_id!r}; {nearest(env_id, tuple(entries))}")
    entry = entries[env_id]
    regime = load_env_creator(entry.entry_point)
    facts = world_facts(entry.world)
    defaults = {**entry.kwargs, **arguments(regime)}
    card = load_card(entry.world)
    parts = [
        f"# {entry.id}",
        section(regime, "Description").partition("\n\n")[0],
        f"## World: {entry.world}",
        *(f"- {name}: {value}" for name, value in facts.items() if name != "world"),
        "## Arguments and defaults",
        *(f"- `{name}`: `{default!r}`" for name, default in defaults.items()),
        "## Ranges: low < published default (action 0) < high",
        ranges_table(facts["rules"].split(", ")),
        ranges_note(facts["rules"].split(", ")),
        "## Card",
        _summary(entry, card),
        f"Flat: {entry.flat}." if entry.flat else "",
        f"```json\n{json.dumps(card, indent=2, ensure_ascii=False)}\n```" if card else "",
        f"Entry points: `{entry.entry_point}`, vector `{entry.vector_entry_point}`.",
    ]
    return Markdown("\n".join(_spaced([part for part in parts if part])))


def _summary(entry: Entry, card: dict[str, Any] | None) -> str:
    """Return the line on a card that says what there is to win in a regime, and whether the world is marked flat."""
    return summary(card, steered=entry.regime == "Control") + (" (flat)" if entry.flat else "")


def _spaced(parts: list[str]) -> list[str]:
    """Put an empty line between parts that are not items of one list."""
    lines: list[str] = []
    for part in parts:
        if lines and not (part.startswith("- ") and lines[-1].startswith("- ")):
            lines.append("")
        lines.append(part)
    return lines
