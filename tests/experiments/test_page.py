"""The site: complete, escaped, true to its ledger, whole or not there; test_site opens it in a browser."""

import json
import re
import sys
from dataclasses import replace
from html import escape
from html.parser import HTMLParser

import numpy as np
import pytest
from boards import AGENTS, HOSTILE, SCENARIOS, board, fake_board, recorded, row, small_site

import agents
from antgym import load_suite
from antgym.errors import AntgymError, LedgerError, MissingExtraError
from experiments.board import EXACT, SBS, VBS, Picture
from experiments.columns import COLUMNS, percent
from experiments.pictures import draw
from experiments.report.cards import definition
from experiments.report.hues import hues
from experiments.report.marks import intervals, label
from experiments.report.page import write_site
from experiments.report.picture import drawn, figure, stretch
from experiments.report.titles import ahead
from experiments.tracks import Round

SCRIPTS = ["page.js", "sorting.js", "curves.js", "scene.js", "maps.js"]


class Reader(HTMLParser):
    """Collects what a page would load, its elements and its text outside scripts."""

    def __init__(self, html):
        super().__init__()
        self.links, self.tags, self.texts, self.inside = [], [], [], []
        self.feed(html)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.inside.append(tag)
        self.links += [value for key, value in attrs if key in ("src", "href", "srcset", "action", "data")]

    def handle_endtag(self, tag):
        self.inside.append("")

    def handle_data(self, data):
        if not self.inside or self.inside[-1] not in ("script", "style"):
            self.texts.append(data)


def written(boards, folder):
    return write_site(boards, recorded(boards, folder), folder).read_text(encoding="utf-8")


def delivered(folder, name):
    """The record of a map, as the script that delivers it says."""
    (path,) = folder.glob(f"data/*/{name.replace('/', '-')}.js")
    call = path.read_text(encoding="utf-8")
    return json.loads(re.fullmatch(rf'antgym\.deliver\("{name}", (.*)\);\n', call)[1])


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    folder = tmp_path_factory.mktemp("site")
    written(small_site("ga", "pso"), folder)
    return folder


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    folder = tmp_path_factory.mktemp("page")
    shown = replace(fake_board(), rows=tuple(replace(one, kind="reference") for one in fake_board().rows))
    recorded([], folder)  # references may be computed and need no runs
    return write_site([shown], folder, folder).read_text(encoding="utf-8")


def test_page_says_what_it_is_and_holds_every_row_map_and_column(page):
    text = " ".join(" ".join(Reader(page).texts).split())
    assert "Agents pick the parameters of a swarm path planner" in text
    for one in fake_board().rows:
        assert f'data-value="{one.name}"' in page
        assert escape(one.summary) in page
        assert f">{percent(one.mean)} <" in page
    for column in COLUMNS:
        assert escape(column.meaning) in page
    assert all(name in page for name in SCENARIOS)


def test_the_world_of_a_board_comes_first_and_is_marked(tmp_path):
    recorded([], tmp_path)
    rows = tuple(replace(one, kind="reference") for one in fake_board().rows)
    manifest = {**fake_board().manifest, "config": {"suite": "room-v0"}}
    board = replace(fake_board(), rows=rows, manifest=manifest)
    page = write_site([board], tmp_path, tmp_path).read_text(encoding="utf-8")
    first = page.partition('<div class="world">')[2].partition("</h3>")[0]
    assert "Room" in first
    assert page.count('<span class="own">this board</span>') == first.count("this board") == 1


def test_page_tells_the_command_and_every_version(page):
    shown = fake_board()
    assert escape(shown.command) in page
    for name, version in shown.manifest["versions"].items():
        assert f"<dt>{name}</dt><dd>{version}</dd>" in page
    assert "<dt>host.<wbr>" in page or "<dt>host.cpu</dt>" in page


def test_page_says_who_competes_alone_and_whom_references_outdo():
    """The bounds are better than anybody, and say nothing against who is ahead."""
    low, high = np.full((4, 2), 0.1), np.full((4, 2), 0.5)
    bounds = [row(name, np.zeros((4, 2)), "reference") for name in (EXACT, "virtual best (bound)")]
    said = ahead(board(row("a", high), row("r", low, "reference"), *bounds))
    assert said.startswith("Only <strong>a</strong> competes here, with a mean gap of 50.0")
    assert said.endswith("; 1 reference is better.")
    assert "reference" not in ahead(board(row("a", low), row("b", high), *bounds))


