"""Sheets: what the tables of every paper share, from a row of Markdown to the files that are written and shown."""

import io
import json
import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.markdown import Markdown

from antgym.console import write_whole
from antgym.errors import MissingExtraError

PICTURE = re.compile(r"!\[[^\]]*\]\(([^)]+)\)")


def table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    return "\n".join([_line(headings), "|---" * len(headings) + "|", *map(_line, rows)])


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def new_figure(width: float, height: float) -> Any:
    """Return an empty figure of so many inches; MissingExtraError if matplotlib is not installed."""
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise MissingExtraError("matplotlib", "viz") from None
    return Figure(figsize=(width, height), layout="constrained")


def publish(folder: Path, paper: str, text: str, numbers: dict[str, Any], figure: Any) -> Path:
    """Write PAPER.md, PAPER.json and PAPER.png into a folder, show the text, and return the Markdown file."""
    picture = io.BytesIO()
    figure.savefig(picture, format="png", dpi=120)
    path = folder / f"{paper}.md"
    write_whole(path, text.encode())
    write_whole(folder / f"{paper}.json", (json.dumps(numbers, indent=1) + "\n").encode())
    write_whole(folder / f"{paper}.png", picture.getvalue())
    Console(width=max(180, Console().width)).print(Markdown(_with_paths(text, folder)))
    return path


def _with_paths(text: str, folder: Path) -> str:
    """Return Markdown that says where its pictures are: a terminal cannot show them."""
    return PICTURE.sub(lambda picture: f"`{folder / picture[1]}`", text)
