"""Seat a committee of published policies: a file beside them that ``rl_committee`` follows.

    python -m experiments.committee out/open/ppo-1 out/open/ppo-2 out/open/ppo-3

writes out/open/committee.json, which names them.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from agents.choosing import Committee
from agents.committee import CommitteeAgent
from agents.published import stem_of
from antgym.console import main, parse
from antgym.errors import ParameterError

FILE = "committee.json"


@dataclass(frozen=True)
class Arguments:
    """Seat a committee of published policies of OneShot, all in one folder."""

    policies: Annotated[tuple[Path, ...], tyro.conf.Positional]
    """NAME of NAME.json and NAME.safetensors, each as experiments.train --out wrote it."""


def seat(arguments: Arguments) -> Path:
    """Write the committee's file and return it, once all of its members can be read."""
    folders = {path.parent for path in arguments.policies}
    if len(folders) != 1:
        raise ParameterError(f"a committee sits in one folder; these are in {sorted(map(str, folders))}")
    path = folders.pop() / FILE
    Committee(tuple(stem_of(policy).name for policy in arguments.policies)).save(path)
    try:
        CommitteeAgent(path)
    except ParameterError:
        path.unlink()
        raise
    return path


if __name__ == "__main__":
    main(lambda: print(f"written: {seat(parse(Arguments, None, 'python -m experiments.committee'))}"))
