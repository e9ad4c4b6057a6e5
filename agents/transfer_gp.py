"""A Gaussian process that train maps have taught, corrected by every run on the target."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from agents.belief import Belief
from agents.experience import Experience, as_experience
from agents.multitask import MultitaskModel
from antgym.errors import ParameterError
from antgym.tuning import Task, Trial

Floats = NDArray[np.float64]
TAU = 0.03
"""Without a trial, on 50 validation maps of mountain-v0 and 100 of open-v0, the blend's gap was 27.8 and 31.0 % with
0.02, 25.5 and 32.0 % with 0.05; that of the best setting of the table 28.9 and 31.1 %."""


class TransferGP:
    """Bayesian optimisation with a prior from train maps (:class:`agents.multitask.MultitaskModel`).

    Candidates are the settings of the experience and, before them, their blend: the mean on each parameter's own scale,
    weighted by exp(-(μ - min μ) / tau) with μ the expected log regret. (More candidates between them were no better.)
    Without a trial the blend is recommended; each trial goes where it tells most about which candidate is best
    (:meth:`agents.belief.Belief.most_telling`), and the candidate of the lowest expected regret is recommended.

    Args:
        experience: costs on train maps, or their file; fitting to 400 maps takes some seconds.
        tau: log cost by which a setting's weight in the blend falls to 1/e, > 0.
    """

    def __init__(self, experience: Experience | str | Path, tau: float = TAU) -> None:
        if not tau > 0:
            raise ParameterError(f"tau = {tau}: must be positive")
        self.experience, self.tau = as_experience(experience), tau
        self.model = MultitaskModel(self.experience)

    def reset(self, task: Task, *, seed: int) -> None:  # noqa: ARG002 - nothing here is random
        """Take on a task; ParameterError where it does not fit the experience."""
        settings = self.experience.settings
        expected = self.model.expect(task, settings)
        shares = np.exp(-(expected - expected.min()) / self.tau)
        blend = task.space.mean(settings, shares / shares.sum())
        self._candidates = np.vstack([blend, settings])
        self._belief = Belief(self.model.predict(task, self._candidates))
        self._left, self._tried = task.budget, False

    def ask(self) -> Floats:
        """Return the most telling candidate, (1, d); (0, d) where the budget is spent."""
        self._asked = [self._belief.most_telling()] if self._left else []
        return self._candidates[self._asked].reshape(-1, self._candidates.shape[1])

    def tell(self, trials: Sequence[Trial]) -> None:
        """Correct the belief by the cost of the last ask's candidate."""
        self._belief.observe([(i, trial.cost) for i, trial in zip(self._asked, trials, strict=False)])
        self._left -= len(trials)
        self._tried = True

    def recommend(self) -> Floats:
        """Return the (d,) candidate of the lowest expected regret; before any trial the blend."""
        return self._candidates[self._belief.best() if self._tried else 0].copy()
