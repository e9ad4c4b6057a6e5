"""Items: what every suite is a sequence of, be it generated or a folder of one's own, and the splits they fall into."""

import hashlib
from collections.abc import Iterable
from typing import Any, NamedTuple

from antgym.maps.discs import DiscWorld
from antgym.maps.fleet import Fleet
from antgym.maps.world import Scenario

SPLITS = ("train", "validation", "test", "ood")


class SuiteItem(NamedTuple):
    """A scenario and the effort and rules it is planned with.

    Attributes:
        name: suite, split and number of what is generated, or window and rotation of real terrain; of one's own, any.
        scenario: what is planned, for one robot or for a fleet.
        ants: ants per iteration, or bees.
        iterations: iterations per run, or cycles.
        rules: name of the swarm's rules.
        family: of the scenario, ``"terrain"`` for real terrain, ``"own"`` for one's own.
    """

    name: str
    scenario: Scenario[Any, Any] | Fleet
    ants: int = 20
    iterations: int = 50
    rules: str = "liu2020"
    family: str = "own"


def digest_of(items: Iterable[SuiteItem]) -> str:
    """Return the hash of the scenarios, efforts and rules of items in order, 64 hex digits."""
    lines = (f"{item.scenario.digest} {item.ants} {item.iterations} {item.rules}\n" for item in items)
    return hashlib.sha256("".join(lines).encode()).hexdigest()


class OwnSuite(tuple[SuiteItem, ...]):
    """Scenarios of one's own in the place of a suite's split."""

    __slots__ = ()

    @property
    def flat(self) -> bool:
        """Whether every world is one cell high, or lies in the plane."""
        worlds = [item.scenario.world for item in self]
        return all(isinstance(world, DiscWorld) or world.shape[2] == 1 for world in worlds)

    @property
    def rules(self) -> tuple[str, ...]:
        """The rules that plan them; all of ants, or all of bees."""
        return tuple(dict.fromkeys(item.rules for item in self))

    @property
    def digest(self) -> str:
        """Hash of every scenario, effort and rule in order, 64 hex digits."""
        return digest_of(self)
