"""Swarms: what a problem's rules say of its ants or bees, and runs of either, or of a fleet, behind one face."""

from typing import Any

from numpy.typing import ArrayLike

from antgym.errors import ParameterError
from antgym.maps.discs import DiscWorld
from antgym.maps.fleet import Fleet, robots_of
from antgym.maps.world import Scenario
from antgym.planners.bee_rules import BeeRules, find_bee_rules
from antgym.planners.colony import Colony
from antgym.planners.fleet import FleetRun
from antgym.planners.flights import FEWEST_BEES
from antgym.planners.hive import Hive
from antgym.planners.parameters import BeeParameters, ColonyParameters
from antgym.planners.planning import AnyRules, are_bees
from antgym.planners.rules import Rules, find_rules
from antgym.planners.space import ParameterSpace

Swarm = Colony | Hive


def find_swarm_rules(rules: AnyRules) -> Rules | BeeRules:
    """Return rules of ants or bees by name, or the given ones checked; ParameterError names what is wrong."""
    given: Any = rules
    return find_bee_rules(given) if are_bees(rules) else find_rules(given)


def parameter_names(rules: AnyRules) -> tuple[str, ...]:
    """Return the names of what is chosen under rules, in the order of their space."""
    found = find_swarm_rules(rules)
    if isinstance(found, Rules):
        return ColonyParameters._fields
    return BeeParameters._fields if found.tabu else BeeParameters._fields[:-1]


def fewest(rules: AnyRules) -> int:
    """Return the least number of ants, or bees, of a run."""
    return FEWEST_BEES if are_bees(rules) else 1


def require_fit(rules: AnyRules, scenario: Scenario[Any, Any] | Fleet, ants: int) -> None:
    """Raise ParameterError where a swarm cannot move in such a world, or is too few."""
    bees, discs = are_bees(rules), isinstance(scenario.world, DiscWorld)
    if bees != discs:
        called = repr(rules) if isinstance(rules, str) else "given as data"
        raise ParameterError(
            f"rules {called} are of {'bees, which fly among discs' if bees else 'ants, which walk a grid'}, and "
            f"{scenario.name!r} {'lies among discs' if discs else 'is a grid'}"
        )
    if ants < fewest(rules):
        raise ParameterError(f"ants = {ants}: a hive has {FEWEST_BEES} bees at least, two with a source each")


def space_of(rules: AnyRules, scenario: Scenario[Any, Any] | Fleet, ants: int) -> ParameterSpace:
    """Return the space of natural values under rules, for a scenario and so many ants or bees.

    The robots of a fleet share a setting; its range of Q is that of their mean straight line.
    """
    found = find_swarm_rules(rules)
    if isinstance(found, Rules):
        straight_line = scenario.straight_line / len(robots_of(scenario))
        return found.ranges.space(straight_line, found.initial_pheromone)
    world: Any = scenario.world
    return found.space(ants, world.width)


def start(
    scenario: Scenario[Any, Any] | Fleet,
    *,
    rules: AnyRules,
    ants: int,
    iterations: int,
    seed: int,
    buffers: Any = None,
) -> Swarm:
    """Return a run that has not walked yet; arguments as for :func:`~antgym.planners.planning.plan`.

    ``buffers`` are what a run of the same kind released; without them, new ones are made. ParameterError for a fleet.
    """
    if isinstance(scenario, Fleet):
        raise ParameterError(
            f"{scenario.name!r} is a fleet, whose robots are planned one after another, so that there is no one run to "
            "steer; take OneShot or Trials"
        )
    given: Any = rules
    kind: Any = Hive if are_bees(rules) else Colony
    run: Swarm = kind(scenario, rules=given, ants=ants, iterations=iterations, seed=seed, buffers=buffers)
    return run


def walked(
    scenario: Scenario[Any, Any] | Fleet,
    parameters: ArrayLike,
    *,
    rules: AnyRules,
    ants: int,
    iterations: int,
    seed: int,
) -> Swarm | FleetRun:
    """Return a run that has walked to its end under natural values; arguments as for ``start``."""
    if isinstance(scenario, Fleet):
        return FleetRun.of(scenario, parameters, rules=rules, ants=ants, iterations=iterations, seed=seed)
    swarm = start(scenario, rules=rules, ants=ants, iterations=iterations, seed=seed)
    swarm.advance(parameters, iterations)
    return swarm
