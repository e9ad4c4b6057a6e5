"""Every agent of the catalogue tunes bees as it is: with three parameters or four, and features of another length."""

from importlib.util import find_spec

import numpy as np
import pytest
from discs import scattered

import agents
from agents.ensemble import Ensemble
from agents.experience import Experience
from agents.static import StaticSetting, StaticSettings
from agents.transfer import TransferGraph
from antgym.tuning import Session, tune
from antgym.tuning.features import DISC_TASK_FEATURES
from antgym.tuning.problem import TuningProblem

MODULES = {"scikit-learn": "sklearn"}
NAMES = [
    pytest.param(name, marks=pytest.mark.slow) if name == "optuna_gp" else name
    for name in agents.CATALOGUE
    if not name.startswith("rl")
]


def session(rules, world, budget):
    return Session(TuningProblem(scattered(world), rules, ants=8, iterations=20, seed=world), budget)


@pytest.fixture(scope="module", params=["wu2018", "abc_standard"])
def rules(request):
    return request.param


@pytest.fixture(scope="module")
def learnt(rules):
    """By the argument that takes it, what every kind of trained agent needs."""
    names = session(rules, 0, 1).task.space.names
    static = StaticSetting((0.4,) * len(names), 1, names)
    units = np.random.default_rng(0).random((8, len(names)))
    described = [feature.name for feature in DISC_TASK_FEATURES]
    sessions = [session(rules, world, 16) for world in range(8)]
    experience = Experience.gather(sessions, units, described=described)
    return {
        "setting": static,
        "settings": StaticSettings({rules: static}),
        "graph": TransferGraph.fit(
            [session(rules, world, 500) for world in range(3)], search=16, repeats=2, seed=0
        ),
        "experience": experience,
        "ensemble": Ensemble.fit(experience, nets=1) if find_spec("torch") else None,
    }


TRAINED = {
    "agents.static:StaticAgent": "setting",
    "agents.static:StaticByRules": "settings",
    "agents.transfer:TransferAgent": "graph",
    "agents.regression:EnsembleAgent": "ensemble",
}


@pytest.mark.parametrize("name", NAMES)
def test_an_agent_tunes_bees_unchanged(name, rules, learnt):
    card = agents.find_card(name)
    for library in card.libraries:
        pytest.importorskip(MODULES.get(library, library))
    argument = TRAINED.get(card.entry_point, "experience")
    given = {argument: learnt[argument]} if card.trained else {}
    paid = session(rules, 9, 12)
    result = tune(agents.make(name, **given), paid, seed=0)
    assert result.recommendation.shape == (len(paid.task.space),)
    assert all(len(trial.unit) == len(paid.task.space) for trial in result.trials)
