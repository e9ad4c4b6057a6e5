"""What every regime shares: how an episode's scenario is drawn, how actions and rewards are read."""

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from inspect import cleandoc
from numbers import Integral
from typing import Any, TypeVar

import gymnasium
import numpy as np
from numpy.typing import ArrayLike, NDArray

from antgym.envs.manual import ranges_table, worlds_table
from antgym.envs.scenarios import find_items
from antgym.errors import ParameterError, is_count, nearest
from antgym.maps.features import Feature, feature_table
from antgym.maps.occupancy import picture_shape
from antgym.maps.suites import SPLITS, SuiteItem
from antgym.planners.colony import Colony, Plans
from antgym.planners.parameters import ColonyParameters
from antgym.planners.space import named_values
from antgym.tuning.features import TASK_FEATURES
from antgym.tuning.observation import bounds, observe
from antgym.tuning.problem import COST_CAP, TRIAL, Request, TuningProblem, run_together
from antgym.tuning.session import Session, evaluate_together

REWARDS = ("gap", "length", "improvement")
OBSERVATIONS = ("features", "map", "map2d", "map3d")
Observation = NDArray[np.float32] | dict[str, NDArray[np.float32]]
Step = tuple[Observation, float, bool, bool, dict[str, Any]]
_Regime = TypeVar("_Regime", bound="type[TuningEnv]")


def documented(regime: _Regime) -> _Regime:
    """Fill the tables of a regime's docstring in from what the environment itself reads."""
    if regime.__doc__:  # python -OO strips it
        tables = {
            "actions": ranges_table(),
            "observations": feature_table(regime.features),
            "worlds": worlds_table(),
        }
        regime.__doc__ = cleandoc(regime.__doc__).format(**tables)
    return regime


