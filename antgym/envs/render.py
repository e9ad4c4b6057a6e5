"""Pictures of the last run: the world, and the path and what the swarm left over it; numpy only.

Of a fleet, robots on their way.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from antgym.envs import disc_pictures, fleet_pictures, grid_pictures
from antgym.maps.discs import DiscWorld
from antgym.maps.fleet import Fleet
from antgym.planners.fleet import FleetRun
from antgym.planners.planning import are_bees
from antgym.planners.swarms import Swarm
from antgym.tuning.problem import TuningProblem


def ansi(problem: TuningProblem, swarm: Swarm | FleetRun | None) -> str:
    """Return the map from above, x to the right, y up, ``o`` the path, ``S`` and ``G`` its ends, or those of a fleet.

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


def rgb_array(problem: TuningProblem, swarm: Swarm | FleetRun | None) -> NDArray[np.uint8]:
    """Return the picture, (h, w, 3) uint8: discs from above, grids also from the side where they are not flat.

    Of a fleet a strip of frames, from when all start to when all have arrived.
    """
    picture = _pictures(problem).pixels(problem.scenario, swarm)
    return np.round(255 * np.clip(picture, 0, 1)).astype(np.uint8)


def _pictures(problem: TuningProblem) -> Any:
    if isinstance(problem.scenario, Fleet):
        return fleet_pictures
    return disc_pictures if isinstance(problem.scenario.world, DiscWorld) else grid_pictures
