"""Learners: which algorithm fits which environment, its settings, and the model that both make."""

import json
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

import numpy as np

from agents.algorithms import ALGORITHMS, Algorithm, find_algorithm
from agents.choosing import choice_of, members_of
from agents.networks import algorithm_class
from agents.published import read_card
from antgym.envs.catalogue import CATALOGUE, Entry
from antgym.envs.control import BLOCKS, LEAST_ITERATIONS
from antgym.errors import ParameterError, nearest
from antgym.maps.suites import load_suite
from antgym.planners.parameters import ColonyParameters
from antgym.planners.swarms import parameter_names
from antgym.tuning.actions import Start
from antgym.tuning.problem import TuningProblem

CONFIGS = Path(__file__).parent / "configs"
FILES = {"OneShot": "one_shot.toml", "Trials": "trials.toml", "Control": "control.toml"}
"""Which file of CONFIGS holds the settings of a regime."""
Action = Literal["each", "one", "setting", "moved"]
ACTIONS: dict[str, tuple[Action, ...]] = {
    "OneShot": ("setting", "moved"),
    "Trials": ("setting", "moved"),
    "Control": ("each", "one", "setting", "moved"),
}
"""Kinds of actions by regime, those that are learnt where nothing is said first; see ``PolicyCard.action``."""
STANDARD_MAPS = 100  # train maps that features are standardised by
CONSTANT = (
    1e-3  # deviation below which a feature tells nothing of these maps; it is then divided by its whole range
)
LEAST_SHARE = (
    0.05  # of its range that a feature is divided by: elsewhere it may well differ more than on train maps
)
OWN = (
    "num_envs",
    "reward_scale",
    "action_noise",
    "table_steps",
)  # settings that are none of the algorithm's constructor


