"""Throw random worlds, rules and parameters at the planner and see what breaks; by hand, never in CI.

    NUMBA_BOUNDSCHECK=1 python -m experiments.fuzz --cases 10000
    NUMBA_BOUNDSCHECK=1 python -m experiments.fuzz --swarm bees

Every case is a function of its number, so that a failure can be looked at alone: ``--first N --cases 1``.
"""

import itertools
from dataclasses import dataclass
from typing import Any, Literal, cast

import numpy as np
from numpy.typing import NDArray

from antgym.console import main, parse, progress
from antgym.errors import ScenarioError
from antgym.maps.motion import CORNERS, Motion, move_table, step_lengths
from antgym.maps.moves import legal_moves
from antgym.maps.world import Cell, GridWorld, Scenario
from antgym.planners.colony import Colony, Plan, plan
from antgym.planners.rules import PAPERS, TARGETS, TRAPS, Rules
from experiments import bee_fuzz

MOTIONS = tuple(Motion(name, corners=corners) for name, rules in CORNERS.items() for corners in rules)
LAYERED = (Motion(), Motion(check_segments=False))
EXTREMES = {  # low, high, and whether between them logarithmically
    "alpha": (0.0, 50.0, False),
    "beta": (0.0, 50.0, False),
    "rho": (1e-9, 1.0, True),
    "Q": (1e-6, 1e6, True),
}


@dataclass(frozen=True)
class Arguments:
    """Fuzz the planner: no crash, no NaN, no path that is invalid or shorter than the optimum."""

    swarm: Literal["ants", "bees"] = "ants"
    """Who is fuzzed."""
    cases: int = 10_000
    """How many cases."""
    first: int = 0
    """Number of the first."""


def scenario(rng: np.random.Generator) -> Scenario:
    """Draw a world from all free to nearly blocked, of any shape, with two free cells under any motion."""
    motion = LAYERED[rng.integers(2)] if rng.random() < 0.4 else MOTIONS[rng.integers(1, len(MOTIONS))]
    deep = motion.layered or motion.name == "grid26"
    nx, ny, nz = int(rng.integers(2, 15)), int(rng.integers(1, 12)), int(rng.integers(1, 8)) if deep else 1
    free = rng.random((nx, ny, nz)) >= rng.choice([0.0, 0.1, 0.3, 0.6, 0.95])
    start, goal = (tuple(int(rng.integers(n)) for n in (nx, ny, nz)) for _ in range(2))
    if motion.layered:
        reach = 2 * (nx - 1)
        y, z = (int(np.clip(g, s - reach, s + reach)) for s, g in zip(start[1:], goal[1:], strict=True))
        start, goal = (0, *start[1:]), (nx - 1, y, z)
    elif start == goal:
        start, goal = (0, 0, 0), (nx - 1, ny - 1, nz - 1)
    free[start] = free[goal] = True
    edges = (10.0 ** rng.uniform(-3, 3, 3)).tolist() if rng.random() < 0.3 else [15.0] * 3
    return Scenario(GridWorld(free, tuple(edges)), cast("Cell", start), cast("Cell", goal), motion)


def rules(rng: np.random.Generator) -> Rules:
    """Draw published rules, or any that the data can say."""
    if rng.random() < 0.5:
        return list(PAPERS.values())[rng.integers(len(PAPERS))]
    exponents: dict[str, Any] = {
        name: float(rng.choice([0.0, 1.0, 10.0])) for name in ("w1", "w2", "z2", "z3")
    }
    drawn = Rules(
        target=str(rng.choice(TARGETS)),
        trap=str(rng.choice(TRAPS)),
        greedy=str(rng.choice(["weighted", "plain"])),
        deposit=str(rng.choice(["length", "edge"])),
        pheromone_on=str(rng.choice(["edge", "node"])),
        clearance=((0.5, 2.5), (1.0, 1.5))[rng.integers(2)],
        q0=float(rng.choice([0.0, 0.5, 1.0])),
        ranked=int(rng.choice([0, 1, 3])),
        elite=float(rng.choice([0.0, 5.0])),
        local=float(rng.choice([0.0, 0.1, 1.0])),
        local_to=float(rng.choice([0.0, 1.0])),
        selective=bool(rng.integers(2)),
        **exponents,
    )
    drawn = drawn._replace(clipped=drawn.target == "current" and bool(rng.integers(2)))
    if drawn.local == 0 and drawn.pheromone_on == "edge" and rng.random() < 0.3:
        drawn = drawn._replace(initial="degree")
    kind = rng.integers(3)
    return drawn._replace(limits=bool(kind == 1), best_only=bool(kind == 2))


