"""CMA-ES is the package's: through our protocol it proposes what its own loop proposes."""

import numpy as np
import pytest

from agents.covariance import CovarianceAdaptation
from agents.search import narrow_seed
from antgym.errors import ParameterError
from antgym.tuning import tune

cmaes = pytest.importorskip("cmaes")


def _own(session, generations, seed, **arguments):
    """The loop of the package's own page."""
    optimizer = cmaes.CMA(
        mean=np.full(4, 0.5), bounds=np.array([[0.0, 1.0]] * 4), seed=narrow_seed(seed), **arguments
    )
    rows = []
    for _ in range(generations):
        solutions = []
        for _ in range(optimizer.population_size):
            x = optimizer.ask()
            solutions.append((x, session.cost(x)[0]))
        optimizer.tell(solutions)
        rows.extend(x.tolist() for x, _ in solutions)
    return sorted(rows)


@pytest.mark.parametrize("lr_adapt", [False, True])
@pytest.mark.parametrize("population", [None, 11])
def test_an_agent_proposes_what_the_packages_own_loop_proposes(population, lr_adapt, bowl):
    size = population or 8
    session = bowl(6 * size)
    agent = CovarianceAdaptation(population=population, sigma=0.2, lr_adapt=lr_adapt, rerun_share=0.0)
    tune(agent, session, seed=7)
    assert [len(batch) for batch in session.batches] == [size] * 6
    own = _own(session, 6, 7, sigma=0.2, population_size=population, lr_adapt=lr_adapt)
    assert sorted(np.concatenate(session.batches).tolist()) == own


def test_it_converges_on_a_bowl_without_noise(bowl):
    session = bowl(600)
    found = tune(CovarianceAdaptation(rerun_share=0.0), session, seed=0).recommendation
    np.testing.assert_allclose(found, session.optimum, atol=1e-3)


def test_once_converged_it_starts_anew_with_twice_the_population(bowl):
    session = bowl(4000)
    tune(CovarianceAdaptation(rerun_share=0.0), session, seed=0)
    sizes = [len(batch) for batch in session.batches[:-1]]
    assert sizes == sorted(sizes)
    assert set(sizes) >= {8, 16}
    first = sizes.index(16)
    assert session.batches[first].std() > 10 * session.batches[first - 1].std(axis=0).max()


def test_a_generation_longer_than_the_budget_is_cut(bowl):
    session = bowl(20)
    tune(CovarianceAdaptation(rerun_share=0.0), session, seed=0)
    assert [len(batch) for batch in session.batches] == [8, 8, 4]


@pytest.mark.parametrize("changes", [{"population": 1}, {"sigma": 0.0}, {"sigma": float("nan")}])
def test_settings_that_make_no_sense_are_refused(changes):
    with pytest.raises(ParameterError, match=next(iter(changes))):
        CovarianceAdaptation(**changes)
