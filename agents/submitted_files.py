"""Files of a submission, read as what they are: plain files of a bounded size, strict JSON, numbers under names.

Nothing here trusts a name, a length or a header before it is compared with what lies on the disk.
"""

import json
import math
import os
import re
import stat
import struct
from pathlib import Path
from typing import Any

from antgym.errors import ParameterError

MOST_JSON, MOST_WEIGHTS, MOST_HEADER = 1 << 20, 1 << 26, 1 << 20  # bytes
MOST_TENSORS = 1 << 10
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,79}")
_SIZES = {"F64": 8, "F32": 4, "F16": 2, "BF16": 2, "I64": 8, "I32": 4, "I16": 2, "I8": 1, "U8": 1, "BOOL": 1}
_PICKLES = (b"\x80", b"PK\x03\x04")  # a pickle, and the zip of one that torch.save writes


def is_file_name(value: Any) -> bool:
    """Whether this is the name of a file in the folder itself: no path, no hidden file."""
    return isinstance(value, str) and _NAME.fullmatch(value) is not None


def read_plain(path: Path, most: int) -> bytes:
    """Return the content of a plain file.

    Raises:
        ParameterError: where it is not there, is a link or no file, or holds more than ``most`` bytes.
    """
    try:
        handle = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)  # a pipe would wait for a writer
    except OSError as error:
        said = (
            "is a link; put the file itself there"
            if path.is_symlink()
            else f"cannot be read ({error.strerror})"
        )
        raise ParameterError(f"{path}: {said}") from None
    status = os.fstat(handle)
    if not stat.S_ISREG(status.st_mode):
        os.close(handle)
        raise ParameterError(f"{path}: is no plain file")
    with open(handle, "rb") as file:
        if status.st_size > most:
            raise ParameterError(f"{path}: {status.st_size:,} bytes; at most {most:,} are read")
        return file.read(most)


def read_object(path: Path) -> dict[str, Any]:
    """Return the JSON object in a file.

    Raises:
        ParameterError: as :func:`read_plain`, and on what is no JSON object, on a name twice, on NaN or infinity.
    """
    data = read_plain(path, MOST_JSON)
    try:
        content = json.loads(data, object_pairs_hook=_different, parse_constant=_no_constant)
    except (ValueError, RecursionError) as error:
        raise ParameterError(f"{path}: no JSON ({error})") from None
    if not isinstance(content, dict):
        raise ParameterError(f"{path}: no JSON object")
    return content


def _different(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, value in pairs:
        if name in found:
            raise ValueError(f"{name!r:.80} is there twice")
        found[name] = value
    return found


def _no_constant(text: str) -> Any:
    raise ValueError(f"{text} is no number of JSON")


def check_weights(path: Path) -> None:
    """Check that a file is a sound .safetensors before anybody makes room for what it promises.

    Raises:
        ParameterError: as :func:`read_plain`; on a pickle; on a header that is longer than the file, is no table of
            tensors, or promises other bytes than there are.
    """
    data = read_plain(path, MOST_WEIGHTS)
    (length,) = struct.unpack("<Q", data[:8]) if len(data) >= 8 else (len(data),)
    if not 0 < length <= min(MOST_HEADER, len(data) - 8):
        said = f"its header claims {length:,} bytes, the file has {len(data):,}"
        if data.startswith(_PICKLES):
            said = "is a pickle, which could run anything, and is not read; export the policy as safetensors"
        raise ParameterError(f"{path}: {said}")
    try:
        header = json.loads(data[8 : 8 + length], object_pairs_hook=_different)
        header.pop("__metadata__", None)
        _check_tensors(header, len(data) - 8 - length)
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError) as error:
        raise ParameterError(f"{path}: its header is none of safetensors ({error})") from None


def _check_tensors(header: dict[str, Any], room: int) -> None:
    """Raise ValueError unless the tensors fill the bytes after the header, one after the other."""
    if len(header) > MOST_TENSORS:
        raise ValueError(f"{len(header):,} tensors; at most {MOST_TENSORS:,}")
    place = 0
    for name, tensor in sorted(header.items(), key=lambda entry: entry[1]["data_offsets"]):
        begin, end = tensor["data_offsets"]
        sides = tensor["shape"]
        if not all(type(number) is int and number >= 0 for number in (begin, end, *sides)):
            raise ValueError(f"{name!r:.80} has a size that is no whole number")
        wanted = math.prod(sides) * _SIZES[tensor["dtype"]]
        if begin != place or end - begin != wanted:
            raise ValueError(
                f"{name!r:.80} promises {wanted:,} bytes, bytes {begin:,} to {end:,} are its own"
            )
        place = end
    if place != room:
        raise ValueError(f"tensors of {place:,} bytes in all, {room:,} are there")
