"""What a published policy's card says of its training, and what a command says of the card."""

from importlib.metadata import version
from pathlib import Path
from typing import Any

from agents.choosing import digest_of, members_of, spent_on
from agents.published import stem_of
from agents.static import StaticSettings
from experiments.checkpoints import Standing
from experiments.learners import Learner

LIBRARIES = ("antgym", "numpy", "gymnasium", "sb3-contrib", "stable-baselines3", "torch")
SHORT = ("algorithm", "env", "regime", "seed", "evaluations", "validation_runs", "validation_gap", "seconds")


def facts(
    learner: Learner, by_rules: Path | None, standing: Standing, *, seed: int, asked: dict[str, Any]
) -> dict[str, Any]:
    """Return the fields of a card that neither the model nor its environment knows.

    Args:
        learner: what was trained.
        by_rules: file of the settings that changes begin from, where there is one.
        standing: how the training stands at its end.
        seed: its root seed.
        asked: what decided it.
    """
    return {
        "action": learner.how,
        "start": learner.start,
        **_begun(learner, by_rules),
        "env": learner.env,
        "arguments": dict(learner.kwargs),
        "evaluations": standing.evaluations,
        "validation_runs": standing.validation_runs,
        "validation_gap": standing.lowest,
        "seconds": standing.seconds,
        "seed": seed,
        "settings": {**learner.settings, "asked": asked},
        "versions": {name: version(name) for name in LIBRARIES},
        "history": standing.history,
    }


def _begun(learner: Learner, by_rules: Path | None) -> dict[str, Any]:
    """Return what a card says of where changes begin, and what finding that spent."""
    if learner.follows is not None:
        name, spent = stem_of(learner.follows).name, spent_on(members_of(learner.follows))
        return {"follows": name, "follows_sha256": digest_of(learner.follows), "start_evaluations": spent}
    return {"start_evaluations": StaticSettings.load(by_rules).evaluations if by_rules else 0}


def short(card: Any) -> dict[str, Any]:
    """Return what a command says of a card."""
    return {**{name: getattr(card, name) for name in SHORT}, "history": card.history}
