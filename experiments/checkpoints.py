"""Checkpoints of a training: the model as stable-baselines3 saves it, and how far it has come. For one's own use only.

A model's zip and what it replays are pickles: they are read from the folder that the same command wrote, from nowhere
else. What is published is another file, see ``agents.networks.export``.
"""

import json
import shutil
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from antgym.console import write_whole
from antgym.errors import ParameterError


@dataclass
class Standing:
    """How far a training has come.

    Attributes:
        leg: how many of its legs are done.
        evaluations: planner runs spent on it.
        validation_runs: planner runs spent on choosing.
        seconds: that it took.
        history: [evaluations, validation gap] of every checkpoint.
        best: leg of the checkpoint with the lowest gap, 0 before any and for the one before all legs.
    """

    leg: int = 0
    evaluations: int = 0
    validation_runs: int = 0
    seconds: float = 0.0
    history: list[list[float]] = field(default_factory=list)
    best: int = 0

    @property
    def lowest(self) -> float | None:
        """The lowest validation gap so far."""
        return min((gap for _, gap in self.history), default=None)


class Checkpoints:
    """A folder with the newest checkpoint of a training, and the best.

    Args:
        folder: made where it is not there.
        asked: what decides the training, JSON; a folder begun with something else is refused.
    """

    def __init__(self, folder: Path, asked: dict[str, Any]) -> None:
        self.folder, self._asked = folder, json.loads(json.dumps(asked))
        self.standing = self._read()

    def resume(self, kind: Any, envs: Any) -> Any:
        """Return the model of the newest checkpoint."""
        model = kind.load(self._zip(self.standing.leg), env=envs, device="cpu")
        if self._replay(self.standing.leg).exists():
            model.load_replay_buffer(self._replay(self.standing.leg))
        return model

    def best(self, model: Any) -> Any:
        """Return the model with the weights of the best checkpoint."""
        if self.standing.best != self.standing.leg:
            model.set_parameters(str(self._zip(self.standing.best)), device="cpu")
        return model

    def keep(self, model: Any, standing: Standing) -> None:
        """Write a checkpoint; a crash leaves the one before or this one."""
        self.folder.mkdir(parents=True, exist_ok=True)
        model.save(self._zip(standing.leg))
        if getattr(model, "replay_buffer", None) is not None:
            model.save_replay_buffer(self._replay(standing.leg))
        text = json.dumps({"asked": self._asked, **asdict(standing)}, indent=1) + "\n"
        write_whole(self.folder / "standing.json", text.encode())
        self.standing = standing
        wanted = {self._zip(standing.leg), self._zip(standing.best), self._replay(standing.leg)}
        for path in self.folder.glob("leg-*"):
            if path not in wanted:
                path.unlink()

    def remove(self) -> None:
        """Remove the folder, once what it led to is published."""
        shutil.rmtree(self.folder, ignore_errors=True)

    def _zip(self, leg: int) -> Path:
        return self.folder / f"leg-{leg:02}.zip"

    def _replay(self, leg: int) -> Path:
        return self.folder / f"leg-{leg:02}.replay.pkl"

    def _read(self) -> Standing:
        path = self.folder / "standing.json"
        if not path.exists():
            return Standing()
        try:
            found = json.loads(path.read_text(encoding="utf-8"))
            asked, standing = found.pop("asked"), Standing(**found)
        except (ValueError, KeyError, TypeError) as error:
            raise ParameterError(
                f"{path} is damaged ({error}); remove its folder, or use another --out"
            ) from None
        require_same(self.folder, asked, self._asked)
        return standing


def require_same(place: Path, then: dict[str, Any], now: dict[str, Any]) -> None:
    """Raise ParameterError where a training was begun with something else than is asked for now; it names what."""
    names = sorted(name for name in {*then, *now} if then.get(name) != now.get(name))
    if names:
        said = "; ".join(f"{name}: {then.get(name)!r:.60}, now {now.get(name)!r:.60}" for name in names)
        raise ParameterError(f"{place} was made with other settings ({said}); use another --out")
