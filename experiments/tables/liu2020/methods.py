"""Methods: the rows of Tables 3 and 4, the paper's own and the controls that it lacks, and how agents are made."""

from pathlib import Path
from typing import Any, NamedTuple

import agents
from agents.graph import TransferGraph
from agents.policy import FLAGSHIP, shipped
from agents.published import read_card
from antgym.tuning.agent import Agent
from experiments.artefact_files import trained_argument
from experiments.artefacts import prepare
from experiments.presets import PRESETS

SUITE, PRESET = "mountain-v0", "quick"  # what is trained elsewhere is trained on this suite's train maps
RUNS = 10  # every figure of the paper is a mean over 10 runs
PROBES = RUNS * 6  # the five sources' sets and a random one, ten runs each
SMALLEST_POPULATION = 4


class Method(NamedTuple):
    """Who tunes the target, at what cost, and what the paper says of it.

    Attributes:
        label: how the tables call it.
        agent: its name in the catalogue.
        trials: evaluations of the target that it may spend.
        is_search: whether ``--share`` cuts its trials.
        population: of each generation; None where there are none.
        is_papers: whether the paper has it; all others are controls.
        seconds: the paper's, None where it gives none.
        length: the paper's, in mm, None where it gives none.
    """

    label: str
    agent: str
    trials: int = 0
    is_search: bool = False
    population: int | None = None
    is_papers: bool = False
    seconds: float | None = None
    length: float | None = None

    def budget(self, share: float) -> int:
        """Return the trials of its session, which has one even where none is asked for."""
        return max(1, int(self.trials * share if self.is_search else self.trials))


TRANSFER = Method(
    "transfer (14) as printed",
    "transfer_graph_paper",
    PROBES,
    is_papers=True,
    seconds=121.4153,
    length=148.6621,
)
COPY = Method("copy the best source", "copy_best_source", PROBES)
RANDOM = Method("one random set", "uniform_random", is_papers=True)
METHODS = (
    TRANSFER,
    Method("GA, 100 x 60", "ga_paper", 6_000, True, 100, True, 2.4248e4, 153.2710),
    Method("PSO, 100 x 100", "pso_paper", 10_000, True, 100, True, 7.5633e4, 152.4676),
    Method("trial and error, 1,000 sets x 10", "trial_and_error", 1_000 * RUNS, True, None, True, 3e4),
    RANDOM,
    Method("transfer, sound", "transfer_graph", PROBES),
    Method("transfer, abs(Λ̂)", "transfer_graph_abs", PROBES),
    COPY,
    Method("mean of the sources", "mean_of_sources"),
    Method("RL, the shipped policy, no trial", "rl"),
    Method("best static setting", "best_static"),
    Method("published default", "published_default"),
)


class Trained(NamedTuple):
    """Files of agents that are trained once, for all draws, and what training each file spent."""

    folder: Path
    spent: dict[str, int]

    @classmethod
    def make(cls, folder: Path) -> "Trained":
        """Make the files that are missing."""
        ready = ("graph", "path")  # fitted to every draw's own sources; and shipped
        named = [m.agent for m in METHODS if not set(ready) & set(trained_argument(m.agent, folder))]
        return cls(folder, prepare(folder, SUITE, PRESETS[PRESET], named))


def build(method: Method, graph: TransferGraph, trained: Trained, share: float) -> tuple[Agent, int]:
    """Return a method's agent, and the evaluations of other maps that it needs first."""
    files = trained_argument(method.agent, trained.folder)
    given: dict[str, Any] = dict(files)
    before = sum(trained.spent.get(path.name, 0) for path in files.values())
    if "graph" in files:
        given, before = {"graph": graph}, graph.evaluations
    if "path" in files:
        given, before = {}, read_card(shipped(FLAGSHIP)).evaluations
    if method.population:
        given["population"] = max(SMALLEST_POPULATION, int(method.population * share))
    return agents.make(method.agent, **given), before
