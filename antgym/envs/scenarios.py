"""Where an environment's scenarios come from: a split of a suite, or scenarios of one's own."""

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeVar

from antgym.errors import ParameterError
from antgym.maps.fleet import Fleet
from antgym.maps.suite_file import NAME
from antgym.maps.suites import Items, OwnSuite, Suite, SuiteItem, load_suite
from antgym.maps.world import Scenario
from antgym.planners.swarms import parameter_names
from antgym.tuning.problem import TuningProblem

Question = TypeVar("Question", Scenario[Any, Any], Fleet)


def find_items(suite: str | Sequence[SuiteItem], split: str) -> Items:
    """Return the items that episodes are drawn from.

    Args:
        suite: name of a suite; path of a folder of maps, see :func:`antgym.load_suite`; or a sequence of items, which
            may be a ``Suite``. Scenarios take their items' names.
        split: of a named suite, or of a folder.

    Raises:
        ParameterError: where an item, its rules or its effort cannot be used, where rules choose different parameters,
            and where a split is asked of items.
        ScenarioError: where no path leads through a scenario; a training should not find that out on its way.
    """
    if isinstance(suite, str):
        found = load_suite(suite, split)
        return found if isinstance(found, Suite) else _own(found, suite)
    if split != "train":  # the default, which says nothing
        raise ParameterError(
            f"split {split!r} of scenarios of your own: they have none; pass other scenarios"
        )
    return suite if isinstance(suite, Suite) else _checked(suite)


@lru_cache(maxsize=16)
def _own(items: OwnSuite, folder: str) -> OwnSuite:
    for item in items:
        try:
            parameter_names(item.rules)
        except ParameterError as error:
            raise ParameterError(f"{Path(folder) / NAME}: rules of {item.name}: {error}") from None
    return _checked(items)


def _checked(items: Sequence[SuiteItem]) -> OwnSuite:
    if not isinstance(items, Sequence) or not items:
        raise ParameterError(f"suite = {items!r}: needs the name of a suite, or SuiteItems, at least one")
    for i, item in enumerate(items):
        if not isinstance(item, SuiteItem):
            raise ParameterError(
                f"suite[{i}] = {item!r}: needs a SuiteItem(name, scenario, ants, iterations, rules)"
            )
        _ = TuningProblem(item.scenario, item.rules, item.ants, item.iterations).scenario.optimum
        if isinstance(item.scenario, Fleet) != isinstance(items[0].scenario, Fleet):
            raise ParameterError(
                f"suite[{i}]: fleets and single robots in one environment; make one of each kind"
            )
        names = parameter_names(items[0].rules), parameter_names(item.rules)
        if names[0] != names[1]:
            raise ParameterError(
                f"suite[{i}]: rules {item.rules!r} choose {names[1]}, and those of suite[0] {names[0]}; an environment "
                "has one action space, so make one of each"
            )
    return OwnSuite(item._replace(scenario=_named(item.scenario, str(item.name))) for item in items)


@lru_cache(maxsize=4096)
def _named(scenario: Question, name: str) -> Question:
    """Return a scenario under an item's name: one object for every slot of a batch, with what is cached on it."""
    if scenario.name == name:
        return scenario
    renamed = replace(scenario, name=name)
    renamed.__dict__.update({**scenario.__dict__, "name": name})
    return renamed
