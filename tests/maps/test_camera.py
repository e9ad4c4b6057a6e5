"""From a picture to a map: threshold, coverage, and the pictures whose true grids are known."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

pytest.importorskip("PIL")

from PIL import Image

from antgym.errors import MapError
from antgym.maps.camera import coverage, otsu, read_picture
from antgym.maps.formats.movingai import read_movingai
from antgym.maps.formats.pictures import encoded, pixels


@pytest.fixture
def picture(tmp_path):
    def write(levels, name="floor.png", **options):
        Image.fromarray(np.asarray(levels, np.uint8)).save(tmp_path / name, **options)
        return tmp_path / name

    return write


def iou(map_, truth):
    """Intersection over union of the blocked cells."""
    seen, true = map_.world.free[:, :, 0] == 0, truth == 0
    return (seen & true).sum() / (seen | true).sum()


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("Berlin_1_256.png", {"cell": 2.0}),
        # the grid lies within a black margin of 23 pixels to the left and above
        ("arena.jpg", {"cell": 641 / 49, "crop": (23, 23, 664, 664)}),
    ],
)
def test_pictures_of_maps_become_the_grids_that_they_show(shared_data, name, options):
    path = shared_data / "images" / name
    truth = read_movingai(path.with_suffix(".map")).world.free[:, ::-1, 0]  # its y counts from the top
    map_ = read_picture(path, **options)
    print(
        f"{name}: IoU {iou(map_, truth):.4f} over {truth.shape} cells, threshold {otsu(pixels(path).grey):g}"
    )
    assert map_.world.shape[:2] == truth.shape
    assert iou(map_, truth) == 1.0


@pytest.mark.parametrize(("cell", "least"), [(2.5, 0.88), (3.0, 0.86), (5.0, 0.75)])
def test_other_cells_than_the_picture_was_drawn_with_keep_most_of_it(shared_data, cell, least):
    path = shared_data / "images" / "Berlin_1_256.png"
    fine, coarse = read_picture(path), read_picture(path, cell=cell)
    x, y = (((np.arange(512) + 0.5) // cell).astype(int) for _ in range(2))
    seen = coarse.world.free[:, :, 0][np.ix_(x, y)]
    print(f"cells of {cell:g} pixels: IoU {iou(fine, seen):.3f} of the picture's own pixels")
    assert iou(fine, seen) > least


def test_the_house_has_all_its_named_places_in_one_part_of_the_floor(shared_data):
    import json

    from antgym.maps.pairs import components

    map_ = read_picture(shared_data / "images" / "house.png", pixel=0.05)
    places = json.loads((shared_data / "images" / "house_places.json").read_text())
    labels = components(map_.world).labels
    assert {int(labels[x, 396 - y, 0]) for x, y in places.values()} == {int(labels[320, 396 - 190, 0])}
    assert map_.frame.unit == "m"


def slow_otsu(levels):
    """Every threshold tried: the between-class variance, as the paper defines it."""
    levels = np.asarray(levels, float).ravel()

    def apart(level):
        low, high = levels[levels < level], levels[levels >= level]
        return len(low) * len(high) * (low.mean() - high.mean()) ** 2 if len(low) and len(high) else 0.0

    return max(apart(level) for level in range(257)), apart


@settings(deadline=None)
@given(levels=st.lists(st.integers(0, 255), min_size=1, max_size=60))
def test_otsu_s_threshold_parts_as_well_as_any(levels):
    best, apart = slow_otsu(levels)
    assert apart(otsu(np.array(levels, np.float32))) == pytest.approx(best)


def slow_coverage(dark, edge):
    """Every pixel cut into 60 x 60 parts."""
    fine = np.kron(dark, np.ones((60, 60)))
    places = [(np.floor((np.arange(n) + 0.5) / 60 / edge)).astype(int) for n in fine.shape]
    shares = np.zeros([place[-1] + 1 for place in places])
    counts = np.zeros_like(shares)
    np.add.at(shares, np.ix_(*places), fine)
    np.add.at(counts, np.ix_(*places), 1)
    return shares / counts


@settings(deadline=None)
@given(
    seed=st.integers(0, 10**6),
    shape=st.tuples(st.integers(1, 6), st.integers(1, 6)),
    edge=st.sampled_from([1, 1.5, 2, 2.4, 3, 10]),
)
def test_coverage_is_by_exact_area(seed, shape, edge):
    dark = np.random.default_rng(seed).random(shape) < 0.5
    np.testing.assert_allclose(coverage(dark, edge), slow_coverage(dark, edge), atol=1e-9)


def test_a_cell_is_blocked_from_half_of_it_on(picture):
    levels = [[0, 255, 0, 255], [0, 255, 255, 255]]
    assert read_picture(picture(levels), cell=2.0).world.free[:, 0, 0].tolist() == [0, 1]


def test_the_origin_is_the_lower_left_corner_and_cells_may_be_metres(picture):
    map_ = read_picture(picture([[255, 255], [0, 255]]), pixel=0.1)
    assert map_.world.free[:, :, 0].tolist() == [[0, 1], [1, 1]]
    assert map_.points((0, 0, 0))[:2] == pytest.approx([0.05, 0.05])


def test_thresholds_and_their_side_may_be_given(picture):
    path = picture([[100, 150, 200]])
    rows = [
        read_picture(path, threshold=150, negate=negate).world.free[:, 0, 0].tolist() for negate in (0, 1)
    ]
    assert rows == [[0, 1, 1], [1, 0, 0]]


def test_what_is_transparent_shows_white(tmp_path):
    shown = np.array([[[0, 0, 0, 0], [0, 0, 0, 255]]], np.uint8)
    Image.fromarray(shown).save(tmp_path / "a.png")
    assert read_picture(tmp_path / "a.png", threshold=128).world.free[:, 0, 0].tolist() == [1, 0]


@pytest.mark.parametrize("name", ["a.png", "a.bmp", "a.pgm", "a.gif"])
def test_every_kind_of_picture_has_the_same_levels(picture, name):
    levels = np.arange(0, 240, 10).reshape(4, 6)
    assert pixels(picture(levels, name)).grey == pytest.approx(levels)


def test_sixteen_bits_and_one_bit_are_scaled_to_255(tmp_path):
    Image.fromarray(np.array([[0, 257, 65535]], np.uint16)).save(tmp_path / "deep.png")
    Image.fromarray(np.array([[0, 255]], np.uint8)).convert("1").save(tmp_path / "bits.png")
    assert pixels(tmp_path / "deep.png").grey.tolist() == [[0, 1, 255]]
    assert pixels(tmp_path / "bits.png").grey.tolist() == [[0, 255]]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"cell": 0.5}, "a cell of 0.5 is smaller than a pixel of 1"),
        ({"cell": -1.0}, "cell = -1.0: must be a positive number"),
        ({"pixel": float("nan")}, "pixel = nan"),
        ({"threshold": 300.0}, "threshold = 300.0: must be a grey level"),
        ({"crop": (0, 0, 9, 1)}, "crop = .* within 2 x 1 pixels"),
    ],
)
def test_options_out_of_their_range_are_named(picture, options, message):
    with pytest.raises(MapError, match=message):
        read_picture(picture([[0, 255]]), **options)


def test_damaged_and_huge_pictures_are_refused_before_their_pixels_are_read(tmp_path):
    data = encoded(np.zeros((2, 2), np.uint8))
    (tmp_path / "cut.png").write_bytes(data[:-30])
    huge = data[:16] + (10**6).to_bytes(4, "big") * 2 + data[24:]
    (tmp_path / "huge.png").write_bytes(huge)
    (tmp_path / "huge.pgm").write_bytes(b"P5 5000 5000 255\n")
    (tmp_path / "text.png").write_text("%!PS")
    for name, message in (
        ("cut.png", "not a readable picture"),
        ("huge.png", "not a readable picture|pixels are more than"),
        ("huge.pgm", "5,000 x 5,000 pixels are more than"),
        ("text.png", "not a readable picture"),
        ("none.png", "no such file"),
    ):
        with pytest.raises(MapError, match=message):
            read_picture(tmp_path / name)
