"""A track at a glance: the mean gap of every agent at every budget, one table of all the track's boards."""

from collections.abc import Sequence

from rich.box import SIMPLE_HEAD
from rich.table import Table
from rich.text import Text

from experiments.board import Board, Row
from experiments.board_table import markdown_line, plain
from experiments.columns import NONE, by_budget_headline, percent


def by_budget(boards: Sequence[Board]) -> Table:
    """Return the table for a terminal; the agents in the order of the last board."""
    table = Table(title=Text(by_budget_headline(boards[-1])), box=SIMPLE_HEAD, padding=0)
    table.add_column("agent", overflow="fold")
    for board in boards:
        table.add_column(f"{board.budget:,}", justify="right", overflow="fold")
    for row in boards[-1].ranked:
        cells = [row.name, *(_gap(board, row.name) for board in boards)]
        table.add_row(*map(Text, cells), style="dim italic" if row.kind == "reference" else None)
    return table


def budgets_to_markdown(boards: Sequence[Board]) -> str:
    """Return the same as Markdown; references in italics."""
    lines = [
        markdown_line(["mean gap % at", *(f"{board.budget:,}" for board in boards)]),
        markdown_line([":--", *["--:"] * len(boards)]),
    ]
    for row in boards[-1].ranked:
        name = f"*{plain(row.name)}*" if row.kind == "reference" else plain(row.name)
        lines.append(markdown_line([name, *(_gap(board, row.name) for board in boards)]))
    return "\n".join(lines)


def _gap(board: Board, name: str) -> str:
    row = next((row for row in board.rows if row.name == name), None)
    return NONE if row is None else _with_interval(row)


def _with_interval(row: Row) -> str:
    ends = "" if row.interval is None else f" [{percent(row.interval[0])}–{percent(row.interval[1])}]"
    return percent(row.mean) + ends
