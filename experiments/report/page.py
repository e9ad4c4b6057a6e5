"""The leaderboards of a ledger as a static site, which opens from a disk and loads nothing from anywhere else.

Every text of a board passes ``escape`` on its way into the page, and reaches scripts as JSON that they show as text. A
content security policy forbids inline scripts and every other origin, whatever would still slip through.
"""

import json
import shutil
from collections.abc import Callable, Mapping, Sequence
from hashlib import sha256
from html import escape
from pathlib import Path
from string import Template
from typing import Any

from antgym.console import progress, write_whole
from antgym.errors import AntgymError, MissingExtraError
from antgym.tuning.kept import KeptRun, read_runs
from experiments.board import EXACT, SBS, VBS, Board, failures
from experiments.columns import COLUMNS, TIE, TRACKS, size
from experiments.report import marks
from experiments.report.cards import agent_card, definition, flat
from experiments.report.curves import anytime, profile, reached
from experiments.report.hues import Hue, hues
from experiments.report.importance import importance
from experiments.report.maps import map_data, world_behind
from experiments.report.titles import board_id, board_label, choice, result, site_title
from experiments.report.versus import versus
from experiments.statistics import TARGETS

HERE = Path(__file__).parent
SCRIPTS = tuple(f"scripts/{name}.js" for name in ("page", "sorting", "curves", "scene", "maps"))
ASSETS = ("page.css", *SCRIPTS)
PLOTLY = "plotly.min.js"
POLICY = (
    "default-src 'none'; style-src 'self' 'unsafe-inline'; script-src 'self'; img-src data: blob:; "
    "base-uri 'none'; form-action 'none'"
)
HELP = (
    f'<p class="help">{escape(TIE)} Rows in italics are references, which do not compete. A heading sorts; pressed '
    "again, the other way round.</p>"
)
ONE_MAP = '<p class="help">One map tells nobody apart.</p>'
HASH = 12  # letters of the hash that names a folder of data
HASHED = "[0-9a-f]" * HASH
AT_FIRST = 6  # agents whose curves are drawn before the reader asks for more


def write_site(boards: Sequence[Board], ledger: Path, folder: Path) -> Path:
    """Write the page of some boards, its scripts and a data file for every map of every board.

    ``index.html`` comes last and data lie in a folder named by their hash, so that an old page works until a new one
    takes its place; then the old data go.

    Args:
        boards: one for each track and budget, in any order.
        ledger: folder of the ``trials.jsonl`` that their gaps come from.
        folder: where the site goes; it may be the ledger's.

    Returns:
        The path of ``index.html``.

    Raises:
        AntgymError: if there is no board, or two of one track and budget.
        LedgerError: if a gap of an agent is not what its run in the ledger says.
        MissingExtraError: if plotly is not installed.
    """
    boards = sorted(boards, key=lambda board: (board.track, board.budget))
    names = [board_id(board) for board in boards]
    if not names or len(set(names)) < len(names):
        raise AntgymError(
            f"a site needs boards, one for each track and budget; got {', '.join(names) or 'none'}"
        )
    files = {PLOTLY: _plotly(), **{name: _asset(name) for name in ASSETS}}
    looks = hues(boards)
    with progress("page", 1 + 2 * len(boards)) as advance:
        runs, records = read_runs(ledger), dict[str, str]()
        advance(1)
        for board in boards:
            records |= _records(board, runs, looks)
            advance(1)
        data = f"data/{sha256(''.join(records.values()).encode()).hexdigest()[:HASH]}"
        page = _page(boards, looks, data, advance)
    files |= {f"{data}/{name}": text for name, text in records.items()} | {"index.html": page}
    for name, text in files.items():
        write_whole(folder / name, text.encode())
    _forget(folder / "data", folder / data)
    return folder / "index.html"


def _records(board: Board, runs: Mapping[str, KeptRun], looks: dict[str, Hue]) -> dict[str, str]:
    """Return scripts that hand maps over, by file name: a page from a disk may load scripts, but fetch nothing."""
    name = board_id(board)
    return {
        f"{name}-{i}.js": f'antgym.deliver("{name}/{i}", {_json(map_data(board, i, runs, looks))});\n'
        for i in range(len(board.scenarios))
    }


def _forget(parent: Path, kept: Path) -> None:
    """Remove the data of earlier pages, and nothing else that may lie there."""
    for folder in parent.glob(HASHED):
        if folder != kept:
            shutil.rmtree(folder)


