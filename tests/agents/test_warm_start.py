"""CMA-ES from source trials: the library's own start and the library's own steps."""

import numpy as np
import pytest

from agents.bayesian import narrow_seed
from agents.warm_start import WarmCmaEs
from antgym.errors import ParameterError
from antgym.tuning import tune

cmaes = pytest.importorskip("cmaes")


def test_the_start_is_the_librarys_own(bowl, experience):
    agent, session = WarmCmaEs(experience), bowl(0)
    agent.reset(session.task, seed=0)
    mean, _, _ = cmaes.get_warm_start_mgd(agent.source_solutions(session.task), gamma=0.1, alpha=0.1)
    assert agent.recommend().tolist() == mean.tolist()


def test_through_the_protocol_it_is_the_librarys_own_loop(bowl, experience):
    agent, session = WarmCmaEs(experience, rerun_share=0.0), bowl(25)
    tune(agent, session, seed=7)
    mean, sigma, cov = cmaes.get_warm_start_mgd(agent.source_solutions(session.task), gamma=0.1, alpha=0.1)
    bounds = np.tile([0.0, 1.0], (4, 1))
    own = cmaes.CMA(mean=mean, sigma=sigma, cov=cov, bounds=bounds, seed=narrow_seed(7), population_size=8)
    expected = [mean]
    for _ in range(3):
        points = [own.ask() for _ in range(8)]
        own.tell([(x, float(cost)) for x, cost in zip(points, session.cost(points), strict=True)])
        expected += points
    assert np.concatenate(session.batches).tolist() == np.array(expected).tolist()


def test_source_solutions_are_the_neighbours_mean(bowl, experience):
    session = bowl(0, features=(1.0, 0.1))
    solutions = WarmCmaEs(experience, neighbours=1).source_solutions(session.task)
    odd = np.array([cost for _, cost in solutions])
    assert any(odd.tolist() == row.tolist() for row in experience.regrets[1::2])


def test_the_start_is_recommended_as_long_as_nothing_found_a_path(bowl, experience):
    session, agent = bowl(12, fails=True), WarmCmaEs(experience)
    agent.reset(session.task, seed=0)
    start = agent.recommend()
    assert tune(agent, session, seed=0).recommendation.tolist() == start.tolist()


def test_populations_leave_room_for_three_generations(bowl, experience):
    for budget, population in ((6, 4), (20, 5), (100, 8)):
        agent, session = WarmCmaEs(experience), bowl(budget)
        agent.reset(session.task, seed=0)
        agent.tell(session.evaluate(agent.ask()))
        assert len(agent.ask()) == min(population, budget)


@pytest.mark.parametrize("wrong", [{"neighbours": 0}, {"gamma": 0.0}, {"gamma": 1.1}, {"alpha": 0.0}])
def test_what_the_library_cannot_take_is_refused(experience, wrong):
    with pytest.raises(ParameterError, match="must be"):
        WarmCmaEs(experience, **wrong)
