"""Efforts that are quick to plan with and that an environment takes."""

from gymnasium.envs.registration import load_env_creator

from antgym.envs.catalogue import CATALOGUE
from antgym.maps.recipes import SUITES
from antgym.planners.planning import are_bees


def flown_by_bees(entry):
    """Whether the scenarios of a catalogue's entry are planned by bees."""
    return are_bees(SUITES[entry.kwargs["suite"]].rules)


def small(entry, ants=3, iterations=5):
    """A few ants and iterations, as many as the regime takes; of bees so many that some arrive."""
    if flown_by_bees(entry):
        ants, iterations = 20, 200
    return [ants, max(iterations, load_env_creator(entry.entry_point).least_iterations)]


BUDGET = 3


def quick(entry, **effort):
    """Arguments of an environment whose episodes take little: a small effort, and few trials where they are paid."""
    return {"effort": small(entry, **effort), **({"budget": BUDGET} if entry.regime == "Trials" else {})}


def some_steps(entry):
    """Steps that end an episode which was made quick, and go on."""
    return {"OneShot": 1, "Trials": BUDGET, "Control": 10}[entry.regime] + 2


ENTRIES = {entry.id: entry for entry in CATALOGUE}
