"""The genetic algorithm, the swarm and differential evolution are pymoo's: they propose what its own loop proposes."""

import numpy as np
import pytest

pytest.importorskip("pymoo")

from pymoo.algorithms.soo.nonconvex.de import DE
from pymoo.algorithms.soo.nonconvex.ga import GA
from pymoo.algorithms.soo.nonconvex.pso import PSO
from pymoo.core.problem import Problem
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.mutation.pm import PM
from pymoo.optimize import minimize

from agents.evolutionary import DifferentialEvolution, GeneticAlgorithm, ParticleSwarm, fit_population
from antgym.errors import ParameterError
from antgym.tuning import tune

GENERATIONS, POPULATION = 6, 10
OWN = {
    (GeneticAlgorithm, "paper"): lambda: GA(
        pop_size=POPULATION,
        crossover=SBX(prob=0.2, eta=15.0),
        mutation=PM(prob=0.2, eta=20.0),
        eliminate_duplicates=False,
    ),
    (GeneticAlgorithm, "fitted"): lambda: GA(
        pop_size=POPULATION,
        crossover=SBX(prob=0.9, eta=5.0),
        mutation=PM(prob=0.9, eta=5.0),
        eliminate_duplicates=False,
    ),
    (ParticleSwarm, "paper"): lambda: PSO(
        pop_size=POPULATION, w=0.9, c1=0.1, c2=0.1, adaptive=False, pertube_best=False
    ),
    (ParticleSwarm, "fitted"): lambda: PSO(
        pop_size=POPULATION, w=0.7298, c1=1.4962, c2=1.4962, adaptive=False, pertube_best=False
    ),
    (DifferentialEvolution, "fitted"): lambda: DE(
        pop_size=POPULATION, variant="DE/rand/1/bin", F=0.5, CR=0.9, prob_mut=0.1
    ),
}
AGENTS = (GeneticAlgorithm, ParticleSwarm, DifferentialEvolution)


class _Recorded(Problem):
    """The bowl as a pymoo problem that keeps every generation."""

    def __init__(self, session):
        super().__init__(n_var=4, n_obj=1, xl=0.0, xu=1.0)
        self.session, self.generations = session, []

    def _evaluate(self, x, out, *args, **kwargs):
        self.generations.append(x.copy())
        out["F"] = self.session.cost(x)


@pytest.mark.parametrize(("agent", "settings"), OWN)
def test_an_agent_proposes_what_pymoos_own_loop_proposes(agent, settings, bowl):
    session = bowl(GENERATIONS * POPULATION)
    tune(agent(settings, population=POPULATION, generations=GENERATIONS, rerun_share=0.0), session, seed=7)
    problem = _Recorded(session)
    minimize(problem, OWN[agent, settings](), ("n_gen", GENERATIONS), seed=7)
    assert len(session.batches) == GENERATIONS
    np.testing.assert_array_equal(session.batches, problem.generations)


@pytest.mark.parametrize("agent", AGENTS)
def test_a_generation_longer_than_the_budget_is_cut(agent, bowl):
    session = bowl(25)
    tune(agent(population=10, rerun_share=0.0), session, seed=0)
    assert [len(batch) for batch in session.batches] == [10, 10, 5]


@pytest.mark.parametrize(("agent", "trials"), [(GeneticAlgorithm, 6000), (ParticleSwarm, 10000)])
def test_paper_settings_are_liu2020s(agent, trials):
    settings = agent("paper").settings
    assert settings.population * settings.generations == trials


def test_the_search_ends_with_its_generations_and_leaves_the_rest(bowl):
    session = bowl(100)
    tune(GeneticAlgorithm(population=5, generations=4, rerun_share=0.0), session, seed=0)
    assert len(session.trials) == 20


@pytest.mark.parametrize(("trials", "population"), [(1, 8), (16, 8), (80, 9), (400, 20)])
def test_the_population_fits_the_budget(trials, population):
    assert fit_population(trials) == population


@pytest.mark.parametrize("changes", [{"population": 1}, {"generations": 0}, {"settings": "papers"}])
def test_settings_that_make_no_sense_are_refused(changes):
    with pytest.raises(ParameterError):
        GeneticAlgorithm(**changes)


def test_differences_between_three_others_are_refused():
    with pytest.raises(ParameterError, match="population = 3"):
        DifferentialEvolution(population=3)
