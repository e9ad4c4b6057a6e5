"""Planning: one scenario, or many in one call, whatever walks there."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from antgym.errors import ParameterError, nearest
from antgym.maps.world import Scenario
from antgym.planners.batch import Batch
from antgym.planners.bee_rules import BEE_PAPERS, BeeRules
from antgym.planners.flights import Flights
from antgym.planners.plans import Plan, Plans
from antgym.planners.rules import PAPERS, Rules
from antgym.planners.threads import run_ranges

AnyRules = str | Rules | BeeRules


def plan(
    scenario: Scenario[Any, Any],
    parameters: ArrayLike,
    *,
    rules: AnyRules = "liu2020",
    ants: int = 20,
    iterations: int = 100,
    seed: int = 0,
) -> Plan:
    """Plan one scenario, by ants on a grid or by bees among discs: the rules say which.

    Args:
        scenario: what to plan.
        parameters: natural values: (α, β, ρ, Q) of ants, see
            :class:`~antgym.planners.parameters.ColonyParameters`; (limit, ξ_max, ξ_min, tabu radius) of bees, see
            :class:`~antgym.planners.parameters.BeeParameters`.
        rules: name or data of the swarm's rules.
        ants: ants per iteration, ≥ 1; or bees, ≥ 4, half of them employed.
        iterations: iterations, ≥ 1; of bees their cycles.
        seed: 0 ≤ seed < 2^64; the same seed gives the same plan on every machine and thread count.

    Raises:
        ParameterError: if a parameter, rule, effort or seed cannot be used, or the rules are not for such a world.
    """
    values = np.atleast_2d(np.asarray(parameters, dtype=np.float64))
    plans = plan_many([scenario], values, rules=rules, ants=ants, iterations=iterations, seeds=[seed])
    return plans.plan(0)


def plan_many(
    scenarios: Sequence[Scenario[Any, Any]],
    parameters: ArrayLike,
    *,
    rules: AnyRules | Sequence[AnyRules] = "liu2020",
    ants: int | Sequence[int] = 20,
    iterations: int | Sequence[int] = 100,
    seeds: ArrayLike,
) -> Plans:
    """Plan B runs in one call, on ANTGYM_THREADS threads; run i is what ``plan`` gives for its arguments.

    Args:
        scenarios: B scenarios, in any mixture of sizes.
        parameters: (B, 4) natural values, see :func:`plan`.
        rules: one for all, or B, all of ants or all of bees.
        ants: one for all, or B.
        iterations: one for all, or B.
        seeds: (B,) integers in [0, 2^64).

    Raises:
        ParameterError: if a parameter, rule, effort or seed cannot be used, or the counts differ.
    """
    pack: Any = Flights.of if are_bees(rules) else Batch.of
    batch = pack(list(scenarios), parameters, rules, ants, iterations, seeds)
    if len(batch.runs):
        run_ranges(batch.plan_range, len(batch.runs))
    return Plans(batch, 0, len(batch.runs))


def are_bees(rules: AnyRules | Sequence[AnyRules]) -> bool:
    """Return whether rules are those of bees, not of ants; ParameterError where one is unknown, or both occur."""
    asked = [rules] if isinstance(rules, (str, Rules, BeeRules)) else list(rules)
    kinds = {_is_bee(rule) for rule in dict.fromkeys(asked)}
    if len(kinds) > 1:
        raise ParameterError(
            "rules of ants and of bees in one call; plan the grids and the disc worlds apart"
        )
    return kinds == {True}


def _is_bee(rules: Any) -> bool:
    if isinstance(rules, str) and rules not in PAPERS and rules not in BEE_PAPERS:
        raise ParameterError(f"unknown rules {rules!r}; {nearest(rules, (*PAPERS, *BEE_PAPERS))}")
    return isinstance(rules, BeeRules) or rules in BEE_PAPERS
