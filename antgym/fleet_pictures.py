"""Pictures of fleets for readers: a strip of frames by matplotlib, and an animated page that needs nothing else.

What an environment renders, pixels by numpy alone at every step, is :mod:`antgym.envs.fleet_pictures`; the colours are
the same.
"""

import io
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antgym.envs.fleet_pictures import COLOURS
from antgym.envs.grid_pictures import HIGH, LOW
from antgym.errors import MissingExtraError, ParameterError
from antgym.maps.fleet import Fleet
from antgym.planners.fleet import FleetPlan
from antgym.planners.timed import TimedPath

FRAMES, MOST_FRAMES = 5, 12
SECONDS = 12.0  # that an animation lasts, whatever the fleet takes

Floats = NDArray[np.float64]


def _hex(colour: Floats) -> str:
    """Return a colour of numbers in [0, 1] as pages and matplotlib write it."""
    return "#" + bytes(np.round(255 * colour).astype(np.uint8)).hex()


_FLOOR, _WALL = _hex(LOW), _hex(HIGH)


def strip(plan: FleetPlan, title: str, frames: int = FRAMES, down: bool = False, note: str = "") -> bytes:
    """Return a PNG of a solved plan from above, at equal intervals from when all start to when all have arrived.

    Robots are discs of half the distance that they keep, with their paths so far and, in the first frame, their goals.

    Args:
        plan: of a fleet.
        title: above it.
        frames: 2 to 12.
        down: whether y counts from the top.
        note: below it.

    Raises:
        MissingExtraError: if matplotlib is not installed.
        ParameterError: on another number of frames, or a plan without paths.
    """
    if not 2 <= frames <= MOST_FRAMES:
        raise ParameterError(f"frames = {frames}: a strip has 2 to {MOST_FRAMES}")
    _require_solved(plan)
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise MissingExtraError("matplotlib", "viz") from None
    across, along = _sides(plan.fleet)
    figure = Figure(
        figsize=(2.6 * frames, 2.6 * min(max(along / across, 0.4), 2.5) + 0.6), layout="constrained"
    )
    panels = figure.subplots(1, frames, squeeze=False)[0]
    for axes, time in zip(panels, np.linspace(0.0, plan.makespan, frames).tolist(), strict=True):
        _draw(axes, plan, time)
        axes.set(
            xlim=(0, across), ylim=(along, 0) if down else (0, along), aspect="equal", xticks=[], yticks=[]
        )
        axes.set_title(f"{time:.3g} s", fontsize=10)
    figure.suptitle(title, fontsize=11)
    figure.supxlabel(note, fontsize=9)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=90)
    return buffer.getvalue()


def _draw(axes: Any, plan: FleetPlan, time: float) -> None:
    """Draw one frame."""
    from matplotlib.patches import Circle

    across, along = _sides(plan.fleet)
    walls = (plan.fleet.world.free == 0).any(axis=2)
    axes.set_facecolor(_FLOOR)
    shown = np.ma.masked_equal(walls.T, 0)
    axes.imshow(
        shown, origin="lower", extent=(0, across, 0, along), cmap=_one_colour(), interpolation="nearest"
    )
    for i, path in enumerate(plan.paths):
        colour, here = _colour(i), path.at(time)
        points = np.vstack([path.points[path.times < time], here])
        axes.plot(*points[:, :2].T, color=colour, lw=1.6)
        if time == 0:
            axes.plot(*path.points[-1, :2], marker="x", ms=6, mew=2, color=colour, zorder=4)
        # an edge line would make discs larger than the robots, and overlap where these just pass
        axes.add_patch(Circle((here[0], here[1]), plan.fleet.apart / 2, color=colour, lw=0, zorder=3))


def _one_colour() -> Any:
    from matplotlib.colors import ListedColormap

    return ListedColormap([_WALL])


