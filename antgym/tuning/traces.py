"""Traces: how the runs that judged a recommendation came to their lengths; one npz file a run of the ledger."""

import hashlib
import io
import os
import zlib
from pathlib import Path
from zipfile import BadZipFile

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antgym.errors import LedgerError
from antgym.tuning.lines import sync_folder

TRACES = "traces"


def trace_path(folder: Path, key: str) -> Path:
    """Return where the ledger of a folder has the trace of a run, or would have it."""
    return folder / TRACES / f"{hashlib.sha256(key.encode()).hexdigest()[:24]}.npz"


def write_trace(folder: Path, key: str, best: ArrayLike) -> None:
    """Write a run's trace as a whole.

    Args:
        folder: of the ledger.
        key: of the run.
        best: (fresh, iterations), the length of the best path so far of every judging run, inf before there is any.
    """
    packed = io.BytesIO()
    np.savez_compressed(packed, run=np.array(key), best=np.asarray(best, dtype=np.float32))
    _write(trace_path(folder, key), packed.getvalue())


def _write(path: Path, data: bytes) -> None:
    """Write a trace as a whole and wait for the disk: the outcome that is synced after it must not be without it."""
    scratch = path.with_suffix(".tmp")
    try:
        try:
            path.parent.mkdir(exist_ok=True)
            with scratch.open("wb") as file:
                file.write(data)
                file.flush()
                os.fsync(file.fileno())
            os.replace(scratch, path)
            sync_folder(path.parent)
        finally:
            scratch.unlink(missing_ok=True)
    except OSError as error:
        raise LedgerError(
            f"{path} cannot be written: {error.strerror}; make room and give the same command again"
        ) from None


def read_trace(folder: Path, key: str) -> NDArray[np.float32]:
    """Return the (fresh, iterations) float32 best lengths so far of a run's judging runs.

    Raises:
        LedgerError: if there is no trace of this run, or one that cannot be read.
    """
    path = trace_path(folder, key)
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as packed:
            best: NDArray[np.float32] = packed["best"]
    except FileNotFoundError:
        raise LedgerError(
            f"{folder} has no trace of {key!r}; experiments.sweep --traces keeps them"
        ) from None
    except (OSError, ValueError, KeyError, EOFError, BadZipFile, zlib.error) as error:
        raise LedgerError(
            f"{path} is damaged ({error}); remove it and the run's lines, and run it again"
        ) from None
    return best


def copy_traces(part: Path, folder: Path) -> None:
    """Copy the traces of a part into the ledger that takes it in; LedgerError where the disk is full."""
    for path in sorted((part / TRACES).glob("*.npz")):
        _write(folder / TRACES / path.name, path.read_bytes())
