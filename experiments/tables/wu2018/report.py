"""The report on wu2018: three claims, each as the paper makes it, on the sound rules and on those as printed."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from antgym.console import progress
from antgym.errors import ParameterError
from antgym.maps.discs import DiscScenario
from experiments.artefacts import derived_seed
from experiments.statistics import Estimate, paired_difference
from experiments.tables.draws import draw
from experiments.tables.findings import Claim, estimate, verdict
from experiments.tables.report import percent
from experiments.tables.sheet import new_figure, publish, table
from experiments.tables.wu2018.hives import BEES, CYCLES, SEEDS, Outcome, fly, hives

WORLDS, DISCS = 100, 20
PAIRS = (("wu2018", "wu2018-basic"), ("wu2018-paper", "wu2018-basic-paper"))
SILENT = (
    "The world, its bounds, D_safe and what a collision likelihood is: ours are the worlds of the family `wu2018`, 40 "
    "cm a side with D_safe = 0.5 cm, and the share of sources that touch a disc over all cycles. Steady is ours, too: "
    "the best path stays within 1 % of the last one. Lengths in print cannot be held against ours, their world being "
    "another; directions can."
)


@dataclass(frozen=True)
class Arguments:
    """Bees with a tabu list and a falling ξ against plain ones: 100 worlds of 20 obstacles, 10 seeds, 1,000 cycles."""

    out: Path = Path("out/tables")
    """Folder of the paper's .md, .json and .png."""
    share: float = 1.0
    """Share of the 100 worlds, for a quick look: above 0, 1 at most; two worlds at least."""
    seed: int = 0
    """Root seed of the bees; the worlds stay."""


class Measure(NamedTuple):
    """One of the paper's three measures: the field that holds it, what is claimed, and what is in print."""

    field: str
    claim: str
    unit: str
    plain: float
    tabu: float


MEASURES = (
    Measure("steady", "With tabu list and falling ξ the best path is steady sooner", "cycles", 600, 400),
    Measure("length", "it is shorter", "cm", 62.732, 48.893),
    Measure("touching", "fewer paths collide", "", 0.18599, 0.11375),
)


def replay(arguments: Arguments) -> Path:
    """Fly, write and show everything; return the Markdown file.

    Raises:
        ParameterError: if the share is not in (0, 1].
    """
    if not 0 < arguments.share <= 1:
        raise ParameterError(
            f"share = {arguments.share}: must be above 0 and 1 at most, 1 being all {WORLDS} worlds"
        )
    new_figure(1, 1)  # a missing library is told before the work, not after it
    count = max(2, round(WORLDS * arguments.share))
    scenarios: Any = draw("wu2018", count, "wu2018", DISCS, lambda _: True)
    outcomes = _flown(scenarios, arguments.seed)
    judged = {pair: [_judge(measure, outcomes, pair) for measure in MEASURES] for pair in PAIRS}
    text, numbers = to_text(outcomes, judged, scenarios), _numbers(outcomes, judged)
    return publish(arguments.out, "wu2018", text, numbers, to_figure(outcomes))


def _flown(scenarios: list[DiscScenario], seed: int) -> dict[str, Outcome]:
    entered = hives(scenarios[0].world.width)
    with progress(
        f"wu2018: {len(entered)} hives in {len(scenarios)} worlds", len(entered) * len(scenarios)
    ) as go:
        return {
            hive.label: fly(hive, scenarios, derived_seed("wu2018", hive.label, seed), go) for hive in entered
        }


def _judge(measure: Measure, outcomes: dict[str, Outcome], pair: tuple[str, str]) -> Claim:
    """Return whether a claim holds: the whole interval of the difference, paired by world, lies below 0."""
    ours, theirs = (getattr(outcomes[name], measure.field) for name in pair)
    difference = paired_difference(ours, theirs)
    shown = (
        percent(difference, "+") + " points"
        if not measure.unit
        else f"{_plain(difference, '+')} {measure.unit}"
    )
    figures = f"Difference, paired by world: {shown}; in print {_printed(measure)}."
    return Claim(measure.claim, difference.high < 0, figures)


