"""The transfer of a Gaussian process: against textbook conditioning, brute force, and two groups of maps."""

import numpy as np
import pytest

from agents import multitask
from agents.belief import Belief
from agents.experience import Experience
from agents.multitask import MapKernel, MultitaskModel, Prediction
from agents.transfer_gp import TransferGP
from antgym.errors import ParameterError
from antgym.tuning import COST_CAP, tune
from antgym.tuning.features import TASK_FEATURES

OPTIMA = {0.0: (0.3, 0.7, 0.6, 0.4), 1.0: (0.8, 0.2, 0.3, 0.6)}  # of the experience's two groups
KERNEL = MapKernel(np.log([0.5, 1.5]), 0.3, -0.2, -1.0, -1.5, -0.7)


@pytest.fixture(scope="module")
def mixed(bowl):
    """Twenty maps, every other one under other rules, whose optimum lies elsewhere."""
    sessions = [
        bowl(64, optimum=OPTIMA[i % 2], noise=0.02, features=(i / 20,), rules=rules)
        for i, rules in enumerate(("liu2020", "max_min") * 10)
    ]
    units = np.random.default_rng(0).random((32, 4))
    return Experience.gather(sessions, units, described=[feature.name for feature in TASK_FEATURES])


@pytest.fixture
def prior():
    """Six candidates that are alike where their numbers are near."""
    numbers = np.arange(7.0)
    covariance = 0.04 * np.exp(-((numbers[:, None] - numbers) ** 2) / 4)
    covariance[-1, :-1] = covariance[:-1, -1] = -0.005
    return Prediction(np.array([0.3, 0.2, 0.25, 0.1, 0.4, 0.3, 0.0]), covariance, np.full(6, 0.01))


def test_the_gradient_of_the_fit_is_that_of_its_loss():
    rng = np.random.default_rng(0)
    maps, values = rng.normal(size=(12, 3)), rng.normal(size=(12, 5))
    rules = rng.integers(2, size=12)
    same = (rules[:, None] == rules).astype(float)
    flat = rng.normal(size=8) / 2
    _, gradient = multitask._loss(flat, values, maps, same)
    for i, step in enumerate(1e-6 * np.eye(8)):
        up, down = (multitask._loss(flat + sign * step, values, maps, same)[0] for sign in (1, -1))
        assert gradient[i] == pytest.approx((up - down) / 2e-6, rel=1e-4, abs=1e-5)


def test_the_kernel_is_one_of_covariances():
    rng = np.random.default_rng(1)
    maps, rules = rng.normal(size=(30, 2)), rng.integers(3, size=30)
    found = KERNEL(maps, maps, (rules[:, None] == rules).astype(float))
    assert found == pytest.approx(found.T)
    assert np.linalg.eigvalsh(found).min() > -1e-9
    assert np.diag(found) == pytest.approx(np.exp(KERNEL[2:5]).sum())


def test_a_prediction_is_the_conditional_of_the_whole_process(experience, bowl):
    """Likeness of maps x likeness of settings, written out in full and conditioned on every cell of the table."""
    model, task = MultitaskModel(experience), bowl(0, features=(1.0, 0.07)).task
    units = experience.settings[:3]
    found = model.predict(task, units)
    table = model._shown() @ model._spread(units)
    between = model._between(units)
    here = experience.standardise(task.features.astype(float))[None, model._columns]
    maps = np.vstack([model._maps, here])
    likeness = model.kernel(maps, maps, np.ones((11, 11))) + np.exp(model.kernel.own) * np.eye(11)
    whole = np.kron(likeness, between)
    known = np.arange(10 * 4)
    gain = whole[40:, known] @ np.linalg.pinv(whole[np.ix_(known, known)])
    mean = gain @ table.ravel()
    mean[-1] += experience.lowest.mean()
    assert found.mean == pytest.approx(mean, abs=1e-6)
    rest = whole[40:, 40:] - gain @ whole[known][:, 40:]
    assert found.covariance == pytest.approx(rest, abs=1e-8)


