"""The figure: the paper's two convergence plots of the first draw, and Table 4 as gap against time."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from experiments.tables.liu2020.draw import ITERATIONS, Draw
from experiments.tables.liu2020.findings import Findings, Standing
from experiments.tables.liu2020.methods import METHODS, RUNS
from experiments.tables.sheet import new_figure

INSTANT, BESIDE = 1e-3, 1.3  # seconds: who takes less ran nothing, and is drawn there, side by side


def to_figure(draws: Sequence[Draw], findings: Findings | None) -> Any:
    """Return the figure; its last panel needs findings."""
    panels = 2 if findings is None else 3
    figure = new_figure(11 if findings is None else 18, 4.5)
    left, middle, *right = figure.subplots(1, panels)
    _draw_first(left, middle, draws[0])
    if findings is not None:
        _draw_standings(right[0], findings.standings, len(draws))
    return figure


def _draw_first(left: Any, right: Any, draw: Draw) -> None:
    wanted = {method.label for method in METHODS if method.is_papers}
    for answer in draw.answers:
        if answer.method not in wanted:
            continue
        curve = np.array(answer.curve, dtype=float)
        left.plot(np.arange(1, ITERATIONS + 1), curve, label=answer.method)
        if answer.evaluations > 1 and answer.steps:
            evaluations, lengths = zip(*answer.steps, strict=True)
            ends = ((*evaluations, answer.evaluations), (*lengths, lengths[-1]))
            right.step(*ends, where="post", label=answer.method)
    for axes in (left, right):
        axes.axhline(draw.optimum, color="black", linestyle="--", linewidth=1, label="exact optimum")
        axes.set_ylabel("length / mm")
        axes.legend(fontsize=8)
    left.set(xlabel="iteration of the colony", title=f"draw 1: the settings found, {RUNS} fresh runs")
    right.set(xlabel="evaluation", xscale="log", title="draw 1: the searches, luckiest run so far")


def _draw_standings(axes: Any, standings: Sequence[Standing], count: int) -> None:
    from matplotlib import colormaps

    strong_then_light, instant = [*range(0, 20, 2), *range(1, 20, 2)], 0
    for place, row in enumerate(standings):
        seconds = row.seconds
        if seconds < INSTANT:
            seconds, instant = INSTANT * BESIDE**instant, instant + 1
        mean, low, high = (100 * value for value in row.gap)
        axes.errorbar(
            [seconds],
            [mean],
            [[mean - low], [high - mean]],
            color=colormaps["tab20"](strong_then_light[place]),
            marker="o" if row.method.is_papers else "s",
            markerfacecolor=None if row.method.is_papers else "white",
            linestyle="none",
            capsize=2,
            label=row.method.label,
        )
    axes.set(
        xlabel="seconds on the target (far left: none)",
        ylabel="gap / %",
        xscale="log",
        title=f"Table 4: {count} draws, 95 % intervals",
    )
    axes.legend(fontsize=8, loc="center left", bbox_to_anchor=(1.0, 0.5))
