"""Tables 1-3 of liu2020 and its convergence figure, on six maps of ours.

The paper's maps are not published, so lengths compare within a column, never across. Times are wall seconds.
"""

import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

import agents
from agents.fitting import trials_needed
from agents.graph import TransferGraph
from agents.laplacian import transfers
from antgym.console import progress
from antgym.maps.world import Scenario
from antgym.tuning.agent import Agent, tune
from antgym.tuning.problem import COST_CAP, TuningProblem
from antgym.tuning.session import Session
from experiments.artefacts import derived_seed
from experiments.tables.draws import draw
from experiments.tables.sheet import new_figure, publish, table

MAPS, SIDE = 6, 21
DETOUR = 1.3  # of the optimum over the straight line; the paper's 148.66 mm over nine layers is 1.10
ANTS, ITERATIONS, RUNS = 20, 50, 10  # m and T are not in the paper; every figure of it is a mean over 10 runs

PAPER_TABLE_1 = (
    (None, -0.0034, 0.1077, -0.00038, 0.0188),
    (0.0207, None, 0.1077, 0.0015, -0.0434),
    (-0.0506, 0.1167, None, -0.0122, 0.0048),
    (0.0107, 0.0229, 0.1156, None, 0.0100),
    (-0.0061, 0.0302, 0.0595, 0.0109, None),
)
PAPER_TABLE_2 = (0.0254, 0.0679, 0.1131, -0.0245, 0.0542)


class Method(NamedTuple):
    """A row of Table 3: how an agent is made, what it may spend, and the paper's seconds and length."""

    label: str
    agent: str
    overrides: dict[str, Any]
    budget: int
    paper_seconds: float | None = None
    paper_length: float | None = None


@dataclass(frozen=True)
class Arguments:
    """Replay liu2020: five source maps, a transfer graph, and ten methods that tune a sixth map."""

    out: Path = Path("out/tables")
    """Folder of liu2020.md, liu2020.json and liu2020.png."""
    rules: Literal["liu2020", "liu2020-paper"] = "liu2020"
    """The sound rules, or the rules as printed."""
    share: float = 1.0
    """Share of the paper's evaluations to spend, for a quick look."""
    seed: int = 0
    """Root seed of agents and planner; the six maps stay."""


def six_maps() -> list[Scenario]:
    """Return map1 to map6, from hashed seeds: the first of each whose detour is like the paper's."""
    return draw("liu2020", MAPS, "mountains", SIDE, lambda s: s.optimum <= DETOUR * s.straight_line)


def methods(graph: TransferGraph, share: float) -> list[Method]:
    """Return the rows of Table 3: the paper's own methods, then the controls it lacks."""
    sources = len(graph.names)
    probes = RUNS * (sources + 1)
    paper = {"settings": "paper", **({} if share == 1 else {"population": max(4, int(100 * share))})}
    return [
        Method(
            "transfer (14) as printed", "transfer_graph_paper", {"graph": graph}, probes, 121.4153, 148.6621
        ),
        Method("GA, 100 x 60", "ga", paper, int(6_000 * share), 2.4248e4, 153.2710),
        Method("PSO, 100 x 100", "pso", paper, int(10_000 * share), 7.5633e4, 152.4676),
        Method("trial and error, 1,000 sets", "random_search", {"rerun_share": 0.0}, int(1_000 * share), 3e4),
        Method("one random set", "uniform_random", {}, 1),
        Method("transfer, sound", "transfer_graph", {"graph": graph}, probes),
        Method("transfer, abs(Λ̂)", "transfer_graph_abs", {"graph": graph}, probes),
        Method("copy the best source", "copy_best_source", {"graph": graph}, probes),
        Method("mean of the sources", "mean_of_sources", {"graph": graph}, 1),
        Method("published default", "published_default", {}, 1),
    ]


class Answer(NamedTuple):
    """What a method arrived at, and what fresh runs say of it."""

    method: Method
    values: NDArray[np.float64]  # (4,) natural
    evaluations: int
    seconds: float
    lengths: NDArray[np.float64]  # (RUNS,) fresh
    notes: tuple[str, ...]
    curve: NDArray[np.float64]  # (ITERATIONS,) mean shortest length so far over the fresh runs that found one
    seen: NDArray[np.float64]  # best length so far over the evaluations


