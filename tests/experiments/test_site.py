"""The site in a browser, opened from a disk: it sorts, filters, shows maps, by mouse and keyboard, on its own."""

import shutil
from dataclasses import replace

import numpy as np
import pytest
from boards import HOSTILE, recorded, row, small_site

from experiments.report.page import write_site

BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
FLAGS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
DESKTOP, PHONE = {"width": 1280, "height": 900}, {"width": 390, "height": 844}
TEXTS = ".lede, .help, .result, .ranking td, .ranking a, .card p, .heat td, .versus td, figcaption, .tools a"
CONTRAST = """(nodes) => nodes.filter((node) => node.checkVisibility()).map((node) => {
  const paint = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
  const linear = (v) => (v > 0.04 ? ((v + 0.055) / 1.055) ** 2.4 : v / 12.92);
  const light = (colour) => {
    paint.fillStyle = colour;
    paint.fillRect(0, 0, 1, 1);
    const [r, g, b] = [...paint.getImageData(0, 0, 1, 1).data].map((v) => linear(v / 255));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b + 0.05;
  };
  let behind = node;
  while (getComputedStyle(behind).backgroundColor === "rgba(0, 0, 0, 0)") behind = behind.parentElement;
  const pair = [light(getComputedStyle(behind).backgroundColor), light(getComputedStyle(node).color)];
  return { text: node.textContent, ratio: Math.max(...pair) / Math.min(...pair) };
})"""

sync_api = pytest.importorskip("playwright.sync_api", reason="playwright drives the browser")
pytestmark = pytest.mark.skipif(BROWSER is None, reason="no chromium, chromium-browser or google-chrome")
expect = sync_api.expect
expect.set_options(
    timeout=30_000
)  # a scene takes a second to draw on a processor, and much more on a busy one


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("site")
    *boards, control = (replace(one, title=HOSTILE) for one in small_site("ga", "pso", HOSTILE))
    schedule = row("schedule", np.full((3, 2), 0.25))
    boards.append(replace(control, rows=(*control.rows, schedule)))
    write_site(boards, recorded(boards, place), place)
    return place


@pytest.fixture(scope="module")
def problems():
    return []


@pytest.fixture(scope="module")
def opened(folder, problems):
    """The page, from a file:// address; whatever it complains of or asks others for is a problem."""

    def ask(request):
        if not request.url.startswith((folder.as_uri(), "data:", "blob:")):
            problems.append(request.url)

    with sync_api.sync_playwright() as play:
        browser = play.chromium.launch(executable_path=BROWSER, args=FLAGS)
        page = browser.new_page(viewport=DESKTOP)
        page.on("console", lambda said: problems.append(said.text) if said.type == "error" else None)
        page.on("pageerror", lambda error: problems.append(str(error)))
        page.on("dialog", lambda dialog: (problems.append(dialog.message), dialog.dismiss()))
        page.on("request", ask)
        page.goto((folder / "index.html").as_uri())
        yield page
        browser.close()


@pytest.fixture
def page(opened, problems):
    opened.set_viewport_size(DESKTOP)
    opened.locator("#filter").fill("")
    go(opened, "A-20")
    yield opened
    assert problems == []


def go(page, address):
    page.evaluate(f"location.hash = '#{address}'")


def ranking(page):
    return page.locator(".ranking tbody tr:visible th a")


def drawn(page, plot):
    return page.locator(f"#{plot} .scatterlayer .trace .js-line:not([style*='stroke-width: 0'])")


def test_page_opens_from_a_disk_sorts_and_filters(page):
    expect(ranking(page)).to_have_text(["exact planner", HOSTILE, "pso", "ga"])
    page.get_by_role("button", name="mean gap").click()
    expect(ranking(page)).to_have_text(["ga", "pso", HOSTILE, "exact planner"])
    page.get_by_label("agents", exact=True).fill("GA, exact")
    expect(ranking(page)).to_have_text(["ga", "exact planner"])
    expect(page.locator("#filtered")).to_have_text("2 of 5")
    expect(page.locator(".versus tbody tr:visible")).to_have_count(1)
    page.get_by_label("intervals").check()
    expect(page.locator(".versus:visible small")).to_have_count(6)
    expect(drawn(page, "profile")).to_have_count(1)
    page.get_by_label("agents", exact=True).fill("zzz")
    expect(page.locator("#filtered")).to_have_text("no agent matches")
    for plot in ("anytime", "profile"):
        expect(page.locator(f"#{plot} .annotation")).to_have_text("no agent matches")
        expect(page.locator(f"#{plot} .xtick")).to_have_count(0)


def test_profiles_go_in_steps_over_an_axis_with_numbers(page):
    expect(page.locator("#profile .xtick text").nth(3)).to_be_visible()
    assert page.evaluate("document.getElementById('profile')._fullData.at(-1).line.shape") == "hv"


