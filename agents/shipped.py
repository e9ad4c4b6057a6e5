"""Shipped policies and committees: what comes with antgym is found by its name wherever the file of one is taken."""

from pathlib import Path

from agents.published import SHIPPED, beside, stem_of
from antgym.errors import ParameterError, nearest


def shipped_names() -> tuple[str, ...]:
    """Return the names of the policies and committees that come with antgym."""
    return tuple(sorted(path.stem for path in SHIPPED.glob("*.json")))


def agent_name(stem: Path) -> str:
    """Return by what name an agent follows a file: a committee has no weights of its own."""
    return f"{'rl' if beside(stem, '.safetensors').is_file() else 'rl_committee'}:{stem.name}"


def find_policy(path: str | Path, *others: str) -> Path:
    """Return the path of a policy or a committee as it is given, or that of the shipped one where there is no file.

    Args:
        path: NAME of NAME.json, that file, or the name of what is shipped, which has neither folder nor suffix.
        others: names of another kind that could have been meant.

    Raises:
        ParameterError: where a name without a folder is of neither, or a file is asked for that is not here; it names
            the nearest.
    """
    given, stem = Path(path), stem_of(path)
    if stem.name and (stem != Path(stem.name) or beside(stem, ".json").exists()):
        return given
    known = shipped_names()
    if str(path) not in known:  # "./NAME" and "NAME.json" mean a file
        raise ParameterError(f"{stem}.json: no such policy; {nearest(stem.name, (*known, *others))}")
    return SHIPPED / stem.name