def parameters(rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw (α, β, ρ, Q), each at an end of its range in half of the cases."""
    values = []
    for low, high, logarithmic in EXTREMES.values():
        between = np.exp(rng.uniform(np.log(low), np.log(high))) if logarithmic else rng.uniform(low, high)
        values.append(float(rng.choice([low, high, between, between])))
    return np.array(values)


def check(case: int) -> bool:
    """Run one case; return whether an ant arrived, AssertionError naming the case where something is wrong."""
    rng = np.random.default_rng(np.random.SeedSequence(case))
    question, rule, values = scenario(rng), rules(rng), parameters(rng)
    ants, iterations = (
        int(rng.choice([1, 2, 7, 70], p=p)) for p in ([0.3, 0.2, 0.4, 0.1], [0.3, 0.2, 0.45, 0.05])
    )
    try:
        optimum = question.optimum
    except ScenarioError:
        optimum = np.inf
    effort: dict[str, Any] = {"rules": rule, "ants": ants, "iterations": iterations, "seed": case}
    found = plan(question, values, **effort)
    fault = _fault(question, found, optimum, rule, ants)
    if not fault and iterations > 1:
        fault = _split(found, Colony(question, **effort), values, int(rng.integers(1, iterations)))
    assert not fault, f"case {case}: {fault}"
    return found.solved


def _fault(question: Scenario, found: Plan, optimum: float, rule: Rules, ants: int) -> str:
    if np.isnan([found.length, *found.best, *found.mean]).any():
        return "a length is no number"
    if found.length < optimum:
        return f"length {found.length} below the optimum {optimum}"
    lost_none = rule.trap == "retreat" and rule.z3 == 0 and np.isfinite(optimum)
    if lost_none and (found.arrived != ants).any():
        return f"{found.arrived.tolist()} of {ants} ants arrived, though they may step back"
    if not found.solved:
        return "" if found.path.shape == (0, 3) else "a path without a length"
    cells = [tuple(cell) for cell in found.path.tolist()]
    if (cells[0], cells[-1]) != (question.start, question.goal) or len(set(cells)) != len(cells):
        return f"the path {cells} does not lead from start to goal"
    steps, moves = np.diff(found.path, axis=0), move_table(question.motion).steps
    made = (steps[:, None] == moves).all(axis=2)
    if not (made & legal_moves(question, found.path[:-1])).any(axis=1).all():
        return "the path makes a move that is not legal"
    length = step_lengths(question.motion, question.world.cell)[made.argmax(axis=1)].sum()
    return "" if np.isclose(length, found.length) else "the path has another length"


def _split(whole: Plan, colony: Colony, values: NDArray[np.float64], first: int) -> str:
    """Return what differs where the same run is walked in two blocks."""
    colony.advance(values, first)
    colony.advance(values, colony.left)
    again = colony.result()
    same = again.moves == whole.moves and again.path.tolist() == whole.path.tolist()
    return "" if same and np.array_equal(again.mean, whole.mean) else "two blocks are not one"


def script() -> None:
    """Run the command line."""
    arguments = parse(Arguments, None, "python -m experiments.fuzz")
    check_one = {"ants": check, "bees": bee_fuzz.check}[arguments.swarm]
    solved = 0
    with progress(f"{arguments.cases:,} cases", arguments.cases) as advance:
        for case in itertools.islice(itertools.count(arguments.first), arguments.cases):
            solved += check_one(case)
            advance(1)
    found = f"one of the {arguments.swarm} arrived in {solved:,}"
    print(f"{arguments.cases:,} cases from {arguments.first}: nothing wrong; {found}")


if __name__ == "__main__":
    main(script, interrupted="interrupted")
