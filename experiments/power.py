"""How many maps and seeds a contest needs to tell agents apart, from what their differences varied by before.

    python -m experiments.power out/board

reads a ledger; ``--gaps`` takes a JSON file of (maps, seeds) gaps by agent instead, and ``--components`` the deviations
themselves. Agents are taken in the order of their mean gap, and each is compared with the one before it, or all of
them with ``--against``: the differences that a board has to resolve.
"""

import json
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Annotated, NamedTuple

import numpy as np
import tyro

from antgym.console import main, parse, write_whole
from antgym.errors import AntgymError, ParameterError
from antgym.tuning.ledger import read_runs
from experiments.columns import NONE
from experiments.statistics import Values, paired_difference
from experiments.statistics.bootstrap import as_matrix
from experiments.statistics.replication import Components, components, maps_needed, resolved
from experiments.tables.sheet import table
from experiments.tracks import agents_in, read_key


@dataclass(frozen=True)
class Arguments:
    """Say how many maps and seeds resolve a difference with 80 % power, two-sided at 5 %, paired by map."""

    ledger: Annotated[Path | None, tyro.conf.Positional] = None
    """Folder of a ledger."""
    gaps: Path | None = None
    """JSON file instead: (maps, seeds) gaps by agent, or by AGENT/BUDGET as experiments.transfer writes them."""
    components: tuple[float, float] | None = None
    """Standard deviations instead, in points: of two agents' difference from map to map, and from seed to seed."""
    budget: int | None = None
    """Trials a map; the largest measured by default."""
    against: str | None = None
    """Compare every agent with this one, not with the one that is next better."""
    points: tuple[float, ...] = (0.5, 1.0, 2.0)
    """Differences to resolve, in points of gap."""
    seeds: tuple[int, ...] = (1, 3, 10)
    """Seeds a map."""
    out: Path | None = None
    """Markdown file to write."""


class Measured(NamedTuple):
    """Gaps by agent at one budget, (maps, seeds) each, best first; who lacks some of their runs; the track."""

    budget: int | None
    gaps: dict[str, Values]
    broken: list[str]
    track: str = ""


class Pair(NamedTuple):
    """Two agents, the worse first."""

    worse: str
    better: str


def read_ledger(folder: Path, budget: int | None) -> Measured:
    """Return what a ledger says at a budget; AntgymError where it holds no contest, or not that budget."""
    found: defaultdict[int | None, defaultdict[str, dict[tuple[str, int], float]]]
    found = defaultdict(lambda: defaultdict(dict))
    names = agents_in(folder)
    for key, run in read_runs(folder).items():
        if run.outcome is not None:
            agent, spent, place, seed = read_key(key, names)
            found[spent][agent][place, seed] = float(np.mean(run.outcome.gaps))
    chosen = _choose(list(found), budget, folder)
    runs = found[chosen]
    every = {at for own in runs.values() for at in own}
    maps, seeds = (sorted(set(column)) for column in zip(*every, strict=True))
    whole = {
        name: np.array([[own[m, s] for s in seeds] for m in maps])
        for name, own in runs.items()
        if len(own) == len(maps) * len(seeds)
    }
    return Measured(chosen, _ranked(whole), sorted(set(runs) - set(whole)), _track(chosen))


def read_gaps(path: Path, budget: int | None) -> Measured:
    """Return what a JSON file of gaps says at a budget; AntgymError where it cannot be read, or not that budget."""
    try:
        given = json.loads(path.read_text(encoding="utf-8"))
        items = list(given.items())
    except (OSError, ValueError, AttributeError) as error:
        raise AntgymError(f"{path} is no JSON object of (maps, seeds) gaps by agent: {error}") from None
    found: defaultdict[int | None, dict[str, Values]] = defaultdict(dict)
    for key, values in items:
        name, _, tail = key.rpartition("/")
        try:
            spent, name = (int(tail), name) if name and tail.isdigit() else (None, key)
            found[spent][name] = as_matrix(values)
        except AntgymError as error:
            raise AntgymError(f"{path}, {key}: {error}") from None
    chosen = _choose(list(found), budget, path)
    return Measured(chosen, _ranked(found[chosen]), [])


def _choose(budgets: Sequence[int | None], budget: int | None, source: Path) -> int | None:
    if not budgets:
        raise AntgymError(f"{source} holds no finished run")
    if budget is None:
        return max(budgets, key=lambda known: -1 if known is None else known)
    if budget not in budgets:
        raise ParameterError(f"--budget {budget} was not measured in {source}; there are {_budgets(budgets)}")
    return budget


def _track(budget: int | None) -> str:
    """Return in which tracks the runs of a ledger at a budget count."""
    return "track C" if budget is None else "track A or B" if budget else "track B"


def _budgets(known: Sequence[int | None]) -> str:
    """Return budgets, smallest first; runs that are steered have none."""
    numbers = sorted(budget for budget in known if budget is not None)
    return _listed([*numbers, *(["runs without one, of track C"] if None in known else [])])


def _listed(names: Sequence[object]) -> str:
    return ", ".join(str(name) for name in names)


def _ranked(gaps: Mapping[str, Values]) -> dict[str, Values]:
    return dict(sorted(gaps.items(), key=lambda item: (float(item[1].mean()), item[0])))


def pairs(names: Sequence[str], against: str | None) -> Iterator[Pair]:
    """Yield neighbours in the ranking, or every agent beside the one that all are compared with."""
    if against is None:
        yield from (Pair(worse, better) for better, worse in pairwise(names))
        return
    if against not in names:
        raise ParameterError(f"--against {against} was not measured; there are {_listed(names)}")
    place = names.index(against)
    yield from (
        Pair(against, name) if i < place else Pair(name, against)
        for i, name in enumerate(names)
        if i != place
    )


