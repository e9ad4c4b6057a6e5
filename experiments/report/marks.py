"""The tables and the interval plot of a page, as HTML and SVG fragments.

Whatever belongs to one agent carries its number on the site in ``data-agent``: by it, the page's filter finds it.
"""

import math
from collections.abc import Callable
from html import escape

from experiments.board import EXACT, SBS, VBS, Board, Row
from experiments.columns import COLUMNS, cells, percent
from experiments.report.hues import Hue

LEFT, WIDTH = 1.5, 97.0  # the plot's scale, per cent of a track; the rest keeps dots at its ends whole
MOST_TICKS = 6
PATHS = " <small>paths</small>"  # of a map that can be looked at


def label(name: str) -> str:
    """Escape a name, and let it break after underscores and colons."""
    return escape(name).replace("_", "_<wbr>").replace(":", ":<wbr>")


def swatch(hue: Hue) -> str:
    """Return the short line in an agent's colour that stands before its name."""
    return f'<span class="swatch {hue.colour} {hue.dash}" aria-hidden="true"></span>'


def headings() -> str:
    """Return the heading cells of the ranking, each with the button that sorts by it."""
    titles = ["#", "agent", *(column.heading for column in COLUMNS)]
    kinds = ["number", "text", *["number"] * len(COLUMNS)]
    at_first = ["none", "none", "ascending", *["none"] * (len(COLUMNS) - 1)]
    return "".join(
        f'<th scope="col" class="{kind}" aria-sort="{order}">'
        f'<button type="button">{escape(_unbroken(title))}</button></th>'
        for title, kind, order in zip(titles, kinds, at_first, strict=True)
    )


def _unbroken(heading: str) -> str:
    """Keep a heading's unit on the line of the word before it."""
    words, _, unit = heading.rpartition(" ")
    return f"{words}\N{NO-BREAK SPACE}{unit}" if words and len(unit) == 1 else heading


def ranking_row(board: Board, row: Row, hue: Hue) -> str:
    """Return one row of the ranking; what a cell is sorted by stands in ``data-value``, the name leads to its card."""
    place = board.places.get(row.name)
    values = [column.value(row, board) for column in COLUMNS]
    numbers = "".join(
        f'<td data-value="{"" if value is None else value}">{_dim_brackets(text)}</td>'
        for value, text in zip(values, cells(row, board), strict=True)
    )
    return (
        f'<tr class="{row.kind}" data-agent="{hue.number}">'
        f'<td class="place" data-value="{place.number if place else ""}">{place or ""}</td>'
        f'<th scope="row" data-value="{escape(row.name)}">{swatch(hue)}'
        f'<a href="#agent-{hue.number}" title="{escape(row.summary)}">{label(row.name)}</a></th>{numbers}</tr>'
    )


def _dim_brackets(text: str) -> str:
    number, bracket, rest = text.partition(" [")
    return f'{number} <span class="range">[{rest}</span>' if bracket else number


def intervals(board: Board, hues: dict[str, Hue]) -> str:
    """Return the interval plot: one line per row, best first, over a common scale that starts at 0."""
    top = max(row.interval[1] if row.interval else row.mean for row in board.rows)
    ticks = _ticks(max(top, 0.01))
    backdrop = _backdrop(board, ticks)
    lines = [_track(row, hues[row.name], ticks[-1], backdrop) for row in board.ranked]
    labels = "".join(
        f'<text x="{_at(tick, ticks[-1])}" y="16">{_tick_label(tick)}{" %" if tick == ticks[-1] else ""}</text>'
        for tick in ticks
    )
    return "\n".join([*lines, f'<div class="axis" aria-hidden="true"><svg>{labels}</svg></div>'])


