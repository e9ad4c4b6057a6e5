"""From a ledger to the rows of a board: what every entrant achieved, and the two bounds, exact and virtual best."""

import time
from collections import defaultdict
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

import agents
from antgym.maps.discs import DiscWorld
from antgym.maps.optimum import shortest_path
from antgym.maps.suites import SuiteItem
from antgym.tuning.ledger import TIMING, Ledger, LedgerRun
from antgym.tuning.lines import read_fields
from experiments import contest, steering
from experiments.board import EXACT, VBS, Row
from experiments.bound import candidates, virtual_best
from experiments.tracks import Entrant, Job, Round

Clocks = Mapping[str, Mapping[str, float]]
"""Seconds by the key of a run and what they were spent on."""


def to_row(played: Round, entrant: Entrant, ledger: Ledger, clocks: Clocks) -> Row:
    """Return what an entrant achieved in a round that is finished."""
    jobs = [played.job(entrant, item, seed) for item in played.items for seed in range(played.seeds)]
    runs = [ledger.run(job.key) for job in jobs]
    outcomes = [run.outcome for run in runs if run.outcome is not None]
    assert len(outcomes) == len(runs), f"{entrant.name} is not finished"
    gaps = np.array([np.mean(outcome.gaps) for outcome in outcomes]).reshape(len(played.items), -1)
    steered = played.track == "C"  # the run is what is judged, and no trial before it
    spent, failure = [clocks.get(run.key, {}) for run in runs], contest.failures(outcomes)
    return Row(
        name=entrant.name,
        kind=entrant.kind,
        summary=f"{entrant.summary}; {failure}" if failure else entrant.summary,
        gaps=tuple(tuple(row) for row in gaps.tolist()),
        success=float(np.mean([np.isfinite(outcome.lengths).mean() for outcome in outcomes])),
        deploy=0.0 if steered else _paid_on_a_map(entrant, runs),
        training=entrant.training,
        tuner_seconds=_seconds("tuner", spent),
        planner_seconds=_seconds("planner", spent),
        optimism=None if steered else _optimism(jobs, runs),
        card=_card(entrant),
        failure=failure,
        steers=isinstance(entrant, steering.Entrant) and entrant.steers,
    )


def _seconds(name: str, spent: Sequence[Mapping[str, float]]) -> float | None:
    """Return the mean over the runs whose seconds are there, None where none are: a killed process leaves none."""
    known = [clock[name] for clock in spent if name in clock]
    return float(np.mean(known)) if known else None


def _optimism(jobs: Sequence[Job], runs: Sequence[LedgerRun]) -> float | None:
    """Return by how much fresh runs fell short of what an agent saw of its setting; None where it saw nothing."""
    found = []
    for job, run in zip(jobs, runs, strict=True):
        assert run.outcome is not None
        seen = [record.length for record in run.records if record.trial.unit == run.outcome.unit]
        if seen and not run.outcome.failure:
            found.append(np.mean(run.outcome.gaps) - job.problem.gap(np.array(seen)).mean())
    return float(np.mean(found)) if found else None


def _paid_on_a_map(entrant: Entrant, runs: Sequence[LedgerRun]) -> float:
    """Return the trials a map: those of the ledger, or what a submission says it took before."""
    before = entrant.trials if isinstance(entrant, contest.Entrant) else 0
    return float(np.mean([max(before, len(run.records)) for run in runs]))


def _card(entrant: Entrant) -> dict[str, Any]:
    card: dict[str, Any] = {"training trials": entrant.training}
    if entrant.name.partition(":")[0] in agents.CATALOGUE:
        card["settings"] = dict(agents.find_card(entrant.name).kwargs)
        card["versions"] = agents.versions(entrant.name)
    return card


def exact_row(played: Round, clocks: Clocks) -> Row:
    """Return the row of the exact planner: no gap, and its seconds."""
    among_discs = isinstance(played.items[0].scenario.world, DiscWorld)
    method = "tangents and arcs" if among_discs else "dynamic programming under the same motion rule"
    return Row(
        name=EXACT,
        kind="reference",
        summary=f"{method}; no {'bees' if among_discs else 'ants'}",
        gaps=tuple((0.0,) * played.seeds for _ in played.items),
        success=1.0,
        deploy=0.0,
        training=0,
        tuner_seconds=0.0,
        planner_seconds=float(np.mean([clocks[exact_key(item)]["planner"] for item in played.items])),
        optimism=None,
        card={},
    )


def time_exact(items: Sequence[SuiteItem], ledger: Ledger) -> None:
    """Note in the ledger how long the exact planner takes on each map, where it is not noted yet."""
    clocks = read_clocks(ledger.folder)
    for item in items:
        if exact_key(item) not in clocks:
            begun = time.perf_counter()
            shortest_path(item.scenario)
            seconds = round(time.perf_counter() - begun, 6)
            ledger.write_timing({"run": exact_key(item), "planner": seconds})


def exact_key(item: SuiteItem) -> str:
    """Return how the seconds of the exact planner on a map are called."""
    return f"{EXACT}/{item.name}"


def bound_row(played: Round, others: Sequence[Round], ledger: Ledger) -> Row | None:
    """Return the row of the virtual best, chosen among all that some rounds recommended on the same maps.

    None where no candidate has two runs, which it takes to choose by one and to score by the other.
    """
    pools = [candidates(others, i, ledger) for i in range(len(played.items))]
    best = [virtual_best(pool) for pool in pools]
    if any(found is None for found in best):
        return None
    found = np.array(best)
    who = "controller" if played.track == "C" else "recommendation of anybody at any budget"
    return Row(
        name=VBS,
        kind="reference",
        summary=f"the best {who} on each map, {np.mean([len(pool) for pool in pools]):.0f} candidates, chosen on all "
        "of their runs but one and scored on that one, each in turn: a bound, no agent; may lie above an agent, for it "
        "is chosen without the run that scores it",
        gaps=tuple((gap,) * played.seeds for gap in found[:, 0].tolist()),
        success=float(found[:, 1].mean()),
        deploy=_paid(others, ledger) / len(played.items),
        training=None,
        tuner_seconds=0.0,
        planner_seconds=0.0,
        optimism=None,
        card={},
    )


def _paid(rounds: Sequence[Round], ledger: Ledger) -> int:
    keys = {job.key for played in rounds for job in played.jobs}
    return sum(len(ledger.run(key).records) for key in keys)


def read_clocks(folder: Path) -> Clocks:
    """Return the seconds of every run, as far as sessions came to its end: a killed one leaves none."""
    total: dict[str, dict[str, float]] = defaultdict(lambda: defaultdict(float))
    for fields in read_fields(folder / TIMING, "run"):
        key = fields.pop("run")
        for name, value in fields.items():
            total[key][name] += value
    return total
