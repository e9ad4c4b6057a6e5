"""Where an environment's scenarios come from: a split of a suite, or scenarios of one's own."""

from collections.abc import Sequence

from antgym.errors import ParameterError
from antgym.maps.suites import Suite, SuiteItem, load_suite
from antgym.tuning.problem import TuningProblem


class OwnSuite(tuple[SuiteItem, ...]):
    """Scenarios of one's own in the place of a suite's split."""

    __slots__ = ()

    @property
    def flat(self) -> bool:
        """Whether every world is one cell high."""
        return all(item.scenario.world.shape[2] == 1 for item in self)


def find_items(suite: str | Sequence[SuiteItem], split: str) -> Suite | OwnSuite:
    """Return the items that episodes are drawn from.

    Args:
        suite: name of a suite; or a sequence of items, which may be a ``Suite``.
        split: of a named suite.

    Raises:
        ParameterError: where an item, its rules or its effort cannot be used, and where a split is asked of items.
        ScenarioError: where no path leads through a scenario; a training should not find that out on its way.
    """
    if isinstance(suite, str):
        return load_suite(suite, split)
    if split != "train":  # the default, which says nothing
        raise ParameterError(
            f"split {split!r} of scenarios of your own: they have none; pass other scenarios"
        )
    return suite if isinstance(suite, Suite) else _checked(suite)


def _checked(items: Sequence[SuiteItem]) -> OwnSuite:
    if not isinstance(items, Sequence) or not items:
        raise ParameterError(f"suite = {items!r}: needs the name of a suite, or SuiteItems, at least one")
    for i, item in enumerate(items):
        if not isinstance(item, SuiteItem):
            raise ParameterError(
                f"suite[{i}] = {item!r}: needs a SuiteItem(name, scenario, ants, iterations, rules)"
            )
        _ = TuningProblem(item.scenario, item.rules, item.ants, item.iterations).scenario.optimum
    return OwnSuite(items)
