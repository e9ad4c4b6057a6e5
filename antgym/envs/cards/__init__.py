"""Cards: what was measured of a world, one JSON file each, by name: ``<World>.json``."""

import json
from importlib.resources import files
from typing import Any

NO_CARD = "no card yet"


def load_card(world: str) -> dict[str, Any] | None:
    """Return the card of a world, ``"Mountain"`` for example, None where it has none yet."""
    file = files(__name__) / f"{world}.json"
    return dict(json.loads(file.read_text(encoding="utf-8"))) if file.is_file() else None


def summary(card: dict[str, Any] | None) -> str:
    """Return one line on a card: mean gaps on the test split, and what a setting of its own per map would save."""
    if card is None:
        return NO_CARD
    gaps = {name: card["gap"][row][0] for name, row in (("default", "published default"), ("SBS", "SBS"))}
    value, low, high = card["headroom"]["over SBS by rule"]
    shown = ", ".join(f"{name} {gap:.0%}" for name, gap in gaps.items())
    return f"gap: {shown}; headroom {value:.0%} [{low:.0%}, {high:.0%}]"
