"""Plain readers of the benchmark files beside a developer's checkout, as far as the tests of optima need them.

A row is (world, start, goal, {column of checks.csv: length}); columns without a length are left out.
"""

import csv
import gzip
from functools import lru_cache

import numpy as np

from antgym.maps.world import GridWorld

UNIT = (1.0, 1.0, 1.0)
CLASSES = ".GSB", "W", "T", "@O"  # terrain that can be walked without a change of class


@lru_cache(maxsize=4)
def letters(path):
    """The (width, height) letters of a MovingAI map."""
    lines = path.read_text().splitlines()
    return np.array([list(line) for line in lines[4 : 4 + int(lines[1].split()[1])]]).T


@lru_cache(maxsize=8)
def terrain(path, kind):
    """The cells of a map that can be walked from one of the given class."""
    return GridWorld(np.isin(letters(path), list(kind)), UNIT)


def rows_of_scen(scen, map_path, checks):
    """Rows of a .scen file, those that start and end in one cell and those that lead nowhere left out."""
    for line, check in zip(scen.read_text().splitlines()[1:], checks, strict=True):
        start, goal = np.array(line.split()[4:8], int).reshape(2, 2).tolist()
        found = lengths_of(check)
        if start != goal and found:
            kind = next(k for k in CLASSES if letters(map_path)[tuple(start)] in k)
            yield terrain(map_path, kind), tuple(start), tuple(goal), found


def lengths_of(check):
    columns = ("octile_nocut", "octile_cut_one_side", "octile_any_diagonal", "four_connected")
    return {name: float(check[name]) for name in columns if check[name] not in ("", "none")}


def checks_by_map(path):
    """The rows of a checks.csv or pairs.csv, by their map."""
    found = {}
    with path.open(newline="") as file:
        for row in csv.DictReader(file):
            found.setdefault(row["map"], []).append(row)
    return found


@lru_cache(maxsize=2)
def voxels(path):
    """The world of a .3dmap file, gzipped or not: a box and the cells in it that are blocked."""
    with (gzip.open if path.suffix == ".gz" else open)(path, "rt") as file:
        free = np.ones([int(n) for n in file.readline().split()[1:]], np.uint8)
        free[tuple(np.loadtxt(file, dtype=int).T)] = 0
    return GridWorld(free, UNIT)


def rows_of_voxels(folder, name):
    """Rows of a .3dscen file with their declared length."""
    packed = folder / f"{name}.3dmap.gz"
    world = voxels(packed if packed.exists() else packed.with_suffix(""))
    for line in (folder / f"{name}.3dmap.3dscen").read_text().splitlines()[2:]:
        cells = np.array(line.split()[:6], int).reshape(2, 3).tolist()
        yield world, *map(tuple, cells), {"declared": float(line.split()[6])}


@lru_cache(maxsize=2)
def forest(path):
    """The 100 x 100 x 50 cells of an OctoMap forest; unknown cells are free, as the checks have them."""
    header, stream = path.read_bytes().split(b"\ndata\n", 1)
    assert b"res 0.1" in header
    words = np.frombuffer(stream, "<u2").tolist()
    blocked, at = np.zeros((128, 128, 128), bool), iter(words)

    def descend(x, y, z, side):
        word = next(at)
        kinds = [word >> 2 * child & 3 for child in range(8)]
        half = side // 2
        for child, kind in enumerate(kinds):
            corner = [low + half * (child >> axis & 1) for axis, low in enumerate((x, y, z))]
            if kind == 3:
                descend(*corner, half)
            elif kind == 2:
                low = [c - o for c, o in zip(corner, (32768 - 50, 32768 - 50, 32768), strict=True)]
                blocked[tuple(slice(max(i, 0), max(i + half, 0)) for i in low)] = True

    descend(0, 0, 0, 1 << 16)
    return GridWorld(~blocked[:100, :100, :50], UNIT)


def rows_of_forest(folder, name):
    world = forest(folder / f"{name}.bt")
    with (folder / f"{name}_checks.csv").open(newline="") as file:
        for row in csv.DictReader(file):
            start, goal = (tuple(int(row[end + axis]) for axis in "xyz") for end in "sg")
            lengths = {column: float(row[column]) for column in ("n26_no_cut", "n26_target_only")}
            yield world, start, goal, lengths


def pixels_free(path):
    """Free cells of a ROS map, a binary PGM picture: all thresholds of these maps are 0.196."""
    lines = path.read_bytes().split(b"\n", 4)
    assert lines[0] == b"P5"
    size = next(line for line in lines[1:] if not line.startswith(b"#"))
    width, height = map(int, size.split())
    grey = np.frombuffer(path.read_bytes()[-width * height :], np.uint8).reshape(height, width).T
    return GridWorld((255 - grey.astype(float)) / 255 <= 0.196, UNIT)


def rows_of_pixels(folder, name):
    """Rows of pairs.csv on one ROS map; cells are pixels, counted from the top left."""
    world = pixels_free(folder / f"{name}.pgm")
    for check in checks_by_map(folder / "pairs.csv")[name]:
        start, goal = ((int(check[f"{end}x_col"]), int(check[f"{end}y_row"])) for end in "sg")
        yield world, start, goal, lengths_of(check)
