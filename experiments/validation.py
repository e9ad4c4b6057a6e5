"""Validation: how a policy in training does on the validation maps, on runs that are no part of its training."""

from typing import Any

import numpy as np

from antgym.errors import ParameterError
from antgym.maps.suites import load_suite
from experiments.learners import Learner

ROOT = 20_101  # of every validation: each checkpoint meets the same maps under the same seeds


class Validation:
    """The first maps of the validation split, one episode each.

    Args:
        learner: what is trained.
        maps: how many, ≥ 1; all where the split has fewer.

    Attributes:
        maps: how many there are.
    """

    def __init__(self, learner: Learner, maps: int) -> None:
        if maps < 1:
            raise ParameterError(f"--validation {maps}: a checkpoint is chosen on one map at least")
        self.maps = min(maps, len(load_suite(learner.suite, "validation")))
        self._envs = learner.envs(self.maps, ROOT, split="validation", reward="gap")

    @property
    def runs(self) -> int:
        """Planner runs so far."""
        return int(self._envs.unwrapped.native.planner_runs)

    def gap(self, model: Any) -> float:
        """Return the mean gap of a model's deterministic policy at the ends of the episodes."""
        self._envs.seed(ROOT)
        self._envs.set_options([{"scenario": i} for i in range(self.maps)])
        seen, state, ends = self._envs.reset(), None, np.ones(self.maps, bool)
        while True:
            actions, state = model.predict(seen, state=state, episode_start=ends, deterministic=True)
            seen, _, ends, infos = self._envs.step(actions)
            if ends.all():  # episodes of a regime are all of one length
                return float(np.mean([info["gap"] for info in infos]))
