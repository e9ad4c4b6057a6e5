"""Files from strangers: text line by line, within bounds, and the words in which every reader refuses one."""

import gzip
import io
import math
import zlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import BinaryIO

from antgym.errors import MapError

MOST_BYTES = 140_000_000  # of a file, unpacked
MOST_LINE = 2_000_000  # bytes
MOST_BLANK = 100_000  # lines with nothing in them: there are archives of nothing else
MOST_SIDE = 1 << 16  # cells of a map along an axis
MOST_CELLS, MOST_FLAT = (
    512**3,
    4096**2,
)  # in space, and of flat maps, whose cells take more within their borders

Line = tuple[int, str]
"""A line and its number, counted from 1."""


def is_file(path: Path) -> bool:
    """Whether there is such a file; none has a name that the system cannot even look for."""
    try:
        return path.is_file()
    except (OSError, ValueError):  # too long, or with a zero byte
        return False


def require_file(path: Path, most: int = MOST_BYTES) -> None:
    """Raise MapError where there is no such file, or it has more than ``most`` bytes."""
    if not is_file(path):
        raise MapError(f"{path}: no such file (looked in {path.parent.resolve()})")
    if path.stat().st_size > most:
        raise MapError(
            f"{path}: {path.stat().st_size:,} bytes, at most {most:,} are read; cut or thin the map"
        )


def content(path: Path, most: int = MOST_BYTES) -> bytes:
    """Return all of a file; MapError where it cannot be read."""
    require_file(path, most)
    try:
        return path.read_bytes()
    except OSError as error:
        raise MapError(f"{path}: cannot be read ({error.strerror or error})") from None


def text(path: Path, most: int) -> str:
    """Return all of a text file; MapError where it is none."""
    try:
        return content(path, most).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise MapError(f"{path}: not a text file (byte {error.start} is no UTF-8)") from None


def lines(path: Path) -> Iterator[Line]:
    """Yield the lines of a text file, of one that is gzipped where its name ends in .gz, without their ends.

    Raises:
        MapError: if it cannot be read, is damaged, unpacks to too much, or has a line that no map has.
    """
    require_file(path)
    number = read = blank = 0
    try:
        with _opened(path) as file:
            while line := file.readline(MOST_LINE + 1):
                number, read = number + 1, read + len(line)
                if len(line) > MOST_LINE:
                    raise MapError(
                        f"{path}:{number}: a line of over {MOST_LINE:,} bytes; is this a text file?"
                    )
                if read > MOST_BYTES:
                    raise MapError(
                        f"{path}:{number}: it unpacks to over {MOST_BYTES:,} bytes; cut or thin the map"
                    )
                blank += len(line) < 3 and not line.strip()
                if blank > MOST_BLANK:
                    raise MapError(f"{path}:{number}: over {MOST_BLANK:,} empty lines; is this a map?")
                yield number, line.decode("utf-8-sig", errors="replace").rstrip("\r\n")
    except (OSError, EOFError, zlib.error) as error:
        raise MapError(f"{path}:{number + 1}: cannot be read ({error})") from None


def _opened(path: Path) -> BinaryIO | io.BufferedReader:
    if path.suffix.lower() != ".gz":
        return path.open("rb")
    return io.BufferedReader(gzip.open(path, "rb"))


def whole(word: str, place: str, least: int = 0, most: int = MOST_SIDE) -> int:
    """Return a whole number within bounds; MapError names the place and the word."""
    try:
        value = int(word) if len(word) <= 20 else None
    except ValueError:
        value = None
    if value is None or not least <= value <= most:
        raise MapError(f"{place}: {word[:40]!r} must be a whole number from {least:,} to {most:,}")
    return value


def real(word: str, place: str) -> float:
    """Return a finite number; MapError names the place and the word."""
    try:
        value = float(word)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise MapError(f"{place}: {word[:40]!r} is not a number (decimals take a point)")
    return value


def require_cells(shape: Sequence[int], place: str) -> None:
    """Raise MapError where a map, flat where its shape is, would have no cell, or too many for memory."""
    most = MOST_FLAT if len(shape) == 2 else MOST_CELLS
    if min(shape) < 1 or math.prod(shape) > most:
        sides = " x ".join(f"{side:,}" for side in shape)
        raise MapError(f"{place}: {sides} cells; a map has from 1 to {most:,}; cut it or take larger cells")
