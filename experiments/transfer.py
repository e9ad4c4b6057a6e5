"""Transfer measured: agents that learnt from train maps, on maps that none of them has seen, at a few budgets.

    python -m experiments.artefacts transfer_graph portfolio best_static --out out/trained
    python -m experiments.transfer --artefacts out/trained --out out/transfer

Every recommendation is judged on fresh, uncharged runs; differences are paired by map. A run that was stopped goes on
where it was when the same command is given again. Transfer is negative on a map
where an agent's setting is clearly worse than one that needs no graph: the published default, or the copied best source
at the same budget; clearly means by more than two standard errors of the fresh runs.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from agents.graph import TransferGraph
from agents.published import PolicyCard, read_card
from antgym.console import main, parse, progress
from antgym.errors import ParameterError
from antgym.maps.suites import load_suite
from antgym.tuning.ledger import Ledger, LedgerRun
from experiments import provenance
from experiments.artefact_files import file_of, require_there, spent, trained_hashes
from experiments.contest import enter, jobs, play
from experiments.rehearsal import rehearse
from experiments.statistics import Estimate, cluster_interval, paired_difference, wilson_interval
from experiments.tables.sheet import new_figure, publish, table
from experiments.trainings import trainings

Floats = NDArray[np.float64]
DEFAULT, COPY = "published_default", "copy_best_source"
GRAPH = "graph.json"
AGENTS = (
    *("transfer_graph", COPY, "mean_of_sources", "transfer_graph_paper", "transfer_graph_abs", "portfolio"),
    *(
        "neighbours",
        "regression",
        "cma_es_warm",
        "transfer_gp",
        "best_static_by_rules",
        "optuna_tpe",
        "cma_es",
    ),
    DEFAULT,
)


@dataclass(frozen=True)
class Arguments:
    """Measure agents on unseen maps: gaps by budget, paired differences, negative transfer, the graph's picture."""

    artefacts: Path = Path("out/trained")
    """Folder of the trained agents' files."""
    out: Path = Path("out/transfer")
    """Folder of the ledger, of transfer.md, transfer.json, transfer.png and graph.png."""
    suite: str = "mountain-v0"
    """Suite of the targets, or a folder of maps."""
    split: str = "validation"
    """Its split: validation, test or ood."""
    maps: int = 50
    """The first so many maps of it."""
    seeds: int = 2
    """Tuner and planner seeds per map."""
    budgets: tuple[int, ...] = (1, 5, 20)
    """Trials that an agent may pay for on a target; 0 asks without any."""
    fresh: int = 16
    """Runs that judge each recommendation."""
    agents: tuple[str, ...] = AGENTS
    """Names in the catalogue, copy_best_source and published_default always among them, which negative transfer is
    measured against; the first is compared with all others. Files that differ in a number at the end, as rl:ppo-1 and
    rl:ppo-2, are shown together, too."""


class Outcome(NamedTuple):
    """What an agent achieved at one budget.

    Attributes:
        gaps: of all fresh runs, (maps, seeds, fresh).
        trials: paid for, mean.
        arrived: share of the fresh runs that found a path.
    """

    gaps: Floats
    trials: float
    arrived: float

    @property
    def means(self) -> Floats:
        """Mean gap of each recommendation, (maps, seeds)."""
        return np.asarray(self.gaps.mean(axis=2), dtype=np.float64)


Key = tuple[int, str]
"""(budget, agent)"""


