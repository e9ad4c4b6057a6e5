"""Cards: what was measured of a world, one JSON file each, by name: ``<World>.json``."""

import json
from importlib.resources import files
from typing import Any

NO_CARD = "no card yet"


def load_card(world: str) -> dict[str, Any] | None:
    """Return the card of a world, ``"Mountain"`` for example, None where it has none yet."""
    file = files(__name__) / f"{world}.json"
    return dict(json.loads(file.read_text(encoding="utf-8"))) if file.is_file() else None


def summary(card: dict[str, Any] | None, *, steered: bool = False) -> str:
    """Return one line on a card: mean gaps on the test split, and what choosing better would save.

    Args:
        card: see :func:`load_card`.
        steered: tell what schedules add within a run (Control), and not what a setting of its own per map would save.
    """
    if card is None:
        return NO_CARD
    gaps = {name: card["gap"][row][0] for name, row in (("default", "published default"), ("SBS", "SBS"))}
    shown = ", ".join(f"{name} {gap:.0%}" for name, gap in gaps.items())
    if steered:
        if not card.get("dynamic"):  # None where too few of its runs are long enough
            return f"gap: {shown}; schedules not measured"
        return f"gap: {shown}; schedules add {_interval(card['dynamic']['headroom'])}"
    return f"gap: {shown}; headroom {_interval(card['headroom']['over SBS by rule'])}"


def _interval(shares: list[float]) -> str:
    value, low, high = shares
    return f"{value:.0%} [{low:.0%}, {high:.0%}]"
