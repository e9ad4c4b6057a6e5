"""Rows of the benchmark files beside a developer's checkout, with the lengths that are declared or checked for them.

A row is (world, start, goal, {column of the checks: length}) with cells of edge 1; columns without a length are left
out, and so are rows that start and end in one cell, or lead nowhere.
"""

import csv
from functools import lru_cache

from antgym.maps.readers import read_map, read_scenarios
from antgym.maps.world import GridWorld

UNIT = (1.0, 1.0, 1.0)
COLUMNS = ("octile_nocut", "octile_cut_one_side", "octile_any_diagonal", "four_connected")


@lru_cache(maxsize=2)
def in_cells(path, **options):
    """The world of a map file, with cells of edge 1."""
    return GridWorld(read_map(path, **options).world.free, UNIT)


def lengths_of(check, columns=COLUMNS):
    return {name: float(check[name]) for name in columns if check[name] not in ("", "none")}


def checks_of(path):
    """The rows of a CSV file."""
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def rows_of_scen(scen, checks):
    """Rows of a .scen file."""
    rows = read_scenarios(scen)
    for i, (row, check) in enumerate(zip(rows, checks, strict=True)):
        found = lengths_of(check)
        if row.start != row.goal and found:
            yield rows.world(i), row.start, row.goal, found


def rows_of_voxels(folder, name):
    """Rows of a .3dscen file with their declared length."""
    rows = read_scenarios(folder / f"{name}.3dmap.3dscen")
    for i, row in enumerate(rows):
        yield rows.world(i), row.start, row.goal, {"declared": row.length}


def rows_of_forest(folder, name):
    """Rows of an OctoMap forest; what it says nothing of is free, as the checks have it."""
    world = in_cells(folder / f"{name}.bt", unknown="free")
    for check in checks_of(folder / f"{name}_checks.csv"):
        start, goal = (tuple(int(check[end + axis]) for axis in "xyz") for end in "sg")
        yield world, start, goal, lengths_of(check, ("n26_no_cut", "n26_target_only"))


def rows_of_pixels(path, checks):
    """Rows of pairs on a picture or a ROS map; the checks count pixels from the top left."""
    world = in_cells(path)
    for check in checks:
        start, goal = (
            (int(check[f"{end}x_col"]), world.shape[1] - 1 - int(check[f"{end}y_row"])) for end in "sg"
        )
        yield world, start, goal, lengths_of(check)
