"""Explain what an agent recommends without a trial: which features move its choice, and how effort does.

    python -m experiments.explain transfer_gp --artefacts out/trained --suite open-v0 --split test --index 0

A feature is given the values that it has on train maps, one after the other, all else left as it is on the map; what
the recommended setting then moves by is what the feature means to the agent there. No planner run is made.
"""

import io
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
import tyro
from numpy.typing import NDArray

import agents
from agents.policy import PolicyAgent
from agents.published import stem_of
from agents.shipped import find_policy
from antgym.console import main, parse, progress, write_whole
from antgym.errors import MissingExtraError, ParameterError
from antgym.maps.features import Feature
from antgym.maps.suites import SuiteItem, load_suite
from antgym.planners.batch import MOST_EFFORT
from antgym.planners.planning import are_bees
from antgym.planners.swarms import fewest
from antgym.tuning.agent import Agent
from antgym.tuning.features import EFFORT_FEATURES, is_rule, task_table
from antgym.tuning.problem import Task, TuningProblem
from experiments.tune import find_agent

Floats = NDArray[np.float64]
FACTORS = (1 / 8, 1 / 4, 1 / 2, 1, 2, 4, 8)  # of the effort
SHOWN = 12  # features in table and picture
TRIALS = 20  # with which an agent is asked whether it would try a setting


def explained(rules: str) -> tuple[Feature, ...]:
    """Return the features that are moved under some rules: a rule is no number, and effort is moved for itself."""
    table = task_table(are_bees(rules))
    return tuple(f for f in table if f not in EFFORT_FEATURES and not is_rule(f))


@dataclass(frozen=True)
class Arguments:
    """Explain what an agent recommends on maps of a suite."""

    agent: Annotated[str, tyro.conf.Positional]
    """An agent of the catalogue, rl:NAME among them, or a published policy of OneShot: its file, or the name of a
    shipped one."""
    suite: str = "open-v0"
    """Suite of the maps."""
    split: Literal["train", "validation", "test", "ood"] = "test"
    """Its split."""
    index: tuple[int, ...] = (0,)
    """Which of its maps."""
    donors: int = 16
    """Train maps whose values a feature is given."""
    artefacts: Path | None = None
    """Folder of trained agents' files."""
    out: Path = Path("out/explain")
    """Folder of a .md and a .png a map, named by agent and map."""


class Explanation(NamedTuple):
    """What moves a choice on one map.

    Attributes:
        item: the map.
        names: of the parameters, d.
        unit: (d,) the setting recommended.
        features: that were moved.
        here: (features,) values on the map.
        spans: (features, 2) 10 and 90 % quantiles of the donors' values.
        moved: (features,) mean distance in the unit cube by which the donors' values move the setting.
        trends: (features, d) mean setting under the upper half of the donors' values minus that under the lower;
            where most of them are the largest, under these minus under the others; nan where all are the same.
        tries: whether the agent would try settings if it could pay for trials, so that this is where it starts.
        efforts: of ants and of iterations: (how many, the setting's natural values, the setting), a row a factor.
    """

    item: SuiteItem
    names: tuple[str, ...]
    unit: Floats
    features: tuple[Feature, ...]
    here: Floats
    spans: Floats
    moved: Floats
    trends: Floats
    tries: bool
    efforts: dict[str, list[tuple[int, Floats, Floats]]]


def explain(
    agent: Agent, item: SuiteItem, donors: Floats, advance: Callable[[int], None] = lambda _: None
) -> Explanation:
    """Return what moves an agent's choice on a map.

    Args:
        agent: recommends without a trial.
        item: the map, its rules and its effort.
        donors: (n, features of a task) of train maps, n ≥ 2.
        advance: called with the number of features that are done.
    """
    task = _task(item)
    unit = _choice(agent, task)
    features, table = explained(item.rules), task_table(are_bees(item.rules))
    moved, trends = np.zeros(len(features)), np.zeros((len(features), len(unit)))
    columns = [table.index(feature) for feature in features]
    for row, column in enumerate(columns):
        values, choices = donors[:, column], np.tile(unit, (len(donors), 1))
        for i in np.flatnonzero(values != task.features[column]):
            changed = task.features.copy()
            changed[column] = values[i]
            choices[i] = _choice(agent, replace(task, features=changed))
        moved[row] = np.linalg.norm(choices - unit, axis=1).mean()
        trends[row] = _trend(values, choices)
        advance(1)
    here, spans = task.features[columns].astype(float), np.quantile(donors[:, columns], (0.1, 0.9), axis=0).T
    efforts = _efforts(agent, item)
    tries = _tries(agent, item)
    return Explanation(item, task.space.names, unit, features, here, spans, moved, trends, tries, efforts)


