"""Control: one planner run, its parameters set anew block by block."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antgym.envs.base import TuningEnv
from antgym.envs.draws import Problems
from antgym.envs.episodes import Episodes, Rows, Terms
from antgym.envs.manual import documented
from antgym.envs.verdicts import Verdicts
from antgym.errors import ParameterError
from antgym.maps.suites import SuiteItem
from antgym.planners.swarms import Swarm
from antgym.tuning.features import feature_bounds
from antgym.tuning.open_trial import OpenTrial
from antgym.tuning.problem import FRESH, TuningProblem, run_together
from antgym.tuning.run_features import (
    CONTROL_FEATURES,
    DEFAULT,
    DISC_CONTROL_FEATURES,
    control_table,
    observe_run,
)
from antgym.tuning.session import Session, steer_together

BLOCKS = 10
LEAST_ITERATIONS = 40  # four a block: fewer and a block is noise


class ControlEpisodes(Episodes):
    """One run each, walked block by block; runs are objects, for each has a colony or a hive of its own."""

    def __init__(self, count: int, terms: Terms) -> None:
        super().__init__(count, terms)
        self._opened: list[Any] = [None] * count  # sessions with a run each; None before the first
        self._potentials = np.zeros(count)

    def trial(self, row: int) -> OpenTrial:
        """Return the run of an episode."""
        trial: OpenTrial = self._opened[row].opened
        return trial

    def spend(self, rows: Rows, units: NDArray[np.float64]) -> Verdicts:
        """Walk a block of every run in one planner call, and show the shortest paths so far."""
        sessions = [self._opened[i] for i in rows.tolist()]
        trials = steer_together(list(zip(sessions, units, strict=True)))
        blocks = np.array([len(trial.units) for trial in trials])
        self.planner_runs[rows] += blocks == 1
        return Verdicts(
            np.array([trial.parameters for trial in trials]),
            np.array([trial.length for trial in trials]),
            self._defaults(rows) if self.terms.reward == "improvement" else None,
            {"block": blocks},
        )

    def pay_out(self, rows: Rows, worth: NDArray[np.float64]) -> NDArray[np.float64]:
        """Pay for what the block gained."""
        gained = worth - self._potentials[rows]
        self._potentials[rows] = worth
        return gained

    def over(self, rows: Rows) -> NDArray[np.bool_]:
        """Return which runs have ended."""
        return np.array([self.trial(i).over for i in rows.tolist()])

    def session(self, row: int) -> Session:
        """Return the session of an episode."""
        session: Session = self._opened[row]
        return session

    def walked(self, row: int) -> Swarm | None:
        """Return the colony or hive of the run, None before its first block."""
        return self.trial(row).colony if self.trial(row).units else None

    def _defaults(self, rows: Rows) -> NDArray[np.float64]:
        """Return what the published default comes to where runs have ended, nan elsewhere."""
        lengths, ended = np.full(len(rows), np.nan), np.flatnonzero(self.over(rows))
        problems = [self._opened[i].problem for i in rows[ended].tolist()]
        fresh = run_together([(p, np.full((1, len(p.space)), DEFAULT), FRESH, 0) for p in problems])
        lengths[ended] = [plans.lengths[0] for plans in fresh]
        self.planner_runs[rows[ended]] += 1
        return lengths

    def _open(self, rows: Rows, problems: list[TuningProblem], seeds: NDArray[np.int64]) -> None:
        for row, problem, seed in zip(rows.tolist(), problems, seeds.tolist(), strict=True):
            before = self._opened[row]
            buffers = None if before is None else before.opened.colony.release()
            session = Session(problem.seeded(seed), self.terms.budget)
            session.open(BLOCKS, buffers)
            self._opened[row] = session
        self._potentials[rows] = 0.0

    def _vectors(self, rows: Rows) -> NDArray[np.float32]:
        sessions = [self._opened[i] for i in rows.tolist()]
        return np.stack([observe_run(session.task, session.opened) for session in sessions])


@documented
class ControlEnv(TuningEnv):
    """Steer an ant colony, or a hive of bees, while it searches: ten times in one run its parameters may change.

    ## Description
    A scenario is drawn as in OneShot, and one run of T ≥ 40 iterations begins on it. Every step sets (α, β, ρ, Q) and
    walks a tenth of the iterations; pheromone is carried on. Early on it pays to explore, later to exploit what was
    found, and when to turn shows in the run itself: whether ants arrive, whether they still differ, how long nothing
    got better. It is hard because gains are small beside the noise of a run, and because a good constant setting is
    not easily beaten: the same action throughout gives OneShot's run of that action, path for path.

    ## Action Space
    `Box(-1, 1, (4,), float32)`: α, β, ρ, Q as in OneShot, for the next block.

    {actions}

    Q's range is κ = Q / straight line from start to goal, shown for a straight line of 1. Of bees, as in OneShot:

    {bee_actions}

    Under stable-baselines3 `antgym.envs.sb3.ChangingVecEnv` makes the actions factorised changes of the last block's
    setting: per parameter −1/4, −1/8, 0, 1/8 or 1/4 of its range, which is about /4, /2, keep, ·2, ·4 for α and β.

    ## Observation Space
    `Box(float32)`: the features of the task, then the state of the run, then the setting of the last block; nothing in
    them depends on the optimum. Before the first block the run shows what an untouched one would.

    {observations}

    Among discs, the radius being there only where there is a tabu list:

    {disc_observations}

    `branching` and `distinct` look at the first 32 ants of an iteration, `distinct` at the first 32 sources. With
    `observation="map"` a `Dict` of this vector, `features`, and the down-sampled world, `map`, as in OneShot.

    ## Rewards
    The change of a potential Φ, so that they add up to what OneShot pays for a run of that length:
    - `"gap"` (default): Φ = −min(gap, 1) of the shortest path so far, −1 before any; the first step pays Φ itself, in
      [−1, 0], every other one the rise of Φ, in [0, 1]; where bees are to keep a distance from the discs, their path
      may get longer while it gets better, and Φ fall a little.
    - `"length"`: likewise with Φ = −L in world units, −10 times the straight line before any path.
    - `"improvement"`: as `"gap"`, and the last step pays min(gap of the published default, 1) on top, the default on
      a fresh run of all T iterations.

    ## Starting State
    As in OneShot; the planner's seed is that of OneShot's run in the same episode of the same root seed.

    ## Episode End
    1. Termination: after ten steps.
    2. Truncation: never.

    ## Information
    As in OneShot, after every step: `length`, `gap` and `solved` are those of the shortest path so far, `parameters`
    those of the block; `block` counts from 1. A run counts in `env.unwrapped.planner_runs` from its first block on.

    ## Arguments
    As in OneShot; a run has T = max(40, the scenario's own) iterations, those of `effort` where it is given, which
    must be 40 or more. Blocks are T // 10 or one iteration longer.

    ```python
    import gymnasium, antgym
    env = gymnasium.make("antgym/MountainControl-v0", effort=[20, 100])
    ```

    ## Vectorized
    `gymnasium.make_vec` walks the blocks of all slots in one threaded call. Each slot keeps the memory that the
    largest of its runs has touched, and uses it again: about 1 kB per visited cell, some MB. `autoreset_mode` is
    `"NextStep"` by default, as in Trials.

    ## Version History
    * v0: first release (not frozen yet)

    ## References
    liu2020, as in OneShot. Adriaensen et al. 2022: dynamic algorithm configuration.
    """

    features, disc_features = CONTROL_FEATURES, DISC_CONTROL_FEATURES
    least_iterations = LEAST_ITERATIONS
    regime = "Control"
    _kind = ControlEpisodes
    _episodes: ControlEpisodes

    def __init__(self, suite: str | Sequence[SuiteItem], **others: Any) -> None:
        super().__init__(suite, **others)
        if self._terms.problems.fleets:
            raise ParameterError(
                "Control steers one run, and a fleet's robots are planned one after another; take OneShot or Trials"
            )

    @property
    def trial(self) -> OpenTrial:
        """The run of the current episode; ParameterError before the first reset."""
        self._episodes.require_begun(self._rows)
        return self._episodes.trial(self._row)

    def _bounds(self, problems: Problems) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        return feature_bounds(control_table(problems.discs, problems.names))
