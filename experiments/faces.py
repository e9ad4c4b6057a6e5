"""From a ledger to what people look at: the board's rows, one scenario's picture, the table and the page."""

import json
import time
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

import agents
from antgym.console import write_whole
from antgym.maps.disc_features import raster
from antgym.maps.discs import DiscWorld
from antgym.maps.optimum import shortest_path
from antgym.maps.suites import SuiteItem
from antgym.tuning.ledger import TIMING, Ledger, Outcome
from antgym.tuning.problem import FRESH
from experiments.board import EXACT, Board, Picture, Row, to_markdown, to_table
from experiments.contest import Entrant, Job, failures
from experiments.presets import Preset
from experiments.report.page import write_page

CELLS = 96  # a side, by which discs are drawn
SHOWN = ("published_default", "random_search", "optuna_tpe", "transfer_graph", "rl", "best_static")


def show(
    folder: Path, ledger: Ledger, contest: Sequence[Entrant], items: Sequence[SuiteItem], preset: Preset
) -> Path:
    """Print the table, write board.md and index.html, and return the page's path."""
    config = ledger.manifest["config"]
    seconds = _seconds(folder / TIMING)
    rows = [_row(entrant, ledger, items, preset, seconds) for entrant in contest]
    board = Board(
        title=_title(items, config),
        command=_command(config),
        rows=(*rows, _exact(items, preset)),
        scenarios=tuple(item.name for item in items),
        budget=preset.budget,
        seeds=preset.seeds,
        manifest=ledger.manifest,
        picture=_picture(contest, ledger, items[_most_telling(rows)], preset.budget),
    )
    Console(width=160 if not Console().is_terminal else None).print(to_table(board))
    write_whole(folder / "board.md", (to_markdown(board) + "\n").encode())
    page = folder / "index.html"
    write_page(board, page)
    return page


def _title(items: Sequence[SuiteItem], config: dict[str, Any]) -> str:
    real = all(item.family == "terrain" for item in items)
    return "Real terrain" if real else f"{config['suite']}, {config['split']}"


def _command(config: dict[str, Any]) -> str:
    """Return what makes the board again; a suite is named where it is not the one of real terrain."""
    suite = (
        "" if config["suite"] == "mountain-v0" else f" --suite {config['suite']} --split {config['split']}"
    )
    chosen = " ".join(config["agents"])
    return f"python -m experiments.leaderboard --preset {config['preset']}{suite} --agents {chosen}"


def _row(
    entrant: Entrant,
    ledger: Ledger,
    items: Sequence[SuiteItem],
    preset: Preset,
    seconds: dict[str, dict[str, float]],
) -> Row:
    gaps, spent, optimism, solved, clocks, outcomes = [], [], [], [], [], []
    for item in items:
        for seed in range(preset.seeds):
            job = Job(entrant, item, seed, preset.budget)
            run = ledger.run(job.key)
            outcome = run.outcome
            assert outcome is not None, f"{run.key} is not finished"
            outcomes.append(outcome)
            gaps.append(float(np.mean(outcome.gaps)))
            solved.append(np.isfinite(outcome.lengths).mean())
            spent.append(len(run.records))
            seen = [r.length for r in run.records if r.trial.unit == outcome.unit]
            if seen and not outcome.failure:
                optimism.append(gaps[-1] - float(job.problem.gap(np.array(seen)).mean()))
            clocks.append(seconds.get(run.key, {}))
    table = np.array(gaps).reshape(len(items), preset.seeds)
    return Row(
        name=entrant.name,
        kind=entrant.kind,
        summary=entrant.summary + failures(outcomes),
        gaps=tuple(tuple(row) for row in table.tolist()),
        success=float(np.mean(solved)),
        deploy=float(np.mean(spent)),
        training=entrant.training,
        tuner_seconds=float(np.mean([clock.get("tuner", 0.0) for clock in clocks])),
        planner_seconds=float(np.mean([clock.get("planner", 0.0) for clock in clocks])),
        optimism=float(np.mean(optimism)) if optimism else None,
        card={
            "training trials": entrant.training,
            "settings": dict(agents.find_card(entrant.name).kwargs),
            "versions": agents.versions(entrant.name),
        },
    )


def _exact(items: Sequence[SuiteItem], preset: Preset) -> Row:
    begun = time.perf_counter()
    for item in items:
        shortest_path(item.scenario)
    each = (time.perf_counter() - begun) / len(items)
    gaps = tuple((0.0,) * preset.seeds for _ in items)
    among_discs = isinstance(items[0].scenario.world, DiscWorld)
    method = "tangents and arcs" if among_discs else "dynamic programming under the same motion rule"
    summary = f"{method}; no {'bees' if among_discs else 'ants'}"
    return Row(EXACT, "reference", summary, gaps, 1.0, 0.0, 0, 0.0, each, None, {})


def _seconds(path: Path) -> dict[str, dict[str, float]]:
    """Return the seconds of every run, as far as sessions came to its end: a killed one leaves none."""
    total: dict[str, dict[str, float]] = defaultdict(lambda: defaultdict(float))
    for line in path.read_text(encoding="utf-8").splitlines() if path.exists() else ():
        fields: dict[str, Any] = json.loads(line)
        key = fields.pop("run")
        for name, value in fields.items():
            total[key][name] += value
    return total


def _most_telling(rows: Sequence[Row]) -> int:
    """Return the scenario on which agents differ most."""
    return int(np.array([row.scenario_means for row in rows if row.name in SHOWN]).std(axis=0).argmax())


def _picture(contest: Sequence[Entrant], ledger: Ledger, item: SuiteItem, budget: int) -> Picture:
    """Walk the first fresh run of some agents' recommendations again, for their paths."""
    scenario = item.scenario
    paths, lengths = {EXACT: shortest_path(scenario)}, {EXACT: scenario.optimum}
    for entrant in contest:
        if entrant.name in SHOWN:
            job = Job(entrant, item, 0, budget)
            outcome = ledger.run(job.key).outcome
            assert isinstance(outcome, Outcome)
            plan = job.problem.run(np.array([outcome.unit]), FRESH, 0).plan(0)
            lengths[entrant.name] = plan.length
            if plan.solved:
                paths[entrant.name] = plan.path
    if isinstance(scenario.world, DiscWorld):
        return _seen_from_above(item.name, scenario.world, paths, lengths)
    world = scenario.world
    heights = (world.free == 0).sum(axis=2) * world.cell[2]
    return Picture(
        item.name, heights.astype(float), np.array(world.free), world.cell, paths, lengths, scenario.optimum
    )


def _seen_from_above(
    name: str, world: DiscWorld, paths: dict[str, Any], lengths: dict[str, float]
) -> Picture:
    """Return the picture of a disc world as one of small cells; paths keep their way-points, in cells."""
    x_min, x_max, y_min, y_max = world.bounds
    free = (raster(world, CELLS, CELLS) > 0).astype(np.uint8)[:, :, None]
    cell = ((x_max - x_min) / CELLS, (y_max - y_min) / CELLS, world.width / CELLS)
    in_cells = {
        agent: np.pad((path - (x_min, y_min)) / cell[:2] - 0.5, ((0, 0), (0, 1)))
        for agent, path in paths.items()
    }
    return Picture(name, None, free, cell, in_cells, lengths, lengths[EXACT])
