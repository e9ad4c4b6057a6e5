"""The archive: finished draws, a JSON file each, so that a replay that was stopped goes on where it was."""

import json
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

import agents
from agents.artefact import as_tuples
from antgym.console import write_whole
from antgym.errors import LedgerError
from experiments.provenance import code_hash, file_hash
from experiments.tables.liu2020.draw import Answer, Arguments, Draw
from experiments.tables.liu2020.methods import METHODS, Trained

FORMAT = "antgym liu2020 draw 1"
HERE = Path(__file__).parent
CODE = (HERE / "draw.py", HERE / "methods.py", HERE.parent / "draws.py", HERE.parents[1] / "artefacts.py")


def origin(arguments: Arguments, trained: Trained) -> dict[str, Any]:
    """Return what decides a draw, flat: arguments, code, trained files and the versions of libraries."""
    origin: dict[str, Any] = {name: getattr(arguments, name) for name in ("rules", "share", "seed")}
    origin["code"] = code_hash(*CODE)
    origin.update({name: file_hash(trained.folder / name) for name in trained.spent})
    origin.update({name: version(name) for name in ("numba", "scipy")})
    for method in METHODS:
        origin.update(agents.versions(method.agent))
    return origin


class Archive:
    """The finished draws of a replay, in one folder.

    Args:
        folder: made with the first draw that is kept.
        origin: what decides a draw, flat and JSON; a draw that was made with anything else is refused.
    """

    def __init__(self, folder: Path, origin: Mapping[str, Any]) -> None:
        self.folder = folder
        self._origin = dict(origin)

    def read(self, number: int) -> Draw | None:
        """Return a draw, None where it is not finished; LedgerError where it is damaged or of another origin."""
        path = self._path(number)
        if not path.exists():
            return None
        try:
            content = json.loads(path.read_text(encoding="utf-8"))
            form, then = content.pop("format"), dict(content.pop("origin"))
            answers = tuple(Answer(**_tuples(fields)) for fields in content.pop("answers"))
            draw = Draw(**_tuples(content), answers=answers)
        except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
            raise LedgerError(
                f"{path} is damaged ({error}); remove it, and this draw is played again"
            ) from None
        now = {**self._origin, "format": FORMAT}
        self._require_same(path, {**then, "format": form}, now)
        return draw

    def keep(self, draw: Draw) -> None:
        """Write a draw; on return it is there as a whole."""
        answers = [answer._asdict() for answer in draw.answers]
        content = {"format": FORMAT, "origin": self._origin, **draw._asdict(), "answers": answers}
        write_whole(self._path(draw.number), (json.dumps(content, indent=1) + "\n").encode())

    def _path(self, number: int) -> Path:
        return self.folder / f"draw-{number:02d}.json"

    def _require_same(self, path: Path, then: Mapping[str, Any], now: Mapping[str, Any]) -> None:
        names = sorted(name for name in {*then, *now} if then.get(name) != now.get(name))
        if names:
            changes = "; ".join(f"{name}: {then.get(name)}, now {now.get(name)}" for name in names)
            raise LedgerError(
                f"{path} was made with something else ({changes}); use another --out, or remove {self.folder} to "
                "begin anew"
            )


def _tuples(fields: Mapping[str, Any]) -> dict[str, Any]:
    return {name: as_tuples(value) for name, value in fields.items()}
