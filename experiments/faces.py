"""From a ledger to what people look at: the boards of its rounds, their tables and the site."""

from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

from rich.console import Console

from antgym.console import write_whole
from antgym.tuning.ledger import Ledger
from experiments.board import Board
from experiments.board_table import to_markdown, to_table
from experiments.budgets import budgets_to_markdown, by_budget
from experiments.columns import by_budget_headline, headline
from experiments.pictures import draw
from experiments.report.page import write_site
from experiments.rows import bound_row, exact_row, read_clocks, time_exact, to_row
from experiments.tracks import Round


def show(folder: Path, ledger: Ledger, rounds: Sequence[Round], command: str) -> Path:
    """Print the tables, write board.md and the site, and return the path of its page.

    Args:
        folder: where they are written.
        ledger: that holds every run of the rounds.
        rounds: one a board, those of a track next to each other and the largest budget last.
        command: what makes these boards again.
    """
    for played in rounds:
        time_exact(played.items, ledger)
    boards = [to_board(played, rounds, ledger, command) for played in rounds]
    tracks = [list(group) for _, group in groupby(boards, lambda board: board.track)]
    console = Console(width=160 if not Console().is_terminal else None)
    for track in tracks:
        console.print(to_table(track[-1]))
        if len(track) > 1:
            console.print(by_budget(track))
    write_whole(folder / "board.md", _markdown(tracks, command).encode())
    return write_site(boards, ledger.folder, folder)


def to_board(played: Round, rounds: Sequence[Round], ledger: Ledger, command: str) -> Board:
    """Return the board of a round that is finished; the others of its kind are what its bound is chosen from."""
    clocks = read_clocks(ledger.folder)
    rows = [to_row(played, entrant, ledger, clocks) for entrant in played.entrants]
    alike = [other for other in rounds if (other.track == "C") == (played.track == "C")]
    bound = bound_row(played, alike, ledger)
    last = max(other.budget for other in rounds if other.track == played.track)
    return Board(
        title=_title(played, ledger.manifest["config"]),
        track=played.track,
        command=command,
        rows=(*rows, exact_row(played, clocks), *([bound] if bound else [])),
        scenarios=tuple(item.name for item in played.items),
        budget=played.budget,
        seeds=played.seeds,
        manifest=ledger.manifest,
        pictures=draw(played, rows, ledger) if played.budget == last else (),
    )


def _title(played: Round, config: dict[str, Any]) -> str:
    real = all(item.family == "terrain" for item in played.items)
    return "Real terrain" if real else f"{config['suite']}, {config['split']}"


def _markdown(tracks: Sequence[Sequence[Board]], command: str) -> str:
    """Return every board as Markdown, the largest budget of a track first, and the command that makes them."""
    parts = []
    for track in tracks:
        parts += [part for board in reversed(track) for part in (f"## {headline(board)}", to_markdown(board))]
        if len(track) > 1:
            parts += [f"## {by_budget_headline(track[-1])}", budgets_to_markdown(track)]
    return "\n\n".join([*(part.rstrip() for part in parts), f"```sh\n{command}\n```"]) + "\n"
