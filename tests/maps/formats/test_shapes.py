"""Scenes of shapes, cut into cells: what is blocked, and what is refused."""

import json

import numpy as np
import pytest

from antgym.errors import MapError
from antgym.maps.formats.shapes import read_shapes

FLAT = {"bounds_xmin_xmax_ymin_ymax": [0, 4, 0, 3]}


@pytest.fixture
def write(tmp_path):
    def write_file(scene):
        text = scene if isinstance(scene, str) else json.dumps(scene)
        (tmp_path / "a.json").write_text(text)
        return tmp_path / "a.json"

    return write_file


def test_a_cell_is_blocked_where_a_shape_reaches_into_it_and_free_where_it_only_touches(write):
    scene = {
        **FLAT,
        "rects_x_y_w_h": [[0, 0, 1, 2]],
        "circles_x_y_r": [[3, 1, 1]],
        "start": [0, 2],
        "note": "x",
    }
    map_ = read_shapes(write(scene), 1.0)
    assert map_.world.free[:, ::-1, 0].T.tolist() == [[1, 1, 1, 1], [0, 1, 0, 0], [0, 1, 0, 0]]


def test_circles_are_cut_as_a_slow_look_at_every_cell_cuts_them(write):
    circles = [[1.3, 1.1, 0.77], [3.9, 0.2, 0.5], [2.0, 2.9, 0.05]]
    world = read_shapes(write({**FLAT, "circles_x_y_r": circles}), 0.125).world
    low = np.stack(np.meshgrid(np.arange(32), np.arange(24), indexing="ij"), axis=-1) * 0.125
    for x, y, r in circles:
        near = np.clip([x, y], low, low + 0.125) - [x, y]
        assert (world.free[:, :, 0][np.hypot(*np.moveaxis(near, -1, 0)) < r - 1e-6] == 0).all()
    assert 0.05 < 1 - world.free.mean() < 0.25


def test_a_scene_in_space_has_boxes_and_spheres(write):
    scene = {"bounds": [0, 0, 0, 2, 2, 2], "boxes_min_max": [[0, 0, 0, 1, 1, 2]], "spheres": [[2, 2, 2, 0.5]]}
    map_ = read_shapes(write(scene), 1.0)
    assert np.argwhere(map_.world.free == 0).tolist() == [[0, 0, 0], [0, 0, 1], [1, 1, 1]]
    assert map_.motion.name == "grid26"


def test_without_bounds_a_flat_scene_ends_a_little_beyond_its_shapes_and_ends(write):
    scene = {"circles_x_y_r": [[1, 1, 1]], "start": [4, 1], "goal": [-6, 1]}
    map_ = read_shapes(write(scene))
    assert map_.world.shape[0] == 200
    assert map_.end((4, 1), "start", "map")
    assert map_.end((-6, 1), "goal", "map")


@pytest.mark.parametrize(
    ("scene", "message"),
    [
        ("{", r"a\.json:1: not JSON"),
        ("[" * 100_000, r"a\.json: not JSON|a\.json:1"),
        ("[]", r"a\.json: a scene is a JSON object"),
        ({"start": [0, 0]}, "a scene is a JSON object"),
        ({**FLAT, "circles": []}, r"unknown shapes 'circles'; known: circles_x_y_r"),
        ({**FLAT, "polygons": []}, "unknown shapes 'polygons'"),
        ({**FLAT, "circles_x_y_r": 5}, "circles_x_y_r: 5: must be a list of 3 numbers"),
        ({**FLAT, "circles_x_y_r": [[1, 1, 1], [1, 2]]}, r"circles_x_y_r\[1\]: \[1, 2\]: must be 3 numbers"),
        ({**FLAT, "circles_x_y_r": [[1, 1, 1e300]]}, "must be 3 numbers"),
        ({**FLAT, "circles_x_y_r": [[1, 1, True]]}, "must be 3 numbers"),
        ({**FLAT, "spheres": [[1, 1, 1, 1]]}, "spheres do not fit the bounds"),
        ({"bounds_xmin_xmax_ymin_ymax": [0, 0, 0, 3]}, "must enclose an area"),
        ({"bounds": [0, 0, 0, 3]}, r"bounds\[0\]: .*: must be 6 numbers"),
        ({"spheres": [[1, 1, 1, 1]]}, "bounds is missing"),
        ({"bounds": [0, 0, 0, 1e9, 1, 1], "boxes_min_max": []}, None),
    ],
)
def test_bad_scenes_are_refused(write, scene, message):
    path = write(scene)
    if message is None:  # long, and cut coarsely: still a map
        assert read_shapes(path).world.shape == (200, 1, 1)
        return
    with pytest.raises(MapError, match=message):
        read_shapes(path)


@pytest.mark.parametrize(
    ("cell", "message"), [(1e-9, "cells; a map has from 1 to"), (0.0, "cell = 0.0"), (5e-324, "cells")]
)
def test_cells_that_are_too_small_are_refused_before_memory_is_taken(write, cell, message):
    with pytest.raises(MapError, match=message):
        read_shapes(write({**FLAT, "rects_x_y_w_h": []}), cell)


def test_large_shapes_in_small_cells_do_not_hang(write):
    with pytest.raises(MapError, match=r"circles_x_y_r\[\d+\]: too many cells in large shapes"):
        read_shapes(write({**FLAT, "circles_x_y_r": [[2, 1.5, 9]] * 999}), 0.004)
