"""The gallery of the README: it shows every world, cut open so that the paths are seen and nothing else is missing."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

from antgym import load_suite
from antgym.envs.catalogue import WORLDS
from antgym.maps.optimum import shortest_path

FILE = Path(__file__).parents[1] / "docs" / "gallery.py"


@pytest.fixture(scope="module")
def gallery():
    pytest.importorskip("matplotlib", reason="needs the extra viz")
    spec = importlib.util.spec_from_file_location("gallery", FILE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_world_is_shown_and_every_panel_is_of_the_family_that_it_says(gallery):
    assert {panel.world for panel in gallery.PANELS} == set(WORLDS)
    shown = [load_suite(WORLDS[panel.world], panel.split)[panel.index].family for panel in gallery.PANELS]
    assert shown == [panel.title.removeprefix("real ") for panel in gallery.PANELS]


def test_a_cut_takes_away_what_lies_in_front_of_the_paths_and_nothing_else(gallery):
    scenario = load_suite("potential-field-v0", "test")[3].scenario
    blocked, path = scenario.world.free == 0, shortest_path(scenario)
    kept = gallery.cut_open(blocked, [path])
    for x, y, _ in path:
        assert not kept[x, :y].any()
        assert (kept[x, y:] == blocked[x, y:]).all()
    assert kept.sum() < blocked.sum()


def test_only_faces_towards_the_viewer_are_drawn_the_nearest_last(gallery):
    """Two cells in a row along y: the front one has three faces, the one behind it two, drawn before."""
    solid = np.ones((1, 2, 1), bool)
    drawn = gallery.blocks(solid, gallery.SOLID).get_paths()
    assert len(drawn) == 5
    behind, front = (
        np.mean([path.vertices[:, 1].mean() for path in part]) for part in (drawn[:2], drawn[2:])
    )
    assert behind > front


def test_a_panel_is_drawn_with_both_paths_and_both_ends(gallery):
    from matplotlib.figure import Figure

    axes = Figure().subplots()
    gallery.draw(axes, gallery.Panel("Mountain", "mountains", 8))
    assert [len(line.get_xdata()) for line in axes.lines] == [19, 19, 1, 1]
    assert axes.texts[0].get_text().startswith("19 × 19 × 19, liu2020, gap ")


def test_discs_are_drawn_within_their_bounds_with_both_paths_and_both_ends(gallery):
    from matplotlib.figure import Figure

    axes = Figure().subplots()
    item = load_suite("bee-v0", "test")[7]
    gallery.draw(axes, gallery.Panel("Bee", item.family, 7))
    assert item.rules == "abc_standard"  # twelve way-points and two ends
    assert [len(line.get_xdata()) for line in axes.lines][::2] == [14, 1]
    assert len(axes.patches) == 1 + len(item.scenario.world.discs)
    assert all(disc.clipbox is not axes.bbox for disc in axes.patches[1:])
    assert axes.texts[0].get_text().startswith(f"{len(item.scenario.world.discs)} discs, {item.rules}, gap ")


def test_the_picture_is_there_and_small():
    assert FILE.with_name("worlds.png").stat().st_size < 400_000
