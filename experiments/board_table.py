"""The table of a board, for a terminal and for READMEs."""

from collections.abc import Sequence

from rich.box import SIMPLE_HEAD
from rich.table import Table
from rich.text import Text

from experiments.board import Board, failures
from experiments.columns import COLUMNS, IN_TERMINAL, TIE, cells, headline, size


def to_table(board: Board) -> Table:
    """Return the board for a terminal; references stand in their order, dim and without a place."""
    caption = Text("\n".join([f"{size(board)}. Without #: references. {TIE}", *failures(board)]))
    table = Table(title=Text(headline(board)), caption=caption, box=SIMPLE_HEAD, padding=0)
    table.add_column("#", justify="right", no_wrap=True)
    table.add_column("agent", overflow="fold")
    for column in IN_TERMINAL:
        table.add_column(column.heading.replace(" ", "\n", 1), justify="right", overflow="fold")
    for row in board.ranked:
        reference = row.kind == "reference"
        texts = ["" if reference else str(board.places[row.name]), row.name, *cells(row, board, IN_TERMINAL)]
        table.add_row(*map(Text, texts), style="dim italic" if reference else None)
    return table


def to_markdown(board: Board) -> str:
    """Return the board as a Markdown table with the line that explains it; references in italics."""
    lines = [markdown_line(["#", "agent", *(column.heading for column in COLUMNS)])]
    lines += [markdown_line(["--:", ":--", *["--:"] * len(COLUMNS)])]
    for row in board.ranked:
        name, reference = plain(row.name), row.kind == "reference"
        place = "" if reference else str(board.places[row.name])
        lines.append(markdown_line([place, f"*{name}*" if reference else name, *cells(row, board)]))
    lines += ["", f"{size(board)}. In brackets 95 % intervals. {TIE} In italics: references.", ""]
    for failure in failures(board):
        lines += [plain(failure), ""]
    return "\n".join(lines)


def markdown_line(texts: Sequence[str]) -> str:
    """Return a line of a Markdown table."""
    return f"| {' | '.join(texts)} |"


def plain(name: str) -> str:
    """Escape what Markdown would take for markup, and line breaks."""
    return "".join(f"\\{sign}" if sign in "\\`*[]<>|" else sign for sign in " ".join(name.split()))
