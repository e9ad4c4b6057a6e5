"""Pictures of the last run: the world, and the path and what the swarm left over it; numpy only."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from antgym.envs import disc_pictures, grid_pictures
from antgym.maps.discs import DiscWorld
from antgym.planners.planning import are_bees
from antgym.planners.swarms import Swarm
from antgym.tuning.problem import TuningProblem


def ansi(problem: TuningProblem, swarm: Swarm | None) -> str:
    """Return the map from above, x to the right, y up, ``o`` the path, ``S`` and ``G`` its ends.

    Shades are heights; among discs ``#`` is one of these, and ``.`` a way-point of some source.
    """
    ants, iterations = ("bees", "cycles") if are_bees(problem.rules) else ("ants", "iterations")
    effort = f"{problem.ants} {ants}, {problem.iterations} {iterations}"
    lines = [f"{problem.scenario.name}: {effort}, {problem.rules}"]
    if swarm is not None:
        plan, values = swarm.result(), zip(problem.space.names, swarm.parameters, strict=False)
        lines += [", ".join(f"{name} {value:.4g}" for name, value in values)]
        lines += [
            f"length {plan.length:.2f}, optimum {problem.scenario.optimum:.2f}"
            if plan.solved
            else plan.status
        ]
    canvas = _pictures(problem).canvas(problem.scenario, swarm)
    return "\n".join(lines + ["".join(row) for row in canvas.T[::-1]])


def rgb_array(problem: TuningProblem, swarm: Swarm | None) -> NDArray[np.uint8]:
    """Return the picture, (h, w, 3) uint8: discs from above, grids also from the side where they are not flat."""
    picture = _pictures(problem).pixels(problem.scenario, swarm)
    return np.round(255 * np.clip(picture, 0, 1)).astype(np.uint8)


def _pictures(problem: TuningProblem) -> Any:
    return disc_pictures if isinstance(problem.scenario.world, DiscWorld) else grid_pictures
