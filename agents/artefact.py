"""Files of trained agents: one JSON object each, named by its format; reading one runs nothing of it."""

import json
import os
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from antgym.errors import ParameterError

Floats = NDArray[np.float64]
_Artefact = TypeVar("_Artefact")


def save(path: str | Path, form: str, content: Mapping[str, Any]) -> None:
    """Write an artefact as JSON; a file of that name is replaced at once or not at all."""
    write_whole(Path(path), json.dumps({"format": form, **content}, indent=1).encode())


def write_whole(path: Path, data: bytes) -> None:
    """Write a file that is there as a whole or not at all."""
    draft = path.with_name(f"{path.name}.{os.getpid()}.tmp")
    draft.write_bytes(data)
    draft.replace(path)


def load(path: str | Path, form: str, kind: type[_Artefact]) -> _Artefact:
    """Return the artefact in a file, lists as tuples; ParameterError names the file and what is wrong with it.

    Args:
        path: the file.
        form: its format.
        kind: the dataclass whose fields it holds.
    """
    path, what = Path(path), form.removeprefix("antgym ").rstrip("0123456789 ")
    known = {each.name for each in fields(kind)}  # type: ignore[arg-type]  # a dataclass
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise ParameterError(f"{path}: no such {what}") from None
    except OSError as error:
        raise ParameterError(f"{path}: no {what} ({error.strerror})") from None
    except (ValueError, RecursionError) as error:
        raise ParameterError(f"{path}: no JSON ({error})") from None
    if not isinstance(content, dict) or content.pop("format", None) != form or set(content) != known:
        raise ParameterError(f"{path}: not an {form!r} with the fields {', '.join(sorted(known))}")
    try:
        return kind(**{name: as_tuples(value) for name, value in content.items()})
    except (ParameterError, TypeError) as error:
        raise ParameterError(f"{path}: {error}") from None


def as_tuples(values: Any) -> Any:
    """Return nested lists or an array as nested tuples; anything else as it is."""
    if isinstance(values, np.ndarray):
        values = values.tolist()
    return tuple(as_tuples(v) for v in values) if isinstance(values, list) else values


def as_array(values: Any, label: str) -> Floats:
    """Return numbers as a float64 array; ParameterError with the label where they are no regular table."""
    try:
        return np.array(values, dtype=np.float64)
    except (ValueError, TypeError):
        raise ParameterError(f"{label} must be numbers in a regular table") from None
