"""Optima of published benchmarks, as their files declare them or as independent checks beside them found.

The default suite takes a sample of every map, evenly spaced over its rows; the slow test takes all rows.
"""

import benchmark_maps as maps
import pytest

pytest.importorskip("yaml")
pytest.importorskip("PIL")

from antgym.errors import ScenarioError
from antgym.maps.motion import Motion
from antgym.maps.readers import read_scenarios
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
ROS = ("TenByTen", "lse_arena", "map", "tb3_sandbox", "testmap")
KINDS = (*FLAT, "voxels", "forest", "ros", "house")
LARGE = {"64room_000", "maze512-32-0", "random512-10-0", "FireWalker", "battleground", "DA1"}
FOLDERS = {"voxels": "voxel3d", "forest": "voxel3d", "ros": "rosmaps", "house": "images"}


def by_map(path):
    """The rows of a checks.csv or pairs.csv, by their map."""
    found = {}
    for check in maps.checks_of(path):
        found.setdefault(check["map"], []).append(check)
    return found


def scen_files(folder):
    """Every .scen file of a folder and the name that its checks go by."""
    for scen in sorted(folder.glob("*.scen")):
        yield scen, scen.name.removesuffix(".scen").removesuffix(".map")


def all_rows(data, kind):
    """(name, rows) for every set of rows of a kind; a folder that is absent is skipped."""
    folder = data / FOLDERS.get(kind, kind)
    if not folder.is_dir():
        pytest.skip(f"{folder} is absent")
    if kind in FLAT:
        checks = by_map(folder / "checks.csv")
        yield from ((name, list(maps.rows_of_scen(scen, checks[name]))) for scen, name in scen_files(folder))
    elif kind == "voxels":
        yield from ((name, list(maps.rows_of_voxels(folder, name))) for name in VOXELS)
    elif kind == "forest":
        yield from ((name, list(maps.rows_of_forest(folder, name))) for name in ("forest0", "forest3"))
    elif kind == "ros":
        pairs = by_map(folder / "pairs.csv")
        yield from ((name, list(maps.rows_of_pixels(folder / f"{name}.yaml", pairs[name]))) for name in ROS)
    else:
        pairs = maps.checks_of(folder / "house_pairs.csv")
        yield "house", list(maps.rows_of_pixels(folder / "house.png", pairs))


def differing(name, rows):
    """The lengths of rows that are not the optimum; checks have six digits behind the point."""
    for world, start, goal, lengths in rows:
        for rule, length in lengths.items():
            found = Scenario(world, start, goal, RULES[rule]).optimum
            if found != pytest.approx(length, abs=1e-6):
                yield name, start, goal, rule, length, found


@pytest.mark.parametrize("kind", KINDS)
def test_a_sample_of_rows_has_the_optimum_of_the_benchmark(shared_data, kind):
    checked = 0
    for name, rows in all_rows(shared_data, kind):
        sample = rows[:: len(rows) // (4 if name in LARGE else 12) + 1]
        assert list(differing(name, sample)) == []
        checked += len(sample)
    assert checked > 10


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_every_row_has_the_optimum_of_the_benchmark(shared_data, kind):
    for name, rows in all_rows(shared_data, kind):
        assert list(differing(name, rows)) == []


@pytest.mark.parametrize("kind", FLAT)
def test_declared_lengths_are_the_checked_ones_to_the_last_digit_printed_but_on_the_map_that_is_known_to_lie(
    shared_data, kind
):
    checks, lies = by_map(shared_data / kind / "checks.csv"), {}
    for scen, name in scen_files(shared_data / kind):
        for row, check in zip(read_scenarios(scen), checks[name], strict=True):
            assert row.length == float(check["declared"])
            holds = row.length == pytest.approx(maps.lengths_of(check).get("octile_nocut", -1), abs=0.006)
            assert holds == (check["declared_matches_nocut"] == "1"), f"{scen.name}:{row.line}"
            lies[name] = lies.get(name, 0) + (not holds)
    assert {name: count for name, count in lies.items() if count} == (
        {"battleground": 8} if kind == "movingai2d" else {}
    )


def test_rows_that_start_where_they_end_are_kept_and_refused_when_they_are_planned(shared_data):
    standing = 0
    for folder in FLAT:
        for scen, _ in scen_files(shared_data / folder):
            rows = read_scenarios(scen)
            for i, row in enumerate(rows):
                if row.start == row.goal:
                    standing += 1
                    with pytest.raises(
                        ScenarioError, match=rf"{scen.name}:{row.line}: start and goal are the same"
                    ):
                        rows.scenario(i)
    assert standing > 0
