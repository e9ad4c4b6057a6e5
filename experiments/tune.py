"""Tune the swarm on one map of your own, with any agent of the catalogue.

    python -m experiments.tune docs/hills.asc --start 0 10 2 --goal 20 10 2 --agent optuna_tpe --budget 40

prints parameters, expected gap and seed, and writes the path as ``antgym plan`` does. Rules of bees tune on a scene of
discs: ``docs/discs.json --rules wu2018 --ants 40 --iterations 1000``. Every trial is on disk before the
next batch is asked for; a run that was stopped, or killed, goes on where it was when the same command is given again.
"""

import hashlib
import re
import sys
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import agents
import antgym
from antgym import plan_file, plan_scene
from antgym.commands import MapFile, PlanFile
from antgym.console import PATIENCE, main, parse, progress
from antgym.errors import BudgetError, LedgerError, ParameterError
from antgym.kernels import sources_hash
from antgym.maps.world import Scenario
from antgym.planners.planning import are_bees, plan_many
from antgym.tuning.agent import Agent, Result, tune
from antgym.tuning.ledger import Ledger
from antgym.tuning.problem import FRESH, TuningProblem
from experiments.artefact_files import TRAINED, file_of, require_there, trained_argument, way_to
from experiments.artefacts import derived_seed
from experiments.watching import WatchedSession

Floats = NDArray[np.float64]
PART = 8  # trials in one planner call: at most so many are lost when a run is killed
PROG = "python -m experiments.tune"


@dataclass(frozen=True)
class Arguments(MapFile):
    """Tune the swarm's parameters on a map of your own: any file that antgym plan takes.

    That is a map with --start and --goal or, under rules of bees (--rules wu2018), a scene of discs with its own.
    An agent may run the planner --budget times on the map, then says which parameters to use. They are judged on
    --fresh further runs, and the best of these is the path that is written. With --budget 0 an agent answers from what
    it has learnt elsewhere. Agents that learn from train maps need --artefacts, the folder of their files.
    """

    agent: str = "optuna_tpe"
    """Name in the catalogue of agents, rl:NAME of a policy, or path/to/file.py:ClassName of yours; an unknown name
    lists them all."""
    budget: int = 20
    """Planner runs that the agent may pay for, from 0 up."""
    artefacts: Path | None = None
    """Folder of trained agents' files: made by experiments.artefacts, or trained/ of a leaderboard."""
    ants: int = 20
    """Ants per iteration of every run, or bees; no agent can buy more. Bees fly well as 40 for 1,000 cycles."""
    iterations: int = 100
    """Iterations of every run, or cycles."""
    fresh: int = 16
    """Runs that judge the parameters afterwards, at least one; not charged to the budget."""
    seed: int = 0
    """Root of the agent's and the planner's seeds."""
    out: Path | None = None
    """Write what antgym plan writes, and the trials, OUT.trials; by default out/tune/FILE-AGENT."""
    picture: bool = True
    """Whether OUT.png is among them; it needs matplotlib."""


def run(arguments: Arguments) -> int:
    """Tune, judge, print, write; return 0, or 1 where no run with the parameters found a path."""
    if arguments.budget < 0 or arguments.fresh < 1:
        raise BudgetError(
            f"--budget {arguments.budget} must be 0 or more, --fresh {arguments.fresh} at least 1"
        )
    if arguments.picture:
        plan_file.require_matplotlib()
    agent = find_agent(arguments.agent, arguments.artefacts)
    scenario, rules = asked(arguments)
    seed = derived_seed("tune", scenario.digest, arguments.seed)
    problem = TuningProblem(scenario, rules, arguments.ants, arguments.iterations, seed)
    stem = arguments.out or default_out(arguments)
    result = search(agent, problem, arguments, stem)
    command, gaps = judge(problem, result.recommendation, arguments)
    face: Any = plan_scene if are_bees(rules) else plan_file
    found = face.find(command)
    print(summary(arguments, len(result.trials), gaps))
    print(face.report(found))
    tuning = {"agent": arguments.agent, "budget": arguments.budget, "trials": len(result.trials)}
    tuning |= {"root_seed": arguments.seed, "unit": result.recommendation.tolist(), "fresh_gaps": gaps}
    face.write(found, stem, {"tuning": tuning})
    return 0 if found.plan.solved else 1


def asked(arguments: Arguments) -> tuple[Scenario[Any, Any], str]:
    """Return the scenario that is asked for, and the name of the rules that plan it."""
    if arguments.rules is not None and are_bees(arguments.rules):
        return plan_scene.read(arguments), arguments.rules
    question = plan_file.read(arguments)
    return question.scenario, question.rules


def default_out(arguments: Arguments) -> Path:
    """Return where results go unless that is said: a place for every map and agent, whose name may be a path."""
    agent = re.sub(r"[^\w.]+", "-", Path(arguments.agent).name)
    return Path("out/tune") / f"{arguments.file.stem}-{agent}"


