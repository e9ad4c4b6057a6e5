"""Worlds and data shared by the tests; one thread for every library that would take all cores."""

import os

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(name, "1")

from pathlib import Path

import numpy as np
import pytest

from antgym.maps.motion import Motion
from antgym.maps.world import GridWorld, Scenario

SHARED = Path(__file__).parents[2] / "shared" / "data"


@pytest.fixture
def shared_data():
    """The folder of real maps, which is not part of the repository."""
    if not SHARED.is_dir():
        pytest.skip(f"{SHARED} is absent: real maps lie beside a developer's checkout only")
    return SHARED


def random_scenario(seed, size=7, blocked=0.3, check_segments=True, cell=(15.0, 15.0, 15.0)):
    """A box of random cells with a free start and goal; a path may or may not exist."""
    rng = np.random.default_rng(seed)
    free = rng.random((size, size, size)) >= blocked
    start, goal = ((x, *rng.integers(0, size, 2).tolist()) for x in (0, size - 1))
    free[start] = free[goal] = True
    return Scenario(
        GridWorld(free, cell), start, goal, Motion(check_segments=check_segments), name=f"random-{seed}"
    )


def random_grid(seed, motion, size=8, blocked=0.25, cell=(15.0, 15.0, 15.0)):
    """Random cells under a grid motion, start and goal in opposite corners; a path may or may not exist."""
    rng = np.random.default_rng(seed)
    shape = (size, size, size if motion.name == "grid26" else 1)
    free = rng.random(shape) >= blocked
    start, goal = (0, 0, 0), tuple(n - 1 for n in shape)
    free[start] = free[goal] = True
    return Scenario(GridWorld(free, cell), start, goal, motion, name=f"{motion.name}-{seed}")


@pytest.fixture
def valley():
    """A 9 x 9 x 9 world with one mountain in the middle; solvable."""
    x, y = np.mgrid[0:9, 0:9]
    heights = 7 * np.exp(-((x - 4) ** 2 + (y - 4) ** 2) / 6)
    free = np.arange(9)[None, None, :] >= heights[:, :, None]
    return Scenario(GridWorld(free), (0, 4, 1), (8, 4, 1), name="valley")


@pytest.fixture
def room():
    """A flat 7 x 7 world with a pocket between start and goal: an ant that walks into it and may not step back dies."""
    rows = [".......", ".###...", "...#.#.", ".#.#.#.", "...#.#.", ".###...", "......."]
    free = np.array([[c == "." for c in row] for row in rows]).T
    return Scenario(GridWorld(free), (0, 3), (6, 3), Motion("grid8"), name="room")
