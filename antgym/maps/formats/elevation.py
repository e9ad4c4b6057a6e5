"""Elevation: height fields from files, and the real terrain that comes with matplotlib.

Whatever a file calls its axes, here ``heights[i, j]`` has i along x and j along y. ESRI grids are pictures
whose first row lies in the north, so they are turned: x points east, y north, and so are pictures. Numpy files are
taken as they are stored.
"""

import importlib.util
import itertools
import math
import warnings
import zipfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antgym.errors import MapError, MissingExtraError
from antgym.maps.formats.files import MOST_BYTES, MOST_SIDE, lines, require_file
from antgym.maps.formats.pictures import SUFFIXES, pixels
from antgym.maps.shaping import height_array

MAX_SAMPLES = 1 << 24  # 4096 x 4096, 134 MB of heights
MOST_MEMBERS = 1000  # of an archive
METRES_PER_DEGREE = 111_320.0  # of latitude
KEYS = ("elevation", "heights", "topo")

_Array = NDArray[Any]
_Line = tuple[int, list[str]]


@dataclass(frozen=True, eq=False)
class HeightField:
    """Heights over a regular grid.

    Args:
        heights: (nx, ny) numbers, i along x, j along y, in any unit; NaN where none is known. Copied to a
            read-only float64 array.
        spacing: (dx, dy), distance between samples along x and y, positive; the unit is the file's.
        source: the file, or the name, that it comes from.

    Raises:
        MapError: if the heights are not a non-empty (nx, ny) array of numbers or a spacing is not positive.
    """

    heights: NDArray[np.float64]
    spacing: tuple[float, float]
    source: str

    def __post_init__(self) -> None:
        try:
            heights = height_array(self.heights).copy()
        except MapError as error:
            raise MapError(f"{self.source}: {error}") from None
        dx, dy = (float(edge) for edge in self.spacing)
        if not all(math.isfinite(edge) and edge > 0 for edge in (dx, dy)):
            raise MapError(f"{self.source}: the spacing must be two positive numbers, got {(dx, dy)}")
        heights.setflags(write=False)
        object.__setattr__(self, "heights", heights)
        object.__setattr__(self, "spacing", (dx, dy))


def read_heights(path: str | Path) -> HeightField:
    """Read a height field from ``.npy``, ``.npz``, an ESRI ASCII grid (``.asc``, ``.txt``) or a picture.

    An ``.npz`` holds the heights under ``elevation``, ``heights`` or ``topo``, or as its only two-dimensional
    array, and may hold ``dx`` and ``dy``; without them the spacing is 1. ``NODATA_value`` becomes NaN
    (``shaping.fill_missing`` replaces it). Heights of a picture are its grey levels, from 0 to 255.

    Raises:
        MapError: if the file is missing, damaged, ragged, larger than 4096 x 4096 samples or of an unknown
            kind; the message names the file and, for text, the line.
        MissingExtraError: if a picture is read, and Pillow is not installed.
    """
    path = Path(path)
    kinds = {**READERS, **dict.fromkeys(SUFFIXES, _read_picture)}
    if path.suffix.lower() not in kinds:
        raise MapError(f"{path}: unknown kind of height file {path.suffix!r}; valid: {', '.join(kinds)}")
    require_file(path)
    return kinds[path.suffix.lower()](path)


def jacksboro() -> HeightField:
    """Return the terrain of the Jacksboro fault (Tennessee): 403 x 344 samples, 236 to 1076 m, spacing in m.

    The file comes with matplotlib (public elevation data); x points east, y north.

    Raises:
        MissingExtraError: if matplotlib is not installed.
    """
    spec = importlib.util.find_spec("matplotlib")  # finds the folder without the import's half second
    if spec is None or spec.origin is None:
        raise MissingExtraError("matplotlib", "viz")
    path = Path(spec.origin).parent / "mpl-data" / "sample_data" / "jacksboro_fault_dem.npz"
    arrays = _load_npz(path)
    latitude = math.radians((float(arrays["ymin"]) + float(arrays["ymax"])) / 2)
    dx = float(arrays["dx"]) * METRES_PER_DEGREE * math.cos(latitude)
    dy = float(arrays["dy"]) * METRES_PER_DEGREE
    # to the centimetre, as the last bit of a cosine depends on the platform
    return HeightField(_north_up(arrays["elevation"]), (round(dx, 2), round(dy, 2)), "jacksboro")


def _north_up(picture: _Array) -> _Array:
    return picture[::-1].T


def _read_npy(path: Path) -> HeightField:
    with _damage_told(path, ".npy"):
        array = np.lib.format.open_memmap(path, mode="r")  # nothing is allocated for a header that lies
    return HeightField(_bounded(array, path), (1.0, 1.0), str(path))


@contextmanager
def _damage_told(path: Path, kind: str) -> Iterator[None]:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of headers that Python 2 wrote
            yield
    except (
        Exception
    ) as error:  # of damaged, encrypted or pickled files, numpy and zipfile raise what they like
        raise MapError(f"{path}: not a readable {kind} file of numbers ({error})") from None


def _read_npz(path: Path) -> HeightField:
    arrays = _load_npz(path)
    planes = [name for name, array in arrays.items() if array.ndim == 2]
    named = [name for name in KEYS if name in arrays] or planes
    if not named or (len(named) > 1 and named is planes):
        raise MapError(
            f"{path}: cannot tell which array holds the heights: it holds {', '.join(arrays) or 'nothing'}; "
            f"name it one of {', '.join(KEYS)}"
        )
    dx, dy = (_scalar(arrays, name, path) for name in ("dx", "dy"))
    return HeightField(_bounded(arrays[named[0]], path), (dx, dy), str(path))