def _trend(values: Floats, choices: Floats) -> Floats:
    """Return the (d,) mean of the choices under the upper half of (n,) values minus that under the lower."""
    middle = np.median(values)
    upper = values > middle if (values > middle).any() else values >= middle
    if upper.all():
        return np.full(choices.shape[1], np.nan)
    return np.asarray(choices[upper].mean(axis=0) - choices[~upper].mean(axis=0))


def _tries(agent: Agent, item: SuiteItem) -> bool:
    agent.reset(_task(item, TRIALS), seed=0)
    return len(agent.ask()) > 0


def _efforts(agent: Agent, item: SuiteItem) -> dict[str, list[tuple[int, Floats, Floats]]]:
    """Return what an agent recommends where there are fewer ants or more, fewer iterations or more."""
    found: dict[str, list[tuple[int, Floats, Floats]]] = {}
    for name, least in (("ants", fewest(item.rules)), ("iterations", 1)):
        rows = []
        counts = [round(getattr(item, name) * factor) for factor in FACTORS]
        for count in dict.fromkeys(min(max(count, least), MOST_EFFORT) for count in counts):
            task = _task(item._replace(**{name: count}))
            unit = _choice(agent, task)
            rows.append((count, task.space.decode(unit)[0], unit))
        found[name] = rows
    return found


def _task(item: SuiteItem, budget: int = 0) -> Task:
    return TuningProblem(item.scenario, item.rules, item.ants, item.iterations).task(budget)


def _choice(agent: Agent, task: Task) -> Floats:
    agent.reset(task, seed=0)
    return np.asarray(agent.recommend(), dtype=np.float64)


def to_markdown(found: Explanation, agent: str) -> str:
    """Return the explanation as text: the setting, what moves it most, and how it goes with the effort."""
    item, names = found.item, found.names
    natural = _task(item).space.decode(found.unit)[0]
    setting = ", ".join(f"{name} = {value:.4g}" for name, value in zip(names, natural, strict=True))
    swarm, rounds = ("bees", "cycles") if are_bees(item.rules) else ("ants", "iterations")
    lines = [
        f"# {agent} on {item.name}",
        "",
        f"Rules {item.rules}, {item.ants} {swarm}, {item.iterations} {rounds}: {setting}.",
        "",
        "How far a feature moves the setting in the unit cube when it takes its values on train maps, and by how much",
        "each parameter is higher under the upper half of these values than under the lower; – where all are the same.",
        "",
        f"| feature | here | train, 10 to 90 % | moves by | {' | '.join(names)} |",
        "|:--|--:|--:|--:|" + "--:|" * len(names),
    ]
    for row in _most(found):
        low, high = found.spans[row]
        trends = " | ".join("–" if np.isnan(value) else f"{value:+.3f}" for value in found.trends[row])
        cells = f"{found.here[row]:.2f} | {low:.2f} to {high:.2f} | {found.moved[row]:.3f} | {trends}"
        lines.append(f"| {found.features[row].name} | {cells} |")
    lines += [line for remark in _remarks(found, agent) for line in ("", remark)]
    for name, rows in found.efforts.items():
        lines += ["", f"| {name} | {' | '.join(names)} |", "|--:|" + "--:|" * len(names)]
        lines += [f"| {n:,} | {' | '.join(f'{v:.4g}' for v in values)} |" for n, values, _ in rows]
    return "\n".join(lines) + "\n"