def solve(method: Method, problem: TuningProblem, seed: int) -> Answer:
    """Let a method tune the target, then run its answer on fresh seeds."""
    agent: Agent = agents.make(method.agent, **method.overrides)
    session = Session(problem, max(1, method.budget))
    begun = time.perf_counter()
    unit, _ = tune(agent, session, seed=derived_seed("liu2020", "agent", seed))
    seconds = time.perf_counter() - begun
    plans = problem.fresh(unit, RUNS)
    histories = np.array([plans.plan(i).best for i in range(RUNS)])
    found = np.isfinite(histories)
    totals, counts = np.where(found, histories, 0.0).sum(axis=0), found.sum(axis=0)
    curve = np.divide(totals, counts, out=np.full(ITERATIONS, np.nan), where=counts == RUNS)
    values = problem.space.decode(unit)[0]
    seen = np.minimum.accumulate(np.array(session.lengths)) if session.lengths else np.empty(0)
    return Answer(
        method, values, len(session.trials), seconds, plans.lengths, getattr(agent, "notes", ()), curve, seen
    )


def replay(arguments: Arguments) -> Path:
    """Fit the graph on maps 1-5, tune map 6 by every method, write tables and figure; return the Markdown file."""
    new_figure(1, 1)  # a missing library is told before the work, not after it
    maps = six_maps()
    problems = [
        TuningProblem(
            scenario, arguments.rules, ANTS, ITERATIONS, derived_seed("liu2020", "runs", i, arguments.seed)
        )
        for i, scenario in enumerate(maps, start=1)
    ]
    sources, target = problems[:-1], problems[-1]
    search = max(8, int(100 * arguments.share))
    begun = time.perf_counter()
    sessions = [Session(problem, trials_needed(len(sources), search, RUNS)) for problem in sources]
    names = [f"map{i}" for i in range(1, MAPS)]
    with progress("liu2020: source sets, Table 1 and ten methods", 11) as advance:
        graph = TransferGraph.fit(sessions, names=names, search=search, repeats=RUNS, seed=arguments.seed)
        fitting = time.perf_counter() - begun
        advance(1)
        answers = []
        for method in methods(graph, arguments.share):
            answers.append(solve(method, target, arguments.seed))
            advance(1)
    text, numbers = _report(graph, fitting, answers, target, arguments), _numbers(graph, answers, target)
    return publish(arguments.out, "liu2020", text, numbers, _figure(answers, target))


def _report(
    graph: TransferGraph, fitting: float, answers: list[Answer], target: TuningProblem, arguments: Arguments
) -> str:
    parts = [
        f"# liu2020: six maps of {SIDE} x {SIDE} x {SIDE} cells, rules `{arguments.rules}`",
        f"{ANTS} ants x {ITERATIONS} iterations (not in the paper), means over {RUNS} runs, seed {arguments.seed}; our "
        f"maps, not the paper's: its lengths and ours do not compare. Source sets and Table 1 took {fitting:.1f} s and "
        f"{graph.evaluations:,} evaluations, which every transfer row needs first. A run without a path costs "
        f"{COST_CAP:g} straight lines in Tables 1 and 2: the paper has no word for it; the same random set is "
        "the reference of (11), of Table 2, and method 1.",
        "## Table 1: transfer from the row's set to the column's map (paper's value in brackets)",
        _table_1(transfers(graph.table)),
        "## Table 2: transfer of each source to map6, against one random set",
        _table_2(answers, graph, target),
        "## Table 3: what each method finds for map6",
        _table_3(answers, target),
        *(f"- {a.method.label}: {note}" for a in answers for note in a.notes),
        _verdict(answers, target),
        "![convergence](liu2020.png)",
    ]
    return "\n\n".join(parts) + "\n"


def _table_1(gains: NDArray[np.float64]) -> str:
    names = [f"map{i + 1}" for i in range(len(gains))]
    rows = [
        [names[i]]
        + ["–" if i == j else f"{value:+.4f} ({PAPER_TABLE_1[i][j]:+.4f})" for j, value in enumerate(row)]
        for i, row in enumerate(gains)
    ]
    return table(["", *names], rows)


