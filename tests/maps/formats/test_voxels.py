"""Voxel maps: read, written, refused by line."""

import gzip

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from antgym.errors import MapError
from antgym.maps.formats import voxels
from antgym.maps.formats.voxels import read_voxels, voxel_bytes
from antgym.maps.world import GridWorld

UNIT = (1.0, 1.0, 1.0)


def test_lines_are_blocked_voxels_and_blank_ones_nothing(tmp_path):
    path = tmp_path / "a.3dmap"
    path.write_text("voxel 2 3 4\n0 0 0\n\n1 2 3\n1 2 3\n")
    assert np.argwhere(read_voxels(path).world.free == 0).tolist() == [[0, 0, 0], [1, 2, 3]]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", r"a\.3dmap:1: ''; a \.3dmap begins with: voxel X Y Z"),
        ("voxel 2 3\n", r"a\.3dmap:1: 'voxel 2 3'"),
        ("voxel 2 0 4\n", r"a\.3dmap:1: '0' must be a whole number from 1"),
        ("voxel 1000000000 1000000000 1\n", r"a\.3dmap:1: '1000000000'"),
        ("voxel 60000 60000 60000\n", r"60,000 x 60,000 x 60,000 cells"),
        ("voxel 2 3 4\n0 0 0\n0 0\n", r"a\.3dmap:3: 2 numbers, a voxel is x y z"),
        ("voxel 2 3 4\n0 0 0\n2 0 0\n", r"a\.3dmap:3: '2' must be a whole number from 0 to 1"),
        ("voxel 2 3 4\n0 -1 0\n", r"a\.3dmap:2: '-1'"),
        ("voxel 2 3 4\n0 0 x\n", r"a\.3dmap:2: 'x'"),
        ("voxel 2 3 4\n0 0 99999999999999999999999\n", r"a\.3dmap:2: '9999"),
    ],
)
def test_bad_maps_are_refused_by_line(tmp_path, text, message):
    (tmp_path / "a.3dmap").write_text(text)
    with pytest.raises(MapError, match=message):
        read_voxels(tmp_path / "a.3dmap")


def test_a_damaged_archive_is_refused(tmp_path):
    packed = gzip.compress(b"voxel 2 3 4\n" + b"0 0 0\n" * 99)
    for name, data in (("cut", packed[:-12]), ("none", b"voxel 2 3 4\n")):
        (tmp_path / f"{name}.3dmap.gz").write_bytes(data)
        with pytest.raises(MapError, match=rf"{name}\.3dmap\.gz:\d+: cannot be read"):
            read_voxels(tmp_path / f"{name}.3dmap.gz")


def test_an_archive_that_unpacks_to_too_much_is_refused(tmp_path, monkeypatch):
    monkeypatch.setitem(voxels.lines.__globals__, "MOST_BYTES", 1000)
    (tmp_path / "a.3dmap.gz").write_bytes(gzip.compress(b"voxel 2 3 4\n" + b"0 0 0\n" * 999))
    with pytest.raises(MapError, match="it unpacks to over 1,000 bytes"):
        read_voxels(tmp_path / "a.3dmap.gz")


@settings(deadline=None)
@given(seed=st.integers(0, 10**6), shape=st.tuples(*[st.integers(1, 6)] * 3))
def test_what_is_written_is_read_as_an_equal_world(tmp_path_factory, seed, shape):
    world = GridWorld(np.random.default_rng(seed).random(shape) < 0.5, UNIT)
    path = tmp_path_factory.mktemp("maps") / "world.3dmap"
    path.write_bytes(voxel_bytes(world))
    again = read_voxels(path).world
    assert (again.shape, again.bits.tolist()) == (world.shape, world.bits.tolist())


def test_an_archive_of_empty_lines_does_not_hang(tmp_path):
    (tmp_path / "a.3dmap.gz").write_bytes(gzip.compress(b"voxel 2 3 4\n" + b"\n" * 200_000))
    with pytest.raises(MapError, match="over 100,000 empty lines"):
        read_voxels(tmp_path / "a.3dmap.gz")
