"""The leaderboard: every agent tunes the swarm on maps it has not seen, its recommendations are judged on fresh runs.

    python -m experiments.leaderboard --preset quick --out out/board

The maps are real terrain unless another suite is asked for; ``--suite tabu-bee-v0 --split test`` is that of the bees.
The ledger in the folder is the result: the table and the page are computed from it. A run that was stopped, or
killed, goes on where it was when the same command is given again.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import tyro

import agents
from agents.stranger import CALL_SECONDS
from antgym.console import main, progress
from antgym.errors import ParameterError
from antgym.maps.suites import load_suite
from antgym.tuning.ledger import Ledger
from experiments import provenance
from experiments.artefacts import prepare
from experiments.contest import enter, foreign_files, jobs, play
from experiments.presets import PRESETS

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


@dataclass(frozen=True)
class Arguments:
    """Run the leaderboard, by default on real terrain, or go on with one that was stopped."""

    preset: Literal["smoke", "quick", "full"] = "quick"
    """smoke: half a minute, for tests; quick: minutes, the published table; full: hours."""
    out: Path = Path("out/leaderboard")
    """Folder of the ledger, of the trained agents and of index.html."""
    agents: tuple[str, ...] = AGENTS
    """Names in the catalogue of agents; path/to/file.py:ClassName is one of yours, a folder a submission."""
    call_seconds: float = CALL_SECONDS
    """Seconds that an agent of yours may take for one call; then that run has failed, and the board goes on."""
    suite: str = "mountain-v0"
    """Suite of the maps; trained agents learn from its train split."""
    split: str = "ood"
    """Split of the maps; of mountain-v0's ood, the first are real terrain."""


def run_board(arguments: Arguments) -> Path:
    """Run what is missing of a board, show it, and return the page."""
    preset = PRESETS[arguments.preset]
    for name in arguments.agents:
        agents.find_card(name)
    if len({*arguments.agents, STATIC}) <= len(arguments.agents):
        raise ParameterError(
            f"--agents {' '.join(arguments.agents)}: name each once; {STATIC} is always there"
        )
    suite = load_suite(arguments.suite, arguments.split)
    items = suite[: preset.scenarios]
    config = {
        "sources": provenance.code_hash(),
        "preset": arguments.preset,
        **preset._asdict(),
        "suite": arguments.suite,
        "split": arguments.split,
        "maps": [item.scenario.digest[:16] for item in items],
        "agents": list(arguments.agents),
    }
    versions = provenance.versions((*arguments.agents, STATIC))
    with Ledger(arguments.out, config, versions, provenance.facts()) as ledger:
        trained = arguments.out / "trained"
        spent = prepare(trained, arguments.suite, preset, (*arguments.agents, STATIC))
        ledger.pin({**provenance.file_hashes(trained), **foreign_files(arguments.agents)})
        contest = enter(arguments.agents, trained, spent, (STATIC,), arguments.call_seconds)
        todo = list(jobs(contest, items, preset.seeds, [preset.budget]))
        with progress(
            f"{arguments.preset} board: {len(contest)} agents, {len(items)} maps", len(todo)
        ) as advance:
            play(todo, ledger, preset.fresh, advance)
        from experiments.faces import show

        return show(arguments.out, ledger, contest, items, preset)


if __name__ == "__main__":
    main(lambda: print(f"\npage: {run_board(tyro.cli(Arguments))}"))
