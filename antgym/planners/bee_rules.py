"""Bee rules: what makes an artificial bee colony, as data that one kernel reads."""

from typing import Any, NamedTuple

from antgym.errors import ParameterError, nearest
from antgym.planners.parameters import BeeRanges
from antgym.planners.space import ParameterSpace


class BeeRules(NamedTuple):
    """A variant of the artificial bee colony over way-points among discs.

    A bee moves one coordinate of a source by a share of its distance from another source; ξ of (12) bounds the share.
    Half of the bees are employed, one a source; one source a cycle is abandoned at most, that tried longest in vain.

    Attributes:
        points: way-points between start and goal, 1 to 1,000.
        away: the share is ξ itself, so that bees only move away from the other source, as wu2018 prints (11); else it
            is uniform in (-ξ, ξ).
        scout: ``"new"``: an abandoned source becomes a new path (7); ``"neighbour"``: it moves by (9), for better or
            worse, as wu2018 prints it for its plain colony.
        elite: the best source is never abandoned; the best path is remembered anyway.
        tabu: abandoned sources remembered, 0 for none; the one listed or hit longest ago makes room for the next.
        redraws: how often a scout draws again that lands within ``tabu_radius`` of one of them; then it stays.
        pull: C, the most by which a bee is also drawn towards the best path so far (Zhu & Kwong 2010, (6)).
        printed: the cost as wu2018 prints it: (4) with the aim of (3), whose turn k·δ is not given and left out, and
            (6), at contact taken at its limit. It hardly minds collisions, and not at all where D_safe is 0 or the
            aim not positive. Else the sound cost, all lengths over the straight line: weight · length + (1 - weight)
            · (what the smallest clearance lacks of D_safe, the depth of a cut included) + (1 - weight) · ``hit`` for
            every segment that touches a disc.
        weight: k of (4), in (0, 1].
        hit: see above; so large that a clear path of any reasonable length beats one that touches.
        ranges: low, default, high of the parameters.
        source: paper and equations.
    """

    points: int = 12
    away: bool = False
    scout: str = "new"
    elite: bool = True
    tabu: int = 0
    redraws: int = 10
    pull: float = 0.0
    printed: bool = False
    weight: float = 0.5
    hit: float = 10.0
    ranges: BeeRanges = BeeRanges()
    source: str = "wu2018 (7)-(10)"

    def space(self, bees: int, width: float) -> ParameterSpace:
        """Return the space of natural values for so many bees in a world so wide; three numbers without a tabu list."""
        return self.ranges.space(bees, self.points, width, self.tabu > 0)


# limit 40 is a twelfth of sources × dimensions, 20 × 24; the radius of 1 cm is taken in worlds 40 cm wide; the length
# of the list and the cap on redraws are ours, the print has neither
_TABU: dict[str, Any] = {
    "tabu": 20,
    "ranges": BeeRanges(xi_max=(0.1, 0.7, 4.0), xi_min=(0.02, 0.2, 4.0)),
    "source": "wu2018 (7)-(12)",
}
_STANDARD: dict[str, Any] = {"elite": False, "ranges": BeeRanges(limit=(1 / 48, 1.0, 10.0))}

BEE_PAPERS: dict[str, BeeRules] = {
    "wu2018": BeeRules(**_TABU),
    # new sources are drawn at random here, as its text and flow chart say; only its plain colony keeps (9)
    "wu2018-paper": BeeRules(**_TABU, away=True, printed=True)._replace(source="wu2018 (1)-(12) as printed"),
    "wu2018-basic": BeeRules(),
    "wu2018-basic-paper": BeeRules(scout="neighbour", printed=True, source="wu2018 (1)-(10) as printed"),
    "abc_standard": BeeRules(**_STANDARD, source="Karaboga & Basturk 2007, (2.1)-(2.3)"),
    "abc_gbest": BeeRules(**_STANDARD, pull=1.5, source="Zhu & Kwong 2010, (6)"),
    # wu2018 has "up to 12" way-points: four are untangled in tens of cycles, twelve in hundreds
    "wu2018-4": BeeRules(**_TABU, points=4),
    "abc_standard-4": BeeRules(**_STANDARD, points=4, source="Karaboga & Basturk 2007, (2.1)-(2.3)"),
    "abc_gbest-4": BeeRules(**_STANDARD, points=4, pull=1.5, source="Zhu & Kwong 2010, (6)"),
}
SCOUTS = ("new", "neighbour")
_BOUNDS: dict[str, tuple[float, float]] = {
    "points": (1, 1000),
    "tabu": (0, 1000),
    "redraws": (0, 1000),
    "pull": (0.0, 100.0),
    "hit": (0.0, 1e6),
}


def find_bee_rules(rules: str | BeeRules) -> BeeRules:
    """Return rules by name, or the given rules checked; ParameterError names what is wrong."""
    if isinstance(rules, str):
        if rules not in BEE_PAPERS:
            raise ParameterError(f"unknown rules {rules!r}; {nearest(rules, tuple(BEE_PAPERS))}")
        return BEE_PAPERS[rules]
    if rules.scout not in SCOUTS:
        raise ParameterError(f"unknown scout {rules.scout!r}; {nearest(str(rules.scout), SCOUTS)}")
    for name, (low, high) in _BOUNDS.items():
        value: Any = getattr(rules, name)
        if not low <= value <= high or (type(low) is int and value != int(value)):
            kind = "a whole number" if type(low) is int else "a number"
            raise ParameterError(f"{name} = {value}: must be {kind} in [{low:g}, {high:g}]")
    if not 0 < rules.weight <= 1:
        raise ParameterError(f"weight = {rules.weight}: must lie in (0, 1]")
    return rules
