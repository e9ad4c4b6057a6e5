"""Trainings that differ in their seed alone: tables show them as one agent, too."""

import json
import re
from collections.abc import Mapping

from agents.published import PolicyCard

_NUMBERED = re.compile(r"(.+)-\d+")


def trainings(cards: Mapping[str, PolicyCard]) -> dict[str, list[str]]:
    """Return the policies that differ in their seed alone, two at least, by what tables call them together.

    Args:
        cards: by name; names are alike but for a number at their end, as ``rl:ppo-1`` and ``rl:ppo-2``.
    """
    found: dict[tuple[str, str], list[str]] = {}
    for name, card in cards.items():
        if match := _NUMBERED.fullmatch(name):
            found.setdefault((match[1], _asked_of(card)), []).append(name)
    return {f"{stem}, {len(each)} trainings": each for (stem, _), each in found.items() if len(each) > 1}


def _asked_of(card: PolicyCard) -> str:
    """Return what a training was asked for but for its seed, and all that it learnt from and led to, as text."""
    asked = {name: value for name, value in card.settings.get("asked", {}).items() if value is not None}
    facts = (card.env, card.algorithm, card.action, card.constructor, card.arguments, card.follows_sha256)
    return json.dumps([*facts, card.evaluations, {**asked, "seed": None}], sort_keys=True)