def test_the_covariance_of_settings_is_what_the_maps_show_or_a_smooth_prior(experience, monkeypatch):
    model, units = MultitaskModel(experience), experience.settings
    table = model._shown() @ model._spread(units)
    shown = table.T @ model._precision @ table / len(table)
    assert np.linalg.matrix_rank(shown) <= 10
    assert np.linalg.matrix_rank(model._between(units)) == 33
    monkeypatch.setattr(multitask, "MAPS", 0)
    assert model._between(units) == pytest.approx(shown)


def test_settings_are_predicted_for_the_rules_they_did_well_under(mixed, bowl):
    model = MultitaskModel(mixed)
    for group, rules in enumerate(("liu2020", "max_min")):
        session = bowl(0, optimum=OPTIMA[group], features=(0.5,), rules=rules)
        expected = model.predict(session.task, mixed.settings).mean[:-1]
        best = mixed.settings[np.argmin(expected)]
        assert session.cost(best)[0] < 1.1 + np.quantile(session.cost(mixed.settings) - 1.1, 0.1)


def test_rules_of_ones_own_are_no_rules_that_were_seen(mixed, bowl):
    task = bowl(0, features=(0.5,)).task
    foreign = bowl(0, features=(0.5,), rules="wei2018").task
    model = MultitaskModel(mixed)
    known, unknown = (model.predict(each, mixed.settings[:2]).covariance[0, 0] for each in (task, foreign))
    assert unknown > known


def test_runs_one_by_one_teach_what_they_teach_together(prior):
    runs = [(0, 1.3), (3, 1.2), (3, 1.25), (5, 1.4)]
    one, other = Belief(prior), Belief(prior)
    one.observe(runs)
    for run in runs:
        other.observe([run])
    assert one.expected == pytest.approx(other.expected)
    assert one.most_telling() == other.most_telling()


def test_a_run_moves_its_candidate_and_its_likes(prior):
    belief = Belief(prior)
    belief.observe([(3, 1.6)] * 8 + [(0, 1.1)] * 8)
    assert belief.expected[3] - belief.expected[0] == pytest.approx(np.log(1.6 / 1.1), abs=0.06)
    assert belief.expected[1] < belief.expected[4]
    assert belief.best() == 0


def test_a_failure_counts_as_twice_the_best_whatever_its_cost(prior):
    belief = Belief(prior)
    belief.observe([(3, COST_CAP)] * 20)
    assert belief.expected[3] == pytest.approx(np.log(2), abs=0.03)
    assert belief.best() != 3


def test_a_better_run_later_shortens_what_came_before(prior):
    """Costs of 9 and 3 beside a best of 1 are both twice the best."""
    late, low = Belief(prior), Belief(prior)
    late.observe([(0, 9.0), (1, 1.0)])
    low.observe([(0, 3.0), (1, 1.0)])
    assert late.expected == pytest.approx(low.expected)


def test_the_most_telling_candidate_is_that_of_brute_force(prior):
    """A thousand possible runs of each candidate, each believed in full."""
    rng, belief = np.random.default_rng(0), Belief(prior)
    belief.observe([(0, 1.3), (5, 1.35)])
    mean, covariance = belief._mean, belief._covariance
    values = []
    for i in range(6):
        spread = covariance[i, i] + 2 * covariance[i, -1] + covariance[-1, -1] + prior.noise[i]
        reach = (covariance[:-1, i] + covariance[:-1, -1]) / spread
        shown = np.sqrt(spread) * rng.standard_normal(40_000)
        values.append((mean[:-1] + shown[:, None] * reach).min(axis=1).mean())
    assert belief.most_telling() == np.argmin(values)


def test_trials_improve_on_what_the_train_maps_say(experience, bowl):
    """The target is like none of the groups."""
    target = (0.6, 0.5, 0.2, 0.2)
    costs = [
        bowl(0, optimum=target).cost(
            tune(TransferGP(experience), bowl(budget, optimum=target, noise=0.02), seed=0).recommendation
        )[0]
        for budget in (1, 5, 25)
    ]
    assert costs[2] < costs[0]
    assert costs[2] < 1.1 + np.quantile(bowl(0, optimum=target).cost(experience.settings) - 1.1, 0.15)


def test_a_scale_must_be_positive(experience):
    with pytest.raises(ParameterError, match="tau = 0: must be positive"):
        TransferGP(experience, tau=0)
