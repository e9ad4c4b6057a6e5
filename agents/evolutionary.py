"""A genetic algorithm, a particle swarm and differential evolution, all pymoo's, a whole generation per ask.

pymoo's genetic algorithm keeps the best of parents and offspring (μ + λ), its swarm the best position of every
particle, differential evolution the better of parent and offspring; all trust costs they have seen, lucky ones
included. The re-runs that follow the search are there for that.
"""

from abc import abstractmethod
from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any, ClassVar, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from agents.judgement import RERUN_SHARE
from agents.search import Search
from antgym.errors import MissingExtraError, ParameterError, nearest
from antgym.tuning import Task

Floats = NDArray[np.float64]
SMALLEST_POPULATION = 8
SMALLEST_DE = 4


class GASettings(NamedTuple):
    """Settings of the genetic algorithm.

    Attributes:
        population: settings per generation, ≥ 2; None fits it to the budget (:func:`fit_population`).
        generations: where to stop; None searches as long as the budget lasts.
        crossover: probability that a pair of parents is crossed (simulated binary crossover).
        mutation: probability that an offspring is mutated (polynomial mutation).
        crossover_index: distribution index of the crossover: the higher, the closer to the parents.
        mutation_index: distribution index of the mutation, likewise.
        rerun_share: share of the budget kept to run the best settings again.
    """

    population: int | None = None
    generations: int | None = None
    crossover: float = 0.9
    mutation: float = 0.9
    crossover_index: float = 5.0
    mutation_index: float = 5.0
    rerun_share: float = RERUN_SHARE


class PSOSettings(NamedTuple):
    """Settings of the particle swarm.

    Attributes:
        population: particles, ≥ 2; None fits it to the budget (:func:`fit_population`).
        generations: where to stop; None searches as long as the budget lasts.
        inertia: w, share of the velocity that is kept.
        cognitive: c₁, pull towards a particle's own best.
        social: c₂, pull towards the swarm's best.
        rerun_share: share of the budget kept to run the best settings again.
    """

    population: int | None = None
    generations: int | None = None
    inertia: float = 0.7298
    cognitive: float = 1.4962
    social: float = 1.4962
    rerun_share: float = RERUN_SHARE


class DESettings(NamedTuple):
    """Settings of differential evolution.

    Attributes:
        population: settings per generation, ≥ 4; None fits it to the budget (:func:`fit_population`).
        generations: where to stop; None searches as long as the budget lasts.
        variant: base vector, number of differences and crossover, as pymoo writes it.
        weight: F, the share of a difference that is added.
        crossover: CR, probability that a parameter comes from the new vector.
        mutation: probability that an offspring is then mutated (polynomial mutation).
        rerun_share: share of the budget kept to run the best settings again.
    """

    population: int | None = None
    generations: int | None = None
    variant: str = "DE/rand/1/bin"
    weight: float = 0.5
    crossover: float = 0.9
    mutation: float = 0.1
    rerun_share: float = RERUN_SHARE


# liu2020's, with no re-runs; it is silent on distribution indices and the inertia: pymoo's defaults stand in.
GA_SETTINGS = {"fitted": GASettings(), "paper": GASettings(100, 60, 0.2, 0.2, 15.0, 20.0, rerun_share=0.0)}
PSO_SETTINGS = {"fitted": PSOSettings(), "paper": PSOSettings(100, 100, 0.9, 0.1, 0.1, rerun_share=0.0)}
DE_SETTINGS = {"fitted": DESettings()}
_S = TypeVar("_S", GASettings, PSOSettings, DESettings)


class _Generations(Search):
    """pymoo's ask and tell over the unit cube, up to a number of generations.

    Args:
        settings: a name among those that the algorithm knows.
        changes: fields of these settings to change.
    """

    _known: ClassVar[Mapping[str, Any]]
    settings: GASettings | PSOSettings | DESettings

    def __init__(self, settings: str = "fitted", **changes: Any) -> None:
        self.settings = _choose(self._known, settings, changes)
        self._pymoo = _pymoo()
        super().__init__(self.settings.rerun_share)

    def _start(self, task: Task, trials: int, seed: int) -> None:
        pymoo = self._pymoo
        self._problem = pymoo.Problem(n_var=len(task.space), n_obj=1, xl=0.0, xu=1.0)
        self._algorithm = self._build(pymoo, self.settings.population or fit_population(trials))
        self._algorithm.setup(self._problem, termination=pymoo.NoTermination(), seed=seed)
        self._done = 0

    @abstractmethod
    def _build(self, pymoo: SimpleNamespace, population: int) -> Any:
        """Return pymoo's algorithm."""

    def _propose(self) -> Floats:
        if self._done == self.settings.generations:
            return np.empty((0, self._problem.n_var))
        self._generation = self._algorithm.ask()
        return np.asarray(self._generation.get("X"), dtype=np.float64)

    def _learn(self, costs: Floats) -> None:
        """Close the generation; one that came back short is dropped, for pymoo takes whole ones only."""
        if len(costs) == len(self._generation):
            outcome = self._pymoo.StaticProblem(self._problem, F=costs[:, None])
            self._pymoo.Evaluator().eval(outcome, self._generation)
            self._algorithm.tell(infills=self._generation)
            self._done += 1


