"""Make docs/worlds.png, the README's gallery: a scenario of every family, the path of a tuned swarm and the optimum.

    python docs/gallery.py

Worlds over a height are drawn as blocks, cut open along the two paths so that both are seen; flat ones and discs from
above. The swarm runs with the best of some settings drawn at random, on a seed that was not among those they were
compared on.
Needs matplotlib, and Pillow, which comes with it and makes the file small.
"""

from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image

from antgym import Scenario, SuiteItem, TuningProblem, load_suite, plan_scene
from antgym.envs.catalogue import WORLDS
from antgym.maps.discs import DiscScenario, DiscWorld
from antgym.maps.fleet import Fleet, robots_of
from antgym.maps.optimum import shortest_path
from antgym.planners.fleet import FleetPlan
from antgym.planners.plans import Plan
from antgym.tuning.problem import FRESH

PICTURE = Path(__file__).with_name("worlds.png")
SETTINGS, RUNS = 64, 4
PAPER, INK, FAINT = "#fafaf5", "#1d2426", "#5b6567"
COLONY = {"color": "#d0431a", "lw": 2.4, "solid_capstyle": "round"}
OPTIMUM = {"color": INK, "lw": 1.7, "ls": (0, (1, 1.2))}
START, GOAL = (
    {"color": colour, "marker": "o", "ms": 9, "mec": PAPER, "mew": 1.3, "ls": ""}
    for colour in ("#11834a", "#e3a008")
)
TITLE = {"fontsize": 14, "fontweight": "bold", "family": "serif", "color": INK}
NOTE = {"fontsize": 10.5, "color": FAINT}
VALLEY, SUMMIT = np.array([0.84, 0.85, 0.78]), np.array([0.50, 0.45, 0.40])
FLOOR, CUT, LOW_WALL = "#f0ebe1", "#dcd7c8", 1.2  # height of a flat world's blocked cells, in cells


class Panel(NamedTuple):
    """One picture of the gallery: world, index in its split, and a title."""

    world: str
    title: str
    index: int
    split: str = "test"


PANELS = (
    Panel("Mountain", "mountains", 3),
    Panel("Mountain", "real terrain", 2, "ood"),
    Panel("PotentialField", "ridges", 9),
    Panel("PotentialField", "forest", 26),
    Panel("PotentialField", "boxes", 27),
    Panel("PotentialField", "caves", 28),
    Panel("PotentialField", "pockets", 2),
    Panel("Room", "rooms", 0),
    Panel("Fleet", "rooms", 2),
    Panel("Pallet", "clutter", 2),
    Panel("Open", "mazes", 25),
    Panel("Open", "warehouse", 59),
    Panel("Bee", "corridors", 9),
    Panel("Bee", "scatter", 5),
    Panel("TabuBee", "wu2018", 3),
)


