"""A committee: several published policies of OneShot, and the mean of what they recommend.

Trainings that differ in their seed alone err on different maps; the mean of their settings errs less than any of them.
"""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from agents import artefact
from agents.policy import PolicyAgent, shipped
from agents.published import read_card
from antgym.errors import ParameterError
from antgym.tuning import Task

Floats = NDArray[np.float64]
FORMAT = "antgym committee 1"
FLAGSHIP = "open-committee"
_NAME = re.compile(
    r"[A-Za-z0-9][A-Za-z0-9._-]{0,99}"
)  # of a file beside the committee's, and of nothing else


@dataclass(frozen=True)
class Committee:
    """Who sits on it.

    Attributes:
        members: names of published policies, NAME.json and NAME.safetensors in the folder of the committee's file.

    Raises:
        ParameterError: where there is none, one is named twice, or a name leads out of the folder.
    """

    members: tuple[str, ...]

    def __post_init__(self) -> None:
        if not isinstance(self.members, tuple):
            raise ParameterError(f"members: {self.members!r} is no list of names")
        for name in self.members:
            if not isinstance(name, str) or not _NAME.fullmatch(name):
                raise ParameterError(f"members: {name!r} is no name of a policy in the same folder")
        if not self.members or len(set(self.members)) < len(self.members):
            raise ParameterError(f"members: needs one policy at least, each once; got {list(self.members)}")

    def save(self, path: str | Path) -> None:
        """Write it as JSON; a file of that name is replaced at once or not at all."""
        artefact.save(path, FORMAT, {"members": self.members})

    @classmethod
    def load(cls, path: str | Path) -> "Committee":
        """Read it; ParameterError names the file and what is wrong with it."""
        return artefact.load(path, FORMAT, cls)

    @classmethod
    def evaluations(cls, path: str | Path) -> int:
        """Return the planner runs of all its members' trainings."""
        return sum(read_card(Path(path).parent / name).evaluations for name in cls.load(path).members)


class CommitteeAgent:
    """Recommend the mean of what published policies of OneShot recommend, without a trial.

    Args:
        path: the committee's file; the shipped one where there is none.

    Raises:
        ParameterError: where a file is missing or damaged, or a member is no policy of OneShot.
    """

    def __init__(self, path: str | Path | None = None) -> None:
        self.path = shipped(FLAGSHIP).with_suffix(".json") if path is None else Path(path)
        folder = self.path.parent
        self._members = [PolicyAgent(folder / name) for name in Committee.load(self.path).members]
        for member in self._members:
            if member.card.regime != "OneShot":
                raise ParameterError(
                    f"{self.path}: {member.path.name} is a policy of {member.card.regime}, not OneShot"
                )

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
