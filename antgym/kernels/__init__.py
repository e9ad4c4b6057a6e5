"""Compiled kernels: pure functions, arrays and scalars in and out; the only home of numba.

Numba's on-disk cache notices an edit of the file a function lives in, not of the files it calls. So the cache
folder is named by a hash of all kernel sources: an edit anywhere here starts an empty folder.
"""

import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numba

_Function = TypeVar("_Function", bound=Callable[..., Any])


def sources_hash() -> str:
    """Return the hash of every kernel source file, 16 hex digits."""
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(path.name.encode() + path.read_bytes())
    return digest.hexdigest()[:16]


# No kernel allocates, so numba's reference counts are switched off: two atomic operations for every array that a
# function touches cost more than all the rest of a plan (90 against 41 ns a move at 20 ants x 100 iterations).
_OPTIONS = {"nogil": True, "error_model": "numpy", "_nrt": False}
_UNWRAPPED = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}


def _cache_folder() -> str | None:
    """Return the folder of the compiled kernels, None where it cannot be written.

    Numba would then fall back to a folder beside the sources, which no hash protects: better to compile anew.
    """
    default = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "antgym"
    folder = Path(os.environ.get("NUMBA_CACHE_DIR") or default) / f"kernels-{sources_hash()}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return None
    return str(folder) if os.access(folder, os.W_OK) else None


_CACHE_FOLDER = _cache_folder()


def kernel(function: _Function) -> _Function:
    """Compile a function that Python calls: without the GIL and fastmath, cached in the folder of these sources."""
    return _cached(function)


def inner(function: _Function) -> _Function:
    """Compile and cache a function that kernels alone call: with wrappers for Python all would take a quarter longer.

    Called from Python, it ends the process.
    """
    return _cached(function, **_UNWRAPPED)


def inlined(function: _Function) -> _Function:
    """Compile a small function that the kernels alone call, in their inner loops; from Python, it ends the process."""
    return _inlined(function, **_UNWRAPPED)


def formula(function: _Function) -> _Function:
    """Compile a small function for the kernels' inner loops that Python may call, too, as the tests' twins do."""
    return _inlined(function)


def _cached(function: _Function, **options: bool) -> _Function:
    """Compile and cache a function.

    Numba reads its cache folder from a global setting when a function is decorated; it is put back at once, so
    that the user's own functions are cached where they always were.
    """
    if _CACHE_FOLDER is None:
        return numba.njit(function, **options, **_OPTIONS)
    before = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = _CACHE_FOLDER
    try:
        return numba.njit(function, cache=True, **options, **_OPTIONS)
    finally:
        numba.config.CACHE_DIR = before


def _inlined(function: _Function, **options: bool) -> _Function:
    return numba.njit(function, forceinline=True, **options, **_OPTIONS)
