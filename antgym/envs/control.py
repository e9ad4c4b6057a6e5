"""Control: one planner run, its parameters set anew block by block."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antgym.envs.base import TuningEnv
from antgym.envs.manual import documented
from antgym.envs.verdicts import Verdict
from antgym.maps.suites import SuiteItem
from antgym.planners.colony import Colony, Plans
from antgym.tuning.features import feature_bounds
from antgym.tuning.open_trial import OpenTrial
from antgym.tuning.problem import FRESH, Request, TuningProblem
from antgym.tuning.run_features import CONTROL_FEATURES, DEFAULT, observe_run
from antgym.tuning.session import Session, steer_together

BLOCKS = 10
LEAST_ITERATIONS = 40  # four a block: fewer and a block is noise


@documented
class ControlEnv(TuningEnv):
    """Steer an ant colony while it searches: ten times in one planner run its parameters may change.

    ## Description
    A scenario is drawn as in OneShot, and one run of T ≥ 40 iterations begins on it. Every step sets (α, β, ρ, Q) and
    walks a tenth of the iterations; pheromone is carried on. Early on it pays to explore, later to exploit what was
    found, and when to turn shows in the run itself: whether ants arrive, whether they still differ, how long nothing
    got better. It is hard because gains are small beside the noise of a run, and because a good constant setting is
    not easily beaten: the same action throughout gives OneShot's run of that action, path for path.

    ## Action Space
    `Box(-1, 1, (4,), float32)`: α, β, ρ, Q as in OneShot, for the next block.

    {actions}

    Q's range is κ = Q / straight line from start to goal, shown for a straight line of 1.

    ## Observation Space
    `Box(float32)`: the features of the task, then the state of the run, then the setting of the last block; nothing in
    them depends on the optimum. Before the first block the run shows what an untouched one would.

    {observations}

    `branching` and `distinct` look at the first 32 ants of an iteration. With `observation="map"` a `Dict` of this
    vector, `features`, and the down-sampled world, `map`, as in OneShot.

    ## Rewards
    The change of a potential Φ, so that they add up to what OneShot pays for a run of that length:
    - `"gap"` (default): Φ = −min(gap, 1) of the shortest path so far, −1 before any; the first step pays Φ itself, in
      [−1, 0], every other one the rise of Φ, in [0, 1].
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

    features = CONTROL_FEATURES
    least_iterations = LEAST_ITERATIONS

    def __init__(self, suite: str | Sequence[SuiteItem], **others: Any) -> None:
        super().__init__(suite, **others)
        self._potential = 0.0

    @property
    def trial(self) -> OpenTrial:
        """The run of the current episode; ParameterError before the first reset."""
        trial = self.session.opened
        assert trial is not None
        return trial

    @property
    def over(self) -> bool:
        """Whether the run has ended."""
        return self.trial.over

    @staticmethod
    def spend(requests: Sequence[tuple[Session, NDArray[np.float64]]]) -> Sequence[OpenTrial]:
        """Walk a block of every run in one planner call."""
        return steer_together(requests)

    def judge(self, outcome: OpenTrial) -> Request | None:
        """At the end a run of the published default, where the reward compares with it."""
        if self._reward != "improvement" or not outcome.over:
            return None
        return self.session.problem, np.full((1, len(outcome.units[0])), DEFAULT), FRESH, 0

    def conclude(self, outcome: OpenTrial, fresh: Plans | None) -> Verdict:
        """Show the shortest path so far."""
        block = len(outcome.units)
        self.planner_runs += int(block == 1) + (0 if fresh is None else len(fresh))
        default = None if fresh is None else float(fresh.lengths[0])
        return Verdict(outcome.units[-1], outcome.length, default, {"block": block}, outcome.parameters)

    def pay_out(self, worth: float) -> float:
        """Pay for what the block gained."""
        before, self._potential = self._potential, worth
        return worth - before

    def _begin(self, problem: TuningProblem) -> Session:
        buffers = None if self._session is None else self.trial.colony.release()
        session = super()._begin(problem)
        session.open(BLOCKS, buffers)
        self._potential = 0.0
        return session

    def _walked(self) -> Colony | None:
        return self.trial.colony if self.trial.units else None

    def _bounds(self) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        return feature_bounds(self.features)

    def _vector(self) -> NDArray[np.float32]:
        return observe_run(self.session.task, self.trial)
