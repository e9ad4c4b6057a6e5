"""ROS maps: thresholds of both ROS, negated, turned, transparent; what is refused, by line; written and read."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

pytest.importorskip("yaml")
pytest.importorskip("PIL")

from PIL import Image

from antgym.errors import MapError
from antgym.maps.formats.pictures import encoded
from antgym.maps.formats.ros import picture_of, read_ros, ros_bytes
from antgym.maps.map import Frame
from antgym.maps.world import GridWorld

YAML = "image: room.pgm\nresolution: 0.5\norigin: [-1, 2, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
LEVELS = np.array([[0, 205, 254], [255, 206, 100]], np.uint8)


@pytest.fixture
def write(tmp_path):
    (tmp_path / "room.pgm").write_bytes(encoded(LEVELS, "PPM"))

    def write_file(text=YAML):
        (tmp_path / "room.yaml").write_bytes(text.encode() if isinstance(text, str) else text)
        return tmp_path / "room.yaml"

    return write_file


def rows(map_):
    """Free cells as people draw the map: the top row first."""
    return map_.world.free[:, ::-1, 0].T.tolist()


def test_the_top_of_the_picture_is_the_far_end_of_y(write):
    map_ = read_ros(write())
    assert rows(map_) == [[0, 0, 1], [1, 1, 0]]
    assert map_.points((0, 0, 0)).tolist() == [-0.75, 2.25, 0.25]
    assert map_.end((0.4, 2.9), "goal", "map") == (2, 1, 0)


def test_grey_205_is_unknown_at_the_threshold_of_map_saver_and_free_at_nav2_s(write):
    assert rows(read_ros(write(YAML.replace("0.196", "0.25"))))[0] == [0, 1, 1]


def test_a_level_at_the_threshold_is_free_in_ros_2_alone(write):
    text = YAML.replace("0.196", repr(50 / 255))
    assert [rows(read_ros(write(text), ros))[0][1] for ros in (1, 2)] == [0, 1]
    with pytest.raises(MapError, match="ros = 3"):
        read_ros(write(), 3)


def test_negated_maps_are_free_where_they_are_dark(write):
    assert rows(read_ros(write(YAML.replace("negate: 0", "negate: true")))) == [[1, 0, 0], [0, 0, 0]]


def test_a_raw_map_holds_per_cent(write, tmp_path):
    (tmp_path / "room.pgm").write_bytes(encoded(np.array([[0, 10, 100, 255]], np.uint8), "PPM"))
    assert rows(read_ros(write(YAML + "mode: raw\n"))) == [[1, 1, 0, 0]]


def test_transparent_pixels_are_unknown_in_ros_2_and_part_of_the_mean_in_ros_1(write, tmp_path):
    pixels = np.array([[[255, 255, 255, 255], [255, 255, 255, 0], [200, 200, 200, 255]]], np.uint8)
    Image.fromarray(pixels).save(tmp_path / "room.png")
    text = YAML.replace("pgm", "png")
    assert [rows(read_ros(write(text), ros)) for ros in (1, 2)] == [[[1, 0, 1]], [[1, 0, 0]]]
    assert rows(read_ros(write(text + "mode: scale\n"), 1)) == [[1, 1, 0]]


def test_a_turned_map_is_found_again_from_its_points(write):
    map_ = read_ros(write(YAML.replace("[-1, 2, 0]", "[-1, 2, 1.0]")))
    cells = np.argwhere(map_.world.free >= 0)
    assert [map_.cell(point) for point in map_.points(cells).tolist()] == [
        tuple(cell) for cell in cells.tolist()
    ]
    assert map_.points((1, 0, 0))[1] > map_.points((0, 0, 0))[1]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("image: room.pgm\n", "", r"room\.yaml: the key 'image' is missing; found resolution"),
        ("room.pgm", "gone.pgm", r"room\.yaml:1: image: no such file .*gone\.pgm \(the path is relative"),
        ("room.pgm", "x" * 3000, r"room\.yaml:1: image: no such file"),
        ("room.pgm", '"a\\0b"', r"room\.yaml:1: image: no such file"),
        ("room.pgm", "[1]", r"room\.yaml:1: image = \[1\]: must be the path"),
        ("0.5", "half", r"room\.yaml:2: resolution: 'half' is not a number"),
        ("0.5", "-0.5", r"room\.yaml:2: resolution = -0.5: must be a positive number"),
        ("0.5", "true", r"room\.yaml:2: resolution = True: must be a number"),
        ("[-1, 2, 0]", "[-1, 2]", r"room\.yaml:3: origin = \[-1, 2\]: must be \[x, y, yaw\]"),
        ("[-1, 2, 0]", "[-1, 2, .nan]", r"room\.yaml:3: origin: 'nan'"),
        ("negate: 0", "negate: 2", r"room\.yaml:4: negate = 2: must be 0 or 1"),
        ("0.196", "0.7", r"room\.yaml:6: free_thresh = 0.7, occupied_thresh = 0.65"),
        ("negate", "mode: grey\nnegate", r"room\.yaml:4: mode = 'grey': unknown mode; did you mean"),
        ("negate: 0", "negate: [0", r"room\.yaml:5: not YAML"),
        ("negate: 0", "negate: \x10", r"room\.yaml:4: not YAML"),
        ("negate: 0", "negate: 2000-99-99", r"room\.yaml: not YAML"),
        (YAML, "- a\n", r"room\.yaml:1: a map's yaml holds keys and values"),
        (YAML, "", r"room\.yaml:1: a map's yaml holds"),
        (YAML, b"\xff\xfe", r"room\.yaml: not a text file"),
        (YAML, "[" * 1500, r"room\.yaml"),
        (YAML, "a: " + "x" * 70_000, r"bytes, at most 64,000 are read"),
    ],
)
def test_bad_maps_are_refused_by_line(write, old, new, message):
    text = new if old == YAML else YAML.replace(old, new)
    with pytest.raises(MapError, match=message):
        read_ros(write(text))


def test_numbers_that_yaml_takes_for_a_text_are_read(write):
    assert read_ros(write(YAML.replace("0.5", "5e-1"))).world.cell[0] == 0.5


def test_a_yaml_never_makes_objects(write):
    with pytest.raises(MapError, match="not YAML"):
        read_ros(write(YAML.replace("0.5", "!!python/name:os.getcwd 5")))


@settings(deadline=None)
@given(
    seed=st.integers(0, 10**6),
    shape=st.tuples(st.integers(1, 9), st.integers(1, 9)),
    edge=st.floats(1e-6, 1e6),
    pose=st.tuples(*[st.floats(-1e6, 1e6)] * 3),
    ros=st.sampled_from([1, 2]),
)
def test_what_is_written_is_read_as_an_equal_world_in_its_place(
    tmp_path_factory, seed, shape, edge, pose, ros
):
    world = GridWorld(np.random.default_rng(seed).random(shape) < 0.5, (edge,) * 3)
    frame = Frame((pose[0], pose[1], 0.0), pose[2], "m")
    path = tmp_path_factory.mktemp("maps") / "world.yaml"
    yaml, picture = ros_bytes(world, frame, "world.pgm")
    path.write_bytes(yaml)
    picture_of_world = path.with_suffix(".pgm")
    picture_of_world.write_bytes(picture)
    again = read_ros(path, ros)
    assert picture_of(path) == picture_of_world
    assert (again.world.cell, again.world.bits.tolist()) == (world.cell, world.bits.tolist())
    assert again.frame == frame
