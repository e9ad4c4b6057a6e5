"""Choices: what published policies of OneShot pick from the features of a task alone, one of them or a committee.

A choice is what other policies correct: those of Trials and Control that were trained with ``--start-by-policy``.
"""

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from agents import artefact
from agents.networks import load
from agents.published import COMMITTEE, FORMAT, NAME, SHIPPED, PolicyCard, beside, read_card, stem_of
from antgym.errors import ParameterError
from antgym.tuning import Choice, Start, settings_of

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Committee:
    """Who sits on it.

    Attributes:
        members: names of published policies, NAME.json and NAME.safetensors in the folder of the committee's file; of
            shipped ones where that has none of this name.

    Raises:
        ParameterError: where there is none, one is named twice, or a name leads out of the folder.
    """

    members: tuple[str, ...]

    def __post_init__(self) -> None:
        if not isinstance(self.members, tuple):
            raise ParameterError(f"members: {self.members!r} is no list of names")
        for name in self.members:
            if not isinstance(name, str) or not NAME.fullmatch(name):
                raise ParameterError(f"members: {name!r} is no name of a policy in the same folder")
        if not self.members or len(set(self.members)) < len(self.members):
            raise ParameterError(f"members: needs one policy at least, each once; got {list(self.members)}")

    def save(self, path: str | Path) -> None:
        """Write it as JSON; a file of that name is replaced at once or not at all."""
        artefact.save(path, COMMITTEE, {"members": self.members})

    @classmethod
    def load(cls, path: str | Path) -> "Committee":
        """Read it; ParameterError names the file and what is wrong with it."""
        file = Path(path)
        if file.is_file() and _form_of(file) == FORMAT:
            raise ParameterError(
                f"{file}: is a policy, which 'rl' follows, and no committee; where agents are named, it is "
                f"rl:{file.stem}"
            )
        return artefact.load(file, COMMITTEE, cls)

    @classmethod
    def seats(cls, path: str | Path) -> list[Path]:
        """Return the paths of the members of the committee in a file."""
        return [_seat(Path(path).parent, name) for name in cls.load(path).members]

    @classmethod
    def evaluations(cls, path: str | Path) -> int:
        """Return the planner runs of all its members' trainings."""
        return spent_on(cls.seats(path))


def _seat(folder: Path, name: str) -> Path:
    places = [place / name for place in (folder, SHIPPED) if beside(place / name, ".json").is_file()]
    return places[0] if places else folder / name


def _form_of(file: Path) -> Any:
    """Return the format that a JSON file names; ParameterError where it cannot be read."""
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise ParameterError(f"{file}: neither a policy nor a committee ({error})") from None
    return content.get("format") if isinstance(content, dict) else None


def members_of(path: str | Path) -> list[Path]:
    """Return the policies behind a file: those of a committee, or the one that it is."""
    file = beside(stem_of(path), ".json")
    return Committee.seats(file) if _form_of(file) == COMMITTEE else [stem_of(path)]


def choice_of(path: str | Path) -> Choice:
    """Return what a policy of OneShot, or the mean of a committee, chooses by features alone.

    Raises:
        ParameterError: where a file is missing or damaged, or a member is of another regime or sees maps.
    """
    networks = []
    for member in members_of(path):
        card, network = load(member)
        if card.regime != "OneShot" or card.map is not None:
            raise ParameterError(
                f"{member}: is a policy of {card.regime} that sees {card.observation}; what others begin from is "
                "chosen by one of OneShot that sees features, or by a committee of such"
            )
        networks.append((member, card, network))
    return lambda features: np.asarray(np.mean([_picked(*one, features) for one in networks], axis=0))


def _picked(path: Path, card: PolicyCard, network: Any, features: NDArray[np.float32]) -> Floats:
    if features.shape[1] != card.size:
        raise ParameterError(f"{path}: chooses by {card.size} features, the task has {features.shape[1]}")
    begins = np.ones(len(features), bool)
    return settings_of(network.predict(features, state=None, episode_start=begins, deterministic=True)[0])


def spent_on(paths: Sequence[Path]) -> int:
    """Return the planner runs of the trainings of some policies."""
    return sum(read_card(path).evaluations for path in paths)


def digest_of(path: str | Path) -> str:
    """Return the hash of the cards behind a file, which hold those of their weights."""
    cards = (beside(member, ".json").read_bytes() for member in members_of(path))
    return hashlib.sha256(b"".join(cards)).hexdigest()


def followed(path: str | Path, card: PolicyCard) -> Choice:
    """Return the choice that a published policy corrects: a file of that name beside its own, or a shipped one.

    Raises:
        ParameterError: where there is none, or it is not the one that the policy was trained with.
    """
    name = f"{card.follows}.json"
    places = [folder / name for folder in (Path(path).parent, SHIPPED) if (folder / name).is_file()]
    for place in places:
        if digest_of(place) == card.follows_sha256:
            return choice_of(place)
    found = f"{places[0]} is another one" if places else "there is none beside it"
    raise ParameterError(
        f"{path}: corrects what {card.follows!r} chooses, and {found}; put its files into the folder"
    )


def start_in(path: str | Path, card: PolicyCard) -> Start | None:
    """Return what the changes of a published policy begin from."""
    return followed(path, card) if card.follows else card.start