def _json(data: Any) -> str:
    # "<" would let a name close the script element that carries the data
    return json.dumps(data, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")


def _plotly() -> str:
    try:
        from plotly.offline import get_plotlyjs
    except ImportError:
        raise MissingExtraError("plotly", "viz") from None
    script: str = get_plotlyjs()
    return script


def _asset(name: str) -> str:
    return (HERE / name).read_text(encoding="utf-8")


def _page(boards: Sequence[Board], looks: dict[str, Hue], data: str, advance: Callable[[int], None]) -> str:
    title = site_title(boards)
    panels = []
    for board in boards:
        panels.append(_panels(board, looks))
        advance(1)
    sections = {name: "\n".join(panel[name] for panel in panels) for name in panels[0]}
    labels = dict(enumerate(map(board_label, boards)))
    return Template(_asset("page.html")).substitute(
        sections,
        policy=escape(POLICY),
        title=escape(title),
        description=escape(f"{title}: agents that tune a swarm path planner, {size(boards[0])}."),
        boards=_choices(boards),
        importance=importance([world for board in boards if (world := world_behind(board))]),
        agents="\n".join(agent_card(name, boards, looks[name], labels) for name in _named(boards)),
        meanings="\n".join(definition(column.heading, column.meaning) for column in COLUMNS),
        making="\n".join(_making(board) for board in _made_apart(boards)),
        targets=", ".join(f"{100 * target:g}" for target in TARGETS),
        plotly=PLOTLY,
        scripts="\n".join(f'<script src="{name}" defer></script>' for name in SCRIPTS),
        site=_json({"data": data, **_site(boards, looks)}),
    )


def _first(boards: Sequence[Board]) -> Board:
    """Return the board that a reader sees first: the largest budget of the first track."""
    return max((board for board in boards if board.track == boards[0].track), key=lambda board: board.budget)


def _shown(boards: Sequence[Board], looks: dict[str, Hue]) -> list[int]:
    """Return the numbers of the names whose curves a track's reader sees first.

    They are those ahead on its first board and, in C, whoever steers, for whom there is that track.
    """
    first = _first(boards)
    ranked = [row.name for row in first.ranked if row.kind == "agent"]
    steering = [row.name for row in first.ranked if row.steers]
    names = {SBS, VBS, *ranked[:AT_FIRST], *steering}
    return [hue.number for name, hue in looks.items() if name in names]


def _named(boards: Sequence[Board]) -> list[str]:
    """Return the names of all rows: agents first, by rank on the first board that has them."""
    rows = [row for board in (_first(boards), *boards) for row in board.ranked]
    return list(dict.fromkeys(row.name for row in sorted(rows, key=lambda row: row.kind)))


def _choices(boards: Sequence[Board]) -> str:
    """Return the links to the boards, a group for each track."""
    groups = []
    for track, (name, meaning) in TRACKS.items():
        links = "".join(
            f'<a href="#{board_id(board)}" data-choice="{board_id(board)}">{choice(board)}</a>'
            for board in boards
            if board.track == track
        )
        if links:
            groups.append(
                f'<span class="track" title="{escape(meaning)}"><b>{track}</b> {escape(name)} {links}</span>'
            )
    return "\n".join(groups)


def _panels(board: Board, looks: dict[str, Hue]) -> dict[str, str]:
    """Return a board's part of every section of the page."""
    ranked = "\n".join(marks.ranking_row(board, row, looks[row.name]) for row in board.ranked)
    parts = {
        "rankings": result(board)
        + HELP
        + _table("ranking", board, f"<thead><tr>{marks.headings()}</tr></thead>\n<tbody>{ranked}</tbody>")
        + "".join(f'<p class="failure">{escape(failure)}</p>' for failure in failures(board)),
        "intervals": f'<div class="plot">{marks.intervals(board, looks)}</div>',
        "versus": _table("versus", board, versus(board, looks)) if len(board.scenarios) > 1 else ONE_MAP,
        "heats": _table("heat", board, marks.heat(board, looks, lambda i: f"#{board_id(board)}/{i}")),
    }
    return {
        name: f'<div class="panel" data-board="{board_id(board)}">{part}</div>'
        for name, part in parts.items()
    }


def _table(kind: str, board: Board, inner: str) -> str:
    spoken = f"{kind}, {board_label(board)}"
    return (
        f'<div class="scroller" role="region" aria-label="{escape(spoken)}" tabindex="0">'
        f'<table class="{kind}">{inner}</table></div>'
    )


def _made_apart(boards: Sequence[Board]) -> list[Board]:
    """Return the boards without those that were made by the same command, with the same manifest."""
    made = {
        json.dumps([board.command, board.manifest], sort_keys=True, default=str): board for board in boards
    }
    return list(made.values())


def _making(board: Board) -> str:
    versions = board.manifest.get("versions", {})
    rest = {key: value for key, value in board.manifest.items() if key != "versions"}
    return (
        f"<pre><code>{escape(board.command)}</code></pre>\n{_facts(versions)}"
        f"<details><summary>The rest of the manifest</summary>{_facts(rest)}</details>"
    )


def _facts(record: Mapping[str, Any]) -> str:
    return f'<dl class="versions">{"".join(definition(name, value) for name, value in flat(record))}</dl>'


def _site(boards: Sequence[Board], looks: dict[str, Hue]) -> dict[str, Any]:
    """Return what the scripts know of the site: names and hues, the boards, and the numbers of the curves."""
    tracks = {
        track: [board for board in boards if board.track == track]
        for track in dict.fromkeys(board.track for board in boards)
    }
    return {
        "first": board_id(_first(boards)),
        "legend": [looks[name].number for name in _named(boards) if name != EXACT],
        "agents": [{"name": name, "colour": hue.colour, "dash": hue.dash} for name, hue in looks.items()],
        "shown": {track: _shown(played, looks) for track, played in tracks.items()},
        "boards": {
            board_id(board): {
                "label": board_label(board),
                "track": board.track,
                "budget": board.budget,
                "maps": board.scenarios,
                "order": [looks[row.name].number for row in board.ranked if row.kind == "agent"],
                "profile": profile(board, looks) if len(board.scenarios) > 1 else None,
            }
            for board in boards
        },
        "anytime": {track: anytime(played, looks) for track, played in tracks.items()},
        "reached": {
            track: reached(played, looks) if len(played[0].scenarios) > 1 else []
            for track, played in tracks.items()
        },
    }
