"""How many threads the planner takes."""

import multiprocessing
from concurrent.futures import ProcessPoolExecutor

import pytest

from antgym.errors import ParameterError
from antgym.planners import threads
from antgym.planners.threads import run_ranges, thread_count


@pytest.mark.parametrize("method", ["fork", "spawn"])
@pytest.mark.parametrize(("told", "expected"), [("", 1), ("3", 3)])
def test_a_worker_takes_one_thread_unless_told(monkeypatch, method, told, expected):
    """Its siblings have the other cores: AsyncVectorEnv and SubprocVecEnv start one process an environment."""
    monkeypatch.setenv("ANTGYM_THREADS", told)
    with ProcessPoolExecutor(1, multiprocessing.get_context(method)) as pool:
        assert pool.submit(thread_count).result(timeout=60) == expected


def test_a_process_of_its_own_takes_the_cores_it_may_use(monkeypatch):
    monkeypatch.delenv("ANTGYM_THREADS", raising=False)
    assert thread_count() >= 1
    monkeypatch.setenv("ANTGYM_THREADS", "two")
    with pytest.raises(ParameterError, match="ANTGYM_THREADS='two'"):
        thread_count()


@pytest.mark.parametrize("count", ["1", "2", "5"])
def test_ranges_cover_every_item_once(monkeypatch, count):
    monkeypatch.setenv("ANTGYM_THREADS", count)
    seen = []
    run_ranges(lambda first, last: seen.extend(range(first, last)), 23)
    assert sorted(seen) == list(range(23))


def test_batches_of_any_size_share_their_threads(monkeypatch):
    monkeypatch.setenv("ANTGYM_THREADS", "7")
    before = set(threads._POOLS)
    for total in (2, 3, 5, 7, 40):
        run_ranges(lambda *_: None, total)
    assert set(threads._POOLS) - before <= {7}
