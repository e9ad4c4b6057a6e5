"""What environments of every regime share: their arguments, spaces and Gymnasium's interface, over their episodes."""

from collections.abc import Mapping, Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector.utils import iterate
from numpy.typing import ArrayLike, NDArray

from antgym.envs.draws import Problems, checked_effort, load_problems
from antgym.envs.episodes import Episodes, Observation, Terms
from antgym.envs.infos import row
from antgym.envs.scenarios import find_items
from antgym.envs.verdicts import REWARDS
from antgym.errors import ParameterError, nearest
from antgym.maps.features import Feature
from antgym.maps.occupancy import picture_shape
from antgym.maps.suites import SPLITS, SuiteItem
from antgym.tuning.actions import settings_of
from antgym.tuning.features import DISC_TASK_FEATURES, TASK_FEATURES, task_table
from antgym.tuning.observation import bounds
from antgym.tuning.session import Session
from antgym.tuning.sessions import Account
from antgym.tuning.shown import Shown, shown_in

OBSERVATIONS = ("features", "map", "map2d", "map3d")
Step = tuple[Observation, float, bool, bool, dict[str, Any]]


class TuningEnv(gymnasium.Env[Observation, NDArray[np.float32]]):
    """Base of the regimes. A step is paid, then judged; a batch does the same for many environments at once.

    Args:
        suite: name of the suite scenarios come from; path of a folder of map files, see :func:`antgym.load_suite`;
            or scenarios of your own, a sequence of ``SuiteItem``.
        split: ``"train"``, ``"validation"``, ``"test"`` or ``"ood"`` of a named suite or a folder.
        effort: (ants, iterations), or (bees, cycles), for every scenario instead of each scenario's own.
        reward: ``"gap"``, ``"length"`` or ``"improvement"``.
        observation: ``"features"``, the vector alone, or with a map beside it: ``"map2d"``, ``"map3d"``, or ``"map"``
            for that of the two which fits the suite: flat where all its worlds are.
        render_mode: ``"ansi"``, ``"rgb_array"`` or None.
        unknown: raises ParameterError naming the nearest valid argument.
    """

    metadata: dict[str, Any] = {"render_modes": ["ansi", "rgb_array"], "render_fps": 1}  # noqa: RUF012
    arguments: tuple[str, ...] = ("suite", "split", "effort", "reward", "observation", "render_mode")
    features: tuple[Feature, ...] = TASK_FEATURES  # the tabulated part of the observation on grids,
    disc_features: tuple[Feature, ...] = DISC_TASK_FEATURES  # and among discs
    regime: str  # OneShot, Trials or Control
    _kind: type[Episodes]  # of its episodes
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
            hint = "the regime Trials has it" if name == "budget" else nearest(name, self.arguments)
            raise ParameterError(f"unknown environment argument {name!r}; {hint}")
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
        items = find_items(suite, split)
        checked = None if effort is None else checked_effort(effort, items, self.least_iterations)
        problems = load_problems(items, checked, self.least_iterations)
        self.render_mode = render_mode
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (len(problems.names),), np.float32)
        features = gymnasium.spaces.Box(*self._bounds(problems), dtype=np.float32)
        flat = {"features": None, "map": problems.flat, "map2d": True, "map3d": False}[observation]
        self.observation_space = _with_map(features, flat)
        self._terms = Terms(problems, reward, flat, self._budget, self._window)
        self.join(self.alike(1), 0)

    @property
    def session(self) -> Session | Account:
        """How the session of the current episode stands; ParameterError before the first reset."""
        self._episodes.require_begun(self._rows)
        return self._episodes.session(self._row)

    def reset(
        self, *, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begin an episode; scenario and planner seeds are a pure function of (root seed, episode index).

        Args:
            seed: root seed; the episode index goes back to 0. Without one, the next episode of the root begins.
            options: ``{"scenario": index}`` picks a scenario of the split instead of drawing it.
        """
        picked = self._episodes.picked(options)
        shown, told = self._episodes.begin(self._rows, [self.root(seed)], picked)
        return next(iterate(self.observation_space, shown)), row(told, 0)

    def step(self, action: NDArray[np.float32]) -> Step:
        """Pay for one setting and judge it."""
        self._episodes.require_open(self._rows)
        shown, rewards, ends, told = self._episodes.step(self._rows, settings(self.action_space, [action]))
        return next(iterate(self.observation_space, shown)), rewards.item(), ends.item(), False, row(told, 0)

    @property
    def over(self) -> bool:
        """Whether the episode has ended."""
        self._episodes.require_begun(self._rows)
        return bool(self._episodes.over(self._rows)[0])

    @property
    def task_features(self) -> tuple[Feature, ...]:
        """The table of the task's features, with which the vectors shown begin."""
        return task_table(self._terms.problems.discs)

    @property
    def shown(self) -> Shown:
        """What the vectors shown hold, which a published policy's card says of whom was trained here."""
        return shown_in(self.regime, self._terms.problems.names, self._window)

    @property
    def planner_runs(self) -> int:
        """Planner runs by this environment so far, fresh ones included."""
        return int(self._episodes.planner_runs[self._row])

    @planner_runs.setter
    def planner_runs(self, count: int) -> None:
        self._episodes.planner_runs[self._row] = count

    def root(self, seed: int | None) -> int | None:
        """Return the root seed that a reset with this seed begins, None where it goes on with its own."""
        if seed is None and self._episodes.roots[self._row] is not None:
            return None
        super().reset(seed=seed)
        return int(self.np_random.integers(2**63)) if seed is None else seed

    def alike(self, count: int) -> Episodes:
        """Return rows for the episodes of ``count`` environments such as this one, none of them begun."""
        return self._kind(count, self._terms)

    def join(self, episodes: Episodes, at: int) -> None:
        """Become a row of the episodes of a batch; an episode of its own is left behind."""
        self._episodes, self._row, self._rows = episodes, at, np.array([at])

    def encode(self, **naturals: float) -> NDArray[np.float32]:
        """Return the action of natural values in the current episode; ParameterError outside their ranges.

        All parameters must be named: ``alpha``, ``beta``, ``rho`` and ``Q`` of ants; ``limit``, ``xi_max``, ``xi_min``
        of bees and, where they keep a tabu list, ``tabu_radius``.
        """
        self._episodes.require_begun(self._rows)
        space = self._episodes.problem(self._row).space
        if set(naturals) != set(space.names):
            raise ParameterError(
                f"encode() takes {', '.join(space.names)}; got {', '.join(naturals) or 'none'}"
            )
        unit = space.encode([naturals[name] for name in space.names])[0]
        return (2 * unit - 1).astype(np.float32)

    def render(self) -> Any:
        """Return the picture of the last run: a string (``ansi``) or an (h, w, 3) uint8 array (``rgb_array``)."""
        if self.render_mode is None:
            raise ParameterError(
                "this environment was made without render_mode; pass 'ansi' or 'rgb_array' to make()"
            )
        from antgym.envs.render import ansi, rgb_array

        self._episodes.require_begun(self._rows)
        problem, swarm = self._episodes.problem(self._row), self._episodes.walked(self._row)
        return (ansi if self.render_mode == "ansi" else rgb_array)(problem, swarm)

    def _bounds(self, problems: Problems) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Return (low, high) of the vector shown."""
        table = task_table(problems.discs)
        return bounds(len(problems.names), window=self._window, features=table)


def settings(space: gymnasium.Space[Any], actions: ArrayLike) -> NDArray[np.float64]:
    """Return what actions ask of the planner, a (d,) setting each; ParameterError on one that is none."""
    try:
        values = np.asarray(actions, dtype=np.float64)
    except (TypeError, ValueError):
        raise ParameterError(f"action {actions!r} is no point of {space}") from None
    fits = values.shape[1:] == space.shape
    if not (fits and (np.abs(values) <= 1).all()):
        bad = values[~(np.abs(values) <= 1).all(axis=1)] if fits else values
        raise ParameterError(f"action {bad[0].tolist()} is no point of {space}")
    return settings_of(values)


def _with_map(features: gymnasium.spaces.Box, flat: bool | None) -> Any:
    if flat is None:
        return features
    picture = gymnasium.spaces.Box(0.0, 1.0, picture_shape(flat), np.float32)
    return gymnasium.spaces.Dict({"features": features, "map": picture})
