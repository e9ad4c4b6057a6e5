"""Amortisation: after how many new maps has what an agent's training cost been worth it?

    python -m experiments.amortisation out/transfer --artefacts out/trained

reads what ``experiments.transfer`` measured. An agent that spent T evaluations on training and spends k on each map has
spent T / N + k a map after N maps. What it reaches is turned into evaluations by a search from nothing: the trials B
with which that search comes to the same mean gap, between two budgets by the logarithm of 1 + B. Training pays against
the search after T / (B - k) maps, and against another trained agent after (T - T') / ((B - k) - (B' - k')).
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import numpy as np
import tyro

import agents
from antgym.console import main, parse
from antgym.errors import ParameterError
from experiments.artefact_files import spent
from experiments.tables.sheet import new_figure, publish, table

MOST_MAPS = 1e6  # that the picture shows


@dataclass(frozen=True)
class Arguments:
    """Ask after how many new maps training pays, against a search from nothing and against the best static setting."""

    measured: Annotated[Path, tyro.conf.Positional] = Path("out/transfer")
    """Folder that experiments.transfer wrote; amortisation.md, .json and .png join it."""
    artefacts: Path = Path("out/trained")
    """Folder of the trained agents' files, which say what training spent."""
    search: str = "optuna_tpe"
    """The search from nothing whose trials are the currency."""
    static: str = "best_static_by_rules"
    """The trained agent that others are compared with."""


class Standing(NamedTuple):
    """What an agent reaches with k trials a map.

    Attributes:
        agent: its name.
        trials: that it spends a map, k.
        gap: mean over maps and seeds.
        training: evaluations, T.
        worth: trials of the search that reach the same gap, B; its largest budget where that does not reach it.
        beyond: whether it does not, so that the training pays even sooner than is said.
    """

    agent: str
    trials: int
    gap: float
    training: int
    worth: float
    beyond: bool

    @property
    def saved(self) -> float:
        """Evaluations that each new map saves."""
        return self.worth - self.trials

    def pays_after(self, other: "Standing | None" = None) -> float:
        """Return the new maps after which training has paid, against the search or another agent; inf: never."""
        training, saved = self.training, self.saved
        if other is not None:
            training, saved = training - other.training, saved - other.saved
        return max(0.0, training / saved) if saved > 0 else np.inf


def worth(gap: float, budgets: Sequence[int], gaps: Sequence[float]) -> tuple[float, bool]:
    """Return the trials with which a search reaches a gap, and whether they lie beyond its largest budget.

    Args:
        gap: to reach.
        budgets: of the search, ascending.
        gaps: mean gap of the search at each; what it had reached before, it can have later.
    """
    falling = np.minimum.accumulate(gaps)
    return float(np.expm1(np.interp(-gap, -falling, np.log1p(budgets)))), bool(gap < falling[-1])


def standings(arguments: Arguments) -> list[Standing]:
    """Return what every trained agent reaches at every budget that was measured, the static one first."""
    means = _means(arguments.measured / "transfer.json")
    budgets = sorted(budget for name, budget in means if name == arguments.search and budget)
    if not budgets:
        raise ParameterError(
            f"{arguments.measured}: {arguments.search} was not measured, with one trial or more"
        )
    path = [means[arguments.search, budget] for budget in budgets]
    trained = {name for name, _ in means if agents.find_card(name).trained}
    if arguments.static not in trained:
        raise ParameterError(f"{arguments.measured}: {arguments.static} was not measured")
    training = {name: sum(spent(arguments.artefacts, [name]).values()) for name in trained}
    found = [
        Standing(name, budget, gap, training[name], *worth(gap, budgets, path))
        for (name, budget), gap in means.items()
        if name in trained
    ]
    return sorted(
        found, key=lambda standing: (standing.agent != arguments.static, standing.trials, standing.gap)
    )


def _means(path: Path) -> dict[tuple[str, int], float]:
    try:
        numbers = json.loads(path.read_text(encoding="utf-8"))
        return {
            (name, int(budget)): float(np.mean(gaps))
            for key, gaps in numbers.items()
            for name, _, budget in [key.rpartition("/")]
        }
    except (OSError, ValueError, TypeError, AttributeError) as error:
        raise ParameterError(
            f"{path}: no gaps by agent and budget, as experiments.transfer writes them ({error})"
        ) from None


def report(arguments: Arguments) -> Path:
    """Write the table and the picture; return the Markdown file."""
    new_figure(1, 1)  # a missing library is told first
    found = standings(arguments)
    static = found[0]
    headings = (
        "agent",
        "trials a map",
        "gap %",
        "training",
        f"worth, trials of {arguments.search}",
        "pays after, maps",
        f"pays against {arguments.static} after",
    )
    rows = [
        [
            f"`{s.agent}`",
            str(s.trials),
            f"{100 * s.gap:.1f}",
            f"{s.training:,}",
            f"{'≥ ' if s.beyond else ''}{s.worth:.1f}",
            _shown(s.pays_after(), s.beyond),
            "–" if s.agent == static.agent else _shown(s.pays_after(static), s.beyond),
        ]
        for s in found
    ]
    text = (
        f"# After how many new maps training pays\n\nWorth: the trials with which {arguments.search} reaches the same "
        "gap; ≥ where its largest budget does not reach it.\n\n"
        f"{table(headings, rows)}\n\n![curves](amortisation.png)\n"
    )
    numbers = {f"{s.agent}/{s.trials}": s._asdict() for s in found}
    return publish(arguments.measured, "amortisation", text, numbers, _figure(found, arguments))


def _shown(maps: float, beyond: bool) -> str:
    if np.isinf(maps):
        return "not told" if beyond else "never"
    return f"{'≤ ' if beyond else ''}{np.ceil(maps):,.0f}"


def _figure(found: Sequence[Standing], arguments: Arguments) -> Any:
    """Return the picture: evaluations a map, training shared out, as a share of the search's for the same gap."""
    figure = new_figure(8, 4.5)
    axes = figure.subplots()
    maps = np.geomspace(1, MOST_MAPS, 200)
    for s in found:
        if s.trials == min(other.trials for other in found if other.agent == s.agent):
            axes.plot(maps, (s.training / maps + s.trials) / s.worth, label=f"{s.agent}, {s.trials} trials")
    axes.axhline(1.0, color="grey", linestyle=":")
    axes.set(
        xlabel="new maps",
        ylabel=f"evaluations a map / those of {arguments.search}",
        xscale="log",
        yscale="log",
    )
    axes.legend(fontsize=7, ncols=2)
    return figure


if __name__ == "__main__":
    main(lambda: print(f"\nwritten: {report(parse(Arguments, None, 'python -m experiments.amortisation'))}"))
