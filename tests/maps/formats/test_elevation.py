"""Readers against real files, small hand-written ones, and files that are damaged or lie."""

import contextlib
import importlib.util
import subprocess
import sys
import zipfile

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from antgym.errors import MapError, MissingExtraError
from antgym.maps.formats.elevation import HeightField, ascii_bytes, jacksboro, read_heights
from antgym.maps.formats.pictures import encoded

HEADER = "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 5\nNODATA_value -9999\n"
needs_matplotlib = pytest.mark.skipif(
    importlib.util.find_spec("matplotlib") is None, reason="matplotlib is absent"
)


@pytest.fixture
def write(tmp_path):
    def write_file(text, name="grid.asc"):
        path = tmp_path / name
        path.write_bytes(text.encode() if isinstance(text, str) else text)
        return path

    return write_file


def test_ascii_rows_run_from_north_to_south_and_become_y(write):
    field = read_heights(write(HEADER + "1 2 3\n4 -9999 6\n"))
    assert field.heights.shape == (3, 2)
    assert field.heights[0].tolist() == [4, 1]
    assert np.isnan(field.heights[1, 0])
    assert field.spacing == (5.0, 5.0)


def test_ascii_headers_may_be_in_any_case_and_have_two_spacings_and_crlf(write):
    field = read_heights(write("NCOLS 2\r\nNRows 1\r\nDX 2\r\nDY 3\r\n\r\n-1 nan\r\n", "grid.TXT"))
    assert field.spacing == (2.0, 3.0)
    assert field.heights[0, 0] == -1
    assert np.isnan(field.heights[1, 0])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (HEADER + "1 2 3\n4 5\n", r"grid\.asc:8: 2 values in a row, ncols promises 3"),
        (HEADER + "1 2 3\n4 5 6 7\n", r"grid\.asc:8: 4 values"),
        (HEADER + "1 2 3\n4 5,5 6\n", r"grid\.asc:8: '5,5' is not a number"),
        (HEADER + "1 2 3\n4 5 6\n7 8 9\n", r"grid\.asc:9: more than the 2 rows"),
        (HEADER + "1 2 3\n", r"ends after 1 of the 2 rows"),
        (HEADER, r"ends after 0 of the 2 rows"),
        ("", r"lacks nrows.*found none"),
        ("1 2 3\n", r"lacks nrows"),
        ("ncols 3\nnrows 2\n1 2 3\n4 5 6\n", r"lacks cellsize.*found ncols, nrows"),
        ("ncols 3 4\n", r"grid\.asc:1: a header line is a name and a value"),
        ("ncols three\nnrows 2\ncellsize 1\n", r"ncols: 'three' is not a number"),
        ("ncols 3\nnrows -2\ncellsize 1\n", r"nrows must be positive, got -2"),
        ("ncols 2.5\nnrows 2\ncellsize 1\n", r"whole numbers"),
        ("ncols 3\nnrows 2\ncellsize 0\n1 2 3\n4 5 6\n", r"cellsize must be positive"),
        ("ncols 3\nnrows 2\ncellsize inf\n", r"cellsize must be positive"),
        (
            "ncols 20000\nnrows 5001\ncellsize 1\n1 2 3\n",
            r"promises 5001 x 20000 samples, more than 16777216",
        ),
        (b"\x89PNG\r\n\x1a\n\x00\x00", r"grid\.asc"),
    ],
)
def test_bad_ascii_grids_are_refused_by_file_and_line(write, text, message):
    with pytest.raises(MapError, match=message):
        read_heights(write(text))


def test_a_bad_nodata_value_is_named(write):
    with pytest.raises(MapError, match="NODATA_value: 'none'"):
        read_heights(write(HEADER.replace("-9999", "none") + "1 2 3\n4 5 6\n"))


def test_numpy_files_are_taken_as_they_are_stored(tmp_path):
    heights = np.arange(6).reshape(2, 3)
    np.save(tmp_path / "a.npy", heights)
    np.savez(tmp_path / "b.npz", heights=heights, other=np.zeros((9, 9)), dx=2.0, dy=np.array([3]))
    np.savez_compressed(tmp_path / "c.npz", relief=heights, names=np.array(["a"]))
    fields = [read_heights(tmp_path / name) for name in ("a.npy", "b.npz", "c.npz")]
    assert all((field.heights == heights).all() for field in fields)
    assert [field.spacing for field in fields] == [(1, 1), (2, 3), (1, 1)]
    assert fields[0].source.endswith("a.npy")


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        ({"a": np.zeros((2, 2)), "b": np.zeros((3, 3))}, "cannot tell which.*a, b.*elevation"),
        ({"a": np.zeros(4)}, "cannot tell which"),
        ({}, "holds nothing"),
        ({"heights": np.zeros((2, 2, 2))}, r"shape \(2, 2, 2\)"),
        ({"heights": np.zeros((2, 2)), "dx": np.zeros(2)}, r"dx must be one number, got .* \(2,\)"),
        (
            {"heights": np.zeros((2, 2)), "dy": -1.0},
            r"spacing must be two positive numbers, got \(1.0, -1.0\)",
        ),
        ({"heights": np.array([[1j]])}, "real numbers"),
        ({"heights": np.array([[object()]])}, r"not a readable \.npz"),
    ],
)
def test_bad_archives_are_refused_by_name(tmp_path, arrays, message):
    np.savez(tmp_path / "bad.npz", **arrays)
    with pytest.raises(MapError, match=rf"bad\.npz.*{message}"):
        read_heights(tmp_path / "bad.npz")


