"""The greedy zero-shot portfolio: settings that together serve all train maps, tried in order on the target."""

from pathlib import Path

from agents.experience import Experience, as_experience
from agents.halving import Advice, Halving
from agents.ordering import greedy_portfolio
from antgym.tuning import Task


class PortfolioAgent(Halving):
    """Try a greedy portfolio of the train maps by successive halving.

    The portfolio is that of the maps under the task's own rules; of all maps, where there are few of them. It looks at
    nothing else of a task: Auto-sklearn 2.0 (Feurer et al. 2022) went without features for the same reason.

    Args:
        experience: costs on train maps, or their file.
    """

    def __init__(self, experience: Experience | str | Path) -> None:
        self.experience = as_experience(experience)

    def _advise(self, task: Task) -> Advice:
        self.experience.check(task)
        regrets = self.experience.regrets[self.experience.akin(task)]
        order = greedy_portfolio(regrets)
        return Advice(self.experience.settings[order], regrets.mean(axis=0)[order], self.experience.spread)
