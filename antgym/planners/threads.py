"""The thread pool of the planner: plain threads over kernels that hold no lock, so no OpenMP and no fork trap."""

import multiprocessing
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

from antgym.errors import ParameterError

_POOLS: dict[int, ThreadPoolExecutor] = {}  # by number of threads
os.register_at_fork(after_in_child=_POOLS.clear)  # a forked child has no threads of its parent's pools


def thread_count() -> int:
    """Return ANTGYM_THREADS, by default every core this process may use, and 1 in a worker of multiprocessing."""
    text = os.environ.get("ANTGYM_THREADS", "")
    if not text and multiprocessing.parent_process() is not None:
        return 1  # its siblings have the other cores
    if not text:
        return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    if not text.isdigit() or int(text) < 1:
        raise ParameterError(
            f"ANTGYM_THREADS={text!r}: needs a whole number of at least 1, or leave it unset"
        )
    return int(text)


def run_ranges(work: Callable[[int, int], None], total: int) -> None:
    """Call ``work(first, last)`` over ranges that cover ``total`` items, on as many threads as there are."""
    threads = thread_count()
    if min(threads, total) <= 1:
        work(0, total)
        return
    parts = min(total, 4 * threads)  # several ranges a thread even out runs of different sizes
    edges = [total * i // parts for i in range(parts + 1)]
    if threads not in _POOLS:
        _POOLS[threads] = ThreadPoolExecutor(threads, thread_name_prefix="antgym")
    list(_POOLS[threads].map(work, edges[:-1], edges[1:]))