def test_page_says_who_is_ahead_and_whether_that_is_sure():
    low, high = np.full((4, 2), 0.1), np.full((4, 2), 0.5)
    assert "<strong>a</strong> is ahead" in ahead(board(row("a", low), row("b", high)))
    assert "not told apart from <strong>b</strong>" in ahead(board(row("a", low), row("b", low)))


def test_a_name_breaks_where_its_words_end_and_nowhere_within_them():
    assert label("halving.py:Halving") == "halving.py:<wbr>Halving"
    assert label("cma_es<") == "cma_<wbr>es&lt;"


def test_what_a_card_does_not_know_is_a_dash():
    assert definition("training trials", None) == "<div><dt>training trials</dt><dd>–</dd></div>"
    assert definition("training trials", 0) == "<div><dt>training trials</dt><dd>0</dd></div>"


def test_only_three_references_are_lines_across_the_intervals_of_all():
    kinds = dict.fromkeys((EXACT, SBS, VBS, "random_search", "published_default"), "reference")
    shown = board(*(row(name, kind=kind) for name, kind in kinds.items()), row("ga"))
    assert intervals(shown, hues([shown])).count('class="aim"') == 3 * len(shown.rows)


def test_site_loads_its_own_files_and_nothing_else(site):
    page = (site / "index.html").read_text(encoding="utf-8")
    loaded = [link for link in Reader(page).links if not link.startswith("#")]
    assert loaded == ["data:,", "page.css", "plotly.min.js", *(f"scripts/{name}" for name in SCRIPTS)]
    assert all((site / link).is_file() for link in loaded[1:])
    assert "script-src &#x27;self&#x27;;" in page
    style = (site / "page.css").read_text(encoding="utf-8")
    assert "url(" not in style
    assert "@import" not in style


def test_every_board_has_its_part_of_every_section_and_a_record_of_every_map(site):
    page = (site / "index.html").read_text(encoding="utf-8")
    for one in ("A-1", "A-20", "B-0", "B-5", "C-1"):
        assert page.count(f'class="panel" data-board="{one}"') == 4
        assert len(list(site.glob(f"data/*/{one}-[012].js"))) == 3


def test_a_map_tells_gaps_and_the_ledgers_rows_behind_them(site):
    record = delivered(site, "A-20/1")
    shown = small_site("ga", "pso")[1]
    assert record["name"] == "two"
    assert record["parameters"] == ["α", "β", "ρ", "Q"]
    assert [one["agent"] for one in record["rows"]] == [
        hues([shown])[one.name].number for one in shown.ranked
    ]
    exact, best, _ = record["rows"]
    assert exact["runs"] == [None, None]
    assert best["gaps"] == [round(gap, 6) for gap in shown.ranked[1].gaps[1]]
    assert best["runs"][0]["trials"] == [[0.9, 0.8, 0.7, 0.6, 10.0, None], [0.1, 0.2, 0.3, 0.4, 1.5, 150.0]]
    assert best["runs"][0]["unit"] == [0.1, 0.2, 0.3, 0.4]


def test_a_map_has_its_picture_where_the_board_has_one(site):
    assert [path["agent"] for path in delivered(site, "A-20/0")["picture"]["paths"]] == [
        2,
        1,
        0,
    ]  # the exact one first
    assert delivered(site, "A-20/1")["picture"] is None


def test_curves_hold_every_budget_of_a_track_and_profiles_end_at_one(site):
    page = (site / "index.html").read_text(encoding="utf-8")
    data = json.loads(re.search(r'id="site">(.*?)</script>', page)[1])
    assert [curve["budgets"] for curve in data["anytime"]["A"]] == [[1, 20], [1, 20]]
    assert [curve["budgets"] for curve in data["anytime"]["B"]] == [[0, 5], [0, 5]]
    for one in data["boards"].values():
        assert all(shares["shares"] == sorted(shares["shares"]) for shares in one["profile"]["rows"])
        assert all(shares["shares"][-1] == 1 for shares in one["profile"]["rows"])
    assert data["first"] == "A-20"


def test_every_track_begins_with_the_curves_of_those_ahead_and_control_with_whoever_steers(tmp_path):
    """Eight are tuned; in C two others steer, one is behind all, and so is somebody's own, whose setting stays."""
    constants = list(agents.CATALOGUE)[2:10]
    tuned = [row(name, [[0.1 + i / 100] * 2] * 2) for i, name in enumerate(constants)]
    tuned.append(row("mine.py:Mine", [[0.8] * 2] * 2))
    static = row(SBS, kind="reference")
    steered = [row(name, [[gap] * 2] * 2, steers=True) for name, gap in (("x", 0.01), ("y", 0.9))]
    boards = [board(*tuned, static), board(*tuned[::-1], *steered, track="C", budget=1)]
    data = json.loads(re.search(r'id="site">(.*?)</script>', written(boards, tmp_path))[1])
    shown = {track: {data["agents"][i]["name"] for i in numbers} for track, numbers in data["shown"].items()}
    assert shown == {"A": {*constants[:6], SBS}, "C": {"x", *constants[:5], "y", SBS}}