class GeneticAlgorithm(_Generations):
    """pymoo's genetic algorithm.

    Args:
        settings: ``"fitted"`` to the budget or ``"paper"``: liu2020's 100 x 60 with probabilities of 0.2.
        changes: fields of :class:`GASettings` to change.
    """

    _known = GA_SETTINGS
    settings: GASettings

    def _build(self, pymoo: SimpleNamespace, population: int) -> Any:
        chosen = self.settings
        return pymoo.GA(
            pop_size=population,
            crossover=pymoo.SBX(prob=chosen.crossover, eta=chosen.crossover_index),
            mutation=pymoo.PM(prob=chosen.mutation, eta=chosen.mutation_index),
            eliminate_duplicates=False,
        )


class ParticleSwarm(_Generations):
    """pymoo's particle swarm, with constant weights.

    Args:
        settings: ``"fitted"`` to the budget, with Clerc's constriction weights, or ``"paper"``: liu2020's 100
            particles x 100 iterations with c₁ = c₂ = 0.1.
        changes: fields of :class:`PSOSettings` to change.
    """

    _known = PSO_SETTINGS
    settings: PSOSettings

    def _build(self, pymoo: SimpleNamespace, population: int) -> Any:
        chosen = self.settings
        return pymoo.PSO(
            pop_size=population,
            w=chosen.inertia,
            c1=chosen.cognitive,
            c2=chosen.social,
            adaptive=False,
            pertube_best=False,
        )


class DifferentialEvolution(_Generations):
    """pymoo's differential evolution: an offspring takes the place of its parent where it is no worse.

    Args:
        settings: ``"fitted"`` to the budget.
        changes: fields of :class:`DESettings` to change.
    """

    _known = DE_SETTINGS
    settings: DESettings

    def __init__(self, settings: str = "fitted", **changes: Any) -> None:
        super().__init__(settings, **changes)
        if self.settings.population is not None and self.settings.population < SMALLEST_DE:
            raise ParameterError(
                f"population = {self.settings.population}: a difference between others needs at least {SMALLEST_DE}"
            )

    def _build(self, pymoo: SimpleNamespace, population: int) -> Any:
        chosen = self.settings
        return pymoo.DE(
            pop_size=population,
            variant=chosen.variant,
            F=chosen.weight,
            CR=chosen.crossover,
            prob_mut=chosen.mutation,
        )


def fit_population(trials: int) -> int:
    """Return a population for a search of so many trials: about as many generations as members.

    At least eight, so five generations or more from 40 trials on. Smaller populations close in on lucky runs:
    on noisy mountains four or six of either algorithm did worse than random search at every budget tried.
    """
    return max(SMALLEST_POPULATION, round(trials**0.5))


def _choose(known: Mapping[str, _S], name: str, changes: Mapping[str, Any]) -> _S:
    if name not in known:
        raise ParameterError(f"unknown settings {name!r}; {nearest(name, tuple(known))}")
    for field in changes:
        if field not in known[name]._fields:
            raise ParameterError(f"unknown setting {field!r}; {nearest(field, known[name]._fields)}")
    chosen = known[name]._replace(**changes)
    if chosen.population is not None and chosen.population < 2:
        raise ParameterError(f"population = {chosen.population}: needs at least 2")
    if chosen.generations is not None and chosen.generations < 1:
        raise ParameterError(f"generations = {chosen.generations}: needs at least 1")
    return chosen


def _pymoo() -> SimpleNamespace:
    """Import what is used of pymoo; a third of a second that only these agents pay."""
    try:
        from pymoo.algorithms.soo.nonconvex.de import DE
        from pymoo.algorithms.soo.nonconvex.ga import GA
        from pymoo.algorithms.soo.nonconvex.pso import PSO
        from pymoo.core.evaluator import Evaluator
        from pymoo.core.problem import Problem
        from pymoo.core.termination import NoTermination
        from pymoo.operators.crossover.sbx import SBX
        from pymoo.operators.mutation.pm import PM
        from pymoo.problems.static import StaticProblem
    except ModuleNotFoundError as error:
        raise MissingExtraError("pymoo", "agents") from error
    return SimpleNamespace(
        DE=DE,
        GA=GA,
        PSO=PSO,
        SBX=SBX,
        PM=PM,
        Evaluator=Evaluator,
        Problem=Problem,
        NoTermination=NoTermination,
        StaticProblem=StaticProblem,
    )
