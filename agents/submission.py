"""Submissions: a folder with a manifest and a table of settings, or a published policy. Data, and never code.

``submission.json`` says what was submitted, on which maps, and which mean gap its makers claim;
``experiments.verify`` scores it again, and a board takes the folder's name where it takes an agent's; one that steers
runs is on track C alone.
"""

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from agents.algorithms import check_constructor
from agents.catalogue import RL_LIBRARIES, Card
from agents.policy import PolicyAgent
from agents.published import SHIPPED, PolicyCard, is_number, is_whole, read_card
from agents.search import ZeroShot
from agents.steering import PolicyController
from agents.stranger import harmless
from agents.submitted_files import check_weights, is_file_name, read_object
from antgym.errors import AgentError, AntgymError, ParameterError
from antgym.tuning import Task, shown_rules

if TYPE_CHECKING:
    from antgym.tuning import Agent

Floats = NDArray[np.float64]
MANIFEST, FORMAT, TABLE_FORMAT = "submission.json", "antgym submission 1", "antgym table 1"
TRACKS, KINDS, SPLITS = ("A", "B", "C"), ("table", "policy"), ("validation", "test", "ood")
MOST_TRIALS = 1000  # that a policy may pick on a map when it is scored; boards' budgets end at 100
MOST_MAP = 1 << 14  # numbers of a map that a policy may be shown; those of antgym have 3,072 or 12,288


@dataclass(frozen=True)
class Submission:
    """A manifest.

    Attributes:
        name: one line.
        authors: a line each.
        summary: one line.
        track: ``"A"``, tuned on each map; ``"B"``, trained elsewhere; ``"C"``, a policy that steers runs.
        suite: of the maps that the claim is about.
        split: its split.
        maps: the first so many of it.
        kind: ``"table"``, a setting for each map or each rule; ``"policy"``, NAME.json and NAME.safetensors.
        files: in this folder: the table's, or the policy's two.
        mean_gap: claimed, in [0, 1]: mean over maps and seeds, of 16 fresh runs of each recommendation, or of a run
            that is steered.
        seeds: that this mean is over, for each map.
        trials: planner runs that were paid for on each of these maps.
        training_trials: planner runs paid for anywhere else.
        antgym: version that the claim was measured with.
    """

    name: str
    authors: list[str]
    summary: str
    track: Literal["A", "B", "C"]
    suite: str
    split: str
    maps: int
    kind: Literal["table", "policy"]
    files: list[str]
    mean_gap: float
    seeds: int
    trials: int
    training_trials: int
    antgym: str


def _is_line(value: Any, most: int = 80) -> bool:
    return isinstance(value, str) and 1 <= len(value) <= most and value.isprintable() and not value.isspace()


def _are(fits: Callable[[Any], bool], most: int) -> Callable[[Any], bool]:
    return lambda value: isinstance(value, list) and 1 <= len(value) <= most and all(map(fits, value))


def _is_share(value: Any) -> bool:
    return is_number(value) and 0 <= value <= 1


Checks = Mapping[str, tuple[Callable[[Any], bool], str]]
_LINE = _is_line, "a line of 1 to 80 printable characters"
_TRIALS = (lambda value: is_whole(value, 0, 1 << 40)), "a whole number from 0 on"
_CHECKS: Checks = {
    "format": ((lambda value: value == FORMAT), repr(FORMAT)),
    "name": _LINE,
    "authors": (_are(_is_line, 20), "a list of up to 20 lines, each of 1 to 80 printable characters"),
    "summary": ((lambda value: _is_line(value, 300)), "a line of 1 to 300 printable characters"),
    "track": ((lambda value: value in TRACKS), " or ".join(TRACKS)),
    "suite": _LINE,
    "split": ((lambda value: value in SPLITS), " or ".join(SPLITS)),
    "maps": ((lambda value: is_whole(value, 2, 1000)), "a whole number from 2 to 1,000"),
    "kind": ((lambda value: value in KINDS), " or ".join(KINDS)),
    "files": (_are(is_file_name, 2), "a list of names of files in this folder, without any path"),
    "mean_gap": (_is_share, "a number from 0 to 1"),
    "seeds": ((lambda value: is_whole(value, 1, 100)), "a whole number from 1 to 100"),
    "trials": _TRIALS,
    "training_trials": _TRIALS,
    "antgym": _LINE,
}
_SETTINGS = "an object of names and settings, a number from 0 to 1 for each parameter"


