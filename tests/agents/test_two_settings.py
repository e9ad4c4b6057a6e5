"""On two scenarios that want different settings: who learns finds both, and it is the features that tell which."""

from copy import deepcopy
from dataclasses import replace

import pytest
from two_settings import ANTS, ITERATIONS, items, problems, rewards, share, shares

pytest.importorskip("agents")

import agents
from agents.algorithms import ALGORITHMS
from agents.experience import Experience
from antgym.tuning import Session
from antgym.tuning.features import TASK_FEATURES
from antgym.tuning.problem import TuningProblem

COPIES, SETTINGS, REPEATS = (
    8,
    128,
    4,
)  # of each scenario, and of the experience; runs of each setting on each copy
ENOUGH, SLOTS, MOST = 0.95, 64, 60_000  # share, and slots and planner runs at most of a training
_SMALL = {"policy_kwargs": {"net_arch": [64, 64]}}
_OFF = {"learning_rate": 1e-3, "learning_starts": 2048, "batch_size": 256, "gradient_steps": 8, **_SMALL}
LEARNERS = {  # all of OneShot but PPO, which tests/envs/test_learners.py trains
    "A2C": {"n_steps": 8, "learning_rate": 1e-3, "gae_lambda": 1.0, "normalize_advantage": True},
    "TRPO": {"n_steps": 8, "batch_size": 128, "gae_lambda": 1.0},
    "RecurrentPPO": {
        **{"n_steps": 8, "batch_size": 128, "n_epochs": 5, "learning_rate": 1e-3},
        "policy_kwargs": {"net_arch": [32], "lstm_hidden_size": 16},
    },
    "ARS": {"n_delta": 8, "delta_std": 0.1, "learning_rate": 0.1, "n_eval_episodes": 32},
    "SAC": {**_OFF, "gamma": 0.0},
    "TD3": _OFF,
    "DDPG": _OFF,
    "TQC": {**_OFF, "gamma": 0.0},
    "CrossQ": {**_OFF, "gamma": 0.0},
}


@pytest.fixture(scope="module")
def learnt():
    """An experience of both scenarios, several copies of each."""
    from scipy.stats import qmc

    units = qmc.Sobol(4, seed=0).random(SETTINGS)
    sessions = [
        Session(TuningProblem(item.scenario, item.rules, ANTS, ITERATIONS, seed=copy), SETTINGS * REPEATS)
        for copy in range(COPIES)
        for item in items()
    ]
    described = [feature.name for feature in TASK_FEATURES]
    return Experience.gather(sessions, units, described=described, repeats=REPEATS)


@pytest.mark.parametrize("name", ["regression", "neural_regression", "neighbours", "transfer_gp"])
def test_an_agent_that_learnt_from_both_knows_which_it_is_on_by_the_features(name, learnt):
    for library in agents.CATALOGUE[name].libraries:
        pytest.importorskip({"scikit-learn": "sklearn"}.get(library, library))
    given = {"experience": learnt}
    if name == "neural_regression":
        from agents.ensemble import Ensemble

        given = {"ensemble": Ensemble.fit(learnt, nets=2)}
    agent = agents.make(name, **given)
    assert shares_of(agent, exchanged=False).min() >= ENOUGH
    assert shares_of(agent, exchanged=True).min() < 0.5


def shares_of(agent, exchanged):
    """The share that an agent earns without a trial in the open and in the cup; on request each shown as the other."""
    tasks, means = [problem.task(0) for problem in problems()], []
    for problem, task, other in zip(problems(), tasks, tasks[::-1], strict=True):
        agent.reset(replace(task, features=other.features if exchanged else task.features), seed=0)
        means.append(rewards(problem, [agent.recommend()] * 200, 10_000).mean())
    return share(means)


@pytest.mark.slow
@pytest.mark.parametrize("algorithm", LEARNERS)
def test_every_algorithm_closes_the_way_from_chance_to_the_best_in_both_scenarios(algorithm):
    pytest.importorskip("sb3_contrib", reason="needs the extra rl")
    from agents.networks import algorithm_class
    from antgym.envs.sb3 import make_sb3_vec

    envs = make_sb3_vec("antgym/MountainOneShot-v0", SLOTS, seed=0, suite=items())
    policy = "MlpLstmPolicy" if ALGORITHMS[algorithm].recurrent else "MlpPolicy"
    settings = deepcopy(LEARNERS[algorithm])  # stable-baselines3 adds to what it is given
    model = algorithm_class(algorithm)(policy, envs, seed=0, device="cpu", **settings)

    def act(features):
        return model.predict(features, deterministic=True)[0]

    while envs.native.planner_runs < MOST and shares(act).min() < 0.97:
        model.learn(1024, reset_num_timesteps=False)
    assert shares(act, runs=1000, first=10_000).min() >= ENOUGH, "on runs that did not decide when to stop"


def test_no_algorithm_that_fits_is_left_out():
    fitting = {name for name, row in ALGORITHMS.items() if "setting" in row.actions}
    assert {*LEARNERS, "PPO"} == fitting
