"""Random disc worlds, rules and parameters for the bees, and what must hold of every plan; ``fuzz.py`` runs them."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antgym.errors import ScenarioError
from antgym.maps.discs import DiscScenario, DiscWorld, path_length
from antgym.maps.world import Scenario
from antgym.planners.bee_rules import BEE_PAPERS, SCOUTS, BeeRules
from antgym.planners.hive import Hive
from antgym.planners.planning import plan
from antgym.planners.plans import Plan

NEARLY = 1e-8  # of a world's extent and of its optimum: what rounding may do
EXTREMES = {"limit": (1.0, 1e4), "xi_max": (1e-3, 1e3), "xi_min": (1e-3, 1e3), "tabu_radius": (1e-6, 1e12)}


def scenario(rng: np.random.Generator) -> DiscScenario | None:
    """Draw a world of any unit and place with up to 25 discs; None where an end lies in a disc."""
    scale = 10.0 ** rng.uniform(-4, 7)
    corner = rng.choice([0.0, 0.0, -1.0, 100.0]) * scale * rng.uniform(0.1, 1.0)
    discs = rng.random((int(rng.integers(0, 26)), 3)) * scale
    discs[:, :2] += corner
    discs[:, 2] *= rng.choice([0.01, 0.1, 0.3])
    discs[:, 2] += scale * 1e-9
    sides = scale * np.array([1.0, rng.choice([1.0, 1.0, 0.05])])
    bounds = [corner, corner + sides[0], corner, corner + sides[1]]
    distances = {
        "robot_radius": float(rng.choice([0.0, 0.01]) * scale),
        "safe_distance": float(rng.choice([0.0, 0.02, 5.0]) * scale),
    }
    start, goal = (tuple((corner + rng.random(2) * sides).tolist()) for _ in range(2))
    try:
        return Scenario(DiscWorld(discs, bounds, **distances), start, goal)
    except ScenarioError:
        return None


def rules(rng: np.random.Generator) -> BeeRules:
    """Draw published rules, or any that the data can say."""
    if rng.random() < 0.3:
        return list(BEE_PAPERS.values())[rng.integers(len(BEE_PAPERS))]
    return BeeRules(
        points=int(rng.choice([1, 2, 5, 12, 40])),
        away=bool(rng.integers(2)),
        scout=str(rng.choice(SCOUTS)),
        elite=bool(rng.integers(2)),
        tabu=int(rng.choice([0, 1, 3, 20])),
        redraws=int(rng.choice([0, 1, 10])),
        pull=float(rng.choice([0.0, 1.5, 100.0])),
        printed=bool(rng.integers(2)),
        weight=float(rng.choice([1e-9, 0.5, 1.0])),
        hit=float(rng.choice([0.0, 10.0, 1e6])),
    )


def parameters(rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw natural values, each at an end of its range in half of the cases."""
    values = []
    for low, high in EXTREMES.values():
        between = math.exp(rng.uniform(math.log(low), math.log(high)))
        values.append(float(rng.choice([low, high, between, between])))
    return np.array(values)


def check(case: int) -> bool:
    """Run one case; return whether a path was found, AssertionError naming the case where something is wrong."""
    rng = np.random.default_rng(np.random.SeedSequence(case))
    question, rule, values = scenario(rng), rules(rng), parameters(rng)
    if question is None:
        return False
    bees, cycles = int(rng.choice([4, 5, 12, 40])), int(rng.choice([1, 2, 30, 200]))
    values = values if rule.tabu else values[:3]
    effort: dict[str, Any] = {"rules": rule, "ants": bees, "iterations": cycles, "seed": case}
    found = plan(question, values, **effort)
    fault = _fault(question, found)
    if not fault and cycles > 1:
        hive, first = Hive(question, **effort), int(rng.integers(1, cycles))
        hive.advance(values, first)
        hive.advance(values, hive.left)
        again = hive.result()
        same = again.moves == found.moves and np.array_equal(again.path, found.path)
        fault = "" if same and np.array_equal(again.mean, found.mean) else "two blocks are not one"
    assert not fault, f"case {case}: {fault}"
    return found.solved


def _fault(question: DiscScenario, found: Plan) -> str:
    world, path = question.world, found.path
    if np.isnan([found.length, *found.best, *found.mean, *path.ravel()]).any():
        return "something is no number"
    if (tuple(path[0]), tuple(path[-1])) != (question.start, question.goal):
        return f"the path {path.tolist()} does not lead from start to goal"
    x_min, x_max, y_min, y_max = world.bounds
    if not ((path >= (x_min, y_min)) & (path <= (x_max, y_max))).all():
        return "a way-point lies out of bounds"
    gap = float(world.clearances(path).min())
    if not found.solved:
        return (
            "" if gap <= NEARLY * world.width else f"the path keeps {gap} away from discs and counts as none"
        )
    if gap < -NEARLY * world.width:
        return f"the path cuts {-gap} into a disc"
    if not math.isclose(path_length(path), found.length, rel_tol=1e-12):
        return "the path has another length"
    try:
        optimum = question.optimum
    except ScenarioError:
        return "a path where none exists"
    return (
        "" if found.length >= optimum * (1 - NEARLY) else f"length {found.length} below the optimum {optimum}"
    )
