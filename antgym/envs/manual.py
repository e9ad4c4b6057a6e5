"""The manual: what docstrings and ``antgym envs`` say of worlds, rules and arguments, from what is read at run time."""

import inspect
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, TypeVar

from antgym.envs.cards import load_card
from antgym.envs.catalogue import WORLDS
from antgym.maps.features import feature_table
from antgym.maps.recipes import SUITES
from antgym.planners.parameters import BeeRanges
from antgym.planners.planning import are_bees
from antgym.planners.rules import PAPERS
from antgym.planners.swarms import find_swarm_rules, parameter_names
from antgym.tuning.features import BEE_RULES_SHOWN, RULES_SHOWN

_GAPS = ("uniform random", "published default", "SBS", "SBS by rule", "VBS")
_Regime = TypeVar("_Regime", bound=type[Any])


def documented(regime: _Regime) -> _Regime:
    """Fill the tables of a regime's docstring in from what the environment itself reads."""
    if regime.__doc__:  # python -OO strips it
        tables = {
            "actions": ranges_table(),
            "bee_actions": ranges_table(BEE_RULES_SHOWN),
            "observations": feature_table(regime.features),
            "disc_observations": feature_table(regime.disc_features),
            "worlds": worlds_table(),
        }
        regime.__doc__ = inspect.cleandoc(regime.__doc__).format(**tables)
    return regime


def ranges_table(rules: Sequence[str] = RULES_SHOWN) -> str:
    """Return the Markdown table of low < published default < high, a row for each of some rules, of ants or of bees."""
    ants, bees = PAPERS["liu2020"].ranges.space(1.0), BeeRanges().space(2, 1, 1.0)
    space = bees if are_bees(rules) else ants
    names = [f"{'κ' if p.name == 'Q' else p.name} ({p.scale})" for p in space.parameters]
    rows = [f"| rules | {' | '.join(names)} |", "|---|" + "---|" * len(names)]
    for name in rules:
        cells = [" < ".join(f"{value:.4g}" for value in values) for values in find_swarm_rules(name).ranges]
        chosen = len(parameter_names(name))
        rows.append(f"| {name} | {' | '.join(cells[:chosen] + ['–'] * (len(cells) - chosen))} |")
    return "\n".join(rows)


def ranges_note(rules: Sequence[str]) -> str:
    """Return the line that says in which units the table of some rules is."""
    if are_bees(rules):
        return "limit / (sources · dimensions), tabu_radius / (width · √dimensions)"
    return "κ = Q / (straight line from start to goal · initial pheromone)"


def worlds_table() -> str:
    """Return the Markdown table of all worlds: what their scenarios, rules and efforts are."""
    headings = (
        "world",
        "suite",
        "rules",
        "families",
        "cells a side, or discs",
        "ants, or bees",
        "iterations",
        "train / test",
    )
    rows = [f"| {' | '.join(headings)} |", "|---" * len(headings) + "|"]
    rows += [f"| {' | '.join(world_facts(world).values())} |" for world in WORLDS]
    return "\n".join(rows)


def world_facts(world: str) -> dict[str, str]:
    """Return what a row of that table says of one world, by short names."""
    recipe = SUITES[WORLDS[world]]
    strands = recipe.strands
    return {
        "world": world,
        "suite": f"`{WORLDS[world]}`",
        "rules": ", ".join(recipe.rules),
        "families": ", ".join(recipe.families),
        "sizes": _span(size for strand in strands for size in strand.sizes),
        "ants": _span(ants for strand in strands for ants in strand.ants),
        "iterations": _span(count for strand in strands for count in strand.iterations),
        "scenarios": f"{recipe.counts['train']} / {recipe.counts['test']}",
    }


def cards_table() -> str:
    """Return the Markdown table of the cards of all worlds that have one."""
    headings = ("world", *_GAPS, "headroom over SBS by rule", "flat maps", "noise", "schedules add")
    rows = [f"| {' | '.join(headings)} |", "|:--" + "|--:" * (len(headings) - 1) + "|"]
    for world in WORLDS:
        card = load_card(world)
        if card is not None:
            rows.append(f"| {world} | {' | '.join(_card_cells(card))} |")
    return "\n".join(rows)


def _card_cells(card: dict[str, Any]) -> Iterator[str]:
    yield from (f"{100 * card['gap'][row][0]:.1f} %" for row in _GAPS)
    yield _share(card["headroom"]["over SBS by rule"])
    yield f"{100 * card['flat']:.0f} %"
    yield f"{100 * card['variance']['run']:.0f} %"
    yield _share(card["dynamic"]["headroom"]) if card["dynamic"] else "–"


def _share(interval: Sequence[float]) -> str:
    value, low, high = (100 * share for share in interval)
    return f"{value:.0f} % [{low:.0f}, {high:.0f}]"


def arguments(regime: Any) -> dict[str, Any]:
    """Return the keyword arguments of a regime and their defaults; ``suite``, which has none, is left out."""
    found: dict[str, Any] = {}
    for kind in reversed(regime.__mro__):
        if "__init__" in vars(kind):
            found |= {name: p.default for name, p in inspect.signature(kind).parameters.items()}
    return {name: found[name] for name in regime.arguments if found[name] is not inspect.Parameter.empty}


def section(regime: Any, heading: str) -> str:
    """Return the text under a heading of a regime's docstring, nothing where Python runs without docstrings."""
    _, _, rest = inspect.cleandoc(regime.__doc__ or "").partition(f"## {heading}\n")
    return rest.partition("\n## ")[0].strip()


def _span(values: Iterable[int]) -> str:
    low, high = min(found := list(values)), max(found)
    return str(low) if low == high else f"{low}–{high}"
