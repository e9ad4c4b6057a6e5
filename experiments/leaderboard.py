"""The leaderboard: every agent tunes the swarm on maps it has not seen, its recommendations are judged on fresh runs.

    python -m experiments.leaderboard --preset quick --out out/board

The maps are real terrain unless another suite is asked for; ``--suite tabu-bee-v0 --split test`` is that of the bees.
The ledger in the folder is the result: the table and the page are computed from it. A run that was stopped, or
killed, goes on where it was when the same command is given again.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, NamedTuple

import tyro

import agents
from antgym.console import main, progress
from antgym.errors import ParameterError
from antgym.maps.suites import SuiteItem, load_suite
from antgym.tuning.ledger import Ledger
from experiments import provenance
from experiments.artefacts import prepare
from experiments.contest import Entrant, Job, enter, jobs, play
from experiments.presets import PRESETS, Preset

AGENTS = (
    "uniform_random",
    "published_default",
    "random_search",
    "sobol",
    "ga",
    "pso",
    "de",
    "cma_es",
    "optuna_tpe",
    "optuna_race",
    "transfer_graph",
    "portfolio",
    "neighbours",
    "regression",
    "neural_regression",
    "cma_es_warm",
    "transfer_gp",
    "rl",
)
STATIC = "best_static"
TRAINED = "trained"  # folder of the trained agents' files below the board's


@dataclass(frozen=True)
class Arguments:
    """Run the leaderboard, by default on real terrain, or go on with one that was stopped."""

    preset: Literal["smoke", "quick", "full"] = "quick"
    """smoke: half a minute, for tests; quick: minutes, the published table; full: hours."""
    out: Path = Path("out/leaderboard")
    """Folder of the ledger, of the trained agents and of index.html."""
    agents: tuple[str, ...] = AGENTS
    """Names in the catalogue of agents."""
    suite: str = "mountain-v0"
    """Suite of the maps; trained agents learn from its train split."""
    split: str = "ood"
    """Split of the maps; of mountain-v0's ood, the first are real terrain."""


class Plan(NamedTuple):
    """What a board asks for, known before anything is trained or run.

    Attributes:
        config: of its ledger, which is refused by any other.
        versions: of what its agents depend on.
        items: the maps.
        preset: how much of everything.
    """

    config: dict[str, Any]
    versions: dict[str, str]
    items: Sequence[SuiteItem]
    preset: Preset


def plan_board(arguments: Arguments) -> Plan:
    """Return what a board asks for; ParameterError on agents, suites or splits that there are not."""
    preset = PRESETS[arguments.preset]
    for name in arguments.agents:
        agents.find_card(name)
    if len({*arguments.agents, STATIC}) <= len(arguments.agents):
        raise ParameterError(
            f"--agents {' '.join(arguments.agents)}: name each once; {STATIC} is always there"
        )
    items = load_suite(arguments.suite, arguments.split)[: preset.scenarios]
    config = {
        "sources": provenance.code_hash(),
        "preset": arguments.preset,
        **preset._asdict(),
        "suite": arguments.suite,
        "split": arguments.split,
        "maps": [item.scenario.digest[:16] for item in items],
        "agents": list(arguments.agents),
    }
    return Plan(config, provenance.versions((*arguments.agents, STATIC)), items, preset)


def enter_board(arguments: Arguments, plan: Plan) -> list[Entrant]:
    """Return the entrants of a board, trained now where they are not yet."""
    trained = arguments.out / TRAINED
    spent = prepare(trained, arguments.suite, plan.preset, (*arguments.agents, STATIC))
    return enter(arguments.agents, trained, spent, references=(STATIC,))


def board_jobs(plan: Plan, contest: Sequence[Entrant]) -> list[Job]:
    """Return every run of a board, those that can be played together next to each other."""
    return list(jobs(contest, plan.items, plan.preset.seeds, [plan.preset.budget]))


def run_board(arguments: Arguments) -> Path:
    """Run what is missing of a board, show it, and return the page."""
    plan = plan_board(arguments)
    with Ledger(arguments.out, plan.config, plan.versions, provenance.facts()) as ledger:
        contest = enter_board(arguments, plan)
        ledger.pin(provenance.file_hashes(arguments.out / TRAINED))
        todo = board_jobs(plan, contest)
        title = f"{arguments.preset} board: {len(contest)} agents, {len(plan.items)} maps"
        with progress(title, len(todo)) as advance:
            play(todo, ledger, plan.preset.fresh, advance)
        from experiments.faces import show

        return show(arguments.out, ledger, contest, plan.items, plan.preset)


if __name__ == "__main__":
    main(lambda: print(f"\npage: {run_board(tyro.cli(Arguments))}"))
