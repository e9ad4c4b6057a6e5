"""zhang_apf: choices by a potential field and pheromone against choices by pheromone alone, in layered 3D worlds.

Its figure shows one world: the improved colony is below 30 from its first iterations on, the original one begins near
35 and is still above after 200. Its world is of bodies in bounding boxes, so ours is of the family ``boxes``.
"""

from dataclasses import dataclass
from pathlib import Path

from experiments.statistics import Estimate
from experiments.tables.comparison import Comparison, Options, Result
from experiments.tables.findings import Claim, first_lengths, length_ratio
from experiments.tables.report import replay as replay_comparison

PAPER_START = 35 / 30

COMPARISON = Comparison(
    paper="zhang_apf",
    basic="zhang_apf-original",
    claim="After 200 iterations the improved colony's path is shorter than the original one's",
    family="boxes",
    size=21,
    iterations=200,
    bar=90,
    also_sooner=False,
    ideas={
        "w1": "step: near cells first",
        "z2": "attraction: cells near the goal",
        "z3": "avoidance: clearance",
    },
    silent=(
        "Its table of settings and its equations (2) and (5)-(8) are lost: forms, exponents and parameters are ours "
        "(see `antgym.planners.rules`), and so are ants, the world's size, its bodies, start and goal. Its basic "
        "colony chooses by pheromone alone, so β acts in the improved one only. κ is how often τ₀ the path that "
        "stays the best comes to hold, here the number of its moves, as in the ant colony system: below 1 both would "
        "unlearn it. Its lengths have no unit; ratios compare."
    ),
)


@dataclass(frozen=True)
class Arguments(Options):
    """Potential field and pheromone against pheromone alone: 100 boxes worlds of 21 cells a side, 200 iterations."""


def replay(arguments: Options) -> Path:
    """Run, write and show the comparison; return the Markdown file."""
    return replay_comparison(COMPARISON, claims, arguments)


def claims(result: Result) -> list[Claim]:
    """Judge what the paper's curves say of the start and of the end."""
    start = length_ratio(first_lengths(result.basic), first_lengths(result.improved))
    end = length_ratio(1 + result.basic.final, 1 + result.improved.final)
    return [
        Claim(
            f"The original colony starts longer, in the paper by 35 over 30, {PAPER_START:.2f} times",
            start.low > 1,
            f"First paths are {_ratio(start)} times as long.",
        ),
        Claim(
            "It is still longer in the end",
            end.low > 1,
            f"Last paths are {_ratio(end)} times as long.",
        ),
    ]


def _ratio(value: Estimate) -> str:
    return f"{value.mean:.2f} [{value.low:.2f}, {value.high:.2f}]"
