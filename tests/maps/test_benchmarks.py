"""Optima of published benchmarks, as their files declare them or as independent checks beside them found.

The default suite takes a sample of every map, evenly spaced over its rows; the slow test takes all rows.
"""

import benchmark_maps as maps
import pytest

from antgym.maps.motion import Motion
from antgym.maps.world import Scenario

RULES = {
    "octile_nocut": Motion("grid8"),
    "octile_cut_one_side": Motion("grid8", corners="one"),
    "octile_any_diagonal": Motion("grid8", corners="cut"),
    "four_connected": Motion("grid4"),
    "declared": Motion("grid26"),
    "n26_no_cut": Motion("grid26"),
    "n26_target_only": Motion("grid26", corners="cut"),
}
FLAT = ("movingai2d", "mapf")
VOXELS = ("Simple", "DA1")
ROS = ("TenByTen", "lse_arena", "map", "tb3_sandbox")  # testmap is a PNG: issue 9 reads it
LARGE = {"64room_000", "maze512-32-0", "random512-10-0", "FireWalker", "battleground", "DA1"}


def map_of(scen):
    """The map that a .scen file is for: of the same name, but for MAPF's -even-1 and -random-1."""
    name = scen.name.removesuffix(".scen").removesuffix(".map")
    return scen.with_name(name.removesuffix("-even-1").removesuffix("-random-1") + ".map")


def files_of(folder):
    """Every set of rows in a folder of flat maps, by name."""
    checks = maps.checks_by_map(folder / "checks.csv")
    for scen in sorted(folder.glob("*.scen")):
        name = scen.name.removesuffix(".scen").removesuffix(".map")
        yield name, lambda scen=scen, name=name: maps.rows_of_scen(scen, map_of(scen), checks[name])


def all_rows(data, kind):
    """(name, rows) for every set of rows of a kind; a folder that is absent is skipped."""
    folder = data / {"voxels": "voxel3d", "forest": "voxel3d", "ros": "rosmaps"}.get(kind, kind)
    if not folder.is_dir():
        pytest.skip(f"{folder} is absent")
    if kind in FLAT:
        yield from ((name, list(rows())) for name, rows in files_of(folder))
    elif kind == "voxels":
        yield from ((name, list(maps.rows_of_voxels(folder, name))) for name in VOXELS)
    elif kind == "forest":
        yield from ((name, list(maps.rows_of_forest(folder, name))) for name in ("forest0", "forest3"))
    else:
        yield from ((name, list(maps.rows_of_pixels(folder, name))) for name in ROS)


def differing(name, rows):
    """The lengths of rows that are not the optimum; checks have six digits behind the point."""
    for world, start, goal, lengths in rows:
        for rule, length in lengths.items():
            found = Scenario(world, start, goal, RULES[rule]).optimum
            if found != pytest.approx(length, abs=1e-6):
                yield name, start, goal, rule, length, found


@pytest.mark.parametrize("kind", [*FLAT, "voxels", "forest", "ros"])
def test_a_sample_of_rows_has_the_optimum_of_the_benchmark(shared_data, kind):
    checked = 0
    for name, rows in all_rows(shared_data, kind):
        sample = rows[:: len(rows) // (4 if name in LARGE else 12) + 1]
        assert list(differing(name, sample)) == []
        checked += len(sample)
    assert checked > 15


@pytest.mark.slow
@pytest.mark.parametrize("kind", [*FLAT, "voxels", "forest", "ros"])
def test_every_row_has_the_optimum_of_the_benchmark(shared_data, kind):
    for name, rows in all_rows(shared_data, kind):
        assert list(differing(name, rows)) == []
