"""The single best static setting, for every map or one for every rule, raced on source maps."""

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from agents import artefact
from agents.search import ZeroShot
from antgym.errors import ParameterError
from antgym.tuning import COST_CAP, Session, Task, shown_rules

Floats = NDArray[np.float64]
FORMAT = "antgym static setting 1"
FORMAT_BY_RULES = "antgym static settings by rules 1"
KEEP = 0.25
_T = TypeVar("_T")


class StaticSetting(NamedTuple):
    """A raced setting: ``unit`` (d values in [0, 1]) and the evaluations that finding it spent."""

    unit: tuple[float, ...]
    evaluations: int
    parameters: tuple[str, ...]

    def save(self, path: Path) -> None:
        """Write it as JSON; the file appears whole or not at all."""
        artefact.save(path, FORMAT, self._asdict())

    @classmethod
    def load(cls, path: Path) -> "StaticSetting":
        """Read it; ParameterError names the file and what is wrong."""
        return _read(path, FORMAT, cls.of)

    @classmethod
    def of(cls, content: Mapping[str, Any]) -> "StaticSetting":
        """Return what a dictionary of its fields says."""
        return cls(tuple(content["unit"]), int(content["evaluations"]), tuple(content["parameters"]))


class StaticSettings(NamedTuple):
    """Raced settings, ``by_rules``: name of the rules -> the setting that did best under them."""

    by_rules: Mapping[str, StaticSetting]

    @property
    def evaluations(self) -> int:
        """Trials that finding all of them spent."""
        return sum(setting.evaluations for setting in self.by_rules.values())

    def save(self, path: Path) -> None:
        """Write them as JSON; the file appears whole or not at all."""
        settings = {rules: setting._asdict() for rules, setting in self.by_rules.items()}
        artefact.save(path, FORMAT_BY_RULES, {"by_rules": settings})

    @classmethod
    def load(cls, path: Path) -> "StaticSettings":
        """Read them; ParameterError names the file and what is wrong."""
        return _read(path, FORMAT_BY_RULES, cls._of)

    @classmethod
    def _of(cls, content: Mapping[str, Any]) -> "StaticSettings":
        return cls({rules: StaticSetting.of(found) for rules, found in content["by_rules"].items()})


def race(sessions: Sequence[Session], candidates: Floats, *, first: int = 16) -> StaticSetting:
    """Race settings over maps: each round runs the survivors on new maps and keeps a quarter of them.

    Successive halving over maps, never over iterations: the best persistence depends on the iterations.
    Costs are averaged over all maps a setting has seen; a run without a path counts as twice the best any candidate
    reached on that map.

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


def race_by_rules(sessions: Sequence[Session], candidates: Floats, *, first: int = 16) -> StaticSettings:
    """Race settings over the maps of each rule apart; arguments and races are those of :func:`race`.

    Raises:
        ParameterError: where a session's task shows no published rules, or there is nothing to race.
    """
    groups: dict[str, list[Session]] = {}
    for session in sessions:
        groups.setdefault(_rules(session.task), []).append(session)
    if not groups:
        raise ParameterError(f"a race needs maps and settings, got 0 and {len(candidates)}")
    return StaticSettings({rules: race(group, candidates, first=first) for rules, group in groups.items()})


class StaticAgent(ZeroShot):
    """Recommend a raced setting, with no trial.

    Args:
        setting: the setting or its file.
    """

    def __init__(self, setting: StaticSetting | Path | str) -> None:
        self.setting = setting if isinstance(setting, StaticSetting) else StaticSetting.load(Path(setting))

    def _choose(self, task: Task, seed: int) -> Floats:  # noqa: ARG002 - the same for every seed
        return _fit(self.setting, task)


class StaticByRules(ZeroShot):
    """Recommend the setting that was raced under a task's own rules, with no trial.

    What rules they are is among the features that every agent sees. Rules that were not raced are refused: a setting of
    other rules would not be what the name says.

    Args:
        settings: the settings or their file.
    """

    def __init__(self, settings: StaticSettings | Path | str) -> None:
        if not isinstance(settings, StaticSettings):
            settings = StaticSettings.load(Path(settings))
        self.settings = settings

    def _choose(self, task: Task, seed: int) -> Floats:  # noqa: ARG002 - the same for every seed
        by_rules, rules = self.settings.by_rules, _rules(task)
        if rules not in by_rules:
            raise ParameterError(
                f"no setting was raced for the rules {rules!r}, only for {', '.join(by_rules)}"
            )
        return _fit(by_rules[rules], task)


def _fit(setting: StaticSetting, task: Task) -> Floats:
    if task.space.names != setting.parameters:
        raise ParameterError(f"the setting is for {setting.parameters}, the task has {task.space.names}")
    return np.array(setting.unit)


def _rules(task: Task) -> str:
    rules = shown_rules(task.features)
    if rules is None:
        raise ParameterError("the task goes by rules of its own, a setting by rules is for published ones")
    return rules


def _read(path: Path, form: str, make: Callable[[Mapping[str, Any]], _T]) -> _T:
    try:
        content: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        if (found := content.pop("format")) != form:
            raise ValueError(f"its format is {found!r}")
        return make(content)
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise ParameterError(f"{path}: no {form!r} ({error})") from None
