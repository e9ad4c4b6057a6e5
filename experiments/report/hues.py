"""One hue per agent, the same in every table and plot of a site; references share a colour that competes with none."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from experiments.board import EXACT, Board

COLOURS = 8
DASHES = ("solid", "dot", "dash", "dashdot")  # in plotly's words; they tell agents of one colour apart


class Hue(NamedTuple):
    """How one name is drawn.

    Attributes:
        number: of the name on the site, by which scripts and tables call it.
        colour: custom property of the style sheet, and class that sets it.
        dash: of its lines.
        kind: ``"agent"`` or ``"reference"``.
    """

    number: int
    colour: str
    dash: str
    kind: str


def hues(boards: Sequence[Board]) -> dict[str, Hue]:
    """Return the hue of every name on some boards and their pictures, in the order of their first rows."""
    kinds = {name: kind for name, kind in reversed(list(_names(boards)))}
    order = list(dict.fromkeys(name for name, _ in _names(boards)))
    agents = [name for name in order if kinds[name] == "agent"]
    others = [name for name in order if kinds[name] == "reference" and name != EXACT]
    look = {name: (f"hue-{i % COLOURS}", DASHES[i // COLOURS % len(DASHES)]) for i, name in enumerate(agents)}
    look |= {name: ("reference", DASHES[i % len(DASHES)]) for i, name in enumerate(others)}
    look[EXACT] = ("exact", "dash")
    return {name: Hue(i, *look[name], kinds[name]) for i, name in enumerate(order)}


def _names(boards: Sequence[Board]) -> Iterable[tuple[str, str]]:
    for board in boards:
        yield from ((row.name, row.kind) for row in board.rows)
    for board in boards:
        for picture in board.pictures:
            yield from ((name, "reference") for name in picture.lengths)
