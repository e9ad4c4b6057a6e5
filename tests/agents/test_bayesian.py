"""The samplers are Optuna's: through our protocol they propose what an Optuna study does; and so does the race."""

import numpy as np
import pytest

from agents.bayesian import OptunaRace, OptunaSearch, fit_batch
from agents.search import narrow_seed
from antgym.errors import ParameterError
from antgym.tuning import COST_CAP, Trial, tune

optuna = pytest.importorskip("optuna")
pytest.importorskip("cmaes")

SPACE = {f"x{i}": optuna.distributions.FloatDistribution(0.0, 1.0) for i in range(4)}
CASES = [
    ("TPESampler", {}, [1] * 30),
    ("TPESampler", {}, [6] * 5),
    ("TPESampler", {"multivariate": False, "constant_liar": False}, [6] * 5),
    ("CmaEsSampler", {}, [1, *[8] * 4, 1]),
    ("CmaEsSampler", {"popsize": 5}, [1, *[5] * 5]),
    ("QMCSampler", {"scramble": True}, [6] * 5),
]


@pytest.fixture
def quiet():
    """Optuna says nothing; its verbosity is back afterwards."""
    verbosity = optuna.logging.get_verbosity()
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    yield
    optuna.logging.set_verbosity(verbosity)


def _own(session, sampler, batches):
    """Optuna's own ask and tell, in batches."""
    study, rows = optuna.create_study(sampler=sampler), []
    for batch in batches:
        asked = [study.ask(SPACE) for _ in range(batch)]
        units = np.array([list(trial.params.values()) for trial in asked])
        for trial, cost in zip(asked, session.cost(units), strict=True):
            study.tell(trial, cost)
        rows.extend(units.tolist())
    return rows


def _sampler(name, arguments, seed):
    return getattr(optuna.samplers, name)(seed=narrow_seed(seed), **arguments)


@pytest.mark.filterwarnings("ignore::optuna.exceptions.ExperimentalWarning")
@pytest.mark.parametrize(("name", "arguments", "batches"), CASES)
def test_an_agent_proposes_what_a_study_proposes(name, arguments, batches, bowl, quiet):
    session, batch = bowl(sum(batches)), None if name == "CmaEsSampler" else batches[0]
    tune(OptunaSearch(name, batch, rerun_share=0.0, **arguments), session, seed=4)
    assert [len(units) for units in session.batches] == batches
    assert np.concatenate(session.batches).tolist() == _own(session, _sampler(name, arguments, 4), batches)


@pytest.mark.slow
def test_a_gaussian_process_proposes_what_a_study_proposes(bowl, quiet):
    for library in ("torch", "greenlet"):
        pytest.importorskip(library)
    session = bowl(10, optimum=(0.5,) * 4)  # no cost above twice the lowest, which would be capped
    tune(OptunaSearch("GPSampler", 2, rerun_share=0.0, n_startup_trials=4), session, seed=4)
    own = _own(session, _sampler("GPSampler", {"n_startup_trials": 4}, 4), [2] * 5)
    assert np.concatenate(session.batches).tolist() == own


def test_a_gaussian_process_is_told_no_cost_above_twice_the_lowest(bowl):
    for library in ("torch", "greenlet"):
        pytest.importorskip(library)
    session, agent = bowl(6), OptunaSearch("GPSampler", 3, rerun_share=0.0)
    agent.reset(session.task, seed=0)
    trials = session.evaluate(agent.ask())
    agent.tell([trial._replace(cost=cost) for trial, cost in zip(trials, (1.5, COST_CAP, 2.0), strict=True)])
    assert [trial.value for trial in agent._study.trials] == [1.5, 3.0, 2.0]


def test_optunas_verbosity_is_what_it_was(bowl):
    verbosity = optuna.logging.get_verbosity()
    tune(OptunaRace(), bowl(20), seed=0)
    assert optuna.logging.get_verbosity() == verbosity


@pytest.mark.parametrize("name", ["TPESampler", "CmaEsSampler", "QMCSampler"])
def test_no_note_of_optuna_reaches_the_terminal(name, bowl, capfd):
    tune(OptunaSearch(name), bowl(12), seed=0)
    assert capfd.readouterr() == ("", "")


