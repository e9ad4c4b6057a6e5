"""Shaping against the definition, cell by cell, and against bad height fields."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from antgym.errors import MapError
from antgym.maps.shaping import FILLED, HALF_FILLED, UNFILLED, block_max, classify, fill_missing, voxelise

HEIGHTS = arrays(
    np.float64,
    array_shapes(min_dims=2, max_dims=2, max_side=5),
    elements=st.integers(-8, 40).map(lambda n: n / 4),
)


def by_definition(height, k, level_height):
    if height >= (k + 1) * level_height:
        return FILLED
    return HALF_FILLED if height > k * level_height else UNFILLED


@given(heights=HEIGHTS, rise=st.sampled_from([0.0, 0.25, 1.0, 2.5]))
def test_every_cell_is_classified_by_the_definition(heights, rise):
    codes = classify(heights, 4, 2.0, rise)
    assert codes.dtype == np.uint8
    assert codes.shape == (*heights.shape, 4)
    for i, j, k in np.ndindex(codes.shape):
        assert codes[i, j, k] == by_definition(heights[i, j] + rise, k, 2.0)


@given(heights=HEIGHTS, rise=st.floats(0, 10))
def test_raising_the_surface_never_frees_a_cell(heights, rise):
    assert (voxelise(heights, 4, (1, 1, 2), rise).free <= voxelise(heights, 4, (1, 1, 2)).free).all()


def test_filled_and_half_filled_cells_are_both_blocked():
    world = voxelise([[0.0, 15.0, 22.0, -3.0, 99.0]], 3, (15.0, 15.0, 15.0))
    assert world.free.sum(axis=2).tolist() == [[3, 2, 1, 3, 0]]
    assert world.cell == (15.0, 15.0, 15.0)


def test_missing_heights_are_counted_placed_and_can_be_filled():
    heights = np.ones((3, 4))
    heights[1, 2], heights[2, 0] = np.nan, np.inf
    with pytest.raises(MapError, match=r"2 of 12 heights .* nan at \[1, 2\]; .*fill_missing"):
        voxelise(heights, 2, (1, 1, 1))
    filled = fill_missing(heights, 0.5)
    assert (filled[1, 2], filled[2, 0], filled.sum()) == (0.5, 0.5, 11.0)
    assert np.isnan(heights[1, 2])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([[1.0]], 0, 1.0), "levels=0"),
        (([[1.0]], 2, -1.0), "positive number, got -1"),
        (([[1.0]], 2, float("nan")), "got nan"),
        (([[1.0]], 2, 1.0, -1.0), "rise"),
        (([1.0, 2.0], 2, 1.0), r"shape \(2,\)"),
        (([[]], 2, 1.0), r"shape \(1, 0\)"),
        (([["high"]], 2, 1.0), "real numbers"),
    ],
)
def test_bad_arguments_are_refused_by_value(arguments, message):
    with pytest.raises(MapError, match=message):
        classify(*arguments)


def test_missing_heights_cannot_be_filled_with_something_missing():
    with pytest.raises(MapError, match="got nan"):
        fill_missing([[1.0]], float("nan"))


@given(heights=HEIGHTS, data=st.data())
def test_block_max_takes_every_sample_into_exactly_one_block(heights, data):
    shape = tuple(data.draw(st.integers(1, n)) for n in heights.shape)
    rows, columns = (np.arange(b + 1) * n // b for n, b in zip(heights.shape, shape, strict=True))
    reduced = block_max(heights, shape)
    assert reduced.shape == shape
    for i, j in np.ndindex(shape):
        assert reduced[i, j] == heights[rows[i] : rows[i + 1], columns[j] : columns[j + 1]].max()


def test_block_max_keeps_a_missing_sample_missing():
    assert np.isnan(block_max([[1.0, np.nan], [2.0, 3.0]], (1, 1))).all()


@pytest.mark.parametrize("shape", [(3, 2), (2, 5), (0, 1)])
def test_block_max_refuses_blocks_without_samples(shape):
    with pytest.raises(MapError, match=r"samples along axis \d cannot be cut into \d blocks"):
        block_max(np.zeros((2, 4)), shape)
