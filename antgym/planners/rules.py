"""Rules: what makes a paper's colony, as data that one kernel reads."""

from typing import NamedTuple

from antgym.errors import ParameterError, nearest
from antgym.planners.parameters import KAPPA, ColonyRanges

TARGETS = ("start", "current", "goal")


class Rules(NamedTuple):
    """A variant of the layered ant colony.

    Attributes:
        target: whose distance the heuristic D takes: ``"start"`` (as liu2020 prints (7)), ``"current"`` (the
            step alone) or ``"goal"`` (the step plus what is left to the goal).
        w1: exponent of D in (5).
        w2: exponent of F = 1 / (|dz| + 1), dz in cells, in (5).
        q0: probability of the greedy move in (4).
        greedy: ``"weighted"``: the greedy move maximises τ^α·η^β; ``"plain"``: τ·η, as (4) prints it.
        initial_pheromone: τ₀; only Q / τ₀ acts.
        ranges: low, default, high of the four parameters.
        source: paper and equations.
    """

    target: str = "goal"
    w1: float = 10.0
    w2: float = 5.0
    q0: float = 0.2
    greedy: str = "weighted"
    initial_pheromone: float = 1.0
    # The default is the set that liu2020's Table 3 publishes for its own method (transfer); Q becomes κ over the
    # path length it reports, 174.0582 / 148.6621.
    ranges: ColonyRanges = ColonyRanges(
        alpha=(0.01, 1.3027, 5.0),
        beta=(0.02, 8.4233, 10.0),
        rho=(0.01, 0.4152, 0.999),
        kappa=(KAPPA[0], 1.1708, KAPPA[1]),
    )
    source: str = "liu2020 (1)-(8)"


PAPERS: dict[str, Rules] = {
    "liu2020": Rules(),
    "liu2020-paper": Rules(target="start", greedy="plain", source="liu2020 (1)-(8) as printed"),
}


def find_rules(rules: str | Rules) -> Rules:
    """Return rules by name, or the given rules checked; ParameterError names what is wrong."""
    if isinstance(rules, str):
        if rules not in PAPERS:
            raise ParameterError(f"unknown rules {rules!r}; {nearest(rules, tuple(PAPERS))}")
        return PAPERS[rules]
    if rules.target not in TARGETS:
        raise ParameterError(f"unknown heuristic target {rules.target!r}; {nearest(rules.target, TARGETS)}")
    if rules.greedy not in ("weighted", "plain"):
        raise ParameterError(f"unknown greedy rule {rules.greedy!r}; valid: weighted, plain")
    if not 0 <= rules.q0 <= 1:
        raise ParameterError(f"q0 = {rules.q0} is not a probability in [0, 1]")
    if not (rules.w1 >= 0 and rules.w2 >= 0 and rules.initial_pheromone > 0):
        raise ParameterError("w1 and w2 must be at least 0 and initial_pheromone above 0")
    return rules