def test_seeds_of_any_size_are_taken(bowl):
    session = bowl(5)
    tune(OptunaSearch(), session, seed=2**63)
    assert len(session.trials) == 5


@pytest.mark.parametrize(("trials", "batch"), [(1, 1), (16, 1), (80, 8), (5000, 10)])
def test_the_batch_fits_the_budget(trials, batch):
    assert fit_batch(trials) == batch


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"batch": 0}, "batch = 0"),
        ({"sampler": "GPsampler"}, "did you mean 'GPSampler'"),
        ({"multivariat": True}, "did you mean 'multivariate'"),
        ({"seed": 3}, "no argument 'seed'"),
    ],
)
def test_settings_that_make_no_sense_are_refused(changes, message):
    with pytest.raises(ParameterError, match=message):
        OptunaSearch(**changes)


@pytest.mark.parametrize("changes", [{"repeats": 1}, {"p_threshold": 1.5}])
def test_races_that_make_no_sense_are_refused(changes):
    with pytest.raises(ParameterError, match=next(iter(changes))):
        OptunaRace(**changes)


def _race(session, **settings):
    """Race and return the trials of the study."""
    agent = OptunaRace(rerun_share=0.0, **settings)
    tune(agent, session, seed=1)
    return agent._study.trials


@pytest.mark.parametrize("granted", [None, 3])
def test_the_best_of_the_first_settings_of_a_race_gets_all_its_runs(granted, bowl):
    session = bowl(40, noise=0.1, granted=granted)
    _race(session, repeats=4, batch=3)
    firsts, champion = session.trials[:10], session.trials[10:13]
    assert len({trial.unit for trial in firsts}) == 10
    assert {trial.unit for trial in champion} == {min(firsts, key=lambda trial: trial.cost).unit}


@pytest.mark.parametrize(("budget", "firsts", "runs"), [(3, 1, 2), (16, 8, 2), (40, 10, 5), (100, 10, 6)])
def test_a_race_fits_its_runs_to_the_budget(budget, firsts, runs, bowl):
    session = bowl(budget)
    _race(session)
    assert len(session.batches[0]) == firsts
    assert len(session.batches[1]) == runs - 1


@pytest.mark.parametrize("granted", [None, 1, 2])
def test_a_race_learns_the_mean_of_every_settings_runs(granted, bowl):
    session = bowl(60, noise=0.1, granted=granted)
    trials = _race(session, repeats=4, batch=3)
    runs = {}
    for trial in session.trials:
        runs.setdefault(trial.unit, []).append(trial.cost)
    assert max(map(len, runs.values())) == 4
    over = [trial for trial in trials if trial.state == optuna.trial.TrialState.COMPLETE]
    assert len(over) > 10
    for trial in over:
        assert trial.value == pytest.approx(np.mean(runs[tuple(trial.params.values())]))


def test_a_race_repeats_good_settings_and_stops_bad_ones(bowl):
    session = bowl(200, noise=0.05)
    trials = _race(session, batch=2)
    counts = {len(trial.intermediate_values): [] for trial in trials}
    for trial in trials:
        counts[len(trial.intermediate_values)].append(session.cost(list(trial.params.values()))[0])
    assert set(counts) >= {1, 6}
    assert np.mean(counts[6]) < np.mean(counts[1])
    assert len(counts[1]) > len(counts[6])


def test_the_pruner_stops_what_is_worse_run_by_run(bowl):
    agent = OptunaRace(repeats=6, batch=1, rerun_share=0.0)
    agent.reset(bowl(100).task, seed=0)
    firsts, champion = [1.1, *[1.9] * 9], [1.3, 1.2, 1.15, 1.25, 1.2]
    told = []
    for costs in (firsts, champion, [1.29], [1.31], [1.28], [1.9]):
        units = agent.ask()
        assert len(units) == len(costs)
        told.append(units[0].tolist())
        agent.tell([Trial(0, tuple(u), cost, 1) for u, cost in zip(units.tolist(), costs, strict=True)])
    first, champion, *challengers, next_one = told
    assert first == champion not in challengers
    assert challengers == challengers[:1] * 3  # 1.29, 1.31, 1.28 against 1.1, 1.3, 1.2
    assert next_one not in (champion, challengers[0])