def _table_2(answers: list[Answer], graph: TransferGraph, target: TuningProblem) -> str:
    reference = next(a for a in answers if a.method.agent == "uniform_random")
    base = float(target.cost(reference.lengths).mean())
    settings = graph.settings
    lengths = [target.fresh(unit, RUNS).lengths for unit in settings]
    ours = [1 - float(target.cost(each).mean()) / base for each in lengths]
    rows = [
        [who, *(f"{value:+.4f}" for value in row)] for who, row in (("ours", ours), ("paper", PAPER_TABLE_2))
    ]
    return table(["", *graph.names], rows)


HEADINGS = (
    *("method", "α", "β", "ρ", "Q", "evaluations", "time/s", "paper's time/s", "ratio"),
    *("length/mm ± sd", "solved", "gap %", "paper's length/mm"),
)


def _table_3(answers: list[Answer], target: TuningProblem) -> str:
    rows: list[tuple[str, ...]] = []
    for a in answers:
        theirs, length = a.method.paper_seconds, a.method.paper_length
        ratio = f"{theirs / max(a.seconds, 1e-3):,.0f}x" if theirs else "–"
        found = a.lengths[np.isfinite(a.lengths)]
        cells = (
            a.method.label,
            *(f"{value:.4g}" for value in a.values),
            f"{a.evaluations:,}",
            f"{a.seconds:.2f}",
            f"{theirs:,.0f}" if theirs else "–",
            ratio,
            f"{found.mean():.2f} ± {found.std():.2f}" if len(found) else "–",
            f"{len(found)}/{RUNS}",
            f"{100 * float(target.gap(a.lengths).mean()):.2f}",
            f"{length:.2f}" if length else "–",
        )
        rows.append(cells)
    exact = (
        "exact planner",
        *"––––",
        "0",
        *"–––",
        f"{target.scenario.optimum:.2f}",
        f"{RUNS}/{RUNS}",
        "0.00",
        "–",
    )
    return table(HEADINGS, [*rows, exact])


def _verdict(answers: list[Answer], target: TuningProblem) -> str:
    gaps = {a.method.agent: float(target.gap(a.lengths).mean()) for a in answers}
    order = ["transfer_graph_paper", "random_search", "uniform_random"]
    holds = gaps[order[0]] < gaps[order[1]] < gaps[order[2]]
    transfer, genetic = (next(a for a in answers if a.method.agent == name) for name in (order[0], "ga"))
    found = ", ".join(f"{100 * gaps[name]:.1f} %" for name in order)
    return (
        "**Verdict.** The paper's order of lengths, transfer < trial and error < random, "
        f"{'holds' if holds else 'does not hold'} on this one target and draw ({found}). Its GA took "
        f"{genetic.method.paper_seconds:,.0f} s for 6,000 evaluations, ours {genetic.seconds:.1f} s for "
        f"{genetic.evaluations:,}: the hours were the planner's. Transfer, once its sources are fitted, takes "
        f"{transfer.seconds:.2f} s. Copying the best source, which the paper does not try, reaches "
        f"{100 * gaps['copy_best_source']:.1f} %."
    )


def _numbers(graph: TransferGraph, answers: list[Answer], target: TuningProblem) -> dict[str, Any]:
    rows = [
        {
            "method": a.method.label,
            "parameters": dict(zip(target.space.names, a.values.tolist(), strict=True)),
            "evaluations": a.evaluations,
            "seconds": round(a.seconds, 3),
            "gaps": target.gap(a.lengths).tolist(),
        }
        for a in answers
    ]
    return {"transfers": transfers(graph.table).tolist(), "optimum": target.scenario.optimum, "methods": rows}


def _figure(answers: list[Answer], target: TuningProblem) -> Any:
    figure = new_figure(11, 4)
    left, right = figure.subplots(1, 2)
    for a in answers:
        if a.method.paper_seconds or a.method.agent == "uniform_random":
            left.plot(np.arange(1, ITERATIONS + 1), a.curve, label=a.method.label)
            if len(a.seen) > 1:
                right.plot(np.arange(1, len(a.seen) + 1), a.seen, label=a.method.label)
    for axes in (left, right):
        axes.axhline(
            target.scenario.optimum, color="black", linestyle="--", linewidth=1, label="exact optimum"
        )
        axes.set_ylabel("length / mm")
        axes.legend(fontsize=8)
    left.set(xlabel="iteration of the colony", title=f"the settings found, mean of {RUNS} fresh runs")
    right.set(xlabel="evaluation", xscale="log", title="the searches: luckiest run so far")
    return figure
