"""Traces: how the runs that judged a recommendation came to their lengths; one npz file a run of the ledger."""

import hashlib
import io
import os
import shutil
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antgym.errors import LedgerError

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
    path = trace_path(folder, key)
    scratch = path.with_suffix(".tmp")
    try:
        path.parent.mkdir(exist_ok=True)
        scratch.write_bytes(packed.getvalue())
        os.replace(scratch, path)
    except OSError as error:
        scratch.unlink(missing_ok=True)
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
        with np.load(path, allow_pickle=False) as packed:
            best: NDArray[np.float32] = packed["best"]
    except FileNotFoundError:
        raise LedgerError(
            f"{folder} has no trace of {key!r}; experiments.sweep --traces keeps them"
        ) from None
    except (OSError, ValueError, KeyError) as error:
        raise LedgerError(
            f"{path} is damaged ({error}); remove it and the run's lines, and run it again"
        ) from None
    return best


def copy_traces(part: Path, folder: Path) -> None:
    """Copy the traces of a part into the ledger that takes it in."""
    for path in sorted((part / TRACES).glob("*.npz")):
        (folder / TRACES).mkdir(exist_ok=True)
        shutil.copyfile(path, folder / TRACES / path.with_suffix(".tmp").name)
        os.replace(folder / TRACES / path.with_suffix(".tmp").name, folder / TRACES / path.name)