def measure(arguments: Arguments) -> dict[Key, Outcome]:
    """Let every agent tune every target at every budget; what the ledger holds already is not run again."""
    _check(arguments)
    items = load_suite(arguments.suite, arguments.split)[: arguments.maps]
    if len(items) < 2:
        raise ParameterError(
            f"--suite {arguments.suite} --split {arguments.split}: {len(items)} map, and intervals are over maps; "
            "take two at least"
        )
    require_there(arguments.agents, arguments.artefacts, arguments.suite)
    rehearse(arguments.agents, arguments.artefacts, items[0], min(arguments.budgets))
    paid = spent(arguments.artefacts, arguments.agents)
    contest = enter(arguments.agents, arguments.artefacts, paid)
    config = {
        **{
            name: getattr(arguments, name)
            for name in ("suite", "split", "seeds", "budgets", "fresh", "agents")
        },
        "code": provenance.code_hash(*provenance.CONTEST),
        "maps": [item.scenario.digest[:16] for item in items],
    }
    versions = provenance.versions(arguments.agents)
    with Ledger(arguments.out, config, versions, provenance.facts()) as ledger:
        ledger.pin(trained_hashes(arguments.artefacts, arguments.agents))
        todo = list(jobs(contest, items, arguments.seeds, arguments.budgets))
        with progress("transfer", len(todo)) as advance:
            play(todo, ledger, arguments.fresh, advance)
        return {
            key: _outcome([ledger.run(job.key) for job in group], len(items))
            for key, group in groupby(todo, lambda job: (job.budget, job.entrant.name))
        }


def _check(arguments: Arguments) -> None:
    if missing := [name for name in (COPY, DEFAULT) if name not in arguments.agents]:
        raise ParameterError(
            f"--agents {' '.join(arguments.agents)}: negative transfer is measured against {COPY} and {DEFAULT}; add "
            f"{' and '.join(missing)}"
        )
    if not arguments.budgets or min(arguments.budgets) < 0 or arguments.maps < 2:
        raise ParameterError(
            f"--budgets {' '.join(map(str, arguments.budgets))} must be 0 or more, --maps {arguments.maps} 2 or more"
        )


def _outcome(runs: Sequence[LedgerRun], maps: int) -> Outcome:
    outcomes = [run.outcome for run in runs if run.outcome is not None]
    gaps, lengths = (np.array([getattr(each, name) for each in outcomes]) for name in ("gaps", "lengths"))
    trials = float(np.mean([len(run.records) for run in runs]))
    return Outcome(gaps.reshape(maps, -1, gaps.shape[1]), trials, float(np.isfinite(lengths).mean()))


def with_trainings(outcomes: dict[Key, Outcome], cards: Mapping[str, PolicyCard]) -> dict[Key, Outcome]:
    """Return the outcomes, and those of several trainings of one agent together, (maps, seeds x trainings, fresh).

    Args:
        outcomes: of every agent at every budget.
        cards: of those that follow policies, by name.
    """
    together = {}
    for label, names in trainings(cards).items():
        for budget in dict.fromkeys(budget for budget, _ in outcomes):
            members = [outcomes[budget, name] for name in names]
            together[budget, label] = Outcome(
                np.concatenate([each.gaps for each in members], axis=1),
                float(np.mean([each.trials for each in members])),
                float(np.mean([each.arrived for each in members])),
            )
    return outcomes | together


def worse(outcome: Outcome, reference: Outcome) -> int:
    """Return on how many maps an outcome is clearly worse than a reference: by more than two standard errors."""
    ours, theirs = (np.reshape(o.gaps, (len(o.gaps), -1)) for o in (outcome, reference))
    doubt = 2 * np.sqrt(ours.var(axis=1) / ours.shape[1] + theirs.var(axis=1) / theirs.shape[1])
    return int((ours.mean(axis=1) - theirs.mean(axis=1) > doubt).sum())


def report(arguments: Arguments) -> Path:
    """Measure, write the tables and the pictures, and return the Markdown file."""
    new_figure(1, 1)  # a missing library is told before the work, not after it
    outcomes = measure(arguments)
    graph = TransferGraph.load(arguments.artefacts / GRAPH)
    policies = [name for name in arguments.agents if name.startswith("rl:")]
    cards = {name: read_card(file_of(name, arguments.artefacts)) for name in policies}
    shown = with_trainings(outcomes, cards)
    arguments.out.mkdir(parents=True, exist_ok=True)
    graph.plot(arguments.out / "graph.png")
    parts = [
        f"# Transfer on {arguments.maps} maps of {arguments.suite} {arguments.split}",
        f"{arguments.seeds} seeds a map, each recommendation judged on {arguments.fresh} fresh runs; gaps in %, "
        "with 95 % intervals over maps and seeds.",
        "## In short",
        _summary(arguments, shown),
        *(_section(arguments, budget, shown) for budget in arguments.budgets),
        "## The graph: each source left out",
        _left_out(graph),
        "![graph](graph.png) ![gaps](transfer.png)",
    ]
    numbers = {f"{name}/{budget}": outcome.means.tolist() for (budget, name), outcome in outcomes.items()}
    return publish(
        arguments.out, "transfer", "\n\n".join(parts) + "\n", numbers, _figure(arguments, outcomes)
    )


