"""Pictures of a board's maps: the world, and the paths that some agents' settings lead to, walked again."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antgym.maps.disc_features import raster
from antgym.maps.discs import DiscWorld
from antgym.maps.optimum import shortest_path
from antgym.maps.suites import SuiteItem
from antgym.planners.fleet import FleetPlan
from antgym.planners.plans import Plan
from antgym.tuning.ledger import Ledger, Outcome
from antgym.tuning.problem import FRESH
from antgym.tuning.session import Session, steer_together
from experiments import contest
from experiments.board import EXACT, SBS, Picture, Row
from experiments.tracks import Job, Round

CELLS = 96  # a side, by which discs are drawn
ALWAYS_DRAWN = ("published_default", SBS)
DRAWN = 7  # paths in all beside the exact one
MOST = 6  # maps


def draw(played: Round, rows: Sequence[Row], ledger: Ledger) -> tuple[Picture, ...]:
    """Return pictures of the maps on which the agents differ most, the first of their runs walked again."""
    ranked = sorted(rows, key=lambda row: row.mean)
    others = [row for row in ranked if row.kind == "agent" and row.name not in ALWAYS_DRAWN]
    chosen = [row for row in ranked if row.name in ALWAYS_DRAWN] + others[: DRAWN - len(ALWAYS_DRAWN)]
    spread = np.array([row.scenario_means for row in chosen]).std(axis=0)
    telling = np.argsort(-spread, kind="stable")[:MOST].tolist()
    names = {row.name for row in chosen}
    return tuple(_picture(played, names, played.items[i], ledger) for i in telling)


def _picture(played: Round, names: set[str], item: SuiteItem, ledger: Ledger) -> Picture:
    scenario = item.scenario
    paths, lengths = {EXACT: shortest_path(scenario)}, {EXACT: scenario.optimum}
    for entrant in played.entrants:
        if entrant.name in names:
            job = played.job(entrant, item, 0)
            outcome = ledger.run(job.key).outcome
            assert isinstance(outcome, Outcome)
            if outcome.failure:  # nothing was recommended
                continue
            plan = _walk(job, outcome)
            lengths[entrant.name] = plan.length
            if plan.solved:
                paths[entrant.name] = plan.path
    if isinstance(scenario.world, DiscWorld):
        return _seen_from_above(item.name, scenario.world, paths, lengths)
    world = scenario.world
    return Picture(item.name, None, np.array(world.free), world.cell, paths, lengths, scenario.optimum)


def _walk(job: Job, outcome: Outcome) -> Plan | FleetPlan:
    """Walk the first fresh run of a recommendation again, or the run that was steered."""
    if isinstance(job, contest.Job):
        return job.problem.run(np.array([outcome.unit]), FRESH, 0).plan(0)
    session = Session(job.problem, 1)
    settings = np.array(outcome.unit).reshape(-1, len(job.problem.space))
    trial = session.open(len(settings))
    for setting in settings:
        steer_together([(session, setting)])
    plan: Plan = trial.colony.result()
    return plan


def _seen_from_above(
    name: str, world: DiscWorld, paths: dict[str, NDArray[Any]], lengths: dict[str, float]
) -> Picture:
    """Return the picture of a disc world as one of small cells; paths keep their way-points, in cells."""
    x_min, x_max, y_min, y_max = world.bounds
    free = (raster(world, CELLS, CELLS) > 0).astype(np.uint8)[:, :, None]
    cell = ((x_max - x_min) / CELLS, (y_max - y_min) / CELLS, world.width / CELLS)
    in_cells: dict[str, NDArray[Any]] = {
        agent: np.pad((path - (x_min, y_min)) / cell[:2] - 0.5, ((0, 0), (0, 1)))
        for agent, path in paths.items()
    }
    return Picture(name, None, free, cell, in_cells, lengths, lengths[EXACT])