def test_targets_reached_hold_every_budget_of_a_track_by_eye(tmp_path):
    """Of 20, 10, 5, 2, 1 and 0.5 %, a gap of 30 % reaches none, 3 % three and 0 all; one map has no band."""
    few, more = [[0.3, 0.3], [0.3, 0.03]], [[0.03, 0.03], [0.0, 0.0]]
    page = written([board(row(gaps=few), budget=1), board(row(gaps=more), budget=20)], tmp_path / "two")
    (curve,) = json.loads(re.search(r'id="site">(.*?)</script>', page)[1])["reached"]["A"]
    assert (curve["budgets"], curve["means"]) == ([1, 20], [0.125, 0.75])
    assert curve["lows"] < curve["means"] < curve["highs"]
    assert "a gap of 20, 10, 5, 2, 1, 0.5&nbsp;%" in page
    assert '"reached":{"A":[]}' in written([board(row(gaps=[[0.2]]))], tmp_path / "one")


def test_a_failure_is_told_below_the_ranking(tmp_path):
    failed = replace(row("pso", [[1.0, 1.0]] * 2), failure="2 of 4 runs failed: <late>")
    assert '<p class="failure">pso: 2 of 4 runs failed: &lt;late&gt;.</p>' in written(
        [board(row("ga"), failed)], tmp_path
    )


def test_who_beats_whom_by_eye(tmp_path):
    worse, better = [[0.5, 0.5]] * 3, [[0.1, 0.1]] * 3
    page = written([board(row("pso", worse), row("ga", better))], tmp_path)
    table = page[page.index('<table class="versus">') :]
    cells = re.findall(r"<b>(\d+)</b><small>([\d–]+)</small>", table[: table.index("</table>")])
    assert cells == [("100", "100–100"), ("0", "0–0")]  # ga, then pso


def test_agents_keep_their_hue_over_boards_and_references_share_one():
    boards = small_site("ga", "pso")
    looks = hues([*boards, board(row("pso"), row("sobol"), row("ga"), row("sbs", kind="reference"))])
    assert [looks[name].colour for name in ("ga", "pso", "sobol")] == ["hue-0", "hue-1", "hue-2"]
    assert (looks["sbs"].colour, looks[EXACT].colour) == ("reference", "exact")


def test_a_number_without_its_run_is_refused(tmp_path):
    boards = [board(row())]
    recorded(boards, tmp_path)
    other = [board(row(gaps=((0.1, 0.2), (0.3, 0.5))))]
    with pytest.raises(LedgerError, match=r"ga/20/map-1/1' has a gap of 0.4 in the ledger, 0.5 on the board"):
        write_site(other, tmp_path, tmp_path)
    with pytest.raises(LedgerError, match="no finished run 'pso/20/map-0/0'"):
        write_site([board(row("pso"))], tmp_path, tmp_path)
    with pytest.raises(LedgerError, match="is no ledger"):
        write_site(boards, tmp_path / "nowhere", tmp_path)
    assert not (tmp_path / "index.html").exists()


def test_a_damaged_line_is_named_and_one_cut_short_is_not_there_yet(tmp_path):
    boards = [board(row())]
    recorded(boards, tmp_path)
    with (tmp_path / "trials.jsonl").open("a") as file:
        file.write('{"run":"ga/20/map-0/0","kind":"tri')
    assert write_site(boards, tmp_path, tmp_path).is_file()
    with (tmp_path / "trials.jsonl").open("a") as file:
        file.write("\n")
    with pytest.raises(LedgerError, match="line 13 is damaged"):
        write_site(boards, tmp_path, tmp_path)


def test_hostile_texts_are_escaped(tmp_path):
    plain, texts = small_site("ga", "pso")[:2], {"title": HOSTILE, "command": HOSTILE}
    manifest = {"versions": {HOSTILE: HOSTILE}, HOSTILE: {"a": HOSTILE}}
    names = {"scenarios": ("one", HOSTILE, "three"), "manifest": manifest}
    hostile = [replace(one, **texts, **names) for one in small_site("ga", HOSTILE)[:2]]
    reader, other = Reader(written(hostile, tmp_path / "hostile")), Reader(written(plain, tmp_path / "plain"))
    assert reader.tags.count("script") == other.tags.count("script")
    assert "img" not in reader.tags
    assert reader.links == other.links
    assert HOSTILE in "".join(reader.texts)
    assert all("<" not in path.read_text() for path in tmp_path.glob("hostile/data/*/*.js"))


