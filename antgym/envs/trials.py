"""Trials: a budget of paid planner runs on one scenario."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antgym.envs.base import TuningEnv
from antgym.envs.episodes import PaidEpisodes, Rows
from antgym.envs.manual import documented
from antgym.envs.verdicts import Verdicts
from antgym.errors import BudgetError, is_count
from antgym.maps.suites import SuiteItem
from antgym.tuning.problem import FRESH


class TrialsEpisodes(PaidEpisodes):
    """A budget of trials each, judged after every one by a fresh run of the incumbent."""

    def spend(self, rows: Rows, units: NDArray[np.float64]) -> Verdicts:
        """Run the settings, then the incumbents; and the default, where the reward compares with it."""
        sessions, count = self._sessions, len(rows)
        ran = sessions.evaluate(rows, units)
        self.planner_runs[rows] += 1
        wanted, first = sessions.best["unit"][rows], 2 * (sessions.made[rows] - 1)
        cost = {"cost": ran.costs}
        if self.terms.reward != "improvement":
            fresh = sessions.run(rows, wanted, FRESH, first)
            self.planner_runs[rows] += 1
            return Verdicts(fresh.naturals, fresh.lengths, None, cost)
        twice, wanted = np.tile(rows, 2), np.concatenate([wanted, np.full_like(wanted, 0.5)])
        fresh = sessions.run(twice, wanted, FRESH, np.concatenate([first, first + 1]))
        self.planner_runs[rows] += 2
        return Verdicts(fresh.naturals[:count], fresh.lengths[:count], fresh.lengths[count:], cost)

    def pay_out(self, rows: Rows, worth: NDArray[np.float64]) -> NDArray[np.float64]:  # noqa: ARG002
        """Each step pays its share of the episode."""
        return worth / self._sessions.total


@documented
class TrialsEnv(TuningEnv):
    """Tune an ant colony, a hive of bees, or the colony that plans a fleet, on one map, one planner run at a time.

    ## Description
    A scenario is drawn as in OneShot and stays for the whole episode. Every step pays for one run of a setting and
    shows its noisy cost; proposing a setting again measures it again. After each step the harness runs the
    incumbent (lowest mean cost so far) once more on a fresh seed, and that run pays the reward: what counts is how
    good the incumbent is, not how lucky a trial was.

    ## Action Space
    `Box(-1, 1, (4,), float32)`: α, β, ρ, Q as in OneShot; 0 is the published default of the scenario's rules. The
    rules of the scenario say which row counts: low < default < high.

    {actions}

    κ = Q / (straight line from start to goal · initial pheromone). Of bees:

    {bee_actions}

    ## Observation Space
    `Box(float32)`: the features of the task, then the share of the budget left, the incumbent's setting and mean
    cost, and for each of the last `window` trials its setting, its cost and a 1 (zeros where there is none yet).
    Costs are length / straight line, shown as log10, clipped to [0, 1]; settings in [0, 1].

    {observations}

    Among discs:

    {disc_observations}

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

    regime = "Trials"
    _kind = TrialsEpisodes
    arguments = (*TuningEnv.arguments, "budget", "window")

    def __init__(
        self, suite: str | Sequence[SuiteItem], *, budget: int = 10, window: int = 5, **others: Any
    ) -> None:
        for name, value in (("budget", budget), ("window", window)):
            if not is_count(value):
                raise BudgetError(f"{name} = {value!r}: needs a whole number of trials, at least one")
        self._budget, self._window = int(budget), int(window)
        super().__init__(suite, **others)
