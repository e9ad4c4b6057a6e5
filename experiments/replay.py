"""Replay: what settings cost on train maps, as what an off-policy algorithm replays before it plays any episode.

An episode of OneShot is one step, so that a table of trials is a set of whole episodes: what is seen of a map, the
setting, and the reward that the environment would have paid. Two trainings, or an agent and a training, may share the
table; each is charged all of it.
"""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from agents.experience import Experience
from antgym.errors import ParameterError
from antgym.maps.suites import load_suite
from antgym.tuning.problem import COST_CAP, GAP_CAP
from experiments.learners import Learner

PLAIN = {"observation": "features", "reward": "gap", "split": "train"}
"""Arguments of an environment whose episodes a table holds; of other efforts, it says nothing."""


class Replayed:
    """The trials of a table on its first maps, as many as the evaluations of a training pay for.

    Args:
        path: an experience, as ``experiments.artefacts experience`` makes it.
        learner: what is trained.
        evaluations: planner runs that the table may have cost.

    Attributes:
        trials: how many there are.
        steps: gradient steps on them, in the whole training.

    Raises:
        ParameterError: where the algorithm replays nothing, the regime or the reward is another, or the table is of
            another suite or version, or a single map of it dearer than what may be paid.
    """

    def __init__(self, path: Path, learner: Learner, evaluations: int) -> None:
        self.steps = int(learner.settings.get("table_steps", 0))
        self._scale = float(learner.settings.get("reward_scale", 1.0))
        given = {name: value for name, value in learner.kwargs.items() if name != "suite"}
        plain = given.items() <= PLAIN.items()
        if learner.entry.regime != "OneShot" or learner.how != "setting" or not plain or not self.steps:
            raise ParameterError(
                f"--experience: {learner.algorithm} on {learner.env} replays no table; what does: algorithms with "
                "table_steps in their settings, in OneShot, with --action setting, and of the environment's arguments "
                f"only suite and {PLAIN}"
            )
        self._table = table = Experience.load(path)
        self._runs = len(table.units) * len(table.costs[0][0])
        self._maps = min(len(table.names), evaluations // self._runs)
        if not self._maps:
            raise ParameterError(
                f"--experience: {evaluations} evaluations pay for no map of {path}, each took {self._runs}"
            )
        self.trials = self._maps * self._runs
        self._optima = self._lengths(path, learner)

    def _lengths(self, path: Path, learner: Learner) -> NDArray[np.float64]:
        """Return the optimum of every map in straight lines, (n,)."""
        items = {item.name: item.scenario for item in load_suite(learner.suite, "train")}
        try:
            scenarios = [items[name] for name in self._table.names[: self._maps]]
        except KeyError as error:
            raise ParameterError(
                f"{path}: {error} is no train map of what {learner.env} draws from"
            ) from None
        return np.array([scenario.optimum / scenario.straight_line for scenario in scenarios])

    def fill(self, model: Any) -> None:
        """Put all trials into what a model replays, in whole rows of its slots; those of the last row are left out."""
        table, buffer = self._table, model.replay_buffer
        settings, repeats = len(table.units), len(table.costs[0][0])
        shown = np.array(table.features[: self._maps], np.float32)
        if shown.shape[1:] != model.observation_space.shape:
            raise ParameterError(
                f"the experience has {shown.shape[1]} features a map, what is trained sees "
                f"{model.observation_space.shape[0]}: it was gathered by another version; gather it anew"
            )
        low, high = model.action_space.low, model.action_space.high
        taken = model.policy.scale_action(low + np.array(table.units) * (high - low))
        rows: tuple[NDArray[Any], ...] = (
            np.repeat(shown, settings * repeats, axis=0),
            np.tile(np.repeat(taken, repeats, axis=0), (self._maps, 1)),
            -self._scale * self.gaps.reshape(-1),
        )
        count = self.trials // buffer.n_envs
        held: tuple[NDArray[Any], ...] = (buffer.observations, buffer.actions, buffer.rewards)
        for kept, values in zip(held, rows, strict=True):
            kept[:count] = values[: count * buffer.n_envs].reshape(kept[:count].shape)
        buffer.next_observations[:count] = buffer.observations[:count]  # nothing follows the one step
        buffer.dones[:count] = 1
        buffer.pos = count % buffer.buffer_size
        buffer.full = count == buffer.buffer_size
        model.learning_starts = 0  # nothing has to be tried at random any more

    @property
    def gaps(self) -> NDArray[np.float64]:
        """The gap of every trial, (n, settings, repeats), as the environment would have found it."""
        costs = np.array(self._table.costs[: self._maps])
        gaps = np.minimum(costs / self._optima[:, None, None] - 1, GAP_CAP)
        return np.where(costs >= COST_CAP, GAP_CAP, gaps)

    def learn(self, model: Any, leg: int, legs: int) -> None:
        """Make a leg's share of the gradient steps on what a model replays."""
        share = self.steps * leg // legs - self.steps * (leg - 1) // legs
        if share:
            model.train(share, model.batch_size)