def _summary(arguments: Arguments, outcomes: dict[Key, Outcome]) -> str:
    """Return the mean gaps of all agents, those that are best at the largest budget first."""
    last = arguments.budgets[-1]
    rows = []
    for name in _ranked(outcomes, last):
        cells = []
        for budget in arguments.budgets:
            means = outcomes[budget, name].means
            low, high = cluster_interval(means)
            cells.append(f"{100 * means.mean():.1f} [{100 * low:.1f}, {100 * high:.1f}]")
        rows.append([f"`{name}`", *cells])
    return table(["agent", *(f"{budget} trials" for budget in arguments.budgets)], rows)


def _ranked(outcomes: dict[Key, Outcome], budget: int) -> list[str]:
    means = {name: outcome.means.mean() for (asked, name), outcome in outcomes.items() if asked == budget}
    return sorted(means, key=lambda name: float(means[name]))


HEADINGS = (
    *("agent", "gap %", "95 %", "arrived", "trials", "first minus this, points", "95 %"),
    *("worse than default", "worse than copy"),
)


def _section(arguments: Arguments, budget: int, outcomes: dict[Key, Outcome]) -> str:
    first = outcomes[budget, arguments.agents[0]]
    rows = []
    for name in _ranked(outcomes, budget):
        found = outcomes[budget, name]
        low, high = cluster_interval(found.means)
        shares = [_share(worse(found, outcomes[budget, other]), len(found.gaps)) for other in (DEFAULT, COPY)]
        difference = paired_difference(first.means, found.means) if found is not first else None
        rows.append(
            [
                name,
                f"{100 * found.means.mean():.1f}",
                f"{100 * low:.1f} to {100 * high:.1f}",
                f"{found.arrived:.1%}",
                f"{found.trials:.1f}",
                *_signed(difference),
                *shares,
            ]
        )
    return f"## {budget} trials a target\n\n{table(HEADINGS, rows)}"


def _signed(difference: Estimate | None) -> tuple[str, str]:
    if difference is None:
        return "–", "–"
    return f"{100 * difference.mean:+.1f}", f"{100 * difference.low:+.1f} to {100 * difference.high:+.1f}"


def _share(hits: int, count: int) -> str:
    low, high = wilson_interval(hits, count)
    return f"{hits / count:.0%} ({low:.0%} to {high:.0%})"


def _left_out(graph: TransferGraph) -> str:
    rows = [
        [
            row.name,
            *(f"{cost:.3f}" for cost in (row.transferred, row.copied, row.default)),
            "yes" if row.worse_than_copy else "no",
            "yes" if row.worse_than_default else "no",
        ]
        for row in graph.negative_transfer
    ]
    return table(
        ["source", "transferred", "copied", "default", "worse than copy", "worse than default"], rows
    )


def _figure(arguments: Arguments, outcomes: dict[Key, Outcome]) -> Any:
    figure = new_figure(8, 5)
    axes = figure.subplots()
    for name in arguments.agents:
        gaps = [100 * outcomes[budget, name].means.mean() for budget in arguments.budgets]
        axes.plot(arguments.budgets, gaps, marker="o", label=name)
    axes.set(xlabel="trials on the target", ylabel="mean gap %", xscale="symlog", ylim=(0, None))
    axes.set_xticks(arguments.budgets, labels=[str(budget) for budget in arguments.budgets])
    axes.minorticks_off()
    axes.legend(fontsize=7, ncols=2)
    return figure


if __name__ == "__main__":
    main(lambda: print(f"\nwritten: {report(parse(Arguments, None, 'python -m experiments.transfer'))}"))