def test_without_plotly_nothing_is_written_and_its_extra_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "plotly.offline", None)
    with pytest.raises(MissingExtraError, match=r"antgym\[viz\]"):
        write_site([board(row())], recorded([board(row())], tmp_path), tmp_path / "site")
    assert not (tmp_path / "site").exists()


def test_boards_of_one_track_and_budget_or_none_make_no_site(tmp_path):
    with pytest.raises(AntgymError, match="got none"):
        write_site([], tmp_path, tmp_path)
    with pytest.raises(AntgymError, match="got A-20, A-20"):
        write_site([board(row()), board(row("pso"))], tmp_path, tmp_path)


def test_one_map_one_seed_and_a_board_of_references_still_make_a_page(tmp_path):
    assert "ga" in written([board(row(gaps=[[0.2]]))], tmp_path / "one")
    assert "ga" in written([board(row(kind="reference"))], tmp_path / "references")


def test_a_failed_write_leaves_the_old_page_and_a_new_one_takes_what_it_no_longer_needs(
    tmp_path, monkeypatch
):
    old = written([board(row(), budget=5)], tmp_path)
    recorded([board(row("pso"))], tmp_path / "ledger")
    with monkeypatch.context() as patch:
        patch.setattr("os.replace", lambda *_: (_ for _ in ()).throw(OSError(28, "disk full")))
        with pytest.raises(AntgymError, match="disk full"):
            write_site([board(row("pso"))], tmp_path / "ledger", tmp_path)
    assert (tmp_path / "index.html").read_text(encoding="utf-8") == old
    assert {path.name for path in tmp_path.glob("data/*/*")} == {"A-5-0.js", "A-5-1.js"}
    write_site([board(row("pso"))], tmp_path / "ledger", tmp_path)
    assert {path.name for path in tmp_path.glob("data/*/*")} == {"A-20-0.js", "A-20-1.js"}


def test_picture_draws_every_path_in_world_units():
    shown = fake_board()
    (picture,) = shown.pictures
    names, lines = drawn(shown, picture), figure(shown, picture)["lines"]
    assert names[0] == EXACT
    assert set(names) == {EXACT, *AGENTS}
    assert lines[0]["x"] == ((picture.paths[EXACT][:, 0] + 0.5) * 15).tolist()


def ground(free, heights=None):
    picture = Picture("p", heights, np.array(free, np.uint8), (1.0, 2.0, 3.0), {}, {}, 1.0)
    return figure(board(row()), picture)["ground"], stretch(picture)


def test_ground_is_the_heights_or_else_the_tops_of_blocked_cells():
    free = np.ones((2, 3, 4), np.uint8)
    free[1, 2, :2] = 0
    assert ground(free, np.array([[0.0, 1, 2], [3, 4, 5]]))[0]["z"] == [[0, 3], [1, 4], [2, 5]]
    assert ground(free)[0]["z"] == [[0, 0], [0, 0], [0, 6]]


def test_a_cave_is_drawn_as_the_faces_of_its_cells():
    free = np.zeros((3, 3, 3), np.uint8)
    free[1, 1, 1] = 1
    walls, factor = ground(free)
    corners = set(zip(walls["x"], walls["y"], walls["z"], strict=True))
    assert corners == {(x, y, z) for x in (1, 2) for y in (2, 4) for z in (3, 6)}
    assert len(walls["i"]) == 12
    assert factor == 1


def test_a_flat_world_is_drawn_as_blocks_and_not_stretched():
    walls, factor = ground([[[1], [0]], [[1], [1]]])
    assert len(walls["i"]) == 2 * 3  # two sides and a lid
    assert factor == 1


def test_flat_ground_is_stretched_by_three_at_most():
    free = np.ones((30, 30, 2), np.uint8)
    free[3, 4, 0] = 0
    assert ground(free)[1] == 3


def test_rooms_of_a_board_are_drawn_as_blocks_that_hide_no_path():
    items = load_suite("room-v0", "test")[:1]
    (picture,) = draw(Round("A", 5, (), items, 1), [row(gaps=[[0.1]])], None)
    assert figure(board(row()), picture)["ground"]["type"] == "mesh3d"
    assert stretch(picture) == 1