class View(NamedTuple):
    """A parallel projection: turned by an azimuth, tilted by an elevation, radians."""

    azimuth: float
    elevation: float

    def project(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return (..., 2) of (..., 3) points, x to the right, y to the back, z up."""
        x, y, z = np.moveaxis(points, -1, 0)
        back = y * np.cos(self.azimuth) - x * np.sin(self.azimuth)
        across = x * np.cos(self.azimuth) + y * np.sin(self.azimuth)
        return np.stack([across, back * np.sin(self.elevation) + z * np.cos(self.elevation)], axis=-1)


SOLID, FLAT = View(np.radians(24), np.radians(32)), View(0.0, np.radians(72))
# corners of a cell's faces that are seen, counter-clockwise, the step to the cell beyond, and how much light they get
FACES = (
    (((0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)), (0, 0, 1), 1.0),
    (((0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)), (0, -1, 0), 0.80),
    (((1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1)), (1, 0, 0), 0.64),
)


def tuned(item: SuiteItem) -> Plan | FleetPlan:
    """Return a plan by the best of some random settings."""
    problem = TuningProblem(item.scenario, item.rules, item.ants, item.iterations)
    units = np.random.default_rng(0).random((SETTINGS, len(problem.space)))
    lengths = problem.run(np.repeat(units, RUNS, axis=0), FRESH, 0).lengths
    best = problem.gap(lengths).reshape(SETTINGS, RUNS).mean(axis=1).argmin()
    return problem.run(units[best : best + 1], FRESH, SETTINGS * RUNS).plan(0)


def cut_open(blocked: NDArray[np.bool_], paths: list[NDArray[np.int64]]) -> NDArray[np.bool_]:
    """Return the blocked cells without those in front of the paths, layer by layer; before the start, of the start."""
    layers = np.arange(blocked.shape[0])
    front = np.min([np.interp(layers, *path[:, :2].T) for path in paths], axis=0).astype(int)
    return blocked & (np.arange(blocked.shape[1])[None, :, None] >= front[:, None, None])


def blocks(solid: NDArray[np.bool_], view: View, height: float = 1.0) -> PolyCollection:
    """Return the faces of solid cells that are seen, the farthest first."""
    nx, ny, nz = solid.shape
    padded = np.pad(solid, 1)
    polygons, colours = [], []
    for y, x, z in product(range(ny - 1, -1, -1), range(nx), range(nz)):
        for corners, (dx, dy, dz), light in FACES if solid[x, y, z] else ():
            if not padded[x + 1 + dx, y + 1 + dy, z + 1 + dz]:
                polygons.append(view.project((np.array(corners) + np.array([x, y, z])) * (1, 1, height)))
                colours.append(light * (VALLEY + (z + 0.5) / nz * (SUMMIT - VALLEY)))
    return PolyCollection(polygons, facecolors=colours, edgecolors=colours, linewidths=0.25)


def tiles(cells: NDArray[np.int64], view: View, colour: str) -> PolyCollection:
    """Return squares on the ground, of (n, 2) cells."""
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    ground = np.pad(cells, ((0, 0), (0, 1)))[:, None, :]
    return PolyCollection(
        list(view.project(corners + ground)), facecolors=colour, edgecolors=colour, linewidths=0.25
    )


def draw_world(axes: Any, scenario: Scenario | Fleet, paths: list[NDArray[np.int64]]) -> None:
    """Draw a flat world as low walls, any other as blocks that are cut open along the paths, on a plate."""
    blocked, flat = scenario.world.free == 0, scenario.world.shape[2] == 1
    view, kept = (FLAT, blocked) if flat else (SOLID, cut_open(blocked, paths))
    axes.add_collection(tiles(np.argwhere(np.ones(blocked.shape[:2])), view, FLOOR))
    axes.add_collection(tiles(np.argwhere((blocked & ~kept).any(axis=2)), view, CUT))
    axes.add_collection(blocks(kept, view, LOW_WALL if flat else 1.0))


def draw(axes: Any, panel: Panel) -> None:
    """Draw one panel and say what it shows."""
    item = load_suite(WORLDS[panel.world], panel.split)[panel.index]
    scenario, plan = item.scenario, tuned(item)
    size = (draw_scene if isinstance(scenario.world, DiscWorld) else draw_grid)(axes, scenario, plan.path)
    gap = plan.length / scenario.optimum - 1
    axes.set_title(f"{panel.world}: {panel.title}", loc="left", pad=19, **TITLE)
    axes.text(0, 1.02, f"{size}, {item.rules}, gap {gap:.0%}", transform=axes.transAxes, **NOTE)
    axes.set_aspect("equal", adjustable="datalim")
    axes.autoscale_view()
    axes.axis("off")


def draw_scene(axes: Any, scenario: DiscScenario, path: NDArray[np.float64]) -> str:
    """Draw discs from above, a path and the optimum; return how many discs there are."""
    plan_scene.draw_discs(axes, scenario.world, FLOOR, SUMMIT)
    for line, style in ((path, COLONY), (shortest_path(scenario), OPTIMUM)):
        axes.plot(*np.asarray(line).T, **style)
    for point, style in ((scenario.start, START), (scenario.goal, GOAL)):
        axes.plot(*point, zorder=5, **style)
    return f"{len(scenario.world.discs)} discs"


def draw_grid(axes: Any, scenario: Scenario | Fleet, path: NDArray[Any]) -> str:
    """Draw a grid, a path and the optimum, or those of a fleet; return how many cells there are."""
    best = shortest_path(scenario)
    flat = scenario.world.shape[2] == 1
    draw_world(axes, scenario, [path, best])
    view, centre = (FLAT, np.array([0.5, 0.5, 0.0])) if flat else (SOLID, np.full(3, 0.5))
    for line, style in ((path, COLONY), (best, OPTIMUM)):
        axes.plot(*view.project(line + centre).T, **style)
    for robot in robots_of(scenario):
        for cell, style in ((robot.start, START), (robot.goal, GOAL)):
            axes.plot(*view.project(np.array(cell) + centre), zorder=5, **style)
    return " × ".join(str(n) for n in scenario.world.shape[: 2 if flat else 3])


def key(axes: Any) -> None:
    """Say what colours and lines mean."""
    rows = ((COLONY, "path of a tuned swarm"), (OPTIMUM, "exact optimum"), (START, "start"), (GOAL, "goal"))
    for i, (style, text) in enumerate(rows):
        ends = [0.02, 0.16] if "lw" in style else [0.09]
        axes.plot(ends, [0.8 - 0.11 * i] * len(ends), **style)
        axes.text(0.22, 0.8 - 0.11 * i, text, va="center", fontsize=12, color=INK)
    axes.text(
        0.02, 0.24, "Solids are cut open along the paths;\nthe darker ground is what was cut away.", **NOTE
    )
    axes.set(xlim=(0, 1), ylim=(0, 1))
    axes.axis("off")


def main() -> None:
    """Write the picture."""
    figure = Figure(figsize=(14.8, 16.5), facecolor=PAPER)
    figure.subplots_adjust(0.015, 0.01, 0.985, 0.96, wspace=0.06, hspace=0.2)
    grid = figure.subplots(4, 4).ravel()
    for axes, panel in zip(grid, PANELS, strict=False):
        draw(axes, panel)
    key(grid[-1])
    figure.savefig(PICTURE, dpi=100)
    steps = [
        min(255, 5 * round(value / 5)) for value in range(256)
    ]  # unseen by the eye, and a third less to store
    Image.open(PICTURE).convert("RGB").point(3 * steps).save(PICTURE, optimize=True)
    print(f"{PICTURE}: {PICTURE.stat().st_size / 1000:.0f} KB")


if __name__ == "__main__":
    main()
