"""Whether features carry what learned agents know: they recommend from those of the map, and from another map's.

    python -m experiments.sanity regression neighbours out/policy.json --artefacts out/trained --suite open-v0

lets every agent recommend twice on each map, without a trial: shown the map, and shown another one of the same rules
and similar effort. Both settings are judged on the same fresh runs. What an agent gains on a setting that looks at the
rules alone has to be lost with the features, or it was no knowledge of maps. Stopped, the same command goes on; with
more agents, it plays those that are new.
"""

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import tyro
from numpy.typing import NDArray

import agents
from agents.policy import PolicyAgent
from agents.published import beside, stem_of
from agents.search import ZeroShot
from agents.shipped import find_policy
from antgym.console import main, parse, progress, write_whole
from antgym.errors import ParameterError
from antgym.maps.suites import SuiteItem, load_suite
from antgym.planners.planning import are_bees
from antgym.tuning.agent import Agent
from antgym.tuning.features import EFFORT_FEATURES, task_table
from antgym.tuning.ledger import Ledger
from antgym.tuning.problem import Task
from experiments import provenance
from experiments.artefact_files import TRAINED, followed_hashes, require_there, spent
from experiments.artefacts import problem
from experiments.contest import Entrant, enter, jobs, play
from experiments.rehearsal import rehearse
from experiments.statistics import cluster_interval, paired_difference
from experiments.tables.sheet import table

Floats = NDArray[np.float64]
LEARNED = ("regression", "neural_regression", "neighbours", "transfer_gp")
MISLED = ", misled"  # what the ledger adds to the name of an agent that is shown another map


@dataclass(frozen=True)
class Arguments:
    """Let agents recommend from a map's own features and from another's, and compare what that is worth."""

    agents: Annotated[tuple[str, ...], tyro.conf.Positional] = LEARNED
    """Agents of the catalogue, rl:NAME among them, and published policies of OneShot: files, or names of shipped
    ones."""
    suite: str = "open-v0"
    """Suite of the maps."""
    split: Literal["validation", "test", "ood"] = "validation"
    """Its split."""
    maps: int | None = None
    """The first so many maps, all by default; those that are alone under their rules are left out."""
    fresh: int = 16
    """Runs that judge each recommendation."""
    against: str = "best_static_by_rules"
    """The agent that knows no maps, whom the others gain on."""
    artefacts: Path = TRAINED
    """Folder of trained agents' files."""
    out: Path = Path("out/sanity")
    """Folder of the ledger and of sanity.md."""


class Misled(ZeroShot):
    """An agent that is shown other maps than those that it recommends for.

    Args:
        agent: recommends without a trial.
        shown: what it is shown, by the bytes of a task's features.
    """

    def __init__(self, agent: Agent, shown: Mapping[bytes, Task]) -> None:
        self._agent, self._shown = agent, shown

    def _choose(self, task: Task, seed: int) -> Floats:
        agent = copy(self._agent)
        agent.reset(self._shown[task.features.tobytes()], seed=seed)
        return agent.recommend()


def partners(items: Sequence[SuiteItem]) -> dict[int, int]:
    """Return another map for every map, both under the same rules and of similar effort; none where there is no other.

    Under each of the rules, maps in the order of their effort are paired off; of an odd number the last three go round.
    """
    found: dict[int, int] = {}
    for rules in dict.fromkeys(item.rules for item in items):
        alike = [i for i, item in enumerate(items) if item.rules == rules]
        alike.sort(key=lambda i: (items[i].ants * items[i].iterations, i))
        groups = [alike[first : first + 2] for first in range(0, len(alike), 2)]
        if len(groups) > 1 and len(groups[-1]) == 1:
            groups[-2:] = [groups[-2] + groups[-1]]
        for group in groups:
            if len(group) > 1:
                found.update(zip(group, group[1:] + group[:1], strict=True))
    return found


def misleading(items: Sequence[SuiteItem]) -> dict[bytes, Task]:
    """Return what is shown in the place of the task of each map that has a partner, by the bytes of its features."""
    tasks = [problem(item).task(0) for item in items]
    effort = [
        i for i, f in enumerate(task_table(are_bees([item.rules for item in items]))) if f in EFFORT_FEATURES
    ]
    return {
        tasks[i].features.tobytes(): _disguised(tasks[i], tasks[other], effort)
        for i, other in partners(items).items()
    }


def _disguised(task: Task, other: Task, effort: Sequence[int]) -> Task:
    """Return a task that looks like another, but for its own effort; its parameters are its own too."""
    features = other.features.copy()
    features[effort] = task.features[effort]
    return replace(task, features=features, map=other.map)


