"""Train an RL tuner of stable-baselines3 on a OneShot environment.

    python -m experiments.train PPO antgym/MountainOneShot-v0 --evaluations 64000 --out out/policy

writes the checkpoint <out>.zip and beside it <out>.json, its card: settings, planner runs and seconds spent,
versions. The same arguments give the same policy.
"""

import json
import os
import time
import tomllib
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import tyro

from antgym.console import progress
from antgym.envs.catalogue import CATALOGUE
from antgym.errors import MissingExtraError, ParameterError, nearest

CONFIGS = Path(__file__).parent / "configs"
LIBRARIES = ("antgym", "numpy", "gymnasium", "stable-baselines3", "torch")


@dataclass(frozen=True)
class Arguments:
    """Train an RL tuner."""

    algorithm: Annotated[str, tyro.conf.Positional]
    """PPO, SAC or TD3; its settings are a table of the configuration file."""
    env: Annotated[str, tyro.conf.Positional] = "antgym/MountainOneShot-v0"
    """Id of the environment; its train split is used."""
    evaluations: int = 64_000
    """Planner runs to spend."""
    seed: int = 0
    """Root seed of networks, scenarios and planner."""
    out: Path = Path("out/policy")
    """Where the checkpoint goes; .zip and .json are added."""
    config: Path = CONFIGS / "one_shot.toml"
    """Settings by algorithm."""


def train(arguments: Arguments) -> dict[str, Any]:
    """Train, save, and return the card; an interrupted training leaves nothing behind."""
    if arguments.evaluations < 1:
        raise ParameterError(
            f"evaluations = {arguments.evaluations}: training needs at least one planner run"
        )
    known = tuple(entry.id for entry in CATALOGUE)
    if arguments.env not in known:
        raise ParameterError(f"unknown environment {arguments.env!r}; {nearest(arguments.env, known)}")
    stable_baselines3 = _library()
    settings = _settings(arguments.config, arguments.algorithm)
    from antgym.envs.sb3 import make_sb3_vec

    envs = make_sb3_vec(arguments.env, settings.pop("num_envs"), seed=arguments.seed)
    if "action_noise" in settings:
        from stable_baselines3.common.noise import NormalActionNoise

        size = envs.action_space.shape
        settings["action_noise"] = NormalActionNoise(np.zeros(size), np.full(size, settings["action_noise"]))
    algorithm = getattr(stable_baselines3, arguments.algorithm)
    model = algorithm("MlpPolicy", envs, seed=arguments.seed, device="cpu", **settings)
    begun = time.perf_counter()
    _learn(model, arguments)
    card = {
        "algorithm": arguments.algorithm,
        "env": arguments.env,
        "seed": arguments.seed,
        "evaluations": envs.native.planner_runs,
        "seconds": round(time.perf_counter() - begun, 1),
        "config": _settings(arguments.config, arguments.algorithm),
        "versions": {name: version(name) for name in LIBRARIES},
    }
    _save(model, arguments.out, card)
    return card


def _library() -> Any:
    try:
        import stable_baselines3
        import torch
    except ImportError:
        raise MissingExtraError("stable-baselines3", "rl") from None
    torch.set_num_threads(1)  # small nets: more threads only get in the planner's way
    return stable_baselines3


def _settings(path: Path, algorithm: str) -> dict[str, Any]:
    table = tomllib.loads(path.read_text(encoding="utf-8"))
    if algorithm not in table:
        raise ParameterError(f"{path} has no settings for {algorithm!r}; {nearest(algorithm, tuple(table))}")
    return dict(table[algorithm])


def _learn(model: Any, arguments: Arguments) -> None:
    with progress(f"training {arguments.algorithm} on {arguments.env}", arguments.evaluations) as advance:

        def after_step(*_: Any) -> bool:
            advance(model.n_envs)
            return True

        model.learn(arguments.evaluations, callback=after_step)


def _save(model: Any, out: Path, card: dict[str, Any]) -> None:
    """Write both files under other names first: a crash leaves the old pair or the new one."""
    out.parent.mkdir(parents=True, exist_ok=True)
    model.save(out.with_name(out.name + ".part.zip"))
    part = out.with_name(out.name + ".part.json")
    part.write_text(json.dumps(card, indent=2) + "\n", encoding="utf-8")
    os.replace(out.with_name(out.name + ".part.zip"), out.with_name(out.name + ".zip"))
    os.replace(part, out.with_name(out.name + ".json"))


if __name__ == "__main__":
    from antgym.console import main

    main(lambda: print(json.dumps(train(tyro.cli(Arguments)), indent=2)))
