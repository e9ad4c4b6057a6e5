"""Make docs/board.png, the README's picture, from a leaderboard page: one map's paths beside its interval plot.

    python docs/picture.py out/board/index.html#A-100/4

The address is the one that the page has when that map is open; the map has to be one with paths.

Needs Chromium and playwright, which draw the page, and Pillow, which makes the file small.
"""

import shutil
import sys
import tempfile
from pathlib import Path

from PIL import Image
from playwright.sync_api import sync_playwright

WIDTH, HEIGHT, COLOURS = 1500, 640, 256
FLAGS = [
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
]  # it may run as root, without a GPU
STYLE = """
body { max-width: none; padding: 1.2rem 1.6rem; } header, .tools { display: none; }
main { display: grid; grid-template-columns: 1.15fr 1fr; gap: 2.5rem; align-items: start; }
section { margin: 0; display: none; } #map > *, section > p { display: none; }
#map, #sure, #map > h2 { display: block; }
#map { order: -1; }
#map > .view { display: grid; grid-template-columns: minmax(0, 1fr) 12.5rem; gap: 0.6rem; }
#scene { height: 32rem; } figcaption { display: none; }
h2 { font-size: 0; } h2::after { font-size: 1.4rem; }
#map-title::after { content: "Paths on real terrain, and how much longer than the best"; }
#sure-title::after { content: "Mean gap to the exact optimum, 95 % intervals"; }
.plot > div { grid-template-columns: 10rem minmax(0, 1fr) 9rem; }
.plot svg { height: 1.72rem; }
"""


def main(page: Path, address: str, picture: Path) -> None:
    """Write the picture of a page that shows what an address asks for."""
    browser = shutil.which("chromium") or shutil.which("google-chrome") or sys.exit("no Chromium found")
    with tempfile.TemporaryDirectory() as folder:
        copy, shot = Path(folder) / "site", Path(folder) / "shot.png"
        for name in ("scripts", "data"):
            shutil.copytree(page.parent / name, copy / name)
        for name in (page.name, "page.css", "plotly.min.js"):
            shutil.copy(page.parent / name, copy)
        with (copy / "page.css").open("a", encoding="utf-8") as style:
            style.write(STYLE)
        with sync_playwright() as play:
            chromium = play.chromium.launch(executable_path=browser, args=FLAGS)
            shown = chromium.new_page(viewport={"width": WIDTH, "height": HEIGHT})
            shown.goto(f"{(copy / page.name).as_uri()}#{address}")
            shown.wait_for_selector("#scene canvas", timeout=60_000)
            shown.wait_for_timeout(3_000)  # until the last path of the scene is drawn
            shown.screenshot(path=shot)
            chromium.close()
        Image.open(shot).convert("RGB").quantize(COLOURS, Image.Quantize.FASTOCTREE).save(
            picture, optimize=True
        )
    print(f"{picture}: {picture.stat().st_size / 1000:.0f} KB")


if __name__ == "__main__":
    file, _, place = sys.argv[1].partition("#")
    main(Path(file), place, Path(__file__).with_name("board.png"))
