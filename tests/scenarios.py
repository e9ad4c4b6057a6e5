"""Scenarios for the tests of what looks at them: drawn at random under every motion, or from a picture."""

import numpy as np
from hypothesis import strategies as st

from antgym.maps.motion import CORNERS, REACH, Motion
from antgym.maps.world import GridWorld, Scenario

CELLS = [(15.0, 15.0, 15.0), (1.0, 0.5, 8.0), (2.0, 300.0, 0.01)]
GRIDS = [Motion(name, corners=corner) for name in CORNERS for corner in CORNERS[name] if name != "layered"]


@st.composite
def layered(draw, max_side=7):
    """Boxes of any shape with random cells, start and goal anywhere that the motion allows."""
    shape = (draw(st.integers(2, max_side)), draw(st.integers(1, max_side)), draw(st.integers(1, max_side)))
    rng = np.random.default_rng(draw(st.integers(0, 10**6)))
    first, last = sorted(rng.choice(shape[0], 2, replace=False).tolist())
    start = (first, *(int(rng.integers(n)) for n in shape[1:]))
    reach = REACH * (last - first)
    near = (
        int(np.clip(c + rng.integers(-reach, reach + 1), 0, n - 1))
        for c, n in zip(start[1:], shape[1:], strict=True)
    )
    motion = Motion(check_segments=draw(st.booleans()))
    return _filled(draw, rng, shape, start, (last, *near), motion)


@st.composite
def grids(draw, max_side=7, motions=GRIDS):
    """The same under a grid motion, one cell high where it is a flat one."""
    motion = draw(st.sampled_from(motions))
    most = [max_side, max_side, max_side if motion.name == "grid26" else 1]
    shape = draw(st.tuples(*(st.integers(1, n) for n in most)).filter(lambda shape: np.prod(shape) > 1))
    rng = np.random.default_rng(draw(st.integers(0, 10**6)))
    ends = rng.choice(np.prod(shape), 2, replace=False)
    start, goal = (tuple(map(int, np.unravel_index(end, shape))) for end in ends)
    return _filled(draw, rng, shape, start, goal, motion)


def _filled(draw, rng, shape, start, goal, motion):
    free = rng.random(shape) < draw(st.floats(0.2, 1))
    free[start] = free[goal] = True
    return Scenario(GridWorld(free, draw(st.sampled_from(CELLS))), start, goal, motion)


def scenarios(max_side=7):
    """Scenarios under any motion."""
    return layered(max_side) | grids(max_side)


def drawn(lines, motion=None, name="drawn"):
    """A world one cell high from a picture: a line per layer along x, a character per cell along y."""
    free = np.array([[c != "#" for c in line] for line in lines])[:, :, None]
    start, goal = (next((x, line.index(c), 0) for x, line in enumerate(lines) if c in line) for c in "SG")
    return Scenario(GridWorld(free), start, goal, motion or Motion(), name)
