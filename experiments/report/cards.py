"""Agent cards: what an agent is, how it did on every board of a site, and whatever else its rows tell."""

from collections.abc import Iterator, Mapping, Sequence
from html import escape
from typing import Any

from experiments.board import Board, Row
from experiments.columns import NONE, percent
from experiments.report.hues import Hue
from experiments.report.marks import label, swatch


def agent_card(name: str, boards: Sequence[Board], hue: Hue, labels: Mapping[int, str]) -> str:
    """Return the card of one name.

    Args:
        name: of the rows.
        boards: of the site; those without the name are left out.
        hue: of the name.
        labels: what the page calls each board, by its index.
    """
    found = [(i, board, row) for i, board in enumerate(boards) for row in board.rows if row.name == name]
    last = found[-1][2]
    lines = "".join(_result(labels[i], board, row) for i, board, row in found)
    return (
        f'<article class="card {hue.kind}" id="agent-{hue.number}" data-agent="{hue.number}">'
        f"<h3>{swatch(hue)}{label(name)}</h3>"
        f'<p>{escape(last.summary)}</p>\n<table class="results"><thead><tr><th scope="col">board</th>'
        f'<th scope="col">place</th><th scope="col">gap %</th><th scope="col">95 %</th></tr></thead>'
        f"<tbody>{lines}</tbody></table>\n"
        f'<dl class="facts">{"".join(definition(key, value) for key, value in flat(last.card))}</dl></article>'
    )


def _result(text: str, board: Board, row: Row) -> str:
    place = board.places.get(row.name)
    ends = "–".join(map(percent, row.interval)) if row.interval else ""
    return (
        f'<tr><th scope="row">{escape(text)}</th><td>{place or "ref."}</td>'
        f"<td>{percent(row.mean)}</td><td>{ends}</td></tr>"
    )


def definition(name: str, text: Any) -> str:
    """Return a term and what is said of it; a dash for what nobody knows."""
    return f"<div><dt>{label(name)}</dt><dd>{escape(NONE if text is None else str(text))}</dd></div>"


def flat(record: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the leaves of nested mappings under dotted names."""
    for name, value in record.items():
        if isinstance(value, Mapping):
            yield from flat(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value