def _are_settings(value: Any) -> bool:
    return (
        isinstance(value, dict)
        and all(map(_is_line, value))
        and all(map(_are(_is_share, 64), value.values()))
    )


_TABLE_CHECKS: Checks = {
    "format": ((lambda value: value == TABLE_FORMAT), repr(TABLE_FORMAT)),
    "parameters": (_are(_is_line, 64), "a list of names"),
    "by_scenario": (_are_settings, _SETTINGS),
    "by_rules": (_are_settings, _SETTINGS),
}


def _checked(path: Path, checks: Checks) -> dict[str, Any]:
    """Return the fields of a JSON file but its format; ParameterError names the file and a field that is amiss."""
    content = read_object(path)
    for name in content:
        if name not in checks:
            raise ParameterError(f"{path}: unknown field {name!r:.80}; valid: {', '.join(checks)}")
    for name, (fits, wanted) in checks.items():
        if name not in content:
            raise ParameterError(f"{path}: field {name!r} is missing")
        if not fits(content[name]):
            raise ParameterError(f"{path}: field {name!r} = {content[name]!r:.80}: has to be {wanted}")
    del content["format"]
    return content


@dataclass(frozen=True)
class Table:
    """Settings in the unit cube: by a scenario's name, and by rules for scenarios that are not named."""

    parameters: list[str]
    by_scenario: dict[str, list[float]]
    by_rules: dict[str, list[float]]

    @classmethod
    def read(cls, path: Path) -> "Table":
        """Read a table; ParameterError names the file and the field."""
        table = cls(**_checked(path, _TABLE_CHECKS))
        for field in ("by_scenario", "by_rules"):
            for name, unit in getattr(table, field).items():
                if len(unit) != len(table.parameters):
                    raise ParameterError(
                        f"{path}: field {field!r}, {name!r}: {len(unit)} values for {len(table.parameters)} parameters"
                    )
        return table


class TableAgent(ZeroShot):
    """Recommend what a table holds for a map, with no trial.

    A task does not say which map it is: the harness does, by :meth:`on`.

    Args:
        table: the settings.
        scenario: name of the map.
    """

    def __init__(self, table: Table, scenario: str = "") -> None:
        self.table, self.scenario = table, scenario

    def on(self, scenario: str) -> "TableAgent":
        """Return the agent that is asked about a map."""
        return TableAgent(self.table, scenario)

    def _choose(self, task: Task, seed: int) -> Floats:  # noqa: ARG002 - the same for every seed
        rules = shown_rules(task.features) or ""
        unit = self.table.by_scenario.get(self.scenario, self.table.by_rules.get(rules))
        if unit is None:
            raise AgentError(f"the table has no setting for the map {self.scenario!r} or the rules {rules!r}")
        if tuple(self.table.parameters) != task.space.names:
            raise AgentError(f"the table sets {self.table.parameters}, the task has {list(task.space.names)}")
        return np.array(unit)


@contextmanager
def _failing_alone(path: Path) -> Iterator[None]:
    """Turn what a submitted policy stumbles over into AgentError; torch's own errors come of weights beyond reason."""
    try:
        yield
    except AntgymError as error:
        raise AgentError(str(error)) from None
    except (ValueError, RuntimeError) as error:
        raise AgentError(f"{path}: its network cannot work: {harmless(str(error))}") from None


def _require_finite(path: Path, setting: Floats) -> Floats:
    if not np.isfinite(setting).all():
        raise AgentError(f"{path}: chose {setting.tolist()}; its weights lead to no finite numbers")
    return setting


class SubmittedPolicy(PolicyAgent):
    """A submitted policy: where it does not fit a task, or its network cannot work, it fails and stops nobody else."""

    def reset(self, task: Task, *, seed: int) -> None:
        """Look at the task; AgentError where the policy was trained on another observation or other parameters."""
        with _failing_alone(self.path):
            super().reset(task, seed=seed)

    def _pick(self) -> Floats:
        with _failing_alone(self.path):
            return _require_finite(self.path, super()._pick())