@dataclass(frozen=True)
class Learner:
    """An algorithm on an environment, with its settings.

    Args:
        algorithm: a name of ``ALGORITHMS``.
        env: id of an environment of the catalogue.
        action: kind of its actions; None for the first of the regime's that the algorithm learns.
        kwargs: arguments of the environment.
        start: what changes begin from, see :class:`antgym.envs.sb3.ChangingVecEnv`.
        follows: file of a policy of OneShot, or of a committee, whose choice they begin from in place of that.
        config: file of settings by algorithm; None for the regime's own.

    Raises:
        ParameterError: on unknown names, and where the algorithm does not learn such actions; it names those that do.
    """

    algorithm: str
    env: str
    action: Action | None
    kwargs: Mapping[str, Any]
    start: Start | None
    config: Path | None
    follows: Path | None = None

    def __post_init__(self) -> None:
        known, wanted = ACTIONS[self.entry.regime], self.action
        if wanted is not None and wanted not in known:
            raise ParameterError(f"{self.env} takes settings; they are changed ({wanted!r}) in Control alone")
        fitting = [
            name for name, row in ALGORITHMS.items() if set(row.actions) & {*([wanted] if wanted else known)}
        ]
        if self.algorithm not in fitting:
            find_algorithm(self.algorithm)
            takes = f"actions of the kind {wanted!r}" if wanted else "settings, a Box"
            raise ParameterError(
                f"{self.algorithm} does not fit {self.env}, which takes {takes}; what fits: {', '.join(fitting)}"
            )
        begun = self.start is not None or self.follows is not None
        if begun and self.how == "setting":
            raise ParameterError(
                "start: there is one only where settings are changed: --action moved, each, one"
            )
        if self.how == "moved" and not begun:
            raise ParameterError("moved from where? give --start, --start-by-rules or --start-by-policy")
        if self.start is not None and self.follows is not None:
            raise ParameterError("--start and --start-by-policy: changes begin from one of them")
        if self.follows is not None:
            self._require_alike(self.follows)

    def _require_alike(self, follows: Path) -> None:
        """Raise ParameterError where what changes begin from is chosen for another swarm."""
        choice_of(follows)  # tells what is none of OneShot
        names = parameter_names(load_suite(self.suite, "train").rules[0])
        for member in members_of(follows):
            theirs = tuple(read_card(member).parameters)
            if theirs != names:
                swarm = "ants" if theirs == ColonyParameters._fields else "bees"
                raise ParameterError(
                    f"--start-by-policy {follows}: chooses {', '.join(theirs)}, for {swarm}, and {self.env} has "
                    f"{', '.join(names)}; name one that was trained in its world"
                )

    @cached_property
    def entry(self) -> Entry:
        """The environment's row of the catalogue."""
        rows = {row.id: row for row in CATALOGUE}
        if self.env not in rows:
            raise ParameterError(f"unknown environment {self.env!r}; {nearest(self.env, tuple(rows))}")
        return rows[self.env]

    @property
    def suite(self) -> Any:
        """The suite that it draws from, as ``load_suite`` takes it."""
        return self.kwargs.get("suite", self.entry.kwargs["suite"])

    @cached_property
    def row(self) -> Algorithm:
        """The algorithm's row."""
        return find_algorithm(self.algorithm)

    @cached_property
    def how(self) -> Action:
        """Kind of the actions."""
        if self.action is not None:
            return self.action
        return next(kind for kind in ACTIONS[self.entry.regime] if kind in self.row.actions)

    @cached_property
    def settings(self) -> dict[str, Any]:
        """What the configuration file says of the algorithm."""
        path = self.config or CONFIGS / FILES[self.entry.regime]
        try:
            table = tomllib.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise ParameterError(f"{path}: no settings ({error})") from None
        if self.algorithm not in table:
            hint = nearest(self.algorithm, tuple(table))
            raise ParameterError(f"{path} has no settings for {self.algorithm!r}; {hint}")
        return dict(table[self.algorithm])

    @property
    def steps_an_episode(self) -> int:
        """Steps of one slot from reset to termination."""
        return {"OneShot": 1, "Trials": int(self.kwargs.get("budget", 10)), "Control": BLOCKS}[
            self.entry.regime
        ]

    @property
    def runs_a_step(self) -> float:
        """Planner runs that a step of one slot costs, those of a reward that compares among them."""
        compared = self.kwargs.get("reward") == "improvement"
        regime = self.entry.regime
        return {"OneShot": 1 + compared, "Trials": 2 + compared, "Control": (1 + compared) / BLOCKS}[regime]

    def envs(self, count: int, seed: int, **others: Any) -> Any:
        """Return a batch of the environment; ``others`` go before ``kwargs``."""
        from antgym.envs.sb3 import ChangingVecEnv, MovedVecEnv, make_sb3_vec

        envs = make_sb3_vec(self.env, count, seed, **{**self.kwargs, **others})
        if self.how == "setting":
            return envs
        start = self.start if self.follows is None else choice_of(self.follows)
        if self.how == "moved":
            assert start is not None
            return MovedVecEnv(envs, start)
        return ChangingVecEnv(envs, self.how, start)

    def train_envs(self, seed: int) -> Any:
        """Return the batch that is trained on; returns are counted in the environment's own units, before any scale.

        ARS counts them itself: it would learn from those that a monitor counts, and not from what it is paid.
        """
        from stable_baselines3.common.vec_env import VecMonitor

        from antgym.envs.sb3 import ScaledRewards

        envs: Any = self.envs(self.settings.get("num_envs", 1), seed)
        scale = self.settings.get("reward_scale", 1.0)
        if self.algorithm != "ARS":
            envs = VecMonitor(envs)
        return envs if scale == 1.0 else ScaledRewards(envs, scale)

    def model(self, envs: Any, seed: int, steps: int) -> Any:
        """Return the untrained model; what it replays holds all ``steps`` of its training."""
        kind, given = algorithm_class(self.algorithm), dict(self.settings)
        noise = given.get("action_noise")
        given = {name: value for name, value in given.items() if name not in OWN}
        given["policy_kwargs"] = self._policy_kwargs(envs, dict(given.get("policy_kwargs", {})))
        if noise is not None:
            from stable_baselines3.common.noise import NormalActionNoise

            size = envs.action_space.shape
            given["action_noise"] = NormalActionNoise(np.zeros(size), np.full(size, noise))
        if "learning_starts" in given:
            given.setdefault("buffer_size", max(steps, envs.num_envs))
        return kind(self._alias(kind, envs), envs, seed=seed, device="cpu", **given)

    def _alias(self, kind: Any, envs: Any) -> str:
        reads = "MultiInput" if hasattr(envs.observation_space, "spaces") else "Mlp"
        alias = f"{reads}{'Lstm' if self.row.recurrent else ''}Policy"
        if alias not in kind.policy_aliases:
            raise ParameterError(f"{self.algorithm} reads no maps; leave --observation at features")
        return alias

    def _policy_kwargs(self, envs: Any, given: dict[str, Any]) -> dict[str, Any]:
        """Return arguments of the policy, its features standardised; ARS alone shows them as they are."""
        import torch

        from antgym.envs.sb3 import FeatureExtractor, MapExtractor

        if "activation_fn" in given:
            given["activation_fn"] = getattr(torch.nn, given["activation_fn"])
        if self.algorithm == "ARS":
            return given
        space = envs.observation_space
        parts = getattr(space, "spaces", {"features": space})
        given["features_extractor_class"] = MapExtractor if "map" in parts else FeatureExtractor
        reader = dict(given.get("features_extractor_kwargs", {}))
        if "map" not in parts:
            reader.pop("width", None)
        given["features_extractor_kwargs"] = {**reader, **self._standard(parts["features"])}
        return given

    def _standard(self, space: Any) -> dict[str, list[float]]:
        """Return mean and deviation of what is shown: of features over train maps, of the rest by its bounds."""
        low, high = space.low.astype(float), space.high.astype(float)
        mean, deviation = (low + high) / 2, (high - low) / 4
        seen = []
        for item in load_suite(self.suite, self.kwargs.get("split", "train"))[:STANDARD_MAPS]:
            least = LEAST_ITERATIONS if self.entry.regime == "Control" else 1
            ants, iterations = self.kwargs.get("effort") or (item.ants, max(item.iterations, least))
            seen.append(TuningProblem(item.scenario, item.rules, ants, iterations).task(0).features)
        count, spread = len(seen[0]), np.std(seen, axis=0)
        mean[:count], width = np.mean(seen, axis=0), (high - low)[:count]
        deviation[:count] = np.where(spread < CONSTANT, width, np.maximum(spread, LEAST_SHARE * width))
        return {"mean": mean.round(6).tolist(), "deviation": deviation.round(6).tolist()}


def parsed(text: str) -> dict[str, Any]:
    """Return the environment's arguments that a command line gives as JSON."""
    try:
        found = json.loads(text)
    except ValueError as error:
        raise ParameterError(f"--kwargs {text!r}: no JSON ({error})") from None
    if not isinstance(found, dict):
        raise ParameterError(f'--kwargs {text!r}: needs a JSON object, as {{"effort": [20, 50]}}')
    return found
