"""The course of a training: legs in which a model learns, each followed by a look at the validation maps."""

import math
import time
from dataclasses import dataclass, replace
from typing import Any

from antgym.console import Advance
from antgym.tuning.seeding import child_states
from experiments import curves
from experiments.checkpoints import Standing
from experiments.replay import Replayed
from experiments.validation import Validation

LEGS = 10
SEED_LIMIT = 1 << 32  # of NumPy's old generator, which stable-baselines3 seeds
_LEG = 11  # seed domain


@dataclass(frozen=True)
class Course:
    """A training under way.

    Attributes:
        model: that learns.
        validation: what it is judged on.
        table: of trials that it learns from before any episode; None for none.
        seed: root seed of the training.
        whole: steps of all slots after which it is over.
    """

    model: Any
    validation: Validation
    table: Replayed | None
    seed: int
    whole: int

    def walk(self, leg: int, until: int, before: Standing, advance: Advance) -> Standing:
        """Train a leg, up to so many steps of all slots, and validate; return how the training stands then."""
        begun = time.perf_counter()
        evaluations = self._learn(leg, until, before.evaluations, advance)
        seconds = before.seconds + time.perf_counter() - begun
        return self.judge(replace(before, leg=leg, evaluations=evaluations, seconds=seconds))

    def judge(self, standing: Standing) -> Standing:
        """Return how the training stands once its model has played the validation maps."""
        begun, before = time.perf_counter(), self.validation.runs
        gap = self.validation.gap(self.model)
        judged = replace(
            standing,
            seconds=round(standing.seconds + time.perf_counter() - begun, 1),
            validation_runs=standing.validation_runs + self.validation.runs - before,
            history=[*standing.history, [standing.evaluations, round(gap, 6)]],
            best=standing.leg if standing.lowest is None or gap < standing.lowest else standing.best,
        )
        curves.draw(self.model, judged)
        return judged

    def _learn(self, leg: int, until: int, spent: int, advance: Advance) -> int:
        """Let the model learn a leg, from the table first where there is one; return what is spent by then."""
        model = self.model
        native = model.get_env().unwrapped.native
        shown = native.planner_runs

        def after_step(*_: Any) -> bool:
            nonlocal shown, spent
            advance(more := int(native.planner_runs - shown))
            shown, spent = native.planner_runs, spent + more
            model.logger.record(curves.RUNS, spent)
            model._total_timesteps = self.whole  # schedules, as of DQN's exploration, go over all legs
            return True

        model.set_random_seed(int(child_states([self.seed], [(_LEG, leg)])[0, 0]) % SEED_LIMIT)
        model._last_obs = None  # so that learning begins new episodes, resumed or not
        if self.table:
            charged = self.table.trials if leg == 1 else 0
            advance(charged)
            spent += charged
            self.table.learn(model, leg, LEGS)
        if until > model.num_timesteps:
            model.learn(until - model.num_timesteps, after_step, reset_num_timesteps=False)
        return spent


def unit_of(model: Any, episode: int) -> int:
    """Return the fewest steps of all slots that are whole updates of the networks and whole episodes of a length."""
    if hasattr(model, "n_delta"):  # ARS: every candidate plays whole episodes, in one slot
        return int(2 * model.n_delta * model.n_eval_episodes * episode)
    if hasattr(model, "train_freq"):
        return math.lcm(getattr(model.train_freq, "frequency", model.train_freq), episode) * int(model.n_envs)
    return math.lcm(model.n_steps, episode) * int(model.n_envs)
