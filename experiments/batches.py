"""What a native batch of environments costs beside its planner, and against the same environments one by one.

Wall time, two threads, everything that a suite computes once computed before the clock starts. Every step ends every
episode, so that each is paid for together with the beginning of the next.
"""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from statistics import median
from typing import Any
from unittest.mock import patch

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from numpy.typing import NDArray

from antgym.bench import threads
from antgym.maps.suites import load_suite
from antgym.planners import planning
from antgym.planners.threads import run_ranges

ENV, SUITE = "antgym/MountainOneShot-v0", "mountain-v0"
SLOTS, EFFORT = 256, (20, 100)
"""Of the batch whose time outside the planner is measured."""
FEW, QUICK = 64, (5, 3)
"""Of the batch that is compared with single environments: planning takes next to nothing."""
Step = Callable[[NDArray[np.float32]], Any]


def batches(repeats: int, slots: int = SLOTS, few: int = FEW) -> dict[str, Any]:
    """Return the figures of both measurements."""
    for item in load_suite(SUITE, "train"):
        _ = item.scenario.optimum, item.scenario.descriptors
    with threads(2):
        return {"overhead": overhead(repeats, slots), "singles": singles(repeats, few)}


def overhead(repeats: int, slots: int = SLOTS) -> dict[str, float]:
    """Return the share of a step spent outside the planner, and microseconds per slot: outside, and of the whole."""
    batch = gymnasium.make_vec(ENV, num_envs=slots, effort=EFFORT)
    batch.reset(seed=0)
    actions = _actions(slots, repeats + 1)
    rows = []
    with planner_clock() as inside:
        for action in actions:
            inside[0], begun = 0.0, time.perf_counter()
            batch.step(action)
            whole = time.perf_counter() - begun
            rows.append((1 - inside[0] / whole, (whole - inside[0]) / slots * 1e6, whole / slots * 1e6))
    share, outside, whole = (median(column) for column in zip(*rows[1:], strict=True))  # the first compiles
    return {
        "slots": slots,
        "share_outside": round(share, 4),
        "us_outside": round(outside, 1),
        "us": round(whole, 1),
    }


def singles(repeats: int, slots: int = FEW) -> dict[str, Any]:
    """Return microseconds per slot of the batch and of vectors of single environments, and these over the batch's."""
    made = {name: make(slots) for name, make in _VECTORS.items()}
    steps = {name: step for name, step in made.items() if step is not None}
    turns: dict[str, list[float]] = {name: [] for name in steps}
    for action in _actions(slots, repeats + 1):
        for name, step in steps.items():
            begun = time.perf_counter()
            step(action)
            turns[name].append((time.perf_counter() - begun) / slots * 1e6)
    ours = turns["native"][1:]
    return {
        "slots": slots,
        "us": {name: round(median(turn[1:]), 1) for name, turn in turns.items()},
        "ratio": {
            name: round(median(other / own for other, own in zip(turn[1:], ours, strict=True)), 2)
            for name, turn in turns.items()
        },
    }


@contextmanager
def planner_clock() -> Iterator[list[float]]:
    """Sum up, in a list of one number, the seconds that planner calls take inside the block."""
    inside = [0.0]

    def timed(work: Callable[[int, int], None], total: int) -> None:
        begun = time.perf_counter()
        run_ranges(work, total)
        inside[0] += time.perf_counter() - begun

    with patch.object(planning, "run_ranges", timed):
        yield inside


def to_sentence(figures: dict[str, Any]) -> str:
    """Return what :func:`batches` measured in words."""
    outside, beside = figures["overhead"], figures["singles"]
    share, ours, whole = (outside[name] for name in ("share_outside", "us_outside", "us"))
    others = " and ".join(f"{ratio} times {name}'s" for name, ratio in beside["ratio"].items() if ratio != 1)
    return (
        f"{outside['slots']} slots, {EFFORT[0]} ants x {EFFORT[1]} iterations: {share:.1%} of a step outside the "
        f"planner, {ours} of {whole} µs a slot; {beside['slots']} slots, {QUICK[0]} x {QUICK[1]}: throughput {others}"
    )


def _actions(slots: int, count: int) -> NDArray[np.float32]:
    return np.random.default_rng(0).uniform(-1, 1, (count, slots, 4)).astype(np.float32)


def _native(slots: int) -> Step:
    batch = gymnasium.make_vec(ENV, num_envs=slots, effort=QUICK)
    batch.reset(seed=0)
    return batch.step


def _sync(slots: int) -> Step:
    batch = SyncVectorEnv([_single] * slots, autoreset_mode=AutoresetMode.SAME_STEP)
    batch.reset(seed=0)
    return batch.step


def _dummy(slots: int) -> Step | None:
    try:
        from stable_baselines3.common.vec_env import DummyVecEnv
    except ImportError:
        return None
    batch = DummyVecEnv([_single] * slots)
    batch.reset()
    return batch.step


def _single() -> gymnasium.Env[Any, Any]:
    return gymnasium.make(ENV, effort=QUICK)


_VECTORS = {"native": _native, "SyncVectorEnv": _sync, "DummyVecEnv": _dummy}