def _load_npz(path: Path) -> dict[str, _Array]:
    with _damage_told(path, ".npz"):
        with zipfile.ZipFile(path) as archive:
            members = archive.infolist()
        size = sum(member.file_size for member in members)
        if len(members) > MOST_MEMBERS:
            raise ValueError(f"it has {len(members):,} members, more than {MOST_MEMBERS:,}")
        if size > MOST_BYTES:
            raise ValueError(f"it unpacks to {size:,} bytes, more than {MOST_BYTES:,}")
        with np.load(path, allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in archive.files}
        return {name: array for name, array in arrays.items() if isinstance(array, np.ndarray)}


def _scalar(arrays: dict[str, _Array], name: str, path: Path) -> float:
    value = arrays.get(name, np.array(1.0))
    if value.size != 1 or value.dtype.kind not in "iuf":
        raise MapError(
            f"{path}: {name} must be one number, got an array of shape {value.shape}, {value.dtype}"
        )
    return float(value.item())


def _bounded(array: _Array, path: Path) -> _Array:
    if array.size > MAX_SAMPLES:
        raise MapError(
            f"{path}: {array.size} samples are more than {MAX_SAMPLES}; cut or thin the field first"
        )
    return array


def _read_picture(path: Path) -> HeightField:
    return HeightField(_north_up(pixels(path).grey), (1.0, 1.0), str(path))


def _read_ascii(path: Path) -> HeightField:
    words = ((number, line.split()) for number, line in lines(path) if line.strip())
    header, rows = _split_header(words, path)
    shape = _grid_shape(header, path)
    # GDAL writes dx and dy where they differ
    dx, dy = (_positive(header, name if name in header else "cellsize", path) for name in ("dx", "dy"))
    picture = _read_rows(rows, shape, path)
    missing = _number(
        header.get("nodata_value", "-9999"), f"{path}: NODATA_value"
    )  # the format's own default
    picture[picture == missing] = np.nan
    return HeightField(_north_up(picture), (dx, dy), str(path))


def ascii_bytes(field: HeightField) -> bytes:
    """Return a height field as an ESRI ASCII grid, its corner at the origin."""
    columns, rows = field.heights.shape
    dx, dy = field.spacing
    cells = f"cellsize {dx!r}\n" if dx == dy else f"dx {dx!r}\ndy {dy!r}\n"
    header = f"ncols {columns}\nnrows {rows}\nxllcorner 0\nyllcorner 0\n{cells}NODATA_value nan\n"
    picture = field.heights.T[::-1].tolist()
    return (header + "".join(" ".join(map(repr, row)) + "\n" for row in picture)).encode()


def _split_header(numbered: Iterable[_Line], path: Path) -> tuple[dict[str, str], Iterable[_Line]]:
    header: dict[str, str] = {}
    numbered = iter(numbered)
    for number, words in numbered:
        if not words[0][0].isalpha() or words[0].lower() == "nan":
            return header, itertools.chain([(number, words)], numbered)
        if len(words) != 2:
            raise MapError(
                f"{path}:{number}: a header line is a name and a value, got {' '.join(words)[:60]!r}"
            )
        header[words[0].lower()] = words[1]
    return header, numbered


def _grid_shape(header: dict[str, str], path: Path) -> tuple[int, int]:
    rows, columns = (_positive(header, name, path) for name in ("nrows", "ncols"))
    if rows % 1 or columns % 1:
        raise MapError(f"{path}: nrows and ncols must be whole numbers, got {rows} and {columns}")
    if max(rows, columns) > MOST_SIDE or rows * columns > MAX_SAMPLES:
        raise MapError(
            f"{path}: the header promises {rows:.0f} x {columns:.0f} samples, more than {MAX_SAMPLES} or {MOST_SIDE} "
            "along a side; mend the header or cut the grid"
        )
    return int(rows), int(columns)


def _positive(header: dict[str, str], name: str, path: Path) -> float:
    if name not in header:
        raise MapError(
            f"{path}: the header lacks {name}; an ESRI ASCII grid begins with ncols, nrows, xllcorner, "
            f"yllcorner, cellsize, found {', '.join(header) or 'none of them'}"
        )
    value = _number(header[name], f"{path}: {name}")
    if not (math.isfinite(value) and value > 0):
        raise MapError(f"{path}: {name} must be positive, got {header[name]}")
    return value


def _number(word: str, place: str) -> float:
    try:
        return float(word)
    except ValueError:
        raise MapError(f"{place}: {word[:40]!r} is not a number (decimals take a point)") from None


def _read_rows(numbered: Iterable[_Line], shape: tuple[int, int], path: Path) -> NDArray[np.float64]:
    rows, columns = shape
    picture: list[NDArray[np.float64]] = []  # grows with the file, not with what its header promises
    for number, words in numbered:
        if len(picture) == rows:
            raise MapError(f"{path}:{number}: more than the {rows} rows that nrows promises")
        if len(words) != columns:
            raise MapError(f"{path}:{number}: {len(words)} values in a row, ncols promises {columns}")
        picture.append(_numbers(words, f"{path}:{number}"))
    if len(picture) < rows:
        raise MapError(f"{path}: the file ends after {len(picture)} of the {rows} rows that nrows promises")
    return np.stack(picture)


def _numbers(words: list[str], place: str) -> NDArray[np.float64]:
    try:
        return np.array(words, dtype=np.float64)
    except ValueError:  # one by one, to name the one at fault
        return np.array([_number(word, place) for word in words])


READERS = {".npy": _read_npy, ".npz": _read_npz, ".asc": _read_ascii, ".txt": _read_ascii}