def test_pickled_arrays_are_never_executed(tmp_path):
    np.save(tmp_path / "trap.npy", np.array([[object()]]), allow_pickle=True)
    with pytest.raises(MapError, match=r"not a readable \.npy"):
        read_heights(tmp_path / "trap.npy")


def test_a_header_that_promises_more_than_the_file_holds_allocates_nothing(tmp_path):
    with (tmp_path / "lie.npy").open("wb") as file:
        np.lib.format.write_array_header_1_0(
            file, {"descr": "<f8", "fortran_order": False, "shape": (10**6, 10**6)}
        )
        file.write(bytes(64))
    with pytest.raises(MapError, match=r"lie\.npy"):
        read_heights(tmp_path / "lie.npy")


def test_unknown_and_missing_files_are_named(tmp_path):
    with pytest.raises(MapError, match=r"'\.tif'; valid: \.npy, \.npz, \.asc, \.txt"):
        read_heights(tmp_path / "a.tif")
    with pytest.raises(MapError, match=r"a\.asc: no such file"):
        read_heights(tmp_path / "a.asc")


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    kind=st.sampled_from([".npy", ".npz", ".asc"]),
    cut=st.integers(0, 400),
    places=st.lists(st.tuples(st.integers(0, 150), st.integers(0, 255)), max_size=3),
)
def test_damaged_files_are_read_or_refused_and_nothing_else(tmp_path, kind, cut, places):
    path = tmp_path / f"damaged{kind}"
    if kind == ".asc":
        path.write_text(HEADER + "1 2 3\n4 5 6\n")
    else:
        {".npy": np.save, ".npz": lambda p, a: np.savez(p, heights=a)}[kind](path, np.ones((2, 3)))
    content = bytearray(path.read_bytes())
    for place, value in places:
        content[place % len(content)] = value
    path.write_bytes(bytes(content[: len(content) - cut]))
    with contextlib.suppress(MapError):
        assert read_heights(path).heights.ndim == 2


def test_heights_are_a_read_only_copy():
    original = np.ones((2, 2))
    field = HeightField(original, (1, 1), "mine")
    original[0, 0] = 5
    assert field.heights[0, 0] == 1
    with pytest.raises(ValueError, match="read-only"):
        field.heights[0, 0] = 2


@pytest.mark.parametrize(
    ("name", "shape", "spacing", "missing"),
    [
        ("DEM_10m.asc", (67, 53), 10, 0),
        ("hugo_site.asc", (76, 55), 10, 2028),
        ("west_bijou_gully.asc", (43, 89), 3, 2739),
        ("jacksboro_fault_dem.npz", (344, 403), 1 / 1200, 0),
    ],
)
def test_real_files_are_read_whole(shared_data, name, shape, spacing, missing):
    field = read_heights(shared_data / "dem" / name)
    assert field.heights.shape == shape
    assert field.spacing == pytest.approx((spacing, spacing))
    assert np.isnan(field.heights).sum() == missing


@needs_matplotlib
def test_jacksboro_points_north_and_is_measured_in_metres(shared_data):
    field = jacksboro()
    stored = read_heights(shared_data / "dem" / "jacksboro_fault_dem.npz").heights
    assert (field.heights == stored[::-1].T).all()
    assert field.spacing == pytest.approx((74.5, 92.8), abs=0.1)
    assert (field.heights.min(), field.heights.max()) == (236, 1076)


@needs_matplotlib
def test_jacksboro_does_not_import_matplotlib():
    script = (
        "import antgym.maps.formats.elevation as r, sys; r.jacksboro(); print('matplotlib' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


def test_without_matplotlib_the_remedy_is_named(monkeypatch):
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(MissingExtraError, match=r"antgym\[viz\]"):
        jacksboro()


def test_a_picture_s_grey_levels_are_heights_with_north_at_its_top(tmp_path):
    pytest.importorskip("PIL")
    (tmp_path / "hill.png").write_bytes(encoded(np.array([[0, 51], [102, 255]], np.uint8)))
    assert read_heights(tmp_path / "hill.png").heights.tolist() == [[102, 0], [255, 51]]


@settings(deadline=None)
@given(
    heights=st.lists(
        st.lists(st.floats(-1e5, 1e5) | st.just(np.nan), min_size=3, max_size=3), min_size=1, max_size=4
    ),
    spacing=st.tuples(st.floats(1e-3, 1e3), st.floats(1e-3, 1e3)),
)
def test_a_grid_that_is_written_is_read_again_to_the_bit(tmp_path_factory, heights, spacing):
    field = HeightField(np.array(heights), spacing, "made")
    path = tmp_path_factory.mktemp("grids") / "made.asc"
    path.write_bytes(ascii_bytes(field))
    again = read_heights(path)
    assert again.spacing == field.spacing
    np.testing.assert_array_equal(again.heights, field.heights)


def test_what_is_no_array_in_an_archive_is_passed_over(tmp_path):
    with zipfile.ZipFile(tmp_path / "a.npz", "w") as archive:
        archive.writestr("notes.txt", "mine")
    with pytest.raises(MapError, match="it holds nothing"):
        read_heights(tmp_path / "a.npz")
