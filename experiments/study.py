"""Study which settings an algorithm learns best with, on train and validation maps.

    python -m experiments.study PPO antgym/OpenOneShot-v0 --configurations 12 --out out/study

The first configuration is the one in experiments/configs; the others are points of a scrambled Sobol sequence in what
experiments/configs/spaces says may change. Each trains a policy for some planner runs; what counts is the mean gap on
validation maps after its last three legs, which is less of a lucky draw than the lowest of ten. A
training that is finished is not done again; OUT/study.jsonl has a line a configuration once all are. The best, trained
on fresh seeds, is what a report may name.
"""

import json
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import tyro
from rich.console import Console
from rich.table import Table
from scipy.stats import qmc

from antgym.console import main, parse, write_whole
from antgym.errors import ParameterError, nearest
from experiments import train
from experiments.learners import CONFIGS, FILES, Learner

LAST = 3  # legs whose gaps count
PARTS = "policy_kwargs."


@dataclass(frozen=True)
class Arguments:
    """Study which settings an algorithm learns best with, or go on with a study that was stopped."""

    algorithm: Annotated[str, tyro.conf.Positional]
    """An algorithm that experiments/configs/spaces has a table for."""
    env: Annotated[str, tyro.conf.Positional] = "antgym/OpenOneShot-v0"
    """Id of the environment."""
    configurations: int = 12
    """How many, the present one among them."""
    evaluations: int = 20_000
    """Planner runs to spend on each."""
    seed: int = 0
    """Of the sequence, and of every training."""
    out: Path = Path("out/study")
    """Folder of the study."""
    experience: Path | None = None
    """A table of trials to learn from before any episode, as of experiments.train."""
    replayed: int | None = None
    """Evaluations at most that are trials of --experience."""
    validation: int = 100
    """Maps of the validation split."""


def configurations(
    space: Mapping[str, Any], present: Mapping[str, Any], count: int, seed: int
) -> list[dict[str, Any]]:
    """Return settings to try: the present ones, and count - 1 others; the first few are the same for any count."""
    points = qmc.Sobol(len(space), seed=seed).random_base2(max(1, int(np.ceil(np.log2(max(count, 2))))))
    tried = [dict(present)]
    for point in points[: count - 1]:
        settings = {**present, "policy_kwargs": dict(present.get("policy_kwargs", {}))}
        for (name, range_), at in zip(space.items(), point.tolist(), strict=True):
            place = settings["policy_kwargs"] if name.startswith(PARTS) else settings
            place[name.removeprefix(PARTS)] = _drawn(range_, at)
        tried.append(settings)
    return tried


def _drawn(range_: Any, at: float) -> Any:
    if isinstance(range_, list):
        return range_[int(at * len(range_))]
    low, high = np.log([range_["low"], range_["high"]])
    return float(f"{np.exp(low + at * (high - low)):.3g}")


def study(arguments: Arguments) -> list[dict[str, Any]]:
    """Train what is left to train; return a record a configuration, the best first."""
    learner = Learner(arguments.algorithm, arguments.env, None, {}, None, None)
    space = _space(learner)
    tried = configurations(space, learner.settings, arguments.configurations, arguments.seed)
    arguments.out.mkdir(parents=True, exist_ok=True)
    records = [_record(i, settings, arguments) for i, settings in enumerate(tried)]
    lines = "".join(json.dumps(record) + "\n" for record in records)
    write_whole(arguments.out / "study.jsonl", lines.encode())
    return sorted(records, key=lambda record: float(record["gap"]))


def _space(learner: Learner) -> dict[str, Any]:
    path = CONFIGS / "spaces" / FILES[learner.entry.regime]
    if not path.exists():
        raise ParameterError(f"{path}: there is no space of settings for {learner.entry.regime}")
    spaces = tomllib.loads(path.read_text(encoding="utf-8"))
    if learner.algorithm not in spaces:
        hint = nearest(learner.algorithm, tuple(spaces))
        raise ParameterError(f"{path} has no space for {learner.algorithm!r}; {hint}")
    return dict(spaces[learner.algorithm])


def _record(number: int, settings: dict[str, Any], arguments: Arguments) -> dict[str, Any]:
    """Return what a configuration came to, trained now where it is not yet."""
    stem = arguments.out / f"{arguments.algorithm}-{number:02}"
    config = stem.with_suffix(".toml")
    write_whole(config, f"[{arguments.algorithm}]\n{as_toml(settings)}".encode())
    told = train.train(
        train.Arguments(
            arguments.algorithm,
            arguments.env,
            evaluations=arguments.evaluations,
            seed=arguments.seed,
            out=stem,
            experience=arguments.experience,
            replayed=arguments.replayed,
            validation=arguments.validation,
            config=config,
        )
    )
    gaps = [gap for _, gap in told["history"][-LAST:]]
    names = ("evaluations", "validation_runs", "seconds", "history")
    return {
        "number": number,
        "gap": round(float(np.mean(gaps)), 6),
        "settings": settings,
        **{name: told[name] for name in names},
    }


def as_toml(settings: Mapping[str, Any]) -> str:
    """Return settings as lines of TOML; nested ones as an inline table."""
    return "".join(f"{name} = {_value(value)}\n" for name, value in settings.items())


def _value(value: Any) -> str:
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{name} = {_value(part)}" for name, part in value.items()) + " }"
    return json.dumps(value)  # numbers, strings, booleans and lists are written alike


def to_table(records: list[dict[str, Any]], space: Mapping[str, Any]) -> Table:
    """Return the table that the terminal shows."""
    table = Table(title="Mean gap on validation maps after the last three legs, per cent")
    for heading in ("", "gap", *(name.removeprefix(PARTS) for name in space)):
        table.add_column(heading)
    for record in records:
        flat = {**record["settings"], **record["settings"].get("policy_kwargs", {})}
        shown = [str(flat.get(name.removeprefix(PARTS), "–")) for name in space]
        table.add_row(str(record["number"]), f"{100 * record['gap']:.1f}", *shown)
    return table


def script() -> None:
    """Run the command line."""
    arguments = parse(Arguments, None, "python -m experiments.study")
    records = study(arguments)
    learner = Learner(arguments.algorithm, arguments.env, None, {}, None, None)
    Console().print(to_table(records, _space(learner)))
    spent = sum(record["evaluations"] for record in records), sum(r["validation_runs"] for r in records)
    print(f"{spent[0]:,} evaluations and {spent[1]:,} runs on validation maps: {arguments.out}/study.jsonl")


if __name__ == "__main__":
    main(script)
