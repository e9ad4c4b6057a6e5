"""Rehearsal: policies are asked once before anything is trained or run, and what cannot be played is told."""

from collections.abc import Iterable
from pathlib import Path

import agents
from antgym.envs.control import BLOCKS
from antgym.errors import ParameterError
from antgym.maps.suites import SuiteItem
from antgym.tuning.run_features import observe_run
from antgym.tuning.session import Session
from experiments import steering
from experiments.artefact_files import FLAGSHIPS, kind_of, trained_argument
from experiments.artefacts import problem


def rehearse(names: Iterable[str], folder: Path, item: SuiteItem, budget: int) -> None:
    """Ask the agents that follow a policy or a committee, as far as its file is there, for a first setting.

    Args:
        names: of agents; all others are left alone.
        folder: of their files.
        item: a map, all of whose suite have the same parameters and observations.
        budget: the smallest at which they play.

    Raises:
        ParameterError: on files of another kind, of another regime, or for another swarm; it names the agent.
    """
    for name in names:
        files = trained_argument(name, folder)
        if not files or kind_of(name) not in FLAGSHIPS or not all(path.exists() for path in files.values()):
            continue
        try:
            agent = agents.make(name, **files)
            agent.reset(problem(item).task(budget), seed=0)
            if budget:
                agent.ask()
        except ParameterError as error:
            raise ParameterError(f"agent {name!r}: {error}") from None


def rehearse_controllers(
    policies: Iterable[str], item: SuiteItem, others: Iterable[str]
) -> list[steering.Entrant]:
    """Ask policies for what they would set in the first block of a run, which is not played; return who they are.

    Args:
        policies: their files, or names of those that are shipped.
        item: a map, all of whose suite have the same parameters and observations.
        others: names of who else takes part; that of the schedule is taken even where there is none yet.

    Raises:
        ParameterError: on a file that is no policy of Control or OneShot, or one for another swarm; on a name that two
            have.
    """
    entrants = [steering.policy_entrant(name) for name in policies]
    if entrants:
        steering.require_apart([steering.SCHEDULE, *others, *(entrant.name for entrant in entrants)])
    for entrant in entrants:
        controller, session = entrant.controller, Session(problem(item), 1)
        controller.reset(session.task, seed=0)
        session.open(BLOCKS)
        assert session.opened is not None
        controller.act(observe_run(session.task, session.opened))
    return entrants
