"""Make docs/board.png, the README's picture, from a leaderboard page: its 3D map beside its interval plot.

    python docs/picture.py out/board/index.html

Needs Chromium, which draws the page, and Pillow (with matplotlib), which makes the file small.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image

WIDTH, HEIGHT, COLOURS = 1500, 640, 192
STYLE = """
body { max-width: none; padding: 1.2rem 1.6rem; } header { display: none; }
main { display: grid; grid-template-columns: 1.15fr 1fr; gap: 2.5rem; align-items: start; }
section { margin: 0; display: none; } section > p { display: none; }
section:has(#picture), section:has(#intervals) { display: block; }
section:has(#picture) { order: -1; }
figure { grid-template-columns: minmax(0, 1fr) 12.5rem; gap: 0.6rem; } #scene { height: 32rem; }
h2 { font-size: 0; } h2::after { font-size: 1.4rem; }
#picture::after { content: "Paths on real terrain, and how much longer than the best"; }
#intervals::after { content: "Mean gap to the exact optimum, 95 % intervals"; }
.plot > div { grid-template-columns: 10rem minmax(0, 1fr) 9rem; }
.plot svg { height: 1.72rem; }
"""


def main(page: Path, picture: Path) -> None:
    """Write the picture of a page."""
    browser = shutil.which("chromium") or shutil.which("google-chrome") or sys.exit("no Chromium found")
    with tempfile.TemporaryDirectory() as folder:
        copy, shot = Path(folder) / "page.html", Path(folder) / "shot.png"
        copy.write_text(
            page.read_text(encoding="utf-8").replace("</style>", STYLE + "</style>", 1), encoding="utf-8"
        )
        flags = ["--headless", "--disable-gpu", "--hide-scrollbars", "--disable-background-networking"]
        flags += ["--no-sandbox"] * (os.geteuid() == 0)  # Chromium refuses to run as root with it
        flags += [f"--user-data-dir={folder}/profile", f"--window-size={WIDTH},{HEIGHT}"]
        flags += ["--virtual-time-budget=10000", f"--screenshot={shot}", copy.as_uri()]
        subprocess.run([browser, *flags], check=True, capture_output=True, timeout=120)
        Image.open(shot).convert("RGB").quantize(COLOURS).save(picture, optimize=True)
    print(f"{picture}: {picture.stat().st_size / 1000:.0f} KB")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(__file__).with_name("board.png"))
