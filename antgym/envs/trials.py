"""Trials: a budget of paid planner runs on one scenario."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from antgym.envs.base import TuningEnv
from antgym.envs.manual import documented
from antgym.envs.verdicts import Verdict
from antgym.errors import BudgetError, is_count
from antgym.maps.suites import SuiteItem
from antgym.planners.colony import Plans
from antgym.tuning.problem import FRESH, Request
from antgym.tuning.session import Trial, incumbent


@documented
class TrialsEnv(TuningEnv):
    """Tune an ant colony on one map, one planner run at a time.

    ## Description
    A scenario is drawn as in OneShot and stays for the whole episode. Every step pays for one run of a setting and
    shows its noisy cost; proposing a setting again measures it again. After each step the harness runs the
    incumbent (lowest mean cost so far) once more on a fresh seed, and that run pays the reward: what counts is how
    good the incumbent is, not how lucky a trial was.

    ## Action Space
    `Box(-1, 1, (4,), float32)`: α, β, ρ, Q as in OneShot; 0 is the published default of the scenario's rules. The
    rules of the scenario say which row counts: low < default < high.

    {actions}

    κ = Q / (straight line from start to goal · initial pheromone).

    ## Observation Space
    `Box(float32)`: the features of the task, then the share of the budget left, the incumbent's setting and mean
    cost, and for each of the last `window` trials its setting, its cost and a 1 (zeros where there is none yet).
    Costs are length / straight line, shown as log10, clipped to [0, 1]; settings in [0, 1].

    {observations}

    With `observation="map"` a `Dict` of this vector, `features`, and the down-sampled world, `map`, as in OneShot.

    ## Rewards
    Each step pays 1/budget of what OneShot would pay for a fresh run of the incumbent, so that with
    `reward="gap"` the return lies in [−1, 0]. With `"improvement"` the default's fresh run is drawn anew each step.

    ## Starting State
    As in OneShot.

    ## Episode End
    1. Termination: when the budget is spent (it is part of the observation).
    2. Truncation: never.

    ## Information
    As in OneShot; `length`, `gap`, `solved` and `parameters` are those of the incumbent's fresh run, `cost` is the
    trial's own. Fresh runs count in `env.unwrapped.planner_runs`.

    ## Arguments
    As in OneShot, and
    | name | default | meaning |
    |---|---|---|
    | `budget` | `10` | trials per episode |
    | `window` | `5` | trials shown |

    ```python
    import gymnasium, antgym
    env = gymnasium.make("antgym/MountainTrials-v0", budget=20)
    ```

    ## Vectorized
    `gymnasium.make_vec(id, num_envs=n)` makes the trials of all slots in one threaded call and judges them in another.
    `autoreset_mode` is `"NextStep"` by default: the step after an episode's end pays 0 and begins the next one.
    `"SameStep"` and `"Disabled"` as in OneShot.

    ## Version History
    * v0: first release (not frozen yet)

    ## References
    As in OneShot.
    """

    arguments = (*TuningEnv.arguments, "budget", "window")

    def __init__(
        self, suite: str | Sequence[SuiteItem], *, budget: int = 10, window: int = 5, **others: Any
    ) -> None:
        for name, value in (("budget", budget), ("window", window)):
            if not is_count(value):
                raise BudgetError(f"{name} = {value!r}: needs a whole number of trials, at least one")
        self._budget, self._window = int(budget), int(window)
        super().__init__(suite, **others)

    def judge(self, outcome: tuple[Trial, ...]) -> Request | None:  # noqa: ARG002 - the incumbent is all that counts
        """A fresh run of the incumbent, and of the default where the reward compares with it."""
        unit, _ = incumbent(self.session.trials)
        units = [unit, (0.5,) * len(unit)] if self._reward == "improvement" else [unit]
        return self.session.problem, np.array(units), FRESH, 2 * (len(self.session.trials) - 1)

    def conclude(self, outcome: tuple[Trial, ...], fresh: Plans | None) -> Verdict:
        """Show the incumbent's fresh run."""
        assert fresh is not None
        self.planner_runs += 1 + len(fresh)
        unit, _ = incumbent(self.session.trials)
        default = float(fresh.lengths[1]) if len(fresh) > 1 else None
        return Verdict(unit, float(fresh.lengths[0]), default, {"cost": outcome[-1].cost})

    def pay_out(self, worth: float) -> float:
        """Each step pays its share of the episode."""
        return worth / self.session.task.budget