@pytest.mark.slow
def test_a_board_is_chosen_and_its_curves_are_drawn(page):
    page.locator("[data-choice=B-0]").click()
    expect(page.locator(".panel:visible h2")).to_have_text("Track B, after training: 0 trials on each map")
    for plot in ("anytime", "reached"):
        expect(page.locator(f"#{plot} .xtick text")).to_have_text(["0", "5"])
        expect(drawn(page, plot)).to_have_count(3)
    expect(page.locator(".legend li", has_text="schedule")).to_be_hidden()  # it steers, and is in C alone
    page.locator("[data-choice=C-1]").click()
    for plot in ("anytime", "reached"):
        expect(page.locator(f"#{plot}")).to_be_hidden()  # one budget makes no curve
    expect(page.locator("#curves-title")).to_have_text("Tails")
    expect(page.locator(".legend button", has_text="schedule")).to_have_attribute("aria-pressed", "true")
    expect(drawn(page, "profile")).to_have_count(4)
    pso = page.locator(".legend button", has_text="pso")
    pso.click()
    page.mouse.move(0, 0)
    expect(drawn(page, "profile")).to_have_count(3)
    page.locator("[data-choice=A-20]").click()
    expect(page.locator("#curves-title")).to_have_text("Budgets and tails")
    expect(pso).to_have_attribute("aria-pressed", "false")  # what a reader has dropped stays dropped
    expect(drawn(page, "profile")).to_have_count(2)
    pso.click()


@pytest.mark.slow
def test_a_map_shows_paths_gaps_and_the_trials_behind_a_number(page):
    page.locator(".heat a:visible", has_text="one").click()
    expect(page.locator("#scene canvas").first).to_be_visible()
    page.locator(".toggles button", has_text="exact").click()
    expect(page.locator(".toggles button[aria-pressed=true]")).to_have_count(2)
    lines = "document.getElementById('scene')._fullData.slice(1).map((line) => line.visible)"
    assert page.evaluate(lines) == [False, True, True]
    expect(page.locator(".seeds tbody tr")).to_have_count(4)
    page.locator(".seeds tr", has_text="pso").locator("a").first.click()
    expect(page.locator("#run-title")).to_have_text("pso on one, seed 0")
    lost, found = page.locator(".trials tbody tr").all()
    assert lost.inner_text().split("\t")[:7] == ["0", "0.900", "0.800", "0.700", "0.600", "10.000", "no path"]
    assert found.inner_text().split("\t")[5:] == ["1.500", "150", "50.0", "recommended"]
    page.go_back()
    expect(page.locator("#run")).to_be_hidden()
    page.locator("#map-choice").select_option("two")
    expect(page.locator("#map-title")).to_have_text("two")
    expect(page.locator("#view")).to_be_hidden()  # the board has no picture of it


@pytest.mark.slow
def test_a_run_that_was_steered_shows_its_settings_block_by_block(page):
    go(page, "C-1/1/0/0")
    expect(page.locator("#run-title")).to_have_text("ga on two, seed 0")
    rows = page.locator(".trials tbody tr").all_inner_texts()
    assert [row.split("\t") for row in rows] == [
        [str(i), "0.100", "0.200", "0.300", "0.400"] for i in range(1, 11)
    ]


@pytest.mark.slow
def test_everything_works_by_keyboard(page):
    page.get_by_role("button", name="success").focus()
    page.keyboard.press("Enter")
    expect(page.locator(".ranking:visible [aria-sort=ascending]")).to_have_text("success\N{NO-BREAK SPACE}%")
    page.keyboard.press("Tab")
    assert page.evaluate("getComputedStyle(document.activeElement).outlineStyle") != "none"
    page.locator("[data-choice=A-1]").focus()
    page.keyboard.press("Enter")
    expect(page.locator(".panel:visible h2")).to_have_text("Track A, per map: 1 trial on each map")
    page.locator(".heat a:visible").nth(1).focus()
    page.keyboard.press("Enter")
    expect(page.locator("#map-title")).to_be_focused()
    page.locator(".seeds a").first.focus()
    page.keyboard.press("Enter")
    expect(page.locator("#run-title")).to_be_focused()


@pytest.mark.slow
def test_a_phone_scrolls_tables_and_not_the_page(page):
    page.set_viewport_size(PHONE)
    for board, place in (("A-1", ""), ("B-5", ""), ("C-1", ""), ("A-20", "/0/0/0")):
        go(page, board + place)
        expect(page.locator(f"[data-choice={board}]")).to_have_attribute("aria-current", "true")
        assert page.evaluate("document.documentElement.scrollWidth") <= PHONE["width"]
    expect(page.locator("#run")).to_be_visible()
    assert page.evaluate("document.documentElement.scrollWidth") <= PHONE["width"]
    assert page.locator(".scroller:has(.ranking):visible").evaluate(
        "node => node.scrollWidth > node.clientWidth"
    )
    page.set_viewport_size({"width": 320, "height": 640})  # the links to the boards are wider than that
    assert page.evaluate("document.documentElement.scrollWidth") <= 320


@pytest.mark.slow
@pytest.mark.parametrize(("scheme", "paper"), [("light", "rgb(251, 250, 247)"), ("dark", "rgb(21, 25, 28)")])
def test_texts_stand_out_from_what_is_behind_them(page, scheme, paper):
    page.emulate_media(color_scheme=scheme)
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == paper
    assert [one for one in page.locator(TEXTS).evaluate_all(CONTRAST) if one["ratio"] < 4.5] == []
    assert page.evaluate("document.getElementById('profile').layout.font.color") == page.evaluate(
        "antgym.colour('muted')"
    )


@pytest.mark.slow
def test_a_page_without_its_data_says_so(page, folder, problems):
    (lost,) = folder.glob("data/*/B-5-2.js")
    lost.unlink()
    go(page, "B-5/2")
    expect(page.get_by_role("alert")).to_contain_text("copy the folder as a whole")
    assert [problem for problem in problems if "ERR_FILE_NOT_FOUND" not in problem] == []
    problems.clear()
