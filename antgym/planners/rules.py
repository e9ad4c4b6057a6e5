"""Rules: what makes a paper's colony, as data that one kernel reads."""

from typing import Any, NamedTuple

from antgym.errors import ParameterError, nearest
from antgym.planners.parameters import KAPPA, ColonyRanges

TARGETS = ("start", "current", "goal")


class Rules(NamedTuple):
    """A variant of the ant colony; the scenario's motion says where its ants can step.

    Attributes:
        target: whose distance the heuristic D takes: ``"start"`` (as liu2020 prints (7)), ``"current"`` (the
            step alone) or ``"goal"`` (the step plus what is left to the goal).
        w1: exponent of D in liu2020 (5); z₁ of zhang_apf (4), whose D is the ``"current"`` one.
        w2: exponent of F = 1 / (|dz| + 1), dz in cells, in (5).
        z2: exponent of the attraction G = 1 / distance to the goal, one cell edge at least (zhang_apf (6)).
        z3: exponent of the avoidance S, a ramp of the clearance (zhang_apf (7)); needs the distance from every
            cell to the nearest blocked one, and so a world of modest size.
        clearance: (d₀, d_m) in cell edges: S = 0 up to d₀, so that no ant goes there, and 1 from d_m on.
        clipped: a step longer than the mean of all moves from its cell counts as that mean (wei2018 (10), (11)).
        q0: probability of the greedy move in (4).
        greedy: ``"weighted"``: the greedy move maximises τ^α·η^β; ``"plain"``: τ·η, as (4) prints it.
        ranked: 0: every ant that arrived deposits; w > 0: the best w - 1 of an iteration do, weighted w - 1 down
            to 1 (so 2 is the iteration's best alone, 1 nobody).
        elite: weight of one more deposit, on the best path so far.
        deposit: ``"length"``: Q / L on every edge of a path; ``"edge"``: ε·Q / d by the edge's own length d and
            ε ≤ 1, the shortest move at its busier end over d (wei2018 (15), (16)).
        selective: only ants deposit whose path is no longer than midway between the iteration's shortest and
            longest (wei2018 (13)).
        local: ξ, the share of pheromone that a passing ant moves to ``local_to``·τ₀.
        local_to: 1: back to τ₀, as in ACS; 0: it decays, as in zhang_apf (1).
        pheromone_on: ``"edge"``: on moves; ``"node"``: on cells, shared by all moves into one (zhang_apf).
        initial: ``"uniform"``: τ₀ everywhere; ``"degree"``: τ₀ · length over the mean length of all moves · number
            of moves from the end (wei2018 (12)); it favours long moves, as printed.
        limits: MAX-MIN: pheromone stays within τ_max = Q / ((1 - ρ) · L_best) and τ_max / (2 · moves of the best
            path), from the first path on. Where κ ≤ 1 - ρ, τ₀ lies above τ_max, and all begins at τ_max as in print.
        best_only: pheromone fades and grows on the depositing paths alone, τ ← ρ·τ + (1 - ρ)·Δτ.
        trap: what becomes of an ant without a legal move to a cell that it has not been to: ``"die"``;
            ``"retreat"``: it steps back, for good, until it has one (zhang2011); ``"lookahead"``: it dies, but a
            move that leads there is no move.
        check_segments: whether a problem with these rules checks what a move that skips a cell crosses; the
            print tests end points alone.
        initial_pheromone: τ₀; only Q / τ₀ acts.
        ranges: low, default, high of the four parameters.
        source: paper and equations.
    """

    target: str = "goal"
    w1: float = 10.0
    w2: float = 5.0
    z2: float = 0.0
    z3: float = 0.0
    clearance: tuple[float, float] = (0.5, 2.5)
    clipped: bool = False
    q0: float = 0.2
    greedy: str = "weighted"
    ranked: int = 0
    elite: float = 0.0
    deposit: str = "length"
    selective: bool = False
    local: float = 0.0
    local_to: float = 1.0
    pheromone_on: str = "edge"
    initial: str = "uniform"
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