def compare(arguments: Arguments) -> str:
    """Play what is missing, write the table and return it."""
    if arguments.fresh < 1 or (arguments.maps is not None and arguments.maps < 2):
        raise ParameterError("--fresh must be 1 or more, --maps 2 or more")
    given = load_suite(arguments.suite, arguments.split)[: arguments.maps]
    items = [given[i] for i in sorted(partners(given))]
    if not items:
        raise ParameterError(f"--maps {arguments.maps}: no two of them have the same rules; take more")
    asked = dict.fromkeys(arguments.agents)
    names = [name for name in asked if name.partition(":")[0] in agents.CATALOGUE]
    policies = [find_policy(name, *agents.CATALOGUE) for name in asked if name not in names]
    known = [arguments.against, *names]
    require_there(known, arguments.artefacts, arguments.suite)
    rehearse(known, arguments.artefacts, items[0], 0)
    for path in policies:
        PolicyAgent(path).reset(problem(items[0]).task(0), seed=0)
    reference, *contest = _entrants(arguments, names, policies)
    config = {
        "code": provenance.code_hash(Path(__file__)),
        **{name: getattr(arguments, name) for name in ("suite", "split", "fresh")},
        "maps": [item.scenario.digest[:16] for item in items],
    }
    versions = provenance.versions([arguments.against, *names, *(["rl"] if policies else [])])
    with Ledger(arguments.out, config, versions, provenance.facts()) as ledger:
        ledger.pin(_hashes(arguments, names, policies))
        shown = misleading(items)
        misled = [_misled(entrant, shown) for entrant in contest]
        todo = list(jobs([reference, *chain(*zip(contest, misled, strict=True))], items, 1, [0]))
        title = f"asking on {len(items)} of {len(given)} maps, with features of the map, and of another"
        with progress(title, len(todo)) as advance:
            play(todo, ledger, arguments.fresh, advance)
        gaps: dict[str, list[float]] = {job.entrant.name: [] for job in todo}
        for job in todo:
            outcome = ledger.run(job.key).outcome
            assert outcome is not None
            gaps[job.entrant.name].append(float(np.mean(outcome.gaps)))
    text = to_markdown(arguments, {name: np.array(own)[:, None] for name, own in gaps.items()}, len(given))
    write_whole(arguments.out / "sanity.md", text.encode())
    return text


def _entrants(arguments: Arguments, names: Sequence[str], policies: Sequence[Path]) -> list[Entrant]:
    """Return who takes part, the one that all are compared with first."""
    known, folder = list(dict.fromkeys([arguments.against, *names])), arguments.artefacts
    found = enter(known, folder, spent(folder, known))
    for path in policies:
        agent = PolicyAgent(path)
        found.append(Entrant(stem_of(path).name, "agent", "", agent, agent.card.evaluations))
    called = [entrant.name for entrant in found]
    if len(set(called)) < len(called):
        raise ParameterError(
            f"agents need names of their own, got {', '.join(called)}; rename a policy's files"
        )
    return found


def _misled(entrant: Entrant, shown: Mapping[bytes, Task]) -> Entrant:
    return entrant._replace(name=f"{entrant.name}{MISLED}", agent=Misled(entrant.agent, shown))


def _hashes(arguments: Arguments, names: Sequence[str], policies: Sequence[Path]) -> dict[str, str]:
    cards = [beside(stem_of(path), ".json") for path in policies]  # which hold the hashes of their weights
    return {
        **followed_hashes(arguments.artefacts, (arguments.against, *names)),
        **{f"policy {card.name}": provenance.file_hash(card) for card in cards},
    }


HEADINGS = (
    *("agent", "gap %", "95 %", "another map's features", "worse by, points", "95 %"),
    *("ahead of {}", "95 %", "so misled", "95 %"),
)


def to_markdown(arguments: Arguments, gaps: Mapping[str, Floats], given: int) -> str:
    """Return the table; gaps are mean gaps of recommendations, (maps, 1), by the name of the entrant."""
    against = gaps[arguments.against]
    rows = []
    for name, own in gaps.items():
        if (misled := gaps.get(f"{name}{MISLED}")) is None:
            continue
        low, high = cluster_interval(own)
        rows.append(
            [
                f"`{name}`",
                f"{100 * own.mean():.1f}",
                f"{100 * low:.1f} to {100 * high:.1f}",
                f"{100 * misled.mean():.1f}",
                *_signed(misled, own),
                *_signed(against, own),
                *_signed(against, misled),
            ]
        )
    left = given - len(against)
    return (
        f"{arguments.suite}, {arguments.split}: {len(against)} maps, each recommendation made without a trial and "
        f"judged on {arguments.fresh} fresh runs; mean gaps in per cent, intervals over maps. `{arguments.against}`: "
        f"{100 * against.mean():.1f}."
        + (f" Of {given} maps {left} are left out, alone under their rules." if left else "")
        + f"\n\n{table([head.format(arguments.against) for head in HEADINGS], rows)}\n"
    )


def _signed(a: Floats, b: Floats) -> tuple[str, str]:
    found = paired_difference(a, b)
    return f"{100 * found.mean:+.1f}", f"{100 * found.low:+.1f} to {100 * found.high:+.1f}"


if __name__ == "__main__":
    main(lambda: print(compare(parse(Arguments, None, "python -m experiments.sanity"))))