def to_markdown(measured: Measured, arguments: Arguments) -> str:
    """Return the table of all pairs, and its explanation."""
    if len(measured.gaps) < 2:
        raise AntgymError(
            f"two agents with all of their runs are needed, got {_listed([*measured.gaps]) or 'none'}"
        )
    maps, seeds = next(iter(measured.gaps.values())).shape
    asked = arguments.seeds if seeds > 1 else (1,)
    rows, counts = [], []
    for pair in pairs(list(measured.gaps), arguments.against):
        worse, better = measured.gaps[pair.worse], measured.gaps[pair.better]
        found = components(worse, better)
        front = [f"`{pair.worse}` − `{pair.better}`", _difference(worse, better), *_deviations(found)]
        if np.array_equal(worse, better):
            rows.append([*front, NONE, *[NONE] * len(arguments.points)])
            continue
        needed = _needed(found, arguments.points, asked)
        counts.append(needed)
        rows.append([*front, _points(resolved(found, maps, seeds)), *_cells(needed)])
    if counts:
        middle = np.ceil(np.median(counts, axis=0)).astype(int).tolist()
        rows.append(["*median*", *[""] * 5, *_cells(middle)])
    trials = "" if measured.budget is None else f", {measured.budget} trials a map"
    trials += f", {measured.track}" if measured.track else ""
    heads = ["pair", "difference", "maps", "map × agent", "seeds", f"resolved by {maps} × {seeds}"]
    return "\n\n".join(
        [
            f"# Maps that resolve a difference: measured on {maps} maps × {_counted(seeds)}{trials}",
            table([*heads, *_headings(arguments.points, asked)], rows),
            _legend(measured, seeds, arguments.against),
        ]
    )


def _points(difference: float) -> str:
    """Return a difference in points; gaps end at 100, and so do differences."""
    return f"{100 * difference:.2f}" if difference <= 1 else "> 100"


def _legend(measured: Measured, seeds: int, against: str | None) -> str:
    text = (
        "In points of gap: the difference with its 95 % interval; standard deviations of what both agents share on a "
        "map (maps), of their difference from map to map (map × agent) and from seed to seed (seeds); and the "
        "difference that as many maps and seeds as were measured resolve. Then the maps that resolve a difference in "
        "four of five contests (80 % power, two-sided at 5 %, paired by map)."
    )
    if seeds == 1:
        text += (
            " With one seed a map, what seeds add is within map × agent, and nothing is known of more seeds."
        )
    if any(
        np.array_equal(measured.gaps[a], measured.gaps[b]) for a, b in pairs(list(measured.gaps), against)
    ):
        text += f" {NONE} at the end of a row: both agents are the same in every run, and nothing tells them apart."
    if measured.broken:
        text += f" Left out, since runs are missing: {_listed(measured.broken)}."
    return f"{text}\n"


def _needed(found: Components, points: Sequence[float], seeds: Sequence[int]) -> list[list[int]]:
    return [[maps_needed(found, point / 100, count) for count in seeds] for point in points]


def _headings(points: Sequence[float], seeds: Sequence[int]) -> list[str]:
    many = " / ".join([*map(str, seeds[:-1]), _counted(seeds[-1])])
    return [f"maps for {point:g} point{'s' if point != 1 else ''}: {many}" for point in points]


def _counted(seeds: int) -> str:
    return f"{seeds} seed{'s' if seeds > 1 else ''}"


def _cells(needed: Sequence[Sequence[int]]) -> list[str]:
    return [" / ".join(f"{count:,}" for count in counts) for counts in needed]


def _difference(worse: Values, better: Values) -> str:
    found = paired_difference(worse, better)
    return f"{100 * found.mean:.2f} [{100 * found.low:.2f}, {100 * found.high:.2f}]"


def _deviations(found: Components) -> list[str]:
    return [NONE if variance is None else f"{100 * np.sqrt(variance):.2f}" for variance in found]


def table_of(deviations: tuple[float, float], arguments: Arguments) -> str:
    """Return the table for given deviations, in points; AntgymError where one is not a number above or at 0."""
    if not all(np.isfinite(value) and value >= 0 for value in deviations):
        raise ParameterError(f"--components are two standard deviations in points, got {_listed(deviations)}")
    interaction, seeds = (value / 100 for value in deviations)
    found = Components(0.0, interaction**2, seeds**2)
    needed = _cells(_needed(found, arguments.points, arguments.seeds))
    return table(_headings(arguments.points, arguments.seeds), [needed]) + "\n"


def report(arguments: Arguments) -> str:
    """Return the table, and write it where that is asked.

    Raises:
        AntgymError: if what is given cannot be read or compared.
    """
    if not arguments.points or not arguments.seeds or min(arguments.points) <= 0 or min(arguments.seeds) < 1:
        raise ParameterError("--points are above 0 and --seeds 1 or more, one of each at least")
    if sum(source is not None for source in (arguments.ledger, arguments.gaps, arguments.components)) != 1:
        raise ParameterError("give one of a ledger's folder, --gaps FILE and --components MAPS SEEDS")
    text = table_of(arguments.components, arguments) if arguments.components else _measured_table(arguments)
    if arguments.out is not None:
        write_whole(arguments.out, text.encode())
    return text


def _measured_table(arguments: Arguments) -> str:
    if arguments.gaps is not None:
        return to_markdown(read_gaps(arguments.gaps, arguments.budget), arguments)
    assert arguments.ledger is not None
    return to_markdown(read_ledger(arguments.ledger, arguments.budget), arguments)


def script() -> None:
    """Run the command line."""
    print(report(parse(Arguments, None, "python -m experiments.power")))


if __name__ == "__main__":
    main(script)
