"""The single best static setting: one setting for every map, raced on source maps."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antgym.errors import ParameterError
from antgym.tuning import COST_CAP, Session, Task, Trial

Floats = NDArray[np.float64]
FORMAT = "antgym static setting 1"
KEEP = 0.25


class StaticSetting(NamedTuple):
    """A raced setting: ``unit`` (d values in [0, 1]) and the evaluations that finding it spent."""

    unit: tuple[float, ...]
    evaluations: int
    parameters: tuple[str, ...]

    def save(self, path: Path) -> None:
        """Write it as JSON; the file appears whole or not at all."""
        draft = path.with_name(path.name + ".tmp")
        draft.write_text(json.dumps({"format": FORMAT, **self._asdict()}, indent=1), encoding="utf-8")
        draft.replace(path)

    @classmethod
    def load(cls, path: Path) -> "StaticSetting":
        """Read it; ParameterError names the file and what is wrong."""
        try:
            content: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
            if content.pop("format") != FORMAT:
                raise ParameterError(f"{path}: not an {FORMAT!r}")
            return cls(tuple(content["unit"]), int(content["evaluations"]), tuple(content["parameters"]))
        except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
            raise ParameterError(f"{path}: no static setting ({error})") from None


def race(sessions: Sequence[Session], candidates: Floats, *, first: int = 16) -> StaticSetting:
    """Race settings over maps: each round runs the survivors on new maps and keeps a quarter of them.

    Successive halving over maps, never over iterations: the best persistence depends on the iterations
    (tuning.md, D5). Costs are averaged over all maps a setting has seen; a run without a path counts as twice
    the best any candidate reached on that map.

    Args:
        sessions: one per map, each with at least one trial per candidate left, in the order to use them.
        candidates: (k, d) settings in [0, 1].
        first: maps of the first round; each round has four times as many, as far as there are maps.

    Returns:
        The survivor with the lowest mean, and what was spent.
    """
    if not len(sessions) or not len(candidates):
        raise ParameterError(f"a race needs maps and settings, got {len(sessions)} and {len(candidates)}")
    alive = np.arange(len(candidates))
    totals, spent, begin, count = np.zeros(len(candidates)), 0, 0, first
    while begin < len(sessions):
        for session in sessions[begin : begin + count]:
            costs = np.array([trial.cost for trial in session.evaluate(candidates[alive])])
            totals[alive] += np.where(costs < COST_CAP, costs, 2 * costs.min()) / costs.min()
            spent += len(costs)
        begin, count = begin + count, 4 * count
        keep = max(1, round(KEEP * len(alive))) if begin < len(sessions) else 1
        alive = alive[np.argsort(totals[alive], kind="stable")[:keep]]
    winner = tuple(candidates[alive[0]].tolist())
    return StaticSetting(winner, spent, sessions[0].task.space.names)


class StaticAgent:
    """Recommend a raced setting, with no trial.

    Args:
        setting: the setting or its file.
    """

    def __init__(self, setting: StaticSetting | Path | str) -> None:
        self.setting = setting if isinstance(setting, StaticSetting) else StaticSetting.load(Path(setting))

    def reset(self, task: Task, *, seed: int) -> None:  # noqa: ARG002 - the protocol's signature
        """Take on a task; ParameterError where it has other parameters."""
        if task.space.names != self.setting.parameters:
            raise ParameterError(
                f"the setting is for {self.setting.parameters}, the task has {task.space.names}"
            )

    def ask(self) -> Floats:
        """Return no settings, (0, d)."""
        return np.empty((0, len(self.setting.unit)))

    def tell(self, trials: Sequence[Trial]) -> None:
        """Ignore trials."""

    def recommend(self) -> Floats:
        """Return the setting, (d,)."""
        return np.array(self.setting.unit)