# zhang_apf's table of settings is lost, and so are (2) and (5)-(8): forms and values are ours, after its description.
# z1 = z2 = z3 = 1; ζ = 0.1; its ρ = 0.2 decays, so 0.8 persists; its α weighs the heuristic and is our β. κ is the
# ratio of a path's pheromone to τ₀ once it has stayed the best; as in ACS, the number of moves.
_POTENTIAL_FIELD: dict[str, Any] = {
    "target": "current",
    "w2": 0.0,
    "q0": 0.0,
    "ranked": 2,
    "best_only": True,
    "local": 0.1,
    "local_to": 0.0,
    "pheromone_on": "node",
}
# zhang2011 bounds its α and β by 5 and its evaporation to 0.1-0.8, so that 0.2-0.9 persists, and gives no values
# within; our ranges are wider, as every rule's are.
_STEP = {"target": "current"}  # η = 1 / d of the step alone

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
    # κ = 1 - ρ: all pheromone begins at τ_max, which the print has it do
    "max_min": _textbook(0.98, 0.02, "Stützle & Hoos 2000, (7)-(12)", beta=2.0, ranked=2, limits=True),
    # τ₀ = 1 / (n · L) of a tour of n moves and deposits of 1 / L: κ is the number of moves, some 20 in our worlds
    "ant_colony_system": _textbook(
        0.9,
        20.0,
        "Dorigo & Gambardella 1997, (3)-(5)",
        beta=2.0,
        q0=0.9,
        ranked=1,
        elite=1.0,
        local=0.1,
        best_only=True,
    ),
    "zhang_apf": _textbook(
        0.8, 20.0, "zhang_apf (1)-(8)", beta=3.0, **_POTENTIAL_FIELD, w1=1.0, z2=1.0, z3=1.0
    ),
    "zhang_apf-original": _textbook(
        0.8, 20.0, "zhang_apf (1)-(3): chosen by pheromone alone", beta=3.0, **_POTENTIAL_FIELD, w1=0.0
    ),
    # all ants deposit, as (4), (5) read: what its global update rule rewards beside them is not given
    "zhang2011": _textbook(
        0.9,
        1.0,
        "zhang2011 (1), (3)-(7), retreat",
        beta=2.0,
        **_STEP,
        q0=0.6,
        limits=True,
        local=0.1,
        trap="retreat",
    ),
    "zhang2011-basic": _textbook(0.9, 1.0, "zhang2011 (1), (3)-(5)", beta=2.0, **_STEP),
    "wei2018": _textbook(
        0.7,
        0.01,
        "wei2018 (10)-(16)",
        beta=4.0,
        **_STEP,
        clipped=True,
        initial="degree",
        deposit="edge",
        selective=True,
        trap="retreat",
    ),
    "wei2018-basic": _textbook(0.7, 0.01, "wei2018 (14), basic colony", beta=4.0, **_STEP, trap="retreat"),
}
TRAPS = ("die", "retreat", "lookahead")  # in the order of the kernels' numbers
_CHOICES = {
    "target": TARGETS,
    "greedy": ("weighted", "plain"),
    "trap": TRAPS,
    "deposit": ("length", "edge"),
    "pheromone_on": ("edge", "node"),
    "initial": ("uniform", "degree"),
}
_BOUNDS = {
    **dict.fromkeys(("w1", "w2", "z2", "z3"), (0.0, 1e3)),
    **dict.fromkeys(("q0", "local", "local_to"), (0.0, 1.0)),
    "ranked": (0, 1e6),
    "elite": (0.0, 1e6),
    "initial_pheromone": (1e-12, 1e12),
}


def find_rules(rules: str | Rules) -> Rules:
    """Return rules by name, or the given rules checked; ParameterError names what is wrong."""
    if isinstance(rules, str):
        if rules not in PAPERS:
            raise ParameterError(f"unknown rules {rules!r}; {nearest(rules, tuple(PAPERS))}")
        return PAPERS[rules]
    for name, valid in _CHOICES.items():
        if getattr(rules, name) not in valid:
            value = getattr(rules, name)
            raise ParameterError(f"unknown {name} {value!r}; {nearest(str(value), valid)}")
    for name, (low, high) in _BOUNDS.items():
        if not low <= getattr(rules, name) <= high:
            raise ParameterError(f"{name} = {getattr(rules, name)} must lie in [{low:g}, {high:g}]")
    least, most = rules.clearance
    if not 0 <= least < most <= 1e3:
        raise ParameterError(f"clearance = {rules.clearance}: needs 0 <= d0 < dm <= 1000, in cell edges")
    _require_compatible(rules)
    return rules


def _require_compatible(rules: Rules) -> None:
    if rules.limits and rules.best_only:
        raise ParameterError("limits and best_only exclude each other: no published rule has both")
    if rules.initial == "degree" and (rules.local > 0 or rules.pheromone_on == "node"):
        raise ParameterError(
            'initial = "degree" goes neither with a local update nor with pheromone on nodes'
        )
    if rules.clipped and rules.target != "current":
        raise ParameterError(
            f'clipped = True clips the step: it needs target = "current", not {rules.target!r}'
        )
