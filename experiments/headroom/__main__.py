"""Measure cards: ``python -m experiments.headroom [WORLD ...]``."""

import json
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import tyro
from rich.console import Console
from rich.table import Table

from antgym.console import main, parse, progress, write_whole
from antgym.envs.catalogue import REGIMES, WORLDS
from antgym.errors import ParameterError, nearest
from experiments.headroom.card import PRESETS, measure, runs_needed


@dataclass(frozen=True)
class Arguments:
    """Measure what worlds are worth to a tuner and write their cards.

    A card of the full preset takes some ten thousand planner runs per map: minutes for most worlds. The committed
    cards in antgym/envs/cards are what this command writes.
    """

    worlds: Annotated[tuple[str, ...], tyro.conf.Positional] = ()
    """Worlds (Mountain, Room, ...) or environment ids; all by default."""
    preset: Literal["smoke", "full"] = "full"
    """How much: smoke takes seconds and says nothing."""
    out: Path | None = None
    """Folder of the cards, one WORLD.json each; by default antgym/envs/cards for full, out/cards for smoke."""


def _world(name: str) -> str:
    short = name.removeprefix("antgym/").rpartition("-v")[0] or name
    for regime in REGIMES:
        short = short.removesuffix(regime)
    return short


def to_table(cards: list[dict[str, Any]]) -> Table:
    """Return the table that the terminal shows."""
    table = Table(title="Mean gap on test maps, per cent; headroom over SBS by rule with its 95 % interval")
    headings = ("world", "random", "default", "SBS", "by rule", "VBS", "headroom", "flat", "dynamic")
    for heading in headings:
        table.add_column(heading, justify="left" if heading == "world" else "right")
    for card in cards:
        gaps = [f"{100 * gap[0]:.1f}" for gap in card["gap"].values()]
        value, low, high = card["headroom"]["over SBS by rule"]
        dynamic = f"{100 * card['dynamic']['headroom'][0]:.0f} %" if card["dynamic"] else "–"
        share = f"{100 * value:.0f} % [{100 * low:.0f}, {100 * high:.0f}]"
        table.add_row(card["world"], *gaps, share, f"{100 * card['flat']:.0f} %", dynamic)
    return table


def run(arguments: Arguments) -> list[dict[str, Any]]:
    """Measure the worlds that are asked for; each card is written when it is whole."""
    known, cards = WORLDS, []
    folder = arguments.out or Path("out/cards" if arguments.preset == "smoke" else "antgym/envs/cards")
    for name in arguments.worlds:
        if _world(name) not in known:
            raise ParameterError(f"unknown world {name!r}; {nearest(_world(name), tuple(known))}")
    for world in dict.fromkeys(map(_world, arguments.worlds)) or known:
        begun = time.perf_counter()
        with progress(world, runs_needed(known[world], PRESETS[arguments.preset])) as advance:
            card = measure(world, known[world], arguments.preset, advance)
        cards.append(card)
        path = folder / f"{world}.json"
        write_whole(path, (json.dumps(card, indent=1, ensure_ascii=False) + "\n").encode())
        print(f"{path} written after {time.perf_counter() - begun:.0f} s")
    Console(width=None if Console().is_terminal else 160).print(to_table(cards))
    return cards


def script() -> None:
    """Run the command line."""
    run(parse(Arguments, None, "python -m experiments.headroom"))


if __name__ == "__main__":
    main(script, interrupted="interrupted; cards written so far are whole")
