"""What the worlds' cards say of parameters: how much of the gap's variance each explains, as bars."""

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from antgym.envs.cards import load_card
from antgym.envs.catalogue import WORLDS
from experiments.report.maps import SYMBOLS
from experiments.report.marks import label

PARTS = {"map": "map", "setting": "setting", "map x setting": "map × setting", "run": "run"}


def importance(own: Sequence[str]) -> str:
    """Return a block for every world that has a card.

    Args:
        own: worlds that the site's boards were played on; they come first and are marked.
    """
    worlds = sorted(WORLDS, key=lambda world: world not in own)
    cards = {world: card for world in worlds if (card := load_card(world))}
    return "\n".join(_block(world, card, own=world in own) for world, card in cards.items())


def _block(world: str, card: Mapping[str, Any], *, own: bool) -> str:
    effects = {SYMBOLS.get(name, name): share for name, share in card["main effects"].items()}
    bars = "".join(_bar(name, share) for name, share in effects.items())
    mark = ' <span class="own">this board</span>' if own else ""
    return (
        f'<div class="world"><h3>{label(world)}{mark}</h3>\n<div class="bars">{bars}</div>\n'
        f"{_stack(card['variance'])}</div>"
    )


def _bar(name: str, share: float) -> str:
    text = f"{100 * share:.0f} %"
    return (
        f'<span class="parameter">{label(name)}</span>'
        f'<svg role="img" aria-label="{escape(name)} {text}"><rect class="track" width="100%" height="100%"/>'
        f'<rect width="{100 * min(share, 1.0):.1f}%" height="100%"/></svg><span class="value">{text}</span>'
    )


def _stack(shares: Mapping[str, float]) -> str:
    """Return one bar that is split among what the gap depends on."""
    at, parts = 0.0, ""
    for i, share in enumerate(shares[name] for name in PARTS):
        parts += f'<rect class="part-{i}" x="{100 * at:.1f}%" width="{100 * share:.1f}%" height="100%"/>'
        at += share
    spoken = ", ".join(f"{text} {100 * shares[name]:.0f} %" for name, text in PARTS.items())
    keys = "".join(
        f'<span><i class="part-{i}"></i>{text} {100 * shares[name]:.0f} %</span>'
        for i, (name, text) in enumerate(PARTS.items())
    )
    return f'<svg class="stack" role="img" aria-label="{spoken}">{parts}</svg><p class="parts">{keys}</p>'
