"""The report: the replay run, or read back, and written as Markdown, numbers and a figure."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from antgym.console import progress
from antgym.errors import ParameterError
from antgym.tuning.problem import COST_CAP
from experiments.statistics import wilson_interval
from experiments.tables.liu2020.archive import Archive, origin
from experiments.tables.liu2020.draw import ANTS, ITERATIONS, SIDE, Arguments, Draw, play
from experiments.tables.liu2020.figure import to_figure
from experiments.tables.liu2020.findings import Findings, Standing, answers, find, worse_than_copy
from experiments.tables.liu2020.methods import METHODS, RUNS, SUITE, TRANSFER, Trained
from experiments.tables.liu2020.sheets import table_1, table_2, table_3, table_4
from experiments.tables.sheet import new_figure, publish

TRANSFERS = tuple(method for method in METHODS if method.agent.startswith("transfer_graph"))
# of an answer, in the JSON file
SHOWN = ("method", "values", "evaluations", "before", "seconds", "gaps", "notes")


def replay(arguments: Arguments) -> Path:
    """Play the draws that are not finished, write tables and figure of all; return the Markdown file.

    Raises:
        ParameterError: if there are to be no draws, or the share is not in (0, 1].
        LedgerError: if a finished draw was made with something else.
    """
    new_figure(1, 1)  # a missing library is told before the work, not after it
    if arguments.draws < 1:
        raise ParameterError(f"draws = {arguments.draws}: needs at least 1, and 2 for Table 4")
    if not 0 < arguments.share <= 1:
        raise ParameterError(
            f"share = {arguments.share}: must be above 0 and 1 at most, 1 being the paper's evaluations"
        )
    draws = _play_all(arguments)
    findings = find(draws) if len(draws) > 1 else None
    text, values = to_text(draws, findings, arguments), numbers(draws, findings, arguments)
    return publish(arguments.out, "liu2020", text, values, to_figure(draws, findings))


def _play_all(arguments: Arguments) -> list[Draw]:
    trained = Trained.make(arguments.out / "trained")
    archive = Archive(arguments.out / "liu2020", origin(arguments, trained))
    found = {number: archive.read(number) for number in range(1, arguments.draws + 1)}
    todo = [number for number, draw in found.items() if draw is None]
    title = f"liu2020: {len(METHODS)} methods on {len(todo)} sixes of maps"
    with progress(title, len(METHODS) * len(todo)) as advance:
        for number in todo:
            draw = play(number, arguments, trained, advance)
            archive.keep(draw)
            found[number] = draw
    return [draw for draw in found.values() if draw is not None]


def to_text(draws: Sequence[Draw], findings: Findings | None, arguments: Arguments) -> str:
    """Return the Markdown; without findings there is no Table 4."""
    first = draws[0]
    parts = [
        f"# liu2020: maps of {SIDE} x {SIDE} x {SIDE} cells, rules `{arguments.rules}`",
        _introduction(draws, arguments),
        verdict(findings, len(draws), arguments.share),
        *(["\n".join(f"- {claim}" for claim in findings.claims)] if findings else []),
        "## Table 1: transfer from the row's set to the column's map, draw 1 (paper's value in brackets)",
        table_1(first),
        "## Table 2: transfer of each source to map6, against one random set, draw 1",
        table_2(first),
        "## Table 3: what each method finds for map6, draw 1",
        table_3(first),
        "\n".join(f"- {answer.method}: {note}" for answer in first.answers for note in answer.notes),
        *([f"## Table 4: over {len(draws)} draws", *_over_all(draws, findings)] if findings else []),
        "![convergence](liu2020.png)",
    ]
    return "\n\n".join(part for part in parts if part) + "\n"


def _introduction(draws: Sequence[Draw], arguments: Arguments) -> str:
    count = len(draws)
    seconds = sum(draw.fitting_seconds for draw in draws) / count
    evaluations = sum(draw.fitting_evaluations for draw in draws) / count
    machines = "; ".join(dict.fromkeys(draw.machine for draw in draws))
    return (
        f"{count} {'draw' if count == 1 else 'draws'} of five source maps and a target, all different. {ANTS} ants x "
        f"{ITERATIONS} iterations (not in the paper), means over {RUNS} fresh runs, seed {arguments.seed}; our maps, "
        "not the paper's: its lengths and ours do not compare, gaps do. A gap is (L − L\\*) / L\\* with L\\* the exact "
        "optimum; a run without a path counts as 1, as does any gap above, but costs "
        f"{COST_CAP:g} straight lines in Tables 1 and 2: the paper has no word for it. The same random set is the "
        "reference of (11), of Table 2, and method 1. Source sets and Table 1 take "
        f"{evaluations:,.0f} evaluations and {seconds:.1f} s a draw, which every transfer row needs first. Times are "
        f"wall seconds on the target ({machines})."
    )


def verdict(findings: Findings | None, count: int, share: float) -> str:
    """Return the verdict line."""
    if findings is None:
        return f"**Verdict: none.** {count} draw says nothing about other targets: it takes two or more (`--draws`)."
    held = sum(claim.holds for claim in findings.claims)
    leaning = sum(claim.margin.mean > 0 for claim in findings.claims)
    look = "" if share == 1 else f" A quick look: searches spent {share:g} of the paper's evaluations."
    return (
        f"**Verdict: {findings.verdict}.** Of the paper's {len(findings.claims)} claims, {held} hold over {count} "
        f"draws by their whole 95 % interval and {leaning} by their mean.{look}"
    )


def _over_all(draws: Sequence[Draw], findings: Findings) -> list[str]:
    count = len(draws)
    worse = "; ".join(f"{m.label} {_share(worse_than_copy(m, draws), count)}" for m in TRANSFERS)
    warned = sum(bool(answer.notes) for answer in answers(TRANSFER, draws))
    return [
        table_4(findings.standings),
        "In brackets 95 % intervals over draws: of shares Wilson's, of means by bootstrap, of differences by draw; "
        "over so few draws the bootstrap's are somewhat narrow (`experiments/statistics`). The best static setting "
        f"was raced once for all draws, on train maps of `{SUITE}` under the sound rules.",
        f"Negative transfer, draws on which transfer is worse than copying the best source: {worse}.",
        "(14) as printed came with a warning, a parameter out of its range or worse sources weighing more, on "
        f"{_share(warned, count)}.",
    ]


def _share(hits: int, count: int) -> str:
    low, high = wilson_interval(hits, count)
    return f"{hits} of {count}, {100 * hits / count:.0f} % [{100 * low:.0f}, {100 * high:.0f}]"


def numbers(draws: Sequence[Draw], findings: Findings | None, arguments: Arguments) -> dict[str, Any]:
    """Return what the JSON file holds: what the tables are made of, draw by draw."""
    shown = {
        **{name: getattr(arguments, name) for name in ("rules", "share", "seed")},
        "draws": [
            {**draw._asdict(), "answers": [{name: getattr(a, name) for name in SHOWN} for a in draw.answers]}
            for draw in draws
        ],
    }
    if findings is None:
        return shown
    return {
        **shown,
        "verdict": findings.verdict,
        "claims": [{**claim._asdict(), "margin": claim.margin._asdict()} for claim in findings.claims],
        "methods": [_numbers(row) for row in findings.standings],
        "worse_than_copy": {method.label: worse_than_copy(method, draws) for method in TRANSFERS},
    }


def _numbers(row: Standing) -> dict[str, Any]:
    estimates = {"gap": row.gap._asdict(), "difference": row.difference and row.difference._asdict()}
    return {**row._asdict(), **estimates, "method": row.method.label, "ratio": row.ratio}
