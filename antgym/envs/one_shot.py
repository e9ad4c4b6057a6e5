"""OneShot: a contextual bandit; one choice, one planner run."""

import numpy as np
from numpy.typing import NDArray

from antgym.envs.base import TuningEnv
from antgym.envs.episodes import PaidEpisodes, Rows
from antgym.envs.manual import documented
from antgym.envs.verdicts import Verdicts
from antgym.tuning.problem import FRESH


class OneShotEpisodes(PaidEpisodes):
    """One trial each, judged by its own length."""

    def spend(self, rows: Rows, units: NDArray[np.float64]) -> Verdicts:
        """Run the settings; and the published default, where the reward compares with it."""
        ran = self._sessions.evaluate(rows, units)
        self.planner_runs[rows] += 1
        if self.terms.reward != "improvement":
            return Verdicts(ran.naturals, ran.lengths)
        fresh = self._sessions.run(rows, np.full_like(units, 0.5), FRESH, np.zeros_like(rows))
        self.planner_runs[rows] += 1
        return Verdicts(ran.naturals, ran.lengths, fresh.lengths)


@documented
class OneShotEnv(TuningEnv):
    """Choose the parameters of an ant colony, or of a hive of bees, once, for a map that it has not seen yet.

    ## Description
    A scenario of the suite is drawn: a world, a start, a goal, the rules of a colony, and an effort (ants and
    iterations). The agent sees features of it and picks (α, β, ρ, Q); the colony runs once; the reward is how close
    its path comes to the exact optimum. In `Bee` and `TabuBee` a hive flies among discs, and the agent picks (limit,
    ξ_max, ξ_min), and the tabu radius where there is a tabu list; ants are bees then, and iterations cycles. In `Fleet`
    a scenario is three robots that share a home: one setting plans all of them, again where they would meet, and they
    keep apart by waits. It is hard because the best setting depends on the map, on the effort and on the rules, and
    because a run is noisy.

    One world of the catalogue is one suite:

    {worlds}

    The flat families, `rooms`, `mazes`, `clutter` and `warehouse`, are walked from cell to cell, to eight neighbours;
    the others are cubes, walked layer by layer, in which a blind valley kills an ant; `corridors`, `wu2018` and
    `scatter` are discs in the plane. The split `ood` holds larger worlds, other families and windows of real terrain.

    ## Action Space
    `Box(-1, 1, (4,), float32)`: α, β, ρ, Q, each from its low end (-1) over the published default of the scenario's
    rules (0) to its high end (1), linear in two pieces on the parameter's own scale. The rules of the scenario say
    which row counts: low < default < high.

    {actions}

    κ = Q / (straight line from start to goal · initial pheromone), the only form in which Q acts.

    Of bees, `Box(-1, 1, (3,), float32)`, or `(4,)` where there is a tabu list; limit is given over sources ·
    dimensions, the radius over the world's width · √dimensions, and a path of 12 way-points has 24 dimensions:

    {bee_actions}

    `info["parameters"]` gives natural values, `encode()` the way back.

    ## Observation Space
    `Box(float32)`: the features of the task, the rules among them; nothing in them depends on the optimum.

    {observations}

    Among discs:

    {disc_observations}

    Of a fleet, the means over its robots; κ counts their mean straight line, and the map marks the ends of all.

    With `observation="map"` a `Dict`: `features` is this vector, `map` a `Box(0, 1, float32)` of the down-sampled
    world, stretched to (3, 16, 16, 16), in suites that are flat throughout to (3, 32, 32): the blocked share of every
    block, then marks of start and goal. `"map3d"` and `"map2d"` ask for one of these shapes; a flat world in 3D is
    its level at every height, as discs are, a voxel world in 2D is seen from above. `antgym.envs.sb3.MapExtractor`
    reads the map by convolutions; the `MultiInputPolicy` of stable-baselines3 alone flattens it.

    ## Rewards
    - `"gap"` (default): −min(gap, 1) in [−1, 0], gap = (L − L*) / L*; a run without a path pays −1.
    - `"length"`: −L in world units; a run without a path pays −10 times the straight line.
    - `"improvement"`: min(gap of the published default, 1) − min(gap, 1) in [−1, 1], the default on a fresh run.

    Of a fleet, L is the sum of what robots travel, and could have travelled at their speeds while they wait; L* the sum
    of their optima, each alone, a bound that not all can reach at once; the straight line the sum of theirs. It is
    unsolved where one robot has no path, or finds no way past others.

    ## Starting State
    Scenario and planner seed are a pure function of (root seed, episode index). `reset(options={{"scenario": i}})`
    picks the i-th scenario of the split.

    ## Episode End
    1. Termination: after one step.
    2. Truncation: never.

    ## Information
    `reset`: `scenario`, `seed`, `ants`, `iterations`, `rules`. `step` adds `length` (10 straight lines where
    unsolved), `optimum`, `gap` (1 where unsolved), `solved`, `parameters`. `env.unwrapped.planner_runs` counts
    every planner run so far; that of a fleet is one.

    ## Arguments
    | name | default | meaning |
    |---|---|---|
    | `suite` | the world's | a suite's name, a folder of map files, or `[antgym.SuiteItem(...), ...]`, see below |
    | `split` | `"train"` | `train`, `validation`, `test` or `ood`; scenarios of your own have none |
    | `effort` | `None` | `[ants, iterations]` for every scenario instead of its own |
    | `reward` | `"gap"` | see above |
    | `observation` | `"features"` | or `"map"`, `"map2d"`, `"map3d"`, see above |
    | `render_mode` | `None` | `"ansi"` or `"rgb_array"` |

    ```python
    import gymnasium, antgym
    env = gymnasium.make("antgym/MountainOneShot-v0", split="test", effort=[10, 20])
    ```

    `antgym.SuiteItem(name, scenario, ants=20, iterations=50, rules="liu2020")` is one scenario of your own. All other
    arguments are JSON; an environment of your own scenarios has a spec that cannot be written as JSON.

    ## Vectorized
    `gymnasium.make_vec(id, num_envs=n)` makes the planner runs of all slots in one threaded call; slot i repeats, to
    the bit, this environment reset with `antgym.env_seeds(seed, n)[i]`. `autoreset_mode` is `"SameStep"` by default: a
    step shows the next episode, and `infos["final_obs"]` and `infos["final_info"]` hold the one that ended. With
    `"NextStep"`, for which Gymnasium's vector wrappers are written, every other step pays 0 and only begins anew; with
    `"Disabled"` slots that are over wait for `reset(options={{"reset_mask": mask}})`.

    ## Version History
    * v0: first release (not frozen yet)

    ## References
    The docstrings of `antgym.planners.rules` and `antgym.planners.bee_rules` name paper and equations of every rule.
    """

    regime = "OneShot"
    _kind = OneShotEpisodes
