"""Files of JSON lines: what was appended is on disk, and a line that a crash cut short is dropped and told of."""

import json
import logging
import os
from collections.abc import Mapping, Sequence
from io import FileIO
from pathlib import Path
from typing import Any

from antgym.errors import LedgerError

LOG = logging.getLogger(__name__)


def mend(file: FileIO) -> list[bytes]:
    """Return a file's lines; a last one that is not whole is cut off: nobody was told of it."""
    file.seek(0)
    data = file.read()
    lines, rest = _whole(data)
    if rest:
        file.truncate(len(data) - rest)
        LOG.warning("%s: a last line of %d bytes was cut short by a crash; it is dropped", file.name, rest)
    return lines


def read(path: Path) -> list[bytes]:
    """Return the lines of a file as they are, without one at its end that is not whole (yet); none where none is."""
    try:
        lines, rest = _whole(path.read_bytes())
    except FileNotFoundError:
        return []
    if rest:
        LOG.warning("%s: a last line of %d bytes is not whole; it is left out", path, rest)
    return lines


def read_fields(path: Path, *needed: str) -> list[dict[str, Any]]:
    """Return the lines of a file as objects, as :func:`read` does.

    Args:
        path: of the file.
        needed: names of fields that every line has.

    Raises:
        LedgerError: with its number, if a line is no such object.
    """
    found: list[dict[str, Any]] = []
    for number, line in enumerate(read(path), start=1):
        try:
            fields = json.loads(line)
            lacking = sorted({*needed} - {*fields.keys()})
            if lacking:
                raise ValueError(f"it lacks {', '.join(lacking)}")
        except (ValueError, AttributeError) as error:
            raise LedgerError(f"{path}, line {number} is damaged ({error}); remove this line") from None
        found.append(fields)
    return found


def _whole(data: bytes) -> tuple[list[bytes], int]:
    end = data.rfind(b"\n") + 1
    return data[:end].splitlines(), len(data) - end


def append(
    file: FileIO, lines: Sequence[Mapping[str, Any]], lost: str = "nothing of this batch is kept"
) -> None:
    """Add lines and wait for the disk; where that fails, the file is what it was before, and what is lost is said."""
    if not lines:
        return
    before = file.seek(0, os.SEEK_END)
    rest = b"".join(json.dumps(line, separators=(",", ":")).encode() + b"\n" for line in lines)
    try:
        while rest:
            rest = rest[file.write(rest) :]
        os.fsync(file.fileno())
    except BaseException as error:
        file.truncate(before)
        if isinstance(error, OSError):
            advice = "make room and give the same command again"
            raise LedgerError(
                f"{file.name!s} cannot be written: {error.strerror}; {lost}; {advice}"
            ) from None
        raise


def sync_folder(folder: Path) -> None:
    """Wait until the disk has the names of a folder's files: the file alone may be lost with the power."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