class SubmittedController(PolicyController):
    """A submitted policy that steers runs; it fails as :class:`SubmittedPolicy` does."""

    def reset(self, task: Task, *, seed: int) -> None:
        """Begin a run; AgentError where the policy sets other parameters."""
        with _failing_alone(self.path):
            super().reset(task, seed=seed)

    def act(self, observation: NDArray[np.float32]) -> Floats:
        """Return the setting for the next block; AgentError where the policy does not fit what it is shown."""
        with _failing_alone(self.path):
            return _require_finite(self.path, super().act(observation))


def read_submission(folder: Path) -> Submission:
    """Return the manifest of a folder, once every file that it names is found sound.

    Raises:
        ParameterError: naming the file and the field that are amiss.
    """
    path = folder / MANIFEST
    submission = Submission(**_checked(path, _CHECKS))
    names, steers = submission.files, False
    if submission.kind == "policy":
        steers = _read_policy(path, names).regime == "Control"
        if submission.trials > MOST_TRIALS:
            raise ParameterError(
                f"{path}: field 'trials' = {submission.trials}: a policy may pick {MOST_TRIALS:,} at most"
            )
    elif len(names) == 1:
        Table.read(folder / names[0])
    else:
        raise ParameterError(f"{path}: field 'files' = {names}: a table is one file")
    if steers != (submission.track == "C"):
        raise ParameterError(
            f"{path}: field 'track' = {submission.track!r}: C is for policies of Control, and they for nothing else"
        )
    return submission


def _read_policy(manifest: Path, names: list[str]) -> PolicyCard:
    """Return a policy's card; ParameterError names the file and the field that are amiss."""
    stem = names[0].removesuffix(".json")
    if names != [f"{stem}.json", f"{stem}.safetensors"]:
        raise ParameterError(
            f"{manifest}: field 'files' = {names}: a policy is NAME.json and NAME.safetensors"
        )
    file, weights = (manifest.parent / name for name in names)
    check_weights(weights)
    read_object(file)  # as strictly as the manifest; what its fields are is the card's business
    card = read_card(file)
    if card.map is not None and np.prod(card.map) > MOST_MAP:
        raise ParameterError(f"{file}: field 'map' = {card.map}: no map of antgym is that large")
    _require_shipped(file, card)
    try:
        check_constructor(card.constructor)
    except ParameterError as error:
        raise ParameterError(f"{file}: {error}") from None
    return card


def _require_shipped(file: Path, card: PolicyCard) -> None:
    """Raise ParameterError where a policy follows another than a shipped one: its files are none that were checked.

    One that lies beside it is refused too, for it would be taken in the place of the shipped one.
    """
    place = f"{file}: field 'follows' = {card.follows!r:.80}"
    beside_it = file.parent / f"{card.follows}.json"
    if card.follows and not (SHIPPED / beside_it.name).is_file():
        raise ParameterError(f"{place}: a submission follows a policy that comes with antgym, or none")
    if card.follows and os.path.lexists(beside_it):
        raise ParameterError(f"{place}: comes with antgym; take {beside_it.name} out of the folder")


def make_agent(folder: str) -> "Agent":
    """Return the agent of a submission; ParameterError names what is amiss."""
    submission = read_submission(Path(folder))
    path = Path(folder) / submission.files[0]
    return SubmittedPolicy(path) if submission.kind == "policy" else TableAgent(Table.read(path))


def card_of(name: str) -> Card:
    """Return the card of a submission, named by its folder; ParameterError names what is amiss."""
    folder = Path(name)
    submission = read_submission(folder)
    policy = submission.kind == "policy"
    spent = submission.training_trials  # those on each map are not spent once
    return Card(
        name=name,
        entry_point="agents.submission:make_agent",
        kwargs={"folder": name},
        summary=f"{submission.name}, by {', '.join(submission.authors)}: {submission.summary} (submitted)",
        needs="rl" if policy else None,
        libraries=RL_LIBRARIES if policy else (),
        track=submission.track,
        trials=submission.trials,
        files=(folder / MANIFEST, *(folder / file for file in submission.files)),
        training=spent,
        steers=submission.track == "C",
    )
