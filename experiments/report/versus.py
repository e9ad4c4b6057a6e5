"""Who beats whom: the probability that one row's run on a map is better than another's, as a table."""

from experiments.board import EXACT, Board, Row
from experiments.report.hues import Hue
from experiments.report.marks import label, swatch, upright
from experiments.statistics import Estimate, probability_of_improvement


def versus(board: Board, hues: dict[str, Hue]) -> str:
    """Return the inside of a board's table: row against column, per cent; bold where the interval leaves 50 out.

    Args:
        board: of two maps or more; one tells nobody apart.
        hues: of its rows.
    """
    rows = [row for row in board.ranked if row.name != EXACT]
    odds = _odds(rows)
    heads = "".join(upright(row, hues[row.name]) for row in rows)
    lines = [_line(row, rows, odds, hues) for row in rows]
    return f'<thead><tr><th scope="col">beats</th>{heads}</tr></thead>\n<tbody>{"".join(lines)}</tbody>'


def _odds(rows: list[Row]) -> dict[tuple[str, str], Estimate]:
    """Return the probability of every ordered pair; the second way round is what the first leaves."""
    odds = {}
    for i, row in enumerate(rows):
        for other in rows[i + 1 :]:
            won = probability_of_improvement(row.gaps, other.gaps)
            odds[row.name, other.name] = won
            odds[other.name, row.name] = Estimate(1 - won.mean, 1 - won.high, 1 - won.low)
    return odds


def _line(row: Row, rows: list[Row], odds: dict[tuple[str, str], Estimate], hues: dict[str, Hue]) -> str:
    cells = "".join(_cell(odds.get((row.name, other.name)), hues[other.name]) for other in rows)
    hue = hues[row.name]
    return (
        f'<tr class="{row.kind}" data-agent="{hue.number}">'
        f'<th scope="row">{swatch(hue)}{label(row.name)}</th>{cells}</tr>'
    )


def _cell(won: Estimate | None, hue: Hue) -> str:
    if won is None:
        return f'<td class="none" data-agent="{hue.number}">·</td>'
    text = f"{100 * won.mean:.0f}"
    if won.low > 0.5 or won.high < 0.5:
        text = f"<b>{text}</b>"
    side = "better" if won.mean >= 0.5 else "worse"
    return (
        f'<td class="{side}" data-agent="{hue.number}" style="--share:{200 * abs(won.mean - 0.5):.0f}%">{text}'
        f"<small>{100 * won.low:.0f}–{100 * won.high:.0f}</small></td>"
    )
