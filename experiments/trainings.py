"""Trainings that differ in their seed alone, as ``rl:ppo-1`` and ``rl:ppo-2``: tables show them as one agent, too."""

import re
from collections.abc import Iterable

_NUMBERED = re.compile(r"(.+)-\d+")


def trainings(names: Iterable[str]) -> dict[str, list[str]]:
    """Return names that are alike but for the number at their end, two at least, by what tables call them together."""
    found: dict[str, list[str]] = {}
    for name in names:
        if match := _NUMBERED.fullmatch(name):
            found.setdefault(match[1], []).append(name)
    return {f"{stem}, {len(each)} trainings": each for stem, each in found.items() if len(each) > 1}
