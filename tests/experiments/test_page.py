"""The page: complete, escaped, self-contained, and alive in a browser where there is one."""

import json
import re
import shutil
import subprocess
import sys
from dataclasses import replace
from html import escape, unescape
from html.parser import HTMLParser

import numpy as np
import pytest
from boards import AGENTS, SCENARIOS, board, fake_board, mountain, row

from antgym.errors import MissingExtraError
from experiments.board import EXACT, Picture
from experiments.columns import COLUMNS, percent
from experiments.report.page import write_page
from experiments.report.picture import drawn, figure, stretch

HOSTILE = "</script><script>alert(1)</script><img src='https://evil.example/x' onerror=alert(2)>\"&"
BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
LISTEN = """<script>
window.problems = [];
const note = (what) => window.problems.push(String(what));
addEventListener("error", (event) => note(event.message ?? event.target), true);
addEventListener("unhandledrejection", (event) => note(event.reason));
addEventListener("securitypolicyviolation", (event) => note(event.blockedURI));
console.error = note;
window.alert = note;
</script>"""
PROBE = """<script>addEventListener("load", () => {
  const order = () => [...document.querySelectorAll(".ranking tbody th")].map((cell) => cell.dataset.value);
  const buttons = [...document.querySelectorAll(".ranking thead button")];
  const [, agent, gap] = buttons, optimism = buttons.at(-1);
  const after = (button) => { button.click(); return order(); };
  const shown = () => document.getElementById("scene")._fullData.slice(1).map((trace) => trace.visible);
  const seen = { start: order(), gap: after(gap), name: after(agent), optimism: after(optimism) };
  seen.sort = optimism.parentElement.getAttribute("aria-sort");
  seen.shown = shown();
  document.querySelector('[data-line="0"]').click();
  seen.toggled = shown();
  seen.loaded = performance.getEntriesByType("resource").map((entry) => entry.name);
  seen.problems = window.problems;
  const out = document.createElement("pre");
  out.id = "probe";
  out.textContent = JSON.stringify(seen);
  document.body.append(out);
});</script>"""


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


def written(shown, folder):
    write_page(shown, folder / "index.html")
    return (folder / "index.html").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    return written(fake_board(), tmp_path_factory.mktemp("page"))


def hostile_board():
    picture = mountain(np.random.default_rng(0), shape=(8, 8, 16))
    paths, lengths = ({**old, HOSTILE: old["ga"]} for old in (picture.paths, picture.lengths))
    picture = replace(picture, name=HOSTILE, paths=paths, lengths=lengths)
    rows = [
        row("ga", optimism=0.1),
        row("pso", [[0.2, 0.2], [0.5, 0.6]], optimism=0.05),
        row(EXACT, [[0, 0], [0, 0]], "reference"),
    ]
    rows.append(row(HOSTILE, [[0.9, 0.9], [0.8, 0.8]], summary=HOSTILE, card={HOSTILE: HOSTILE}))
    texts = {
        "title": HOSTILE,
        "command": HOSTILE,
        "scenarios": (HOSTILE, "b"),
        "manifest": {"versions": {HOSTILE: HOSTILE}, HOSTILE: {"a": HOSTILE}},
    }
    return board(*rows, pictures=(picture,), **texts)


def test_page_says_what_it_is_and_holds_every_row_map_and_column(page):
    text = " ".join(" ".join(Reader(page).texts).split())
    assert "Agents pick four numbers (α, β, ρ, Q) for an ant-colony path planner" in text
    for one in fake_board().rows:
        assert f'data-value="{one.name}"' in page
        assert escape(one.summary) in page
        assert f">{percent(one.mean)} <" in page
    for column in COLUMNS:
        assert escape(column.meaning) in page
    assert all(name in page for name in SCENARIOS)


def test_page_tells_the_command_and_every_version(page):
    shown = fake_board()
    assert escape(shown.command) in page
    for name, version in shown.manifest["versions"].items():
        assert f"<dt>{name}</dt><dd>{version}</dd>" in page
    assert "<dt>host.<wbr>" in page or "<dt>host.cpu</dt>" in page