def to_text(
    outcomes: dict[str, Outcome], judged: dict[tuple[str, str], list[Claim]], scenarios: list[DiscScenario]
) -> str:
    """Return the Markdown."""
    optimum = np.mean([scenario.optimum for scenario in scenarios])
    verdicts = [
        f"**{verdict(claims)}** between `{pair[0]}` and `{pair[1]}`, where {sum(claim.holds for claim in claims)} of "
        f"{len(claims)} directions hold"
        for pair, claims in judged.items()
    ]
    parts = [
        f"# wu2018: TS-ABC against ABC in {len(scenarios)} worlds of {DISCS} obstacles",
        f"{BEES} bees x {CYCLES:,} cycles, {SEEDS} seeds a world; the exact optimum is {optimum:.2f} cm in the mean. "
        "In brackets 95 % intervals from a bootstrap over worlds.",
        f"**Verdict:** {'; '.join(verdicts)}.",
        *(
            f"`{pair[0]}` against `{pair[1]}`:\n\n" + "\n".join(f"- {claim}" for claim in claims)
            for pair, claims in judged.items()
        ),
        "## The paper's two hives, and what each idea does",
        _rows(outcomes),
        "Gap: of paths that touch no disc, over the exact optimum; 100 % at most, and where the best path touches one. "
        f"The first two rows as in print: {_printed(MEASURES[0])} cycles, {_printed(MEASURES[1])} cm, "
        f"{_printed(MEASURES[2])} collisions. `-paper`: cost and moves as printed.",
        "## Where the paper is silent",
        SILENT,
        "![gaps](wu2018.png)",
    ]
    return "\n\n".join(parts) + "\n"


def _rows(outcomes: dict[str, Outcome]) -> str:
    headings = (
        "hive",
        "steady / cycles",
        "length / cm",
        "gap / %",
        "sources that touch / %",
        "best path touches / %",
    )
    rows = [
        (
            label,
            _plain(estimate(outcome.steady), digits=0),
            _plain(estimate(outcome.length)),
            *(percent(estimate(values)) for values in (outcome.gap, outcome.touching, outcome.collided)),
        )
        for label, outcome in outcomes.items()
    ]
    return table(headings, rows)


def _plain(value: Estimate, sign: str = "", digits: int = 2) -> str:
    mean, low, high = (f"{each:{sign}.{digits}f}" for each in value)
    return f"{mean} [{low}, {high}]"


def _printed(measure: Measure) -> str:
    if measure.unit:
        return f"{measure.tabu:g} against {measure.plain:g}"
    return f"{100 * measure.tabu:g} % against {100 * measure.plain:g} %"


def _numbers(outcomes: dict[str, Outcome], judged: dict[tuple[str, str], list[Claim]]) -> dict[str, Any]:
    """Return what the JSON file holds: all that the table is made of, world by world."""
    return {
        "paper": "wu2018",
        "claims": {f"{a} against {b}": [c._asdict() for c in claims] for (a, b), claims in judged.items()},
        "hives": {
            label: {name: values.tolist() for name, values in outcome._asdict().items()}
            for label, outcome in outcomes.items()
        },
    }


def to_figure(outcomes: dict[str, Outcome]) -> Any:
    """Return mean gaps and shares of touching sources, a row for each hive."""
    figure = new_figure(11, 4)
    places = np.arange(len(outcomes))
    for axes, field, title in zip(
        figure.subplots(1, 2, sharey=True),
        ("gap", "touching"),
        ("gap over the exact optimum / %", "sources that touch a disc / %"),
        strict=True,
    ):
        means, lows, highs = zip(
            *(estimate(100 * getattr(outcome, field)) for outcome in outcomes.values()), strict=True
        )
        axes.hlines(places, lows, highs, color="C0")
        axes.plot(means, places, "o", color="C0")
        axes.set(xlabel=f"{title}, 95 % intervals")
        axes.set_yticks(places, list(outcomes))
    axes.invert_yaxis()
    return figure