def _remarks(found: Explanation, agent: str) -> list[str]:
    """Return what must be said of an agent that looks at nothing, or that begins to choose with its first trial."""
    still = not found.moved.any()
    if not found.tries:
        return ["No feature moves it: the agent recommends the same on every map."] if still else []
    more = ": the same on every map, for no feature moves it" if still else ""
    return [f"{agent} chooses by trials; this is its answer without any, from which it starts{more}."]


def _most(found: Explanation) -> list[int]:
    return [int(row) for row in np.argsort(-found.moved, kind="stable")[:SHOWN] if found.moved[row] > 0]


def picture(found: Explanation, agent: str) -> bytes:
    """Return the same as a PNG; MissingExtraError if matplotlib is not installed."""
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise MissingExtraError("matplotlib", "viz") from None
    figure = Figure(figsize=(15, 5), layout="constrained")
    bars, *panels = figure.subplots(1, 3, width_ratios=(5, 4, 4))
    _draw_features(bars, found)
    for axis, (name, rows) in zip(panels, found.efforts.items(), strict=True):
        _draw_effort(axis, name, rows, found)
    without = ", without a trial" if found.tries else ""
    figure.suptitle(f"{agent} on {found.item.name}, rules {found.item.rules}{without}")
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=110)
    return buffer.getvalue()


def _draw_features(axis: Any, found: Explanation) -> None:
    most = _most(found)[::-1]
    if not most:  # axes around nothing would say that there is something
        axis.set_axis_off()
        axis.text(0.5, 0.5, "no feature moves it", ha="center", va="center")
        return
    axis.barh([found.features[row].name for row in most], found.moved[most], color="#4c72b0")
    axis.set_xlabel("how far it moves the setting, in the unit cube")


def _draw_effort(
    axis: Any, name: str, rows: Sequence[tuple[int, Floats, Floats]], found: Explanation
) -> None:
    counts, units = [count for count, _, _ in rows], np.stack([unit for _, _, unit in rows])
    for column, parameter in enumerate(found.names):
        axis.plot(counts, units[:, column], marker="o", label=parameter)
    axis.axvline(getattr(found.item, name), color="grey", linewidth=1, linestyle=":")
    axis.set_xscale("log")
    axis.set_ylim(-0.02, 1.02)
    axis.set_xlabel(name)
    axis.set_ylabel("setting, over its range")
    axis.legend()


def _find(arguments: Arguments) -> tuple[Agent, str]:
    """Return the agent or the policy that is asked for, and its name."""
    if arguments.agent.partition(":")[0] in agents.CATALOGUE:
        return find_agent(arguments.agent, arguments.artefacts), arguments.agent
    policy = PolicyAgent(find_policy(arguments.agent, *agents.CATALOGUE))
    return policy, stem_of(policy.path).name


def run(arguments: Arguments) -> list[Path]:
    """Explain every map that is asked for; return the texts' files."""
    if arguments.donors < 2:
        raise ParameterError(f"--donors {arguments.donors}: needs at least two train maps")
    agent, name = _find(arguments)
    items = load_suite(arguments.suite, arguments.split)
    for index in arguments.index:
        if not 0 <= index < len(items):
            raise ParameterError(f"--index {index}: this split holds 0 to {len(items) - 1}")
    train = load_suite(arguments.suite, "train")[: arguments.donors]
    moved = len(explained(train[0].rules))
    with progress(f"explaining {name}", len(arguments.index) * moved) as advance:
        donors = np.stack([_task(item).features for item in train]).astype(np.float64)
        found = [explain(agent, items[index], donors, advance) for index in arguments.index]
    files = []
    for one in found:
        text = to_markdown(one, name)
        file = arguments.out / f"{name.replace(':', '-')}-{one.item.name.replace('/', '-')}.md"
        write_whole(file, text.encode())
        write_whole(file.with_suffix(".png"), picture(one, name))
        files.append(file)
        print(text)
    return files


def script() -> None:
    """Run the command line."""
    for file in run(parse(Arguments, None, "python -m experiments.explain")):
        print(f"{file} and its .png are written")


if __name__ == "__main__":
    main(script, interrupted="interrupted; nothing was written")