def _track(row: Row, hue: Hue, top: float, backdrop: str) -> str:
    mean, bar, spoken, text = percent(row.mean), "", "", ""
    if row.interval:
        low, high = map(percent, row.interval)
        bar = _bar(row.interval, top)
        spoken, text = f", 95 % interval {low} to {high} %", f" <span>[{low}–{high}]</span>"
    tick = _at(row.interquartile, top)
    return (
        f'<div class="{row.kind}" data-agent="{hue.number}"><span class="name">{label(row.name)}</span>'
        f'<svg class="{hue.colour}" role="img" aria-label="mean gap {mean} %{spoken}">{backdrop}{bar}'
        f'<line class="middle" x1="{tick}" x2="{tick}" y1="25%" y2="75%"/>'
        f'<circle cx="{_at(row.mean, top)}" cy="50%" r="5"/></svg><span class="value">{mean}{text}</span></div>'
    )


def _bar(ends: tuple[float, float], top: float) -> str:
    low, high = ends
    return f'<line class="bar" x1="{_at(low, top)}" x2="{_at(high, top)}" y1="50%" y2="50%"/>'


def _backdrop(board: Board, ticks: list[float]) -> str:
    # a line for each reference would be a fence
    aims = [row.mean for row in board.rows if row.name in (EXACT, SBS, VBS)]
    lines = [("grid", tick) for tick in ticks] + [("aim", mean) for mean in aims]
    return "".join(
        f'<line class="{kind}" x1="{_at(value, ticks[-1])}" x2="{_at(value, ticks[-1])}" y1="0" y2="100%"/>'
        for kind, value in lines
    )


def _at(value: float, top: float) -> str:
    return f"{LEFT + WIDTH * value / top:.2f}%"


def _ticks(top: float) -> list[float]:
    """Return round values from 0 to the first at or above ``top``."""
    power = 10.0 ** math.floor(math.log10(top / MOST_TICKS))
    step = next(power * factor for factor in (1, 2, 5, 10) if top / (power * factor) <= MOST_TICKS)
    return [step * i for i in range(math.ceil(top / step - 1e-9) + 1)]


def _tick_label(tick: float) -> str:
    return f"{100 * tick:.4g}"


def heat(board: Board, hues: dict[str, Hue], link: Callable[[int], str]) -> str:
    """Return the inside of the table of gaps, maps × rows, each cell shaded by the square root of its gap.

    Args:
        board: whose gaps.
        hues: of its rows.
        link: address of a map's details, by its index.
    """
    top = max(max(row.scenario_means) for row in board.rows) or 1.0
    names = "".join(upright(row, hues[row.name]) for row in board.ranked)
    drawn = {picture.name for picture in board.pictures}
    rows = [
        f'<tr><th scope="row"><a href="{escape(link(i))}">{label(name)}</a>{PATHS if name in drawn else ""}</th>'
        f"{_heat_cells(board, hues, i, top)}</tr>"
        for i, name in enumerate(board.scenarios)
    ]
    return f'<thead><tr><th scope="col">map</th>{names}</tr></thead>\n<tbody>{"".join(rows)}</tbody>'


def upright(row: Row, hue: Hue) -> str:
    """Return the heading of a row's column, written upwards."""
    return (
        f'<th scope="col" class="upright {row.kind}" data-agent="{hue.number}">'
        f"<span>{swatch(hue)}{label(row.name)}</span></th>"
    )


def _heat_cells(board: Board, hues: dict[str, Hue], scenario: int, top: float) -> str:
    gaps = [row.scenario_means[scenario] for row in board.ranked]
    best = min(
        (gap for gap, row in zip(gaps, board.ranked, strict=True) if row.kind == "agent"), default=-1.0
    )
    return "".join(
        f'<td data-agent="{hues[row.name].number}" style="--share:{100 * math.sqrt(max(gap, 0.0) / top):.0f}%">'
        f"{_strong(percent(gap), gap, best, row)}</td>"
        for gap, row in zip(gaps, board.ranked, strict=True)
    )


def _strong(text: str, gap: float, best: float, row: Row) -> str:
    return f"<b>{text}</b>" if gap == best and row.kind == "agent" else text