class TuningEnv(gymnasium.Env[Observation, NDArray[np.float32]]):
    """Base of the regimes. A step is paid, then judged; a batch does the same for many environments at once.

    Args:
        suite: name of the suite scenarios come from, or scenarios of your own: a sequence of ``SuiteItem``.
        split: ``"train"``, ``"validation"``, ``"test"`` or ``"ood"`` of a named suite.
        effort: (ants, iterations) for every scenario instead of each scenario's own.
        reward: ``"gap"``, ``"length"`` or ``"improvement"``.
        observation: ``"features"``, the vector alone, or with a map beside it: ``"map2d"``, ``"map3d"``, or ``"map"``
            for that of the two which fits the suite: flat where all its worlds are.
        render_mode: ``"ansi"``, ``"rgb_array"`` or None.
        unknown: raises ParameterError naming the nearest valid argument.
    """

    metadata: dict[str, Any] = {"render_modes": ["ansi", "rgb_array"], "render_fps": 1}  # noqa: RUF012
    arguments: tuple[str, ...] = ("suite", "split", "effort", "reward", "observation", "render_mode")
    features: tuple[Feature, ...] = TASK_FEATURES  # the tabulated part of the observation
    _budget, _window = 1, 0  # trials an episode pays for, and how many of them the observation shows
    least_iterations = 1  # of a run

    def __init__(
        self,
        suite: str | Sequence[SuiteItem],
        split: str = "train",
        effort: Sequence[int] | None = None,
        reward: str = "gap",
        observation: str = "features",
        *,
        render_mode: str | None = None,
        **unknown: Any,
    ) -> None:
        for name in unknown:
            raise ParameterError(f"unknown environment argument {name!r}; {nearest(name, self.arguments)}")
        for name, value, valid in (
            ("split", split, SPLITS),
            ("reward", reward, REWARDS),
            ("observation", observation, OBSERVATIONS),
        ):
            if value not in valid:
                raise ParameterError(f"unknown {name} {value!r}; {nearest(str(value), valid)}")
        if render_mode is not None and render_mode not in self.metadata["render_modes"]:
            valid = tuple(self.metadata["render_modes"])
            raise ParameterError(f"unknown render_mode {render_mode!r}; {nearest(str(render_mode), valid)}")
        self._suite = find_items(suite, split)
        self._effort = None if effort is None else _checked_effort(effort, self.least_iterations)
        self._reward = reward
        self.render_mode = render_mode
        dimension = len(ColonyParameters._fields)
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (dimension,), np.float32)
        features = gymnasium.spaces.Box(*self._bounds(), dtype=np.float32)
        self._flat_map = {"features": None, "map": self._suite.flat, "map2d": True, "map3d": False}[
            observation
        ]
        self.observation_space = _with_map(features, self._flat_map)
        self._root: int | None = None
        self._episode = 0
        self._session: Session | None = None
        self.planner_runs = 0  # by this environment so far, fresh ones included

    @property
    def session(self) -> Session:
        """The current episode's session; ParameterError before the first reset."""
        if self._session is None:
            raise ParameterError("the environment has no episode yet; call reset() first")
        return self._session

    def reset(
        self, *, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begin an episode; scenario and planner seeds are a pure function of (root seed, episode index).

        Args:
            seed: root seed; the episode index goes back to 0. Without one, the next episode of the root begins.
            options: ``{"scenario": index}`` picks a scenario of the split instead of drawing it.
        """
        super().reset(seed=seed)
        root, episode = self._root, self._episode + 1
        if seed is not None or root is None:
            root, episode = int(self.np_random.integers(2**63)) if seed is None else seed, 0
        session = self._begin(self._draw(root, episode, dict(options or {})))
        self._root, self._episode, self._session = root, episode, session
        return self._observe(), self._facts()

    def step(self, action: NDArray[np.float32]) -> Step:
        """Pay for one setting and judge it."""
        return step_together([self], [action])[0]

    @property
    def over(self) -> bool:
        """Whether the episode has ended."""
        return self.session.left == 0

    def pay(self, action: ArrayLike) -> tuple[Session, NDArray[np.float64]]:
        """Return what this action asks of the planner: the session and the (1, d) setting."""
        if self.over:
            raise ParameterError("the episode is over; call reset()")
        values = np.asarray(action, dtype=np.float64)
        if values.shape != self.action_space.shape or not (np.abs(values) <= 1).all():
            raise ParameterError(f"action {values.tolist()} is no point of {self.action_space}")
        return self.session, ((values + 1) / 2)[None, :]

    @staticmethod
    def spend(requests: Sequence[tuple[Session, NDArray[np.float64]]]) -> Sequence[Any]:
        """Let the planner run what several environments of this regime ask of it, in one call."""
        return evaluate_together(requests)

    @abstractmethod
    def judge(self, outcome: Any) -> Request | None:
        """Return the fresh, uncharged runs that the reward of what was spent needs, or None."""

    @abstractmethod
    def conclude(self, outcome: Any, fresh: Plans | None) -> Step:
        """Return what step() returns."""

    def encode(self, *, alpha: float, beta: float, rho: float, Q: float) -> NDArray[np.float32]:
        """Return the action of natural values in the current episode; ParameterError outside their ranges."""
        unit = self.session.problem.space.encode([alpha, beta, rho, Q])[0]
        return (2 * unit - 1).astype(np.float32)

    def render(self) -> Any:
        """Return the picture of the last run: a string (``ansi``) or an (h, w, 3) uint8 array (``rgb_array``)."""
        if self.render_mode is None:
            raise ParameterError(
                "this environment was made without render_mode; pass 'ansi' or 'rgb_array' to make()"
            )
        from antgym.envs.render import ansi, rgb_array

        return (ansi if self.render_mode == "ansi" else rgb_array)(self.session.problem, self._walked())

    def _begin(self, problem: TuningProblem) -> Session:
        """Return the session of a new episode."""
        return Session(problem, self._budget)

    def _draw(self, root: int, episode: int, options: dict[str, Any]) -> TuningProblem:
        rng = np.random.default_rng(np.random.SeedSequence(root, spawn_key=(episode,)))
        index, planner_seed = int(rng.integers(len(self._suite))), int(rng.integers(2**63))
        chosen = options.pop("scenario", index)
        for name in options:
            raise ParameterError(f"unknown reset option {name!r}; valid: scenario")
        if not isinstance(chosen, Integral) or not 0 <= int(chosen) < len(self._suite):
            raise ParameterError(f"scenario {chosen!r}: this split holds 0 to {len(self._suite) - 1}")
        item = self._suite[int(chosen)]
        ants, iterations = self._effort or (item.ants, max(item.iterations, self.least_iterations))
        return TuningProblem(item.scenario, item.rules, ants, iterations, planner_seed)

    def _walked(self) -> Colony | None:
        """Return the colony of the last run, None before any: it is walked again, same seed and same ants."""
        if not self.session.trials:
            return None
        problem, trial = self.session.problem, self.session.trials[-1]
        colony = Colony(
            problem.scenario,
            rules=problem.rules,
            ants=problem.ants,
            iterations=problem.iterations,
            seed=int(problem.seeds(TRIAL, trial.index, 1)[0]),
        )
        colony.advance(problem.space.decode(trial.unit)[0], problem.iterations)
        return colony

    def _observe(self) -> Observation:
        vector = self._vector()
        if self._flat_map is None:
            return vector
        return {"features": vector, "map": self.session.task.map(self._flat_map).copy()}

    def _bounds(self) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Return (low, high) of the vector shown."""
        return bounds(len(ColonyParameters._fields), window=self._window)

    def _vector(self) -> NDArray[np.float32]:
        return observe(self.session.task, self.session.trials, window=self._window)

    def _facts(self) -> dict[str, Any]:
        problem = self.session.problem
        return {
            "scenario": problem.scenario.name,
            "seed": problem.seed,
            "ants": problem.ants,
            "iterations": problem.iterations,
            "rules": problem.rules,
        }

    def _judged(self, parameters: Sequence[float], length: float) -> dict[str, Any]:
        """Return the facts of a run with natural parameters and the length that it came to."""
        problem = self.session.problem
        return {
            **self._facts(),
            "length": min(length, COST_CAP * problem.scenario.straight_line),
            "optimum": problem.scenario.optimum,
            "gap": float(problem.gap(np.array([length]))[0]),
            "solved": bool(np.isfinite(length)),
            "parameters": named_values(problem.space, parameters),
        }

    def _natural(self, unit: tuple[float, ...]) -> list[float]:
        return self.session.problem.space.decode(unit)[0].tolist()

    def _pays(self, judged: Mapping[str, Any], default: Plans | None) -> float:
        """Return the reward of a judged run, beside one of the published default where that counts."""
        if self._reward == "length":
            return -float(judged["length"])
        gap = float(judged["gap"])
        return -gap if default is None else float(self.session.problem.gap(default.lengths)[0]) - gap


def step_together(envs: Sequence[TuningEnv], actions: Sequence[ArrayLike]) -> list[Step]:
    """Step environments of one regime: what they ask is one planner call, what judging them needs another."""
    if not envs:
        return []
    outcomes = envs[0].spend([env.pay(action) for env, action in zip(envs, actions, strict=True)])
    requests = [env.judge(outcome) for env, outcome in zip(envs, outcomes, strict=True)]
    fresh = iter(run_together([request for request in requests if request is not None]))
    plans = [None if request is None else next(fresh) for request in requests]
    return [env.conclude(*judged) for env, *judged in zip(envs, outcomes, plans, strict=True)]


def _with_map(features: gymnasium.spaces.Box, flat: bool | None) -> Any:
    if flat is None:
        return features
    picture = gymnasium.spaces.Box(0.0, 1.0, picture_shape(flat), np.float32)
    return gymnasium.spaces.Dict({"features": features, "map": picture})


def _checked_effort(effort: Sequence[int], least_iterations: int) -> tuple[int, int]:
    if not isinstance(effort, Sequence) or len(effort) != 2 or not all(map(is_count, effort)):
        raise ParameterError(
            f"effort = {effort!r}: needs (ants, iterations), two whole numbers of at least 1"
        )
    if effort[1] < least_iterations:
        raise ParameterError(
            f"effort = {effort!r}: needs (ants, iterations) with at least {least_iterations} iterations, for a run "
            "is steered in blocks"
        )
    return int(effort[0]), int(effort[1])
