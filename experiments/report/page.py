"""The leaderboard as one self-contained HTML file, which opens from a disk and loads nothing from anywhere.

Every text of a board passes ``escape`` on its way in; a content security policy in the page forbids whatever
would still slip through to fetch anything.
"""

import json
import os
from collections.abc import Iterator, Mapping
from html import escape
from pathlib import Path
from string import Template
from typing import Any

from antgym.errors import MissingExtraError
from experiments.board import EXACT, Board, Picture, Row
from experiments.columns import COLUMNS, TIE, percent, size
from experiments.report import marks
from experiments.report.picture import drawn, figure, stretch

HERE = Path(__file__).parent
HUES = 8
POLICY = (
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data: blob:; "
    "base-uri 'none'; form-action 'none'"
)


def write_page(board: Board, path: Path) -> None:
    """Write a board's page; the file is either there as a whole or not at all.

    Raises:
        MissingExtraError: if the board has a picture and plotly is not installed.
    """
    text = _page(board)
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        temporary.write_text(text, encoding="utf-8")
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)


def _page(board: Board) -> str:
    versions = board.manifest.get("versions", {})
    rest = {key: value for key, value in board.manifest.items() if key != "versions"}
    return Template(_asset("page.html")).substitute(
        policy=escape(POLICY),
        description=escape(f"{board.title}: agents that tune an ant-colony path planner, {size(board)}."),
        title=escape(board.title),
        style=_asset("page.css"),
        result=_result(board),
        size=escape(f"{size(board)}."),
        tie=escape(TIE),
        headings=marks.headings(),
        rows="\n".join(marks.ranking_row(board, row) for row in board.ranked),
        intervals=marks.intervals(board),
        heat=marks.heat(board),
        picture="".join(_picture(board, picture) for picture in board.pictures[:1]),
        meanings="\n".join(_definition(column.heading, column.meaning) for column in COLUMNS),
        agents="\n".join(_who(row) for row in board.ranked),
        command=escape(board.command),
        versions="\n".join(_definition(name, value) for name, value in _flat(versions)),
        manifest=_details("The rest of the manifest", rest) if rest else "",
        sorting=_asset("sorting.js"),
        drawing="".join(_drawing(board, picture) for picture in board.pictures[:1]),
    )


def _asset(name: str) -> str:
    return (HERE / name).read_text(encoding="utf-8")


def _result(board: Board) -> str:
    """Say who is ahead, and of whom nobody can tell whether they are."""
    agents = [row for row in board.ranked if row.kind == "agent"]
    if not agents:
        return ""
    best, *others = agents
    space = "\N{NO-BREAK SPACE}"
    interval = f" (95{space}% interval {_range(*best.interval)})" if best.interval else ""
    text = f"<strong>{escape(best.name)}</strong> is ahead with a mean gap of {percent(best.mean)}{space}%{interval}"
    if others and board.places[others[0].name].tied:
        return f"{text}, but is not told apart from <strong>{escape(others[0].name)}</strong>."
    return f"{text}."


def _range(low: float, high: float) -> str:
    return f"{percent(low)} to {percent(high)}"


def _definition(name: str, text: Any) -> str:
    return f"<div><dt>{marks.label(name)}</dt><dd>{escape(str(text))}</dd></div>"


def _who(row: Row) -> str:
    card = _details("card", row.card) if row.card else ""
    return f"<div><dt>{marks.label(row.name)}</dt><dd>{escape(row.summary)}{card}</dd></div>"


def _details(summary: str, record: Mapping[str, Any]) -> str:
    inner = "\n".join(_definition(name, value) for name, value in _flat(record))
    return f'<details><summary>{escape(summary)}</summary><dl class="versions">{inner}</dl></details>'


def _flat(record: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the leaves of nested mappings under dotted names."""
    for name, value in record.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value


def _picture(board: Board, picture: Picture) -> str:
    names = drawn(board, picture)
    items = "\n".join(_toggle(picture, name, i) for i, name in enumerate(names))
    lost = [row.name for row in board.ranked if row.name not in picture.paths and row.name in picture.lengths]
    notes = [f"Heights are drawn {stretch(picture):.1f} times too high."] if stretch(picture) > 1.05 else []
    notes += [f"No path on this map: {', '.join(lost)}."] if lost else []
    return Template(_asset("picture.html")).substitute(
        name=escape(picture.name),
        optimum=f"{picture.optimum:,.1f}",
        toggles=items,
        notes=f"<p>{escape(' '.join(notes))}</p>" if notes else "",
    )


def _toggle(picture: Picture, name: str, index: int) -> str:
    exact = name == EXACT
    length = picture.lengths[name]
    note = f"{length:,.1f}" if exact else f"+{percent(length / picture.optimum - 1)} %"
    hue = "exact" if exact else f"hue-{(index - 1) % HUES}"
    return (
        f'<li><button type="button" class="{hue}" data-line="{index}" aria-pressed="false">'
        f'<span class="swatch"></span><span class="name">{marks.label(name)}</span> '
        f'<span class="note">{note}</span></button></li>'
    )


def _drawing(board: Board, picture: Picture) -> str:
    try:
        from plotly.offline import get_plotlyjs
    except ImportError:
        raise MissingExtraError("plotly", "viz") from None
    # "<" would let a name close the script element that carries the data
    data = json.dumps(figure(board, picture), allow_nan=False).replace("<", "\\u003c")
    return (
        f"<script>{get_plotlyjs()}</script>\n"
        f'<script type="application/json" id="figure">{data}</script>\n'
        f"<script>\n{_asset('drawing.js')}</script>"
    )
