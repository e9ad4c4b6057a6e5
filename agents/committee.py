"""A committee: several published policies of OneShot, and the mean of what they recommend.

Trainings that differ in their seed alone err on different maps; the mean of their settings errs less than any of them.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from agents.choosing import Committee
from agents.policy import PolicyAgent, shipped
from agents.published import beside, stem_of
from agents.shipped import find_policy
from antgym.errors import ParameterError
from antgym.tuning import Task

Floats = NDArray[np.float64]
FLAGSHIP = "open-committee"


class CommitteeAgent:
    """Recommend the mean of what published policies of OneShot recommend, without a trial.

    Args:
        path: the committee's file, or the name of one that is shipped; by default the shipped one.

    Raises:
        ParameterError: where a file is missing or damaged, or a member is no policy of OneShot.
    """

    def __init__(self, path: str | Path | None = None) -> None:
        self.path = beside(stem_of(shipped(FLAGSHIP) if path is None else find_policy(path)), ".json")
        self._members = seated(self.path, Committee.seats(self.path))

    def reset(self, task: Task, *, seed: int) -> None:
        """Show the task to every member; ParameterError where one was trained on another observation."""
        for member in self._members:
            member.reset(task, seed=seed)

    def ask(self) -> Floats:
        """Return no setting, (0, d): nothing is tried."""
        return self._members[0].ask()

    def tell(self, trials: object) -> None:
        """Nothing is learnt from trials."""

    def recommend(self) -> Floats:
        """Return the mean setting, (d,)."""
        return np.asarray(np.mean([member.recommend() for member in self._members], axis=0), dtype=np.float64)


def seated(path: Path, members: Sequence[Path]) -> list[PolicyAgent]:
    """Return the policies that sit on the committee of a file, which need not be there yet.

    Raises:
        ParameterError: where one is missing, damaged or no policy of OneShot.
    """
    found = [PolicyAgent(member) for member in members]
    for member in found:
        if member.card.regime != "OneShot":
            raise ParameterError(
                f"{path}: {member.path.name} is a policy of {member.card.regime}, not OneShot"
            )
    return found
