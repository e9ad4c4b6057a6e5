"""MovingAI maps: classes of terrain, line ends, and what is refused by line."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from antgym.errors import MapError
from antgym.maps.formats.movingai import map_bytes, read_movingai, read_terrain
from antgym.maps.world import GridWorld

MAP = "type octile\nheight 3\nwidth 4\nmap\n..GS\n@TWW\nb.OW\n"


@pytest.fixture
def write(tmp_path):
    def write_file(text):
        path = tmp_path / "field.map"
        path.write_bytes(text.encode())
        return path

    return write_file


def test_x_counts_columns_and_y_rows_from_the_top(write):
    world = read_movingai(write(MAP)).world
    assert world.free[:, :, 0].T.tolist() == [[1, 1, 1, 1], [0, 0, 0, 0], [1, 1, 0, 0]]


def test_line_ends_of_windows_and_a_header_in_either_order_are_read(write):
    windows = MAP.replace("height 3\nwidth 4", "width 4\nheight 3").replace("\n", "\r\n") + "\r\n"
    assert (read_movingai(write(windows)).world.free == read_movingai(write(MAP)).world.free).all()


def test_one_walks_within_a_class_of_terrain(write):
    terrain = read_terrain(write(MAP))
    assert [int(terrain.walkable(letter).free_count) for letter in ".GSBWT@O"] == [6, 6, 6, 6, 3, 1, 2, 2]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", r"field\.map:0: ''; a MovingAI map begins"),
        (MAP.replace("octile", "tile"), r"field\.map:1: 'type tile'"),
        (MAP.replace("width 4", "depth 4"), r"field\.map:3: 'depth 4'"),
        (MAP.replace("width 4", "height 4"), r"field\.map:3: 'height 4'"),
        (MAP.replace("height 3", "height x"), r"field\.map:2: height: 'x' must be a whole number"),
        (MAP.replace("height 3", "height 0"), r"field\.map:2: height: '0'"),
        (MAP.replace("height 3", "height 1000000000"), r"from 1 to 65,536"),
        (MAP.replace("height 3", "height 65536").replace("width 4", "width 65536"), r"65,536 x 65,536 cells"),
        (MAP.replace("@TWW", "@TW"), r"field\.map:6: 3 letters in a row, the header promises 4"),
        (MAP.replace("@TWW", "@TWß"), r"field\.map:6: unknown letter 'ß' in column 3"),
        (MAP.replace("b.OW\n", ""), r"ends after 2 of the 3 rows"),
        (MAP + "....\n", r"field\.map:8: more than the 3 rows"),
    ],
)
def test_bad_maps_are_refused_by_line(write, text, message):
    with pytest.raises(MapError, match=message):
        read_movingai(write(text))


@settings(deadline=None)
@given(
    cells=st.integers(1, 9).flatmap(
        lambda n: st.lists(st.lists(st.booleans(), min_size=n, max_size=n), min_size=1)
    )
)
def test_what_is_written_is_read_as_an_equal_world(tmp_path_factory, cells):
    world = GridWorld(np.array(cells), (1.0, 1.0, 1.0))
    path = tmp_path_factory.mktemp("maps") / "world.map"
    path.write_bytes(map_bytes(world))
    again = read_movingai(path).world
    assert (again.shape, again.cell, again.bits.tolist()) == (world.shape, world.cell, world.bits.tolist())


def test_worlds_that_are_not_flat_or_not_square_are_not_written():
    with pytest.raises(MapError, match=r"write a \.3dmap"):
        map_bytes(GridWorld(np.ones((2, 2, 2)), (1.0, 1.0, 1.0)))
    with pytest.raises(MapError, match="cells of equal edges"):
        map_bytes(GridWorld(np.ones((2, 2)), (1.0, 2.0, 1.0)))