def animation(plan: FleetPlan, title: str, down: bool = False, note: str = "") -> bytes:
    """Return a page of HTML in which the robots of a solved plan move, over and over: one drawing, no script.

    Robots are where their timed paths have them at every moment, not only at some frames.

    Args:
        plan: of a fleet.
        title: above it.
        down: whether y counts from the top.
        note: below it.

    Raises:
        ParameterError: if the plan has no paths.
    """
    from html import escape

    _require_solved(plan)
    across, along = _sides(plan.fleet)
    flip = "" if down else f' transform="matrix(1 0 0 -1 0 {along:g})"'
    robots = "\n".join(_robot(plan, i, path) for i, path in enumerate(plan.paths))
    return (
        "<!DOCTYPE html>\n"
        f'<html lang="en"><head><meta charset="utf-8"><title>{escape(title)}</title></head>\n'
        '<body style="font-family: sans-serif; margin: 1em">\n'
        f"<h1>{escape(title)}</h1>\n"
        f'<svg viewBox="0 0 {across:g} {along:g}" style="max-width: 100%; height: 80vh; background: {_FLOOR}">\n'
        f'<g{flip}>\n<path fill="{_WALL}" d="{_walls(plan.fleet)}"/>\n{robots}\n</g>\n</svg>\n'
        f"<p>{plan.makespan:.4g} s, shown in {SECONDS:g} s. {escape(note)}</p>\n</body></html>\n"
    ).encode()


def _robot(plan: FleetPlan, index: int, path: TimedPath) -> str:
    """Return the path of a robot, its goal, and the disc that moves along it."""
    colour, radius = _colour(index), plan.fleet.apart / 2
    xy = np.round(path.points[:, :2], 6)
    line = " ".join(f"{x:g},{y:g}" for x, y in xy.tolist())
    times = np.append(path.times, plan.makespan) / plan.makespan
    stands = np.vstack([xy, xy[-1]])
    keys = ";".join(f"{time:.6f}" for time in times.tolist())
    timing = f'keyTimes="{keys}" dur="{SECONDS:g}s" repeatCount="indefinite"'
    moves = "".join(
        f'<animate attributeName="{name}" values="{";".join(f"{value:g}" for value in values)}" {timing}/>'
        for name, values in (("cx", stands[:, 0].tolist()), ("cy", stands[:, 1].tolist()))
    )
    (x, y), (goal_x, goal_y) = xy[0].tolist(), xy[-1].tolist()
    return (
        f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="{radius / 4:g}" opacity="0.5"/>\n'
        f'<circle cx="{goal_x:g}" cy="{goal_y:g}" r="{radius:g}" fill="none" stroke="{colour}" '
        f'stroke-width="{radius / 4:g}"/>\n'
        f'<circle cx="{x:g}" cy="{y:g}" r="{radius:g}" fill="{colour}"><title>robot {index}</title>{moves}</circle>'
    )


def _walls(fleet: Fleet) -> str:
    """Return the blocked cells as one path, a rectangle for each run of them along y."""
    dx, dy, _ = fleet.world.cell
    blocked = np.pad((fleet.world.free == 0).any(axis=2), ((0, 0), (1, 1))).astype(np.int8)
    parts = []
    for x, column in enumerate(np.diff(blocked, axis=1)):
        for first, last in zip(np.flatnonzero(column == 1), np.flatnonzero(column == -1), strict=True):
            parts.append(f"M{x * dx:g} {first * dy:g}h{dx:g}v{(last - first) * dy:g}h{-dx:g}z")
    return "".join(parts)


def _sides(fleet: Fleet) -> tuple[float, float]:
    """Return how wide and how long the world is, in its unit."""
    across, along, _ = np.multiply(fleet.world.shape, fleet.world.cell).tolist()
    return across, along


def _colour(index: int) -> str:
    return _hex(COLOURS[index % len(COLOURS)])


def _require_solved(plan: FleetPlan) -> None:
    if not plan.solved:
        raise ParameterError(f"there are no paths to show: {plan.status}")
