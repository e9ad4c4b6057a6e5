"""The catalogue of agents: one card each, bound to strings, so that listing them imports no library."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple


class Card(NamedTuple):
    """One agent of the catalogue.

    Attributes:
        name: what ``make`` takes.
        entry_point: ``"module:class"``.
        kwargs: what the class is called with.
        summary: one line for tables.
        needs: extra of antgym that holds its libraries, or None.
        trained: whether it needs a fitted artefact, which ``make`` must be given.
        libraries: distributions that its results depend on, numpy apart.
        files: that an agent from outside the catalogue consists of.
        track: the one that it was submitted for; "" for who was not.
        trials: planner runs on each map that whoever submitted it says it takes.
        training: planner runs that whoever submitted it says its making spent.
        steers: whether it sets parameters within a run, and can be asked for none before it.
    """

    name: str
    entry_point: str
    kwargs: Mapping[str, Any]
    summary: str
    needs: str | None = None
    trained: bool = False
    libraries: tuple[str, ...] = ()
    files: tuple[Path, ...] = ()
    track: str = ""
    trials: int = 0
    training: int = 0
    steers: bool = False


_OPTUNA, _TRANSFER = "agents.bayesian:OptunaSearch", "agents.transfer:TransferAgent"
_PYMOO, _CMAES = ("pymoo",), ("optuna", "cmaes")
RL_LIBRARIES = ("safetensors", "sb3-contrib", "stable-baselines3", "torch")
_CARDS = (
    Card(
        "best_static",
        "agents.static:StaticAgent",
        {},
        "the one setting that did best on the train maps, no trial",
        trained=True,
    ),
    Card(
        "best_static_by_rules",
        "agents.static:StaticByRules",
        {},
        "the setting that did best on the train maps of the same rules, no trial",
        trained=True,
    ),
    Card("uniform_random", "agents.controls:UniformRandom", {}, "one random setting, no trial"),
    Card("published_default", "agents.controls:PublishedDefault", {}, "the published setting, no trial"),
    Card(
        "rule_of_thumb",
        "agents.controls:RuleOfThumb",
        {},
        "the published setting with ρ = exp(-7.5 / (α T)) for T iterations, no trial",
    ),
    Card("random_search", "agents.controls:RandomSearch", {}, "uniform settings, the best run again"),
    Card(
        "sobol", "agents.controls:RandomSearch", {"design": "sobol"}, "a Sobol sequence, the best run again"
    ),
    Card(
        "trial_and_error",
        "agents.controls:TrialAndError",
        {"repeats": 10},
        "random sets, ten runs each where the budget allows, the best mean (liu2020)",
    ),
    Card(
        "ga",
        "agents.evolutionary:GeneticAlgorithm",
        {},
        "genetic algorithm (pymoo), population fitted to the budget",
        "agents",
        libraries=_PYMOO,
    ),
    Card(
        "ga_paper",
        "agents.evolutionary:GeneticAlgorithm",
        {"settings": "paper"},
        "genetic algorithm with liu2020's settings, 100 sets x 60 generations",
        "agents",
        libraries=_PYMOO,
    ),
    Card(
        "pso",
        "agents.evolutionary:ParticleSwarm",
        {},
        "particle swarm (pymoo), swarm fitted to the budget",
        "agents",
        libraries=_PYMOO,
    ),
    Card(
        "pso_paper",
        "agents.evolutionary:ParticleSwarm",
        {"settings": "paper"},
        "particle swarm with liu2020's settings, 100 particles x 100 iterations",
        "agents",
        libraries=_PYMOO,
    ),
    Card(
        "de",
        "agents.evolutionary:DifferentialEvolution",
        {},
        "differential evolution (pymoo), population fitted to the budget",
        "agents",
        libraries=_PYMOO,
    ),
    Card(
        "cma_es",
        "agents.covariance:CovarianceAdaptation",
        {},
        "CMA-ES (cmaes), restarts with twice the population",
        "agents",
        libraries=("cmaes",),
    ),
    Card(
        "optuna_tpe",
        _OPTUNA,
        {"sampler": "TPESampler"},
        "tree-structured Parzen estimator (Optuna 5: multivariate, constant liar), in batches",
        "agents",
        libraries=("optuna",),
    ),
    Card(
        "optuna_tpe_univariate",
        _OPTUNA,
        {"sampler": "TPESampler", "multivariate": False, "constant_liar": False},
        "the same with every parameter on its own, Optuna's default before 5",
        "agents",
        libraries=("optuna",),
    ),
    Card(
        "optuna_gp",
        _OPTUNA,
        {"sampler": "GPSampler"},
        "Gaussian process (Optuna), log expected improvement, in batches",
        "gp",
        libraries=("optuna", "greenlet", "torch"),
    ),
    Card(
        "optuna_cma",
        _OPTUNA,
        {"sampler": "CmaEsSampler"},
        "CMA-ES as Optuna samples it, σ a sixth of the range around the default, whole generations",
        "agents",
        libraries=_CMAES,
    ),
    Card(
        "optuna_qmc",
        _OPTUNA,
        {"sampler": "QMCSampler", "scramble": True},
        "quasi-Monte Carlo as Optuna samples it, a scrambled Sobol sequence",
        "agents",
        libraries=("optuna", "scipy"),
    ),
    Card(
        "optuna_race",
        "agents.bayesian:OptunaRace",
        {"sampler": "TPESampler", "p_threshold": 0.2},
        "TPE over settings that are run repeatedly, with Optuna's Wilcoxon pruner",
        "agents",
        libraries=("optuna", "scipy"),
    ),
    Card(
        "transfer_graph",
        _TRANSFER,
        {"mode": "sound"},
        "transfer graph, sound version with guard runs",
        trained=True,
    ),
    Card(
        "transfer_graph_paper",
        _TRANSFER,
        {"mode": "paper"},
        "transfer graph as liu2020 prints it",
        trained=True,
    ),
    Card("transfer_graph_abs", _TRANSFER, {"mode": "abs"}, "as printed, but with |Λ̂| in (14)", trained=True),
    Card(
        "copy_best_source",
        _TRANSFER,
        {"mode": "copy"},
        "the source set that does best on the target",
        trained=True,
    ),
    Card(
        "mean_of_sources", _TRANSFER, {"mode": "mean"}, "the mean of the source sets, no trial", trained=True
    ),
    Card(
        "portfolio",
        "agents.portfolio:PortfolioAgent",
        {},
        "settings that together serve the train maps, tried by successive halving",
        trained=True,
    ),
    Card(
        "neighbours",
        "agents.neighbours:NeighbourAgent",
        {},
        "what did well on the train maps most alike, blended, then tried",
        trained=True,
    ),
    Card(
        "regression",
        "agents.regression:ForestAgent",
        {},
        "extra trees from a map's features to what all settings cost (scikit-learn), blended, then tried",
        "agents",
        trained=True,
        libraries=("scikit-learn",),
    ),
    Card(
        "neural_regression",
        "agents.regression:EnsembleAgent",
        {},
        "the same by four small nets (torch), fitted once and kept",
        "rl",
        trained=True,
        libraries=("safetensors", "torch"),
    ),
    Card(
        "cma_es_warm",
        "agents.warm_start:WarmCmaEs",
        {},
        "CMA-ES (cmaes) started where settings did well on the train maps most alike",
        "agents",
        trained=True,
        libraries=("cmaes",),
    ),
    Card(
        "transfer_gp",
        "agents.transfer_gp:TransferGP",
        {},
        "Gaussian process over maps and settings, its prior from the train maps, by knowledge gradient",
        trained=True,
        libraries=("scipy",),
    ),
    Card(
        "rl",
        "agents.policy:PolicyAgent",
        {},
        "published policy (stable-baselines3), no trial, or trials that it picks one by one",
        "rl",
        trained=True,
        libraries=RL_LIBRARIES,
    ),
    Card(
        "rl_committee",
        "agents.committee:CommitteeAgent",
        {},
        "the mean of what several published policies recommend, no trial",
        "rl",
        trained=True,
        libraries=RL_LIBRARIES,
    ),
)
CATALOGUE: dict[str, Card] = {card.name: card for card in _CARDS}
