"""Cards: what was measured of a world, one JSON file each, by name: ``<World>.json``."""

import json
from importlib.resources import files
from typing import Any


def load_card(world: str) -> dict[str, Any] | None:
    """Return the card of a world, ``"Mountain"`` for example, None where it has none yet.

    Its ``"summary"`` is one line of text, for lists.
    """
    file = files(__name__) / f"{world}.json"
    return dict(json.loads(file.read_text(encoding="utf-8"))) if file.is_file() else None
