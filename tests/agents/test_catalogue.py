"""The contract of every agent that needs no training, and of the transfer agents on a small graph."""

import copy
import sys
from pathlib import Path

import numpy as np
import pytest

import agents
from agents.static import StaticSetting, StaticSettings
from antgym.errors import MissingExtraError, ParameterError
from antgym.maps.world import GridWorld, Scenario
from antgym.tuning import COST_CAP, Session, tune, tune_together
from antgym.tuning.problem import TuningProblem

MODULES = {"scikit-learn": "sklearn"}
SLOW = ("optuna_gp",)
NAMES = [
    pytest.param(name, marks=pytest.mark.slow) if name in SLOW else name
    for name in agents.CATALOGUE
    if not name.startswith("rl")
]
LEARNT = ("portfolio", "neighbours", "regression", "cma_es_warm", "transfer_gp")
SEARCHING = [f"agents.{module}" for module in ("bayesian", "controls", "covariance", "evolutionary")]
SEARCHERS = [
    name
    for name, card in agents.CATALOGUE.items()
    if card.entry_point.split(":")[0] in SEARCHING and "no trial" not in card.summary
]
README = Path(__file__).parents[2] / "README.md"


def require(name):
    """Skip where a library behind an agent is absent."""
    for library in agents.CATALOGUE[name].libraries:
        pytest.importorskip(MODULES.get(library, library))


@pytest.fixture(params=NAMES)
def build(request, graph, experience, ensemble):
    """A function that makes a fresh agent of one catalogue entry."""
    card = agents.CATALOGUE[request.param]
    require(card.name)
    static = StaticSetting((0.2, 0.4, 0.6, 0.8), 1, graph.parameters)
    trained = {
        "agents.static:StaticAgent": {"setting": static},
        "agents.static:StaticByRules": {"settings": StaticSettings({"liu2020": static})},
        "agents.transfer:TransferAgent": {"graph": graph},
        "agents.regression:EnsembleAgent": {"ensemble": ensemble},
    }
    learnt = {"experience": experience} if card.name in LEARNT else {}
    return lambda: agents.make(card.name, **learnt, **trained.get(card.entry_point, {}))


@pytest.fixture
def walled_in():
    """No path: the layer in the middle is blocked."""
    free = np.ones((5, 3, 3), bool)
    free[2] = False
    return Scenario(GridWorld(free), (0, 1, 1), (4, 1, 1))


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


@pytest.mark.parametrize("how", ["apart", "copies"])
def test_agents_that_take_turns_do_not_disturb_each_other(build, bowl, how):
    """Copies share what training left, and nothing that a task brings."""
    agent = build()
    both = [copy.copy(agent), copy.copy(agent)] if how == "copies" else [agent, build()]
    sessions = [bowl(24), bowl(24)]
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


@pytest.mark.parametrize("population", [8, 50])
@pytest.mark.parametrize("name", ["ga", "pso", "de", "cma_es"])
def test_a_population_larger_than_the_budget_is_cut_to_it(name, population, bowl):
    require(name)
    session = bowl(7, noise=0.1)
    result = tune(agents.make(name, population=population), session, seed=0)
    assert [len(batch) for batch in session.batches] == [6, 1]
    session.space.check(result.recommendation)


def test_agents_in_lock_step_do_what_they_do_alone(build, valley):
    runs = [(build(), Session(TuningProblem(valley, ants=2, iterations=2, seed=i), 12), i) for i in range(2)]
    for result, (_, session, seed) in zip(tune_together(runs), runs, strict=True):
        alone = tune(build(), Session(session.problem, 12), seed=seed)
        assert result.trials == alone.trials
        assert result.recommendation.tolist() == alone.recommendation.tolist()


def test_an_agent_copes_where_no_run_of_the_planner_finds_a_path(build, walled_in):
    session = Session(TuningProblem(walled_in, ants=1, iterations=1), 12)
    session.problem.space.check(tune(build(), session, seed=0).recommendation)
    assert {trial.cost for trial in session.trials} <= {COST_CAP}


@pytest.mark.parametrize("name", [name for name in SEARCHERS if name not in SLOW])
def test_searching_beats_the_default_on_an_easy_bowl(name, bowl):
    require(name)
    session = bowl(100, optimum=(0.9, 0.1, 0.2, 0.8), noise=0.02)
    found = tune(agents.make(name), session, seed=0).recommendation
    assert session.cost(found)[0] < session.cost(np.full(4, 0.5))[0]
    assert session.left == 0


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        ("optuna_tp", "optuna_tpe"),
        ("best_static_by_rule", "best_static_by_rules"),
        ("pso_papr", "pso_paper"),
        ("cma_es_warn", "cma_es_warm"),
        ("cma_es_of_mine", "cma_es"),
    ],
)
def test_an_unknown_agent_names_the_nearest(name, meant):
    with pytest.raises(ParameterError, match=f"did you mean '{meant}'"):
        agents.make(name)