def test_page_says_who_is_ahead_and_whether_that_is_sure():
    from experiments.report.page import _result

    low, high = np.full((4, 2), 0.1), np.full((4, 2), 0.5)
    assert "<strong>a</strong> is ahead" in _result(board(row("a", low), row("b", high)))
    assert "not told apart from <strong>b</strong>" in _result(board(row("a", low), row("b", low)))


def test_page_loads_nothing(page):
    assert Reader(page).links == ["data:,"]
    style = page[page.index("<style>") : page.index("</style>")]
    assert "url(" not in style
    assert "@import" not in style
    assert "default-src &#x27;none&#x27;" in page


def test_hostile_texts_are_escaped(tmp_path):
    reader, plain = Reader(written(hostile_board(), tmp_path)), Reader(written(fake_board(), tmp_path))
    assert reader.tags.count("script") == plain.tags.count("script")
    assert "img" not in reader.tags
    assert reader.links == ["data:,"]
    assert HOSTILE in "".join(reader.texts)


def test_a_page_without_a_picture_needs_no_plotly(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "plotly.offline", None)
    assert "Plotly" not in written(fake_board(pictures=()), tmp_path)
    with pytest.raises(MissingExtraError, match=r"antgym\[viz\]"):
        write_page(fake_board(), tmp_path / "other.html")
    assert [path.name for path in tmp_path.iterdir()] == ["index.html"]


def test_one_map_one_seed_and_a_board_of_references_still_make_a_page(tmp_path):
    assert "ga" in written(board(row(gaps=[[0.2]])), tmp_path)
    assert "ga" in written(board(row(kind="reference")), tmp_path)


def test_a_failed_write_leaves_the_old_page_and_nothing_else(tmp_path, monkeypatch):
    old = written(board(row()), tmp_path)
    monkeypatch.setattr("os.replace", lambda *_: (_ for _ in ()).throw(OSError("disk full")))
    with pytest.raises(OSError, match="disk full"):
        write_page(board(row("pso")), tmp_path / "index.html")
    assert (tmp_path / "index.html").read_text(encoding="utf-8") == old
    assert len(list(tmp_path.iterdir())) == 1


def test_picture_draws_every_path_in_world_units_and_the_exact_one_dashed():
    shown = fake_board()
    (picture,) = shown.pictures
    names, lines = drawn(shown, picture), figure(shown, picture)["lines"]
    assert names[0] == EXACT
    assert set(names) == {EXACT, *AGENTS}
    assert [line["line"]["dash"] for line in lines[:2]] == ["dash", "solid"]
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


@pytest.mark.skipif(
    BROWSER is None, reason="no chromium, chromium-browser or google-chrome to open the page with"
)
def test_page_works_in_a_browser(tmp_path):
    html = written(hostile_board(), tmp_path)
    html = html.replace("<head>", f"<head>{LISTEN}", 1)
    start, end = html.rsplit("</body>", 1)
    (tmp_path / "probe.html").write_text(f"{start}{PROBE}</body>{end}", encoding="utf-8")
    seen = opened(tmp_path / "probe.html")
    assert seen["problems"] == []
    assert seen["loaded"] == []
    assert seen["start"] == [EXACT, "ga", "pso", HOSTILE]
    assert seen["gap"] == [HOSTILE, "pso", "ga", EXACT]
    assert seen["name"] == [HOSTILE, EXACT, "ga", "pso"]
    assert seen["optimism"][:2] == ["pso", "ga"]  # those without a number go last
    assert seen["sort"] == "ascending"
    assert [seen["shown"][0], seen["toggled"][0]] == [True, False]


def opened(path):
    flags = [
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--use-angle=swiftshader",
        "--enable-unsafe-swiftshader",
    ]
    flags += [
        f"--user-data-dir={path.parent / 'profile'}",
        "--window-size=400,600",
        "--virtual-time-budget=2000",
        "--dump-dom",
    ]
    done = subprocess.run(
        [BROWSER, *flags, path.as_uri()], capture_output=True, text=True, timeout=60, check=True
    )
    return json.loads(unescape(re.search(r'<pre id="probe">(.*?)</pre>', done.stdout, re.S)[1]))
