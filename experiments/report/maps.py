"""What a page tells of one map: the gaps of every agent and seed, the runs behind them, and paths, if drawn."""

from collections.abc import Mapping
from typing import Any

from antgym.envs.cards import load_card
from antgym.envs.catalogue import world_of
from antgym.envs.control import BLOCKS
from antgym.tuning.kept import KeptRun
from experiments.board import EXACT, Board, Picture
from experiments.columns import percent
from experiments.report.hues import Hue
from experiments.report.picture import drawn, figure, stretch
from experiments.report.runs import behind

SYMBOLS = {"alpha": "α", "beta": "β", "rho": "ρ"}


def map_data(
    board: Board, scenario: int, runs: Mapping[str, KeptRun], hues: dict[str, Hue]
) -> dict[str, Any]:
    """Return the record of one map that the page's script shows, plain JSON.

    Raises:
        LedgerError: as :func:`experiments.report.runs.behind`.
    """
    name = board.scenarios[scenario]
    rows = []
    for row in board.ranked:
        found = [behind(board, row, scenario, seed, runs) for seed in range(len(row.gaps[scenario]))]
        rows.append(
            {
                "agent": hues[row.name].number,
                "gaps": [round(gap, 6) for gap in row.gaps[scenario]],
                "runs": found,
            }
        )
    picture = next((one for one in board.pictures if one.name == name), None)
    return {
        "name": name,
        "rows": rows,
        "parameters": symbols(board),
        "blocks": BLOCKS if board.track == "C" else 1,  # settings that one run was given, one after the other
        "picture": _picture(board, picture, hues) if picture else None,
    }


def symbols(board: Board) -> list[str]:
    """Return the names of a setting's numbers, as the card of the board's world has them; none without a card."""
    world = world_behind(board)
    card = load_card(world) if world else None
    return [SYMBOLS.get(name, name) for name in card["main effects"]] if card else []


def world_behind(board: Board) -> str:
    """Return the world whose suite a board was played on, "" where its manifest names no such suite."""
    return world_of(board.manifest.get("config", {}).get("suite"))


def _picture(board: Board, picture: Picture, hues: dict[str, Hue]) -> dict[str, Any]:
    lost = [row.name for row in board.ranked if row.name in picture.lengths and row.name not in picture.paths]
    notes = [f"Heights are drawn {stretch(picture):.1f} times too high."] if stretch(picture) > 1.05 else []
    notes += [f"No path on this map: {', '.join(lost)}."] if lost else []
    return {
        **figure(board, picture),
        "paths": [
            {"agent": hues[name].number, "note": _note(picture, name)} for name in drawn(board, picture)
        ],
        "optimum": f"{picture.optimum:,.1f}",
        "notes": " ".join(notes),
    }


def _note(picture: Picture, name: str) -> str:
    length = picture.lengths[name]
    return f"{length:,.1f}" if name == EXACT else f"+{percent(length / picture.optimum - 1)} %"
