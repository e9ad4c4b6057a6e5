"""What a page calls its boards: addresses, labels, headings, and the sentence that says who is ahead."""

from collections.abc import Sequence
from html import escape

from experiments.board import Board
from experiments.columns import TRACKS, percent, size


def site_title(boards: Sequence[Board]) -> str:
    """Return the title that boards have in common."""
    titles = {board.title for board in boards}
    return titles.pop() if len(titles) == 1 else "Leaderboards"


def board_id(board: Board) -> str:
    """Return how a page's addresses call a board, as ``A-20``."""
    return f"{board.track}-{board.budget}"


def board_label(board: Board) -> str:
    """Return what a page calls a board among others."""
    if board.track == "C":
        return "C · control"
    return f"{board.track} · {board.budget:,} {_trials(board)}"


def choice(board: Board) -> str:
    """Return, as HTML, what the link to a board among those of its track says."""
    if board.track == "C":
        return "one run"
    return f'{board.budget:,}<span class="unseen"> {_trials(board)}</span>'


def _trials(board: Board) -> str:
    return "trial" if board.budget == 1 else "trials"


def result(board: Board) -> str:
    """Say what the board is, who is ahead, and of whom nobody can tell whether they are."""
    name, meaning = TRACKS[board.track]
    heading = f"Track {board.track}, {name}"
    if board.track != "C":
        heading += f": {board.budget:,} {_trials(board)} on each map"
    return (
        f"<h2>{escape(heading)}</h2><p>{escape(meaning)} {escape(size(board))}.</p>"
        f'<p class="result">{ahead(board)}</p>'
    )


def ahead(board: Board) -> str:
    """Return the sentence, as HTML, that says which agent is ahead and whether that is sure."""
    agents = [row for row in board.ranked if row.kind == "agent"]
    if not agents:
        return "No agent competes here: all rows are references."
    best, *others = agents
    space = "\N{NO-BREAK SPACE}"
    ends = (
        f" (95{space}% interval {percent(best.interval[0])} to {percent(best.interval[1])})"
        if best.interval
        else ""
    )
    name, mean = f"<strong>{escape(best.name)}</strong>", f"a mean gap of {percent(best.mean)}{space}%{ends}"
    text = f"{name} is ahead with {mean}" if others else f"Only {name} competes here, with {mean}"
    if others and board.places[others[0].name].tied:
        text += f", but is not told apart from <strong>{escape(others[0].name)}</strong>"
    better = len(board.outdone_by)
    return f"{text}; {better} reference{'s are' if better > 1 else ' is'} better." if better else f"{text}."
