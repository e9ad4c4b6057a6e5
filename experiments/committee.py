"""Seat a committee of published policies: a file beside them that ``rl_committee`` follows.

    python -m experiments.committee out/open/ppo-1 out/open/ppo-2 out/open/ppo-3

writes out/open/committee.json, which names them. Shipped policies are named without a folder; where all are shipped, it
is out/trained/committee.json.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from agents.choosing import Committee
from agents.committee import seated
from agents.published import SHIPPED, beside, stem_of
from agents.shipped import find_policy
from antgym.console import main, parse
from antgym.errors import ParameterError
from experiments.artefact_files import COMMITTEE, TRAINED

PROG = "python -m experiments.committee"


@dataclass(frozen=True)
class Arguments:
    """Seat a committee of published policies of OneShot, all in one folder or shipped."""

    policies: Annotated[tuple[str, ...], tyro.conf.Positional]
    """NAME of NAME.json and NAME.safetensors, each as experiments.train --out wrote it, or of a shipped one."""


def seat(arguments: Arguments) -> Path:
    """Write the committee's file and return it, once all of its members were read; else all stays as it was."""
    if not arguments.policies:
        raise ParameterError(f"name the policies that sit on it, as: {PROG} out/open/ppo-1 out/open/ppo-2")
    stems = [stem_of(find_policy(policy)) for policy in arguments.policies]
    shipped = [stem for stem in stems if stem.parent.absolute() == SHIPPED.absolute()]
    folders = {stem.parent for stem in stems if stem not in shipped}
    if len(folders) > 1:
        raise ParameterError(f"a committee sits in one folder; these are in {sorted(map(str, folders))}")
    folder = folders.pop() if folders else TRAINED
    for own in (beside(folder / stem.name, ".json") for stem in shipped):
        if own.is_file():
            raise ParameterError(
                f"{own} would sit instead of the shipped {own.stem}; rename its files, or seat it as "
                f"{stem_of(own)}"
            )
    path, committee = folder / COMMITTEE, Committee(tuple(stem.name for stem in stems))
    seated(path, stems)
    folder.mkdir(parents=True, exist_ok=True)
    committee.save(path)
    return path


if __name__ == "__main__":
    main(lambda: print(f"written: {seat(parse(Arguments, None, PROG))}"))
