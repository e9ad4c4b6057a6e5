"""Rules: what makes a paper's colony, as data that one kernel reads."""

from typing import Any, NamedTuple

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
        ranked: 0: every ant that arrived deposits; w > 0: the best w - 1 of an iteration do, weighted w - 1 down
            to 1 (so 2 is the iteration's best alone, 1 nobody).
        elite: weight of one more deposit, on the best path so far.
        local: ξ, the share of an edge's pheromone that a passing ant puts back to τ₀.
        limits: MAX-MIN: pheromone stays within τ_max = Q / ((1 - ρ) · L_best) and τ_max / (2 · layers), from the
            first path on.
        best_only: pheromone fades and grows on the best path so far alone, τ ← ρ·τ + (1 - ρ)·elite·Q / L_best.
        trap: ``"die"``: an ant in a dead end dies; ``"lookahead"``: a move into one is no move.
        check_segments: whether a problem with these rules checks what a move that skips a cell crosses; the
            print tests end points alone.
        initial_pheromone: τ₀; only Q / τ₀ acts.
        ranges: low, default, high of the four parameters.
        source: paper and equations.
    """

    target: str = "goal"
    w1: float = 10.0
    w2: float = 5.0
    q0: float = 0.2
    greedy: str = "weighted"
    ranked: int = 0
    elite: float = 0.0
    local: float = 0.0
    limits: bool = False
    best_only: bool = False
    trap: str = "die"
    check_segments: bool = True
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


# The textbook rules take η = 1 / (step + distance to the goal), the 1 / d of a graph with a goal.
_DISTANCE = {"target": "goal", "w1": 1.0, "w2": 0.0}
_WIDE = (0.5, 5.0, 60.0)


def _textbook(rho: float, kappa: float, source: str, beta: float = 5.0, **changes: Any) -> Rules:
    ranges = ColonyRanges(
        (0.01, 1.0, 5.0), (_WIDE[0], beta, _WIDE[2]), (0.01, rho, 0.999), (KAPPA[0], kappa, KAPPA[1])
    )
    return Rules(**{**_DISTANCE, "q0": 0.0, "ranges": ranges, "source": source, **changes})


PAPERS: dict[str, Rules] = {
    "liu2020": Rules(),
    "liu2020-paper": Rules(
        target="start", greedy="plain", check_segments=False, source="liu2020 (1)-(8) as printed"
    ),
    # (α, β, ρ, Q) = (1, 5, 0.5, 100) on tours of length 424: Dorigo, Maniezzo & Colorni 1996
    "ant_system": _textbook(0.5, 100 / 424, "Dorigo, Maniezzo & Colorni 1996, (4)-(8)"),
    # the weight of 8 is ours: the print tries several
    "elitist": _textbook(0.5, 100 / 424, "Dorigo, Maniezzo & Colorni 1996, elitist strategy", elite=8.0),
    "rank_based": _textbook(0.9, 100 / 424, "Bullnheimer, Hartl & Strauss 1999, (2)", ranked=6, elite=6.0),
    "max_min": _textbook(0.98, 1.0, "Stützle & Hoos 2000, (7)-(12)", beta=2.0, ranked=2, limits=True),
    "ant_colony_system": _textbook(
        0.9,
        1.0,
        "Dorigo & Gambardella 1997, (3)-(5)",
        beta=2.0,
        q0=0.9,
        ranked=1,
        elite=1.0,
        local=0.1,
        best_only=True,
    ),
}
TRAPS = ("die", "lookahead")


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
    if rules.trap not in TRAPS:
        raise ParameterError(f"unknown trap rule {rules.trap!r}; {nearest(rules.trap, TRAPS)}")
    if rules.ranked < 0 or rules.elite < 0 or not 0 <= rules.local <= 1:
        raise ParameterError(
            f"ranked = {rules.ranked} and elite = {rules.elite} must be at least 0, local = {rules.local} in [0, 1]"
        )
    if rules.limits and rules.best_only:
        raise ParameterError("limits and best_only exclude each other: no published rule has both")
    for name, low, high in (("w1", 0.0, 1e3), ("w2", 0.0, 1e3), ("initial_pheromone", 1e-12, 1e12)):
        if not low <= getattr(rules, name) <= high:
            raise ParameterError(f"{name} = {getattr(rules, name)} must lie in [{low:g}, {high:g}]")
    return rules
