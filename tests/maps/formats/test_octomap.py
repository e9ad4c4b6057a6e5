"""OctoMaps against trees written one node after the other, and streams that are cut, padded or lie."""

import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from octrees import CENTRE, HEADER, tree_bytes

from antgym.errors import MapError
from antgym.maps.formats.octomap import encode, octomap_bytes, read_octomap
from antgym.maps.map import Frame
from antgym.maps.world import GridWorld

TEXT = HEADER.format(size=1, res=0.1)


@pytest.fixture
def write(tmp_path):
    def write_file(data):
        (tmp_path / "a.bt").write_bytes(data)
        return tmp_path / "a.bt"

    return write_file


def stream(*words, header=TEXT):
    return header.encode() + struct.pack(f"<{len(words)}H", *words)


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10**6), side=st.integers(1, 6), at=st.integers(-5, 5))
def test_any_tree_is_decoded_to_what_was_written(tmp_path_factory, seed, side, at):
    rng = np.random.default_rng(seed)
    kinds = rng.choice(3, (side,) * 3, p=(0.2, 0.5, 0.3))
    kinds[0, 0, 0] = kinds[-1, -1, -1] = 1  # known corners, so that the box is the whole array
    if rng.random() < 0.5:
        kinds[: side // 2 * 2] = kinds[:1, :1, :1]  # large leaves
    path = tmp_path_factory.mktemp("trees") / "a.bt"
    path.write_bytes(tree_bytes(kinds, [CENTRE + at] * 3))
    map_ = read_octomap(path)
    assert (map_.world.free == (kinds == 1)).all()
    assert (read_octomap(path, unknown="free").world.free == (kinds != 2)).all()
    assert map_.frame.origin == (at * 0.5,) * 3
    assert map_.world.cell == (0.5, 0.5, 0.5)


@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 10**6), side=st.integers(1, 6), at=st.integers(-9, 9))
def test_the_writer_agrees_word_for_word_with_the_tree_that_is_written_node_after_node(seed, side, at):
    rng = np.random.default_rng(seed)
    kinds = rng.choice(3, (side,) * 3, p=(0.2, 0.5, 0.3)).astype(np.uint8)
    kinds[0, 0, 0] = 1
    kinds[: side // 2 * 2] = kinds[:1, :1, :1]
    low = np.array([CENTRE + at, CENTRE, CENTRE - 2 * at])
    assert encode(kinds, low).tobytes() == tree_bytes(kinds, low).partition(b"data\n")[2]


def test_a_world_is_read_again_as_it_was_written_and_written_again_to_the_byte(write):
    world = GridWorld(np.random.default_rng(3).random((7, 12, 5)) > 0.4, (0.15, 0.15, 0.15))
    data = octomap_bytes(world, Frame((-0.45, 0.3, -1.05), 0.0, "m"))
    again = read_octomap(write(data))
    assert (again.world.cell, again.world.shape, again.world.bits.tolist()) == (
        world.cell,
        world.shape,
        world.bits.tolist(),
    )
    assert again.frame.origin == pytest.approx((-0.45, 0.3, -1.05))
    assert octomap_bytes(again.world, again.frame) == data
    # octomap counts all nodes of a tree in its header: eight free cells beside one another are one leaf below 15 more
    block = octomap_bytes(GridWorld(np.ones((2, 2, 2)), (1.0, 1.0, 1.0)), Frame())
    assert b"\nsize 16\n" in block


def test_forests_beside_a_checkout_keep_every_cell(shared_data, write):
    for name in ("forest0", "forest3"):
        given = read_octomap(shared_data / "voxel3d" / f"{name}.bt")
        again = read_octomap(write(octomap_bytes(given.world, given.frame)))
        assert again.frame == given.frame
        assert (again.world.free == given.world.free).all()


@pytest.mark.parametrize(
    ("cell", "frame", "message"),
    [
        ((1.0, 1.0, 2.0), Frame(), "cells of equal edges"),
        ((1.0,) * 3, Frame((0.5, 0.0, 0.0)), r"multiples of their edge 1, not turned; .* begins at \(0\.5"),
        ((1.0,) * 3, Frame(yaw=0.1), r"turned by 0\.1: write its world alone"),
        ((1.0,) * 3, Frame((32768.0, 0.0, 0.0)), "ends 32,768 cells from its origin"),
        ((1.0,) * 3, Frame((0.0, -32769.0, 0.0)), "ends 32,768 cells from its origin"),
    ],
)
def test_what_no_octree_holds_is_refused(cell, frame, message):
    with pytest.raises(MapError, match=message):
        octomap_bytes(GridWorld(np.ones((2, 2, 2)), cell), frame)


def test_unknown_cells_are_blocked_unless_they_are_said_to_be_free(write):
    kinds = np.array([1, 0, 2, 1]).reshape(4, 1, 1) * np.ones((4, 1, 1), int)
    path = write(tree_bytes(np.pad(kinds, ((0, 0), (0, 3), (0, 3)), constant_values=1), [CENTRE] * 3))
    assert read_octomap(path).world.free[:, 0, 0].tolist() == [1, 0, 0, 1]
    assert read_octomap(path, "free").world.free[:, 0, 0].tolist() == [1, 1, 0, 1]
    with pytest.raises(MapError, match="unknown = 'open'"):
        read_octomap(path, "open")


CHAIN = [3] * 15


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", r"a\.bt:1: b''; a \.bt file begins with"),
        (b"# Octomap OcTree binary file\nid OcTree\n", r"the line 'data' .* is missing"),
        (
            stream(*CHAIN, 1, header=HEADER.replace("id OcTree\n", "").format(size=1, res=1)),
            "lacks 'id'; found size, res",
        ),
        (
            stream(*CHAIN, 1, header=HEADER.replace("id OcTree", "id Color").format(size=1, res=1)),
            r"a\.bt:3: id 'Color'",
        ),
        (stream(*CHAIN, 1, header=HEADER.format(size=1, res="no")), r"a\.bt:5: res: 'no' is not a number"),
        (stream(*CHAIN, 1, header=HEADER.format(size=1, res=0)), r"a\.bt:5: res = 0.0: must be a positive"),
        (stream(*CHAIN, 1) + b"\0", r"byte 104: the tree ends within a node"),
        (stream(), r"byte 71 \+ 0: the tree ends too soon, after 0 inner nodes"),
        (stream(*CHAIN), r"byte 71 \+ 30: the tree ends too soon, after 15 inner nodes"),
        (stream(*CHAIN, 1, 1), r"byte 71 \+ 32: the tree is complete, but the file goes on"),
        (stream(*CHAIN, 3, 1), r"byte 71 \+ 32: a node lies deeper than 16"),
        (stream(*CHAIN, 0), r"nothing is known in this tree"),
        (stream(0b10_01), r"65,536 x 32,768 x 32,768 cells"),
    ],
)
def test_bad_trees_are_refused_by_line_or_byte(write, data, message):
    with pytest.raises(MapError, match=message):
        read_octomap(write(data))