def find_agent(name: str, folder: Path | None) -> Agent:
    """Return an agent, with its file where it needs one; ParameterError names the command that makes it."""
    card = agents.find_card(name)
    if not card.trained:
        return agents.make(name)
    path = file_of(name, folder)
    if folder is None and path.parent == TRAINED:
        raise ParameterError(
            f"agent {name!r} needs what it learnt from train maps, and --artefacts FOLDER is missing; "
            f"{way_to(name, path)}; then give --artefacts {TRAINED}"
        )
    require_there([name], folder)
    return agents.make(name, **trained_argument(name, folder))


def search(agent: Agent, problem: TuningProblem, arguments: Arguments, stem: Path) -> Result:
    """Return what an agent recommends after its trials, and these, which a ledger beside the stem keeps."""
    seed = derived_seed("tune", arguments.agent, problem.seed)
    if arguments.budget == 0 or agents.find_card(arguments.agent).trained:
        take_on(agent, problem, arguments, seed)
    if arguments.budget == 0:
        return Result(problem.space.check(agent.recommend())[0], ())
    with _ledger(problem, arguments, stem) as ledger:
        kept = ledger.run("tune")
        title = f"{arguments.agent} on {arguments.file.name}"
        with progress(title, arguments.budget, after=PATIENCE) as advance:
            session = WatchedSession(problem, arguments.budget, advance, kept, PART)
            return tune(agent, session, seed=seed)


def take_on(agent: Agent, problem: TuningProblem, arguments: Arguments, seed: int) -> None:
    """Let an agent look at the task before anything is written: what learnt of ants cannot tune bees."""
    try:
        agent.reset(problem.task(arguments.budget), seed=seed)
    except ParameterError as error:
        if not are_bees(problem.rules):
            raise
        raise ParameterError(
            f"--agent {arguments.agent} on {arguments.file}, --rules {problem.rules}: {error}; give one that learnt "
            "under such rules, or one that learns on the map itself, as optuna_tpe"
        ) from None


def _ledger(problem: TuningProblem, arguments: Arguments, stem: Path) -> Ledger:
    folder = stem.with_name(stem.name + ".trials")
    try:
        return Ledger(folder, _config(problem, arguments), _versions(arguments.agent))
    except LedgerError as error:
        raise LedgerError(f"{error}; give another --out than {stem} for another folder") from None


def judge(problem: TuningProblem, unit: Floats, arguments: Arguments) -> tuple[PlanFile, list[float]]:
    """Run a setting on fresh seeds; return the command that plans the best of these runs again, and all gaps.

    Values are rounded to the six digits that are printed, and seeds are short, so that what is printed is what was run.
    """
    values = [float(f"{value:.6g}") for value in problem.space.decode(unit)[0]]
    seeds = problem.seeds(FRESH, 0, arguments.fresh) >> np.uint64(32)
    with progress("judging on fresh runs", arguments.fresh, after=PATIENCE) as advance:
        lengths: list[float] = []
        for first in range(0, len(seeds), PART):
            part = [int(seed) for seed in seeds[first : first + PART]]
            effort = {"ants": problem.ants, "iterations": problem.iterations}
            scenarios: list[Any] = [problem.scenario] * len(part)  # of one robot, or among discs
            settings = [values] * len(part)
            runs = plan_many(scenarios, settings, rules=problem.rules, **effort, seeds=part)
            lengths += runs.lengths.tolist()
            advance(len(part))
    best = int(seeds[int(np.argmin(lengths))])
    given: dict[str, Any] = {field.name: getattr(arguments, field.name) for field in fields(MapFile)}
    given.update(zip(problem.space.names, values, strict=True))
    given.update(ants=problem.ants, iterations=problem.iterations, seed=best, picture=arguments.picture)
    command = PlanFile(**given)
    return command, problem.gap(np.array(lengths)).tolist()


def summary(arguments: Arguments, trials: int, gaps: list[float]) -> str:
    """Return what there is to say of the setting, and of the trials it took, before its best run is shown."""
    solved = sum(gap < 1 for gap in gaps)
    spent = str(trials) if trials == arguments.budget else f"{trials} of {arguments.budget}"
    expected = (
        f"{np.mean(gaps):.2%} on average over {len(gaps)} fresh runs, {min(gaps):.2%} to {max(gaps):.2%}"
    )
    return (
        f"agent    {arguments.agent}, {spent} trials, seed {arguments.seed}\n"
        f"expected {expected}; {solved} of {len(gaps)} below twice the optimum\n"
        "below    the best of them, as antgym plan finds it with this setting"
    )


def _config(problem: TuningProblem, arguments: Arguments) -> dict[str, Any]:
    """Return what decides a trial; a folder goes on only with the same."""
    paths = [
        *trained_argument(arguments.agent, arguments.artefacts).values(),
        *agents.find_card(arguments.agent).files,
    ]
    learnt = {path.name: hashlib.sha256(path.read_bytes()).hexdigest()[:16] for path in paths}
    effort = {"rules": problem.rules, "ants": problem.ants, "iterations": problem.iterations}
    asked = {name: getattr(arguments, name) for name in ("agent", "budget", "seed")}
    return {"map": problem.scenario.digest[:16], **effort, **asked, "learnt": learnt}


def _versions(name: str) -> dict[str, str]:
    return {"antgym": antgym.__version__, "kernels": sources_hash(), **agents.versions(name)}


if __name__ == "__main__":
    main(lambda: sys.exit(run(parse(Arguments, None, PROG))))