def test_a_trained_agent_may_have_a_file_of_its_own_name():
    assert agents.find_card("rl:seed-3") == agents.find_card("rl")._replace(name="rl:seed-3")


@pytest.mark.parametrize("name", ["rl:", "ga:x", "r:x"])
def test_others_have_none(name):
    with pytest.raises(ParameterError, match=f"unknown agent '{name}'"):
        agents.find_card(name)


def test_an_unknown_argument_names_the_nearest():
    with pytest.raises(ParameterError, match="did you mean 'rerun_share'"):
        agents.make("random_search", rerun=0.1)


@pytest.mark.parametrize("name", ["ga", "pso", "de", "cma_es"])
def test_an_unknown_setting_names_the_nearest(name):
    require(name)
    with pytest.raises(ParameterError, match="did you mean 'population'"):
        agents.make(name, popullation=10)


@pytest.mark.parametrize("name", [*LEARNT, "neural_regression"])
def test_experience_beats_the_default_without_a_trial(name, experience, ensemble, bowl):
    require(name)
    session = bowl(0, optimum=(0.8, 0.2, 0.3, 0.6), features=(1, 0.1))
    learnt = {"ensemble": ensemble} if name == "neural_regression" else {"experience": experience}
    agent = agents.make(name, **learnt)
    agent.reset(session.task, seed=0)
    assert session.cost(agent.recommend())[0] < session.cost(np.full(4, 0.5))[0]


@pytest.mark.parametrize(
    ("name", "argument"),
    [
        ("transfer_graph", "graph"),
        ("portfolio", "experience"),
        ("neural_regression", "ensemble"),
        ("best_static_by_rules", "settings"),
    ],
)
def test_a_trained_agent_without_its_artefact_says_what_it_needs(name, argument):
    with pytest.raises(ParameterError, match=f"needs {argument}="):
        agents.make(name)


def test_a_policy_without_safetensors_says_how_to_mend_it(tmp_path, monkeypatch):
    pytest.importorskip("sb3_contrib")
    pytest.importorskip("safetensors")
    from blank_models import blank_model

    from agents.networks import export

    export(blank_model(), tmp_path / "p")
    monkeypatch.setitem(sys.modules, "safetensors.torch", None)
    with pytest.raises(MissingExtraError, match=r"safetensors is not .*antgym\[rl\]"):
        agents.make("rl", path=tmp_path / "p")


def test_versions_name_every_library_behind_an_agent():
    require("optuna_cma")
    assert set(agents.versions("optuna_cma")) == {"numpy", "optuna", "cmaes"}


@pytest.mark.parametrize(
    ("name", "library", "extra"),
    [
        ("ga", "pymoo", "agents"),
        ("cma_es", "cmaes", "agents"),
        ("optuna_tpe", "optuna", "agents"),
        ("optuna_cma", "cmaes", "agents"),
        ("optuna_gp", "torch", "gp"),
        ("optuna_gp", "greenlet", "gp"),
        ("cma_es_warm", "cmaes", "agents"),
        ("regression", "scikit-learn", "agents"),
    ],
)
def test_a_missing_library_says_how_to_mend_it(name, library, extra, experience, monkeypatch):
    learnt = {"experience": experience} if name in LEARNT else {}
    module = MODULES.get(library, library)
    for before in agents.CATALOGUE[name].libraries[: agents.CATALOGUE[name].libraries.index(library)]:
        pytest.importorskip(before)
    for loaded in [m for m in sys.modules if m == module or m.startswith(f"{module}.")]:
        monkeypatch.delitem(sys.modules, loaded)
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(MissingExtraError, match=rf"{library} is not .*antgym\[{extra}\]"):
        agents.make(name, **learnt)


def test_the_readme_shows_the_agents_as_they_are():
    """If not: put what ``python -c "import agents; print(agents.to_markdown())"`` prints between the marks."""
    shown = README.read_text(encoding="utf-8").partition("<!-- agents:begin -->\n")[2]
    assert shown.partition("\n<!-- agents:end -->")[0] == agents.to_markdown()


def test_a_card_holds_every_argument_that_makes_an_agent_another():
    told = [(card.entry_point, sorted(card.kwargs.items(), key=str)) for card in agents.CATALOGUE.values()]
    assert all(told.count(pair) == 1 for pair in told)
