"""The leaderboard: every agent tunes the colony on real terrain, its recommendations are judged on fresh runs.

    python -m experiments.leaderboard --preset quick --out out/board

The ledger in the folder is the result: the table and the page are computed from it. A run that was stopped, or
killed, goes on where it was when the same command is given again.
"""

import platform
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any, Literal, NamedTuple

import tyro

import agents
import antgym
from antgym.console import main, progress
from antgym.errors import LedgerError, ParameterError
from antgym.kernels import sources_hash
from antgym.maps.suites import SuiteItem, load_suite
from antgym.tuning.agent import Agent, tune
from antgym.tuning.ledger import Ledger, LedgerRun, Outcome
from antgym.tuning.session import Session
from experiments.artefacts import derived_seed, prepare, problem, trained_argument
from experiments.presets import PRESETS, Preset
from experiments.provenance import code_hash, facts, file_hash

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
    "cma_es_warm",
    "rl",
)
STATIC = "best_static"
SUITE, SPLIT = "mountain-v0", "ood"


@dataclass(frozen=True)
class Arguments:
    """Run the leaderboard on real terrain, or go on with one that was stopped."""

    preset: Literal["smoke", "quick", "full"] = "quick"
    """smoke: half a minute, for tests; quick: minutes, the published table; full: hours."""
    out: Path = Path("out/leaderboard")
    """Folder of the ledger, of the trained agents and of index.html."""
    agents: tuple[str, ...] = AGENTS
    """Names in the catalogue of agents."""


class Entrant(NamedTuple):
    """An agent in the contest, and what its training spent."""

    name: str
    kind: Literal["agent", "reference"]
    summary: str
    agent: Agent
    training: int


class Job(NamedTuple):
    """One entrant on one map with one tuner seed."""

    entrant: Entrant
    item: SuiteItem
    seed: int

    @property
    def key(self) -> str:
        """How the ledger calls this run."""
        return f"{self.entrant.name}/{self.item.name}/{self.seed}"


class Stopwatch:
    """An agent, and the seconds spent inside it."""

    def __init__(self, agent: Agent) -> None:
        self._agent = agent
        self.seconds = 0.0

    def _timed(self, name: str, *args: Any, **kwargs: Any) -> Any:
        begun = time.perf_counter()
        try:
            return getattr(self._agent, name)(*args, **kwargs)
        finally:
            self.seconds += time.perf_counter() - begun

    def reset(self, task: Any, *, seed: int) -> None:
        """Pass on."""
        self._timed("reset", task, seed=seed)

    def ask(self) -> Any:
        """Pass on."""
        return self._timed("ask")

    def tell(self, trials: Any) -> None:
        """Pass on."""
        self._timed("tell", trials)

    def recommend(self) -> Any:
        """Pass on."""
        return self._timed("recommend")


def entrants(names: Sequence[str], folder: Path, spent: dict[str, int]) -> list[Entrant]:
    """Return the agents of a board and its one reference that is an agent, the best static setting."""
    out = []
    for name in (*names, STATIC):
        card = agents.find_card(name)
        argument = trained_argument(name, folder)
        training = sum(spent[path.name] for path in argument.values())
        kind: Literal["agent", "reference"] = "reference" if name == STATIC else "agent"
        out.append(Entrant(name, kind, card.summary, agents.make(name, **argument), training))
    return out


def play(job: Job, run: LedgerRun, preset: Preset) -> None:
    """Let one entrant tune one map, then judge its recommendation on fresh, uncharged runs."""
    task = problem(job.item, "board", job.seed)
    watch = Stopwatch(job.entrant.agent)
    begun = time.perf_counter()
    seed = derived_seed(job.entrant.name, job.item.scenario.digest, job.seed)
    unit, trials = tune(watch, Session(task, preset.budget, run), seed=seed)
    if len(trials) < len(run.records):
        raise LedgerError(
            f"{job.key}: the ledger holds {len(run.records)} trials, now it stops at {len(trials)}"
        )
    tuned = time.perf_counter()
    fresh = task.fresh(unit, preset.fresh)
    seconds = {"tuner": watch.seconds, "planner": tuned - begun - watch.seconds}
    gaps = task.gap(fresh.lengths)
    run.finish(Outcome(tuple(unit.tolist()), tuple(fresh.lengths.tolist()), tuple(gaps.tolist())))
    run.time(**seconds, judging=time.perf_counter() - tuned)


def jobs(contest: Sequence[Entrant], items: Sequence[SuiteItem], seeds: int) -> Iterator[Job]:
    """Return every run of a board, map by map so that an early look shows all agents."""
    for item in items:
        for seed in range(seeds):
            for entrant in contest:
                yield Job(entrant, item, seed)


def run_board(arguments: Arguments) -> Path:
    """Run what is missing of a board, show it, and return the page."""
    preset = PRESETS[arguments.preset]
    for name in arguments.agents:
        agents.find_card(name)
    if len({*arguments.agents, STATIC}) <= len(arguments.agents):
        raise ParameterError(
            f"--agents {' '.join(arguments.agents)}: name each once; {STATIC} is always there"
        )
    suite = load_suite(SUITE, SPLIT)
    items = suite[: preset.scenarios]
    config = {
        "sources": code_hash(),
        "preset": arguments.preset,
        **preset._asdict(),
        "suite": SUITE,
        "split": SPLIT,
        "maps": [item.scenario.digest[:16] for item in items],
        "agents": list(arguments.agents),
    }
    with Ledger(arguments.out, config, _versions(arguments.agents), facts()) as ledger:
        trained = arguments.out / "trained"
        spent = prepare(trained, SUITE, preset, (*arguments.agents, STATIC))
        ledger.pin({path.name: file_hash(path) for path in sorted(trained.iterdir())})
        contest = entrants(arguments.agents, trained, spent)
        todo = [job for job in jobs(contest, items, preset.seeds) if ledger.run(job.key).outcome is None]
        with progress(
            f"{arguments.preset} board: {len(contest)} agents, {len(items)} maps", len(todo)
        ) as advance:
            for job in todo:
                play(job, ledger.run(job.key), preset)
                advance(1)
        from experiments.faces import show

        return show(arguments.out, ledger, contest, items, preset)


def _versions(names: Sequence[str]) -> dict[str, str]:
    found = {"antgym": antgym.__version__, "kernels": sources_hash(), "python": platform.python_version()}
    found.update({name: version(name) for name in ("gymnasium", "matplotlib", "numba", "scipy")})
    for name in names:
        found.update(agents.versions(name))
    return found


if __name__ == "__main__":
    main(lambda: print(f"\npage: {run_board(tyro.cli(Arguments))}"))
