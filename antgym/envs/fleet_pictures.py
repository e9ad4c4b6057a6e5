"""What environments of fleets render: a strip of frames from above, robots as discs of their size on their way.

By numpy only, since rendering must need no extra; a strip with axes' titles and an animated page, for readers, are
:mod:`antgym.fleet_pictures`.
"""

from itertools import product

import numpy as np
from numpy.typing import NDArray

from antgym.envs.grid_pictures import HIGH, LOW, START
from antgym.maps.fleet import Fleet
from antgym.planners.fleet import FleetPlan, FleetRun
from antgym.planners.timed import TimedPath

FRAMES = 4
SIDE = 240  # pixels of the longer edge of a frame
MARGIN = 4  # pixels between two frames
_HEX = ("d0431a", "1b66b8", "7a3f9d", "13806a", "b8741a", "8c2f4f", "5a6b1a", "3b4a54")
COLOURS = np.array([list(bytes.fromhex(colour)) for colour in _HEX]) / 255
"""(8, 3) of robots, in [0, 1]; with more robots, from the first again."""


def canvas(fleet: Fleet, run: FleetRun | None) -> NDArray[np.str_]:
    """Return (nx, ny) characters: ``#`` blocked, ``o`` paths, ``S`` and ``G`` the ends of all robots."""
    drawn = np.where((fleet.world.free == 0).any(axis=2), "#", " ")
    for path in () if run is None else run.result().paths:
        x, y, _ = np.floor(path.points / fleet.world.cell).astype(int).T
        drawn[x, y] = "o"
    for robot in fleet.robots:
        drawn[robot.start[:2]], drawn[robot.goal[:2]] = "S", "G"
    return drawn


def pixels(fleet: Fleet, run: FleetRun | None) -> NDArray[np.float64]:
    """Return the strip, (h, w, 3) in [0, 1], x to the right, y up: frames at equal intervals of time.

    The first is when all start, the last when all have arrived; where there is no solution, or no run yet, all robots
    stand at their starts.
    """
    plan = None if run is None else run.result()
    frames = []
    for time in np.linspace(0.0, plan.makespan if plan is not None and plan.solved else 0.0, FRAMES):
        frames.append(frame(fleet, plan, float(time)).transpose(1, 0, 2)[::-1])
        frames.append(np.ones((frames[-1].shape[0], MARGIN, 3)))
    return np.concatenate(frames[:-1], axis=1)


def frame(fleet: Fleet, plan: FleetPlan | None, time: float) -> NDArray[np.float64]:
    """Return one frame, (w, h, 3) in [0, 1]: where robots are after some seconds, and their paths so far.

    Starts are green dots, goals crosses in the colour of the robot that goes there.
    """
    blocked = (fleet.world.free == 0).any(axis=2)
    scale = max(1, SIDE // max(blocked.shape))
    image = (LOW + blocked[..., None] * (HIGH - LOW)).repeat(scale, axis=0).repeat(scale, axis=1)
    edges = np.array(fleet.world.cell[:2])
    paths = plan.paths if plan is not None else ()
    for i, robot in enumerate(fleet.robots):
        colour = COLOURS[i % len(COLOURS)]
        _disc(image, np.array(robot.start[:2]) + 0.5, np.full(2, 0.3), scale, START)
        _cross(image, np.array(robot.goal[:2]) + 0.5, scale, colour)
        if paths:
            _line(image, trail(paths[i], time, float(edges.min()) / scale) / edges, scale, colour)
        here = paths[i].at(time) if paths else fleet.world.centre(robot.start)
        _disc(image, here[:2] / edges, fleet.apart / 2 / edges, scale, colour)
    return image


def trail(path: TimedPath, time: float, spacing: float) -> NDArray[np.float64]:
    """Return (n, 2) points of a path so far, ``spacing`` apart at most, world units, wherever it waited."""
    so_far = np.vstack([path.points[path.times < time], path.at(time)])[:, :2]
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(so_far, axis=0), axis=1))])
    places = np.linspace(0.0, along[-1], 1 + int(np.ceil(along[-1] / spacing)))
    return np.stack([np.interp(places, along, axis) for axis in so_far.T], axis=1)


def _cross(
    image: NDArray[np.float64], place: NDArray[np.float64], scale: int, colour: NDArray[np.float64]
) -> None:
    """Draw a cross about a place in cells."""
    arm = np.linspace(-0.4, 0.4, 2 * scale)
    for slope in (-1, 1):
        _line(image, place + np.stack([arm, slope * arm], axis=1), scale, colour)


def _line(
    image: NDArray[np.float64], points: NDArray[np.float64], scale: int, colour: NDArray[np.float64]
) -> None:
    """Draw (n, 2) points, in cells, two pixels wide."""
    x, y = np.floor(points * scale).astype(int).T
    for dx, dy in product((0, 1), repeat=2):
        image[np.minimum(x + dx, image.shape[0] - 1), np.minimum(y + dy, image.shape[1] - 1)] = colour


def _disc(
    image: NDArray[np.float64],
    place: NDArray[np.float64],
    radii: NDArray[np.float64],
    scale: int,
    colour: NDArray[np.float64],
) -> None:
    """Draw a filled disc; place and radii along x and y in cells."""
    low = np.maximum(np.floor((place - radii) * scale).astype(int), 0)
    high = np.minimum(np.ceil((place + radii) * scale).astype(int) + 1, image.shape[:2])
    x, y = (np.arange(a, b) + 0.5 for a, b in zip(low, high, strict=True))
    across, along = (x / scale - place[0]) / radii[0], (y / scale - place[1]) / radii[1]
    inside = across[:, None] ** 2 + along[None, :] ** 2 <= 1
    image[low[0] : high[0], low[1] : high[1]][inside] = colour
