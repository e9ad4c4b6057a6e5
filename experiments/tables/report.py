"""Reports: a comparison as Markdown and as a figure."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from antgym.planners.rules import PAPERS
from experiments.statistics import Estimate, anytime, wilson_interval
from experiments.tables.comparison import (
    CAP,
    Comparison,
    Options,
    Outcome,
    Result,
    compare,
)
from experiments.tables.findings import Claim, Findings, estimate, find, numbers, verdict
from experiments.tables.sheet import new_figure, publish, table

HOW = {"without": "improved colony without it", "alone": "basic colony with it alone"}


def replay(comparison: Comparison, further: Callable[[Result], list[Claim]], options: Options) -> Path:
    """Run a comparison, judge its claim and the further ones, write and show everything; return the Markdown file."""
    new_figure(1, 1)  # a missing library is told before the work, not after it
    result = compare(comparison, options)
    findings = find(result, further)
    text, values = to_text(result, findings), numbers(result, findings)
    return publish(options.out, comparison.paper, text, values, to_figure(result, findings))


def to_text(result: Result, findings: Findings) -> str:
    """Return the Markdown."""
    comparison = result.comparison
    count = len(result.basic.final)
    parts = [
        f"# {comparison.paper}: `{comparison.paper}` against `{comparison.basic}` on {count} maps",
        f"Maps of the family `{comparison.family}`, {comparison.size} cells a side; {comparison.ants} ants x "
        f"{comparison.iterations} iterations, {comparison.seeds} planner seeds a map, seed {result.options.seed}. "
        f"{_parameters(comparison)} A gap is (L − L\\*) / L\\*, L being the shortest length so far and L\\* the exact "
        f"optimum; a run without a path counts as {CAP:g}, as does any gap above. In brackets 95 % intervals: of "
        "counts Wilson's, of means over maps by bootstrap.",
        f"**Verdict: {verdict(findings.claims)}.** {findings.claims[0]}",
        "\n".join(f"- {claim}" for claim in findings.claims[1:]),
        "## On how many maps the improved colony is ahead",
        _counts(findings),
        "Sooner: its mean gap is down to the basic colony's last one in an earlier iteration than the basic colony's "
        "own is.",
        "## The two colonies",
        _colonies(result),
        "## What each idea does",
        f"Change of the mean gap in percentage points, paired by map, {comparison.idea_seeds} seeds; below 0 is "
        "shorter.",
        _ideas(result, findings),
        "## Where the paper is silent",
        comparison.silent,
        f"![curves]({comparison.paper}.png)",
    ]
    return "\n\n".join(parts) + "\n"


def _parameters(comparison: Comparison) -> str:
    texts = {}
    for name in (comparison.paper, comparison.basic):
        alpha, beta, rho, kappa = (each[1] for each in PAPERS[name].ranges)
        kappa = kappa if comparison.kappa is None else comparison.kappa
        texts[name] = f"α = {alpha:g}, β = {beta:g}, ρ = {rho:g}, κ = {kappa:g}"
    if len(set(texts.values())) == 1:
        return f"Both colonies: {texts[comparison.paper]}."
    return " ".join(f"`{name}`: {text}." for name, text in texts.items())


def _counts(findings: Findings) -> str:
    counted = findings.tally
    rows = []
    for label, marks in (
        ("lower at the end", counted.lower),
        ("exact ties, not lower", counted.tied),
        ("sooner", counted.sooner),
        ("lower and sooner", counted.both),
    ):
        low, high = wilson_interval(int(marks.sum()), len(marks))
        rows.append(
            (
                label,
                f"{int(marks.sum())} of {len(marks)}",
                f"{100 * marks.mean():.0f} [{100 * low:.0f}, {100 * high:.0f}]",
            )
        )
    return table(("", "maps", "share / %"), rows)


def _colonies(result: Result) -> str:
    names = {"improved": result.comparison.paper, "basic": result.comparison.basic}
    rows = []
    for label, name in names.items():
        outcome = result.outcomes[label]
        pathless = int(np.isinf(outcome.ratios[:, :, -1]).sum())
        rows.append(
            (
                f"`{name}`",
                percent(estimate(outcome.final)),
                f"{pathless:,} of {outcome.final.size:,}",
                percent(estimate(outcome.lost)),
                percent(estimate(outcome.rising)),
            )
        )
    headings = (
        *("", "gap at the end / %", "runs without a path"),
        *("ants lost / %", "iterations whose mean length rises / %"),
    )
    return table(headings, rows)


def _ideas(result: Result, findings: Findings) -> str:
    rows = [
        (result.comparison.ideas[field], percent(row["without"], sign="+"), percent(row["alone"], sign="+"))
        for field, row in findings.changes.items()
    ]
    return table(("idea", *HOW.values()), rows)


def percent(value: Estimate, sign: str = "") -> str:
    """Return an estimate in per cent, its interval in brackets."""
    mean, low, high = (f"{100 * each:{sign}.1f}" for each in value)
    return f"{mean} [{low}, {high}]"


def to_figure(result: Result, findings: Findings) -> Any:
    """Return the curves over the iterations, and what each idea does, side by side."""
    figure = new_figure(11, 4)
    left, right = figure.subplots(1, 2)
    for label, name in (("improved", result.comparison.paper), ("basic", result.comparison.basic)):
        _draw_curve(left, result.outcomes[label], name)
    left.axhline(1, color="black", linestyle="--", linewidth=1, label="exact optimum")
    left.set(
        xlabel="iteration",
        ylabel="shortest length so far / optimum",
        title=f"mean of {len(result.basic.final)} maps, 95 % interval",
    )
    left.legend(fontsize=8)
    for shift, how, colour in ((-0.15, "without", "C3"), (0.15, "alone", "C2")):
        rows = [[100 * value for value in row[how]] for row in findings.changes.values()]
        places = np.arange(len(rows)) + shift
        means, lows, highs = zip(*rows, strict=True)
        right.hlines(places, lows, highs, color=colour)
        right.plot(means, places, "o", color=colour, label=HOW[how])
    right.axvline(0, color="black", linewidth=1)
    right.set_yticks(range(len(result.comparison.ideas)), result.comparison.ideas.values())
    right.invert_yaxis()
    right.set(
        xlabel="change of the mean gap / percentage points", title="what each idea does, 95 % intervals"
    )
    right.legend(fontsize=8)
    return figure


def _draw_curve(axes: Any, outcome: Outcome, name: str) -> None:
    curves = 1 + outcome.curves
    iterations = np.arange(1, curves.shape[1] + 1)
    mean, low, high = anytime(curves[:, None])
    axes.plot(iterations, mean, label=name)
    axes.fill_between(iterations, low, high, alpha=0.25)
