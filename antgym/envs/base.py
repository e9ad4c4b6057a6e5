"""What every regime shares: how an episode's scenario is drawn, how actions and rewards are read."""

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from numbers import Integral
from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector.utils import iterate
from numpy.typing import ArrayLike, NDArray

from antgym.envs.draws import checked_effort, load_problems
from antgym.envs.infos import Columns, row
from antgym.envs.scenarios import find_items
from antgym.envs.verdicts import REWARDS, Verdict, facts, judged, worths
from antgym.errors import ParameterError, nearest
from antgym.maps.features import Feature
from antgym.maps.occupancy import picture_shape
from antgym.maps.suites import SPLITS, SuiteItem
from antgym.planners.colony import Colony, Plans
from antgym.planners.parameters import ColonyParameters
from antgym.tuning.features import TASK_FEATURES
from antgym.tuning.observation import bounds, observe
from antgym.tuning.problem import TRIAL, Request, TuningProblem, run_together
from antgym.tuning.session import Session, evaluate_together

OBSERVATIONS = ("features", "map", "map2d", "map3d")
Observation = NDArray[np.float32] | dict[str, NDArray[np.float32]]
Step = tuple[Observation, float, bool, bool, dict[str, Any]]


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
        checked = None if effort is None else checked_effort(effort, self.least_iterations)
        self._problems = load_problems(find_items(suite, split), checked, self.least_iterations)
        self._reward = reward
        self.render_mode = render_mode
        dimension = len(ColonyParameters._fields)
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (dimension,), np.float32)
        features = gymnasium.spaces.Box(*self._bounds(), dtype=np.float32)
        self._flat_map = {"features": None, "map": self._problems.flat, "map2d": True, "map3d": False}[
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
        shown, told = begin_together([self], [seed], options)
        return next(iterate(self.observation_space, shown)), row(told, 0)

    def step(self, action: NDArray[np.float32]) -> Step:
        """Pay for one setting and judge it."""
        shown, (reward,), (over,), told = step_together([self], [action])
        return next(iterate(self.observation_space, shown)), reward, over, False, row(told, 0)

    @property
    def over(self) -> bool:
        """Whether the episode has ended."""
        return self.session.left == 0

    @staticmethod
    def spend(requests: Sequence[tuple[Session, NDArray[np.float64]]]) -> Sequence[Any]:
        """Let the planner run what several environments of this regime ask of it, in one call."""
        return evaluate_together(requests)

    @abstractmethod
    def judge(self, outcome: Any) -> Request | None:
        """Return the fresh, uncharged runs that the reward of what was spent needs, or None."""

    @abstractmethod
    def conclude(self, outcome: Any, fresh: Plans | None) -> Verdict:
        """Return what the step came to."""

    def pay_out(self, worth: float) -> float:
        """Return the reward of a verdict of some worth, see :func:`antgym.envs.verdicts.worths`."""
        return worth

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

    def _next(self, seed: int | None) -> tuple[int, int]:
        """Return root and index of the episode that a reset with this seed begins."""
        if seed is None and self._root is not None:
            return self._root, self._episode + 1
        super().reset(seed=seed)
        return int(self.np_random.integers(2**63)) if seed is None else seed, 0

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

    def _bounds(self) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Return (low, high) of the vector shown."""
        return bounds(len(ColonyParameters._fields), window=self._window)

    def _vector(self) -> NDArray[np.float32]:
        """Return the vector to show, not to be written to."""
        task = self.session.task
        return observe(task, self.session.trials, window=self._window) if self._window else task.features


def begin_together(
    envs: Sequence[TuningEnv], seeds: Sequence[int | None], options: Mapping[str, Any] | None = None
) -> tuple[Observation, Columns]:
    """Begin an episode in environments of one kind; return what they show, one below the other, and infos.

    Args:
        envs: those to reset, at least one.
        seeds: root seeds, see :meth:`TuningEnv.reset`.
        options: of the reset, for all of them.
    """
    problems = envs[0]._problems
    picked = _picked(options, len(problems))
    episodes = [env._next(seed) for env, seed in zip(envs, seeds, strict=True)]
    drawn = problems.draw(*zip(*episodes, strict=True))
    for env, (root, episode), (index, seed) in zip(envs, episodes, drawn, strict=True):
        env._session = env._begin(problems.at(index if picked is None else picked, seed))
        env._root, env._episode = root, episode
    return observed(envs), facts([env.session.problem for env in envs])


def step_together(
    envs: Sequence[TuningEnv], actions: Sequence[ArrayLike] | NDArray[np.float32]
) -> tuple[Observation, list[float], list[bool], Columns]:
    """Step environments of one kind: what they ask is one planner call, what judging them needs another.

    Args:
        envs: at least one, none of them over.
        actions: one each.

    Returns:
        What they show, one below the other, rewards, whether episodes ended, and infos.

    Raises:
        ParameterError: on an action that is none, or where an episode is over (nothing is paid).
    """
    units = _units(envs, actions)
    outcomes = envs[0].spend([(env.session, unit) for env, unit in zip(envs, units, strict=True)])
    requests = [env.judge(outcome) for env, outcome in zip(envs, outcomes, strict=True)]
    fresh = iter(run_together([request for request in requests if request is not None]))
    plans = [None if request is None else next(fresh) for request in requests]
    verdicts = [env.conclude(*each) for env, *each in zip(envs, outcomes, plans, strict=True)]
    problems = [env.session.problem for env in envs]
    told = judged(problems, verdicts)
    worth = worths(envs[0]._reward, problems, verdicts, told).tolist()
    rewards = [env.pay_out(each) for env, each in zip(envs, worth, strict=True)]
    return observed(envs), rewards, [env.over for env in envs], told


def observed(envs: Sequence[TuningEnv]) -> Observation:
    """Return the observations of environments of one kind, one below the other, in arrays of its own."""
    vectors = [env._vector() for env in envs]
    features = np.concatenate(vectors).reshape(len(vectors), -1)
    flat = envs[0]._flat_map
    if flat is None:
        return features
    return {"features": features, "map": np.stack([env.session.task.map(flat) for env in envs])}


def _picked(options: Mapping[str, Any] | None, count: int) -> int | None:
    """Return the index of the scenario that the options of a reset pick, None where they leave it to the draw."""
    for name in options or ():
        if name != "scenario":
            raise ParameterError(f"unknown reset option {name!r}; valid: scenario")
    if not options:
        return None
    chosen = options["scenario"]
    if not isinstance(chosen, Integral) or not 0 <= int(chosen) < count:
        raise ParameterError(f"scenario {chosen!r}: this split holds 0 to {count - 1}")
    return int(chosen)


def _units(
    envs: Sequence[TuningEnv], actions: Sequence[ArrayLike] | NDArray[np.float32]
) -> NDArray[np.float64]:
    """Return what actions ask of the planner, a (1, d) setting each; charges nothing."""
    if any([env.over for env in envs]):
        raise ParameterError("the episode is over; call reset()")
    space, values = envs[0].action_space, np.asarray(actions, dtype=np.float64)
    fits = values.shape[1:] == space.shape
    if not (fits and (np.abs(values) <= 1).all()):
        bad = values[~(np.abs(values) <= 1).all(axis=1)] if fits else values
        raise ParameterError(f"action {bad[0].tolist()} is no point of {space}")
    return (values[:, None] + 1) / 2


def _with_map(features: gymnasium.spaces.Box, flat: bool | None) -> Any:
    if flat is None:
        return features
    picture = gymnasium.spaces.Box(0.0, 1.0, picture_shape(flat), np.float32)
    return gymnasium.spaces.Dict({"features": features, "map": picture})
