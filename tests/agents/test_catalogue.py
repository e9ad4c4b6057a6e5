"""The contract of every agent that needs no training, and of the transfer agents on a small graph."""

import copy

import numpy as np
import pytest

import agents
from agents.static import StaticSetting
from antgym.errors import MissingExtraError, ParameterError
from antgym.tuning import tune

REQUIRES = {
    "ga": "pymoo",
    "pso": "pymoo",
    "optuna_tpe": "optuna",
    "cma_es_warm": "cmaes",
    "regression": "sklearn",
}
LEARNT = ("portfolio", "neighbours", "regression", "cma_es_warm")
NAMES = tuple(name for name in agents.CATALOGUE if name != "rl")


@pytest.fixture(params=NAMES)
def build(request, graph, experience):
    """A function that makes a fresh agent of one catalogue entry."""
    if request.param in REQUIRES:
        pytest.importorskip(REQUIRES[request.param])
    card = agents.CATALOGUE[request.param]
    static = StaticSetting((0.2, 0.4, 0.6, 0.8), 1, graph.parameters)
    trained = {"setting": static} if card.name == "best_static" else {"graph": graph}
    trained = {"experience": experience} if card.name in LEARNT else trained
    return lambda: agents.make(card.name, **(trained if card.trained else {}))


@pytest.mark.parametrize("budget", [1, 3, 7, 100])
def test_an_agent_survives_any_budget_and_stays_in_the_cube(build, bowl, budget):
    session = bowl(budget, noise=0.1)
    result = tune(build(), session, seed=0)
    assert result.recommendation.shape == (4,)
    assert len(session.trials) <= budget
    assert all(len(batch) for batch in session.batches)


def test_an_agent_is_deterministic_given_its_seed(build, bowl):
    first, second = (tune(build(), bowl(40, noise=0.1), seed=5) for _ in range(2))
    assert first.trials == second.trials
    assert first.recommendation.tolist() == second.recommendation.tolist()


def test_reset_forgets_everything(build, bowl):
    agent = build()
    tune(agent, bowl(30, optimum=(0.9, 0.1, 0.9, 0.1), noise=0.2), seed=1)
    again = tune(agent, bowl(40, noise=0.1), seed=5)
    assert again.trials == tune(build(), bowl(40, noise=0.1), seed=5).trials


def test_agents_that_take_turns_do_not_disturb_each_other(build, bowl):
    sessions, both = [bowl(24), bowl(24)], [build(), build()]
    for agent, session, seed in zip(both, sessions, (1, 2), strict=True):
        agent.reset(session.task, seed=seed)
    for _ in range(24):
        for agent, session in zip(both, sessions, strict=True):
            if session.left and len(units := agent.ask()):
                agent.tell(session.evaluate(units))
    assert sessions[0].trials == tune(build(), bowl(24), seed=1).trials
    assert sessions[1].trials == tune(build(), bowl(24), seed=2).trials


def test_an_agent_leaves_global_random_state_alone(build, bowl):
    before = copy.deepcopy(np.random.get_state())  # noqa: NPY002
    tune(build(), bowl(20), seed=0)
    after = np.random.get_state()  # noqa: NPY002
    assert before[1].tolist() == after[1].tolist()
    assert before[2] == after[2]


def test_a_recommendation_can_be_had_at_any_time(build, bowl):
    session, agent = bowl(23, noise=0.1), build()
    agent.reset(session.task, seed=2)
    session.space.check(agent.recommend())
    while session.left and len(units := agent.ask()):
        agent.tell(session.evaluate(units))
        session.space.check(agent.recommend())


def test_a_zero_shot_task_gets_a_recommendation(build, bowl):
    session, agent = bowl(0), build()
    agent.reset(session.task, seed=2)
    assert agent.ask().shape == (0, 4)
    session.space.check(agent.recommend())


def test_an_agent_copes_where_every_trial_fails(build, bowl):
    session = bowl(30, fails=True)
    session.space.check(tune(build(), session, seed=0).recommendation)


@pytest.mark.parametrize("granted", [1, 3])
def test_an_agent_copes_with_batches_cut_short(build, bowl, granted):
    session = bowl(40, granted=granted)
    session.space.check(tune(build(), session, seed=0).recommendation)


def test_recommending_changes_nothing(build, bowl):
    session, agent = bowl(20), build()
    tune(agent, session, seed=0)
    kept = agent.recommend()
    agent.recommend()[:] = -1
    assert agent.recommend().tolist() == kept.tolist()


@pytest.mark.parametrize("name", ["random_search", "ga", "pso", "optuna_tpe"])
def test_searching_beats_the_default_on_an_easy_bowl(name, bowl):
    if name in REQUIRES:
        pytest.importorskip(REQUIRES[name])
    session = bowl(100, optimum=(0.9, 0.1, 0.2, 0.8), noise=0.02)
    found = tune(agents.make(name), session, seed=0).recommendation
    assert session.cost(found)[0] < session.cost(np.full(4, 0.5))[0]
    assert session.left == 0


def test_an_unknown_agent_names_the_nearest():
    with pytest.raises(ParameterError, match="did you mean 'optuna_tpe'"):
        agents.make("optuna")


def test_an_unknown_argument_names_the_nearest():
    with pytest.raises(ParameterError, match="did you mean 'rerun_share'"):
        agents.make("random_search", rerun=0.1)


@pytest.mark.parametrize("name", ["ga", "pso"])
def test_an_unknown_setting_names_the_nearest(name):
    with pytest.raises(ParameterError, match="did you mean 'population'"):
        agents.make(name, popullation=10)


@pytest.mark.parametrize("name", LEARNT)
def test_experience_beats_the_default_without_a_trial(name, experience, bowl):
    if name in REQUIRES:
        pytest.importorskip(REQUIRES[name])
    session = bowl(0, optimum=(0.8, 0.2, 0.3, 0.6), features=(1, 0.1))
    agent = agents.make(name, experience=experience)
    agent.reset(session.task, seed=0)
    assert session.cost(agent.recommend())[0] < session.cost(np.full(4, 0.5))[0]


@pytest.mark.parametrize(
    ("name", "argument"), [("transfer_graph", "graph"), ("rl", "path"), ("portfolio", "experience")]
)
def test_a_trained_agent_without_its_artefact_says_what_it_needs(name, argument):
    with pytest.raises(ParameterError, match=f"needs {argument}="):
        agents.make(name)


def test_versions_name_every_library_behind_an_agent():
    pytest.importorskip("optuna")
    assert set(agents.versions("optuna_tpe")) == {"numpy", "optuna"}


@pytest.mark.parametrize(
    ("name", "library"),
    [("ga", "pymoo"), ("optuna_tpe", "optuna"), ("cma_es_warm", "cmaes"), ("regression", "sklearn")],
)
def test_a_missing_library_says_how_to_mend_it(name, library, bowl, experience, monkeypatch):
    for module in [m for m in __import__("sys").modules if m == library or m.startswith(f"{library}.")]:
        monkeypatch.delitem(__import__("sys").modules, module)
    monkeypatch.setitem(__import__("sys").modules, library, None)
    learnt = {"experience": experience} if name in LEARNT else {}
    with pytest.raises(MissingExtraError, match=r"antgym\[agents\]"):
        agents.make(name, **learnt).reset(bowl(10).task, seed=0)
