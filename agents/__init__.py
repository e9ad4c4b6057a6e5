"""Agents: who picks the parameters. One file a family, all behind ``antgym.tuning.Agent``.

``agents.make("ga")`` builds an agent by name. Names are bound to strings, so a library is imported only when
an agent that needs it is made. Not part of the wheel: run from a checkout.
"""

import inspect
from collections.abc import Callable, Mapping
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING, Any

from agents.catalogue import CATALOGUE, Card
from agents.published import SHIPPED, beside, stem_of
from agents.shipped import agent_name, shipped_names
from antgym.errors import MissingExtraError, ParameterError, nearest

if TYPE_CHECKING:
    from antgym.tuning import Agent

FOLLOWERS = (
    "agents.policy:PolicyAgent",
    "agents.committee:CommitteeAgent",
)  # of files that antgym ships, too
__all__ = ["CATALOGUE", "Card", "find_card", "make", "to_markdown", "versions"]


def find_card(name: str) -> Card:
    """Return an agent's card; ParameterError names the nearest known agent.

    A trained agent may be named with a file of its own behind a colon: ``"rl:NAME"`` is ``rl`` by another name, which
    harnesses give NAME.json. So policies of several trainings take part beside each other, and shipped ones by name.

    ``"path/to/my_agent.py:MyAgent"`` is an agent of one's own, or of a stranger, which is played in a process of its
    own; the folder of a submission is what was submitted.
    """
    if name not in CATALOGUE and (foreign := _foreign_card(name)):
        return foreign
    known, _, file = name.partition(":")
    if name in shipped_names():
        raise ParameterError(
            f"unknown agent {name!r}; the shipped {name} is followed as {agent_name(SHIPPED / name)!r}"
        )
    if known not in CATALOGUE or (":" in name and not (file and CATALOGUE[known].trained)):
        raise ParameterError(f"unknown agent {name!r}; {nearest(name, tuple(CATALOGUE))}")
    return CATALOGUE[known]._replace(name=name)


def make(name: str, **overrides: Any) -> "Agent":
    """Build an agent by name.

    Args:
        name: a key of ``CATALOGUE``; ``"rl:NAME"`` of a policy or ``"rl_committee:NAME"`` of a committee, whose file
            lies where this runs, or is shipped.
        overrides: arguments of the agent's class; a trained agent needs its artefact here (``graph=``,
            ``path=``).

    Raises:
        ParameterError: on an unknown agent, an unknown argument or a missing artefact.
        MissingExtraError: if the library behind the agent is not installed.
    """
    card = find_card(name)
    module, _, attribute = card.entry_point.partition(":")
    build = getattr(import_module(module), attribute)
    kwargs = {**_own_file(card), **card.kwargs, **overrides}
    _check_arguments(name, build, kwargs)
    agent: Agent = build(**kwargs)
    return agent


def _own_file(card: Card) -> dict[str, str]:
    """Return the argument that a name behind a colon stands for, where an agent finds a file by its name."""
    own = card.name.partition(":")[2]
    return {"path": own} if own and card.entry_point in FOLLOWERS else {}


def _foreign_card(name: str) -> Card | None:
    """Return the card of an agent from a file or of a submission, None where the name is of neither kind."""
    if name.partition(":")[0].endswith(".py"):
        from agents.stranger import find_class

        file, kind, summary = find_class(name)
        made_with = {"file": str(file), "kind": kind}
        return Card(name, "agents.stranger:Stranger", made_with, summary, files=(file,))
    is_folder, stem = Path(name).is_dir(), stem_of(name)
    if not is_folder and stem.name and beside(stem, ".json").is_file():
        raise ParameterError(
            f"unknown agent {name!r}; what is in this file is followed as {agent_name(stem)!r}, with the artefacts of "
            f"the folder {stem.parent}"
        )
    if "/" in name or is_folder:
        from agents.submission import card_of

        return card_of(name)
    return None


def to_markdown() -> str:
    """Return the table of all agents that the README shows: who, what, with which arguments, from which extra."""
    lines = ["| agent | what it does | settings | extra |", "|---|---|---|---|"]
    for card in CATALOGUE.values():
        settings = ", ".join(f"{name}={value!r}" for name, value in card.kwargs.items())
        name = f"`{card.name}`" + ("\\*" if card.trained else "")
        summary = card.summary.replace("|", "\\|")
        cells = (name, summary, f"`{settings}`" if settings else "", card.needs or "")
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def versions(name: str) -> dict[str, str]:
    """Return {distribution: version} of the libraries an agent's results depend on, for ledgers."""
    card = find_card(name)
    return {library: _version(library, card) for library in ("numpy", *card.libraries)}


def _version(library: str, card: Card) -> str:
    try:
        return version(library)
    except PackageNotFoundError:
        raise MissingExtraError(library, card.needs or "agents") from None


def _check_arguments(name: str, build: Callable[..., Any], kwargs: Mapping[str, Any]) -> None:
    parameters = inspect.signature(build).parameters
    open_ended = any(p.kind is p.VAR_KEYWORD for p in parameters.values())
    known = tuple(n for n, p in parameters.items() if p.kind is not p.VAR_KEYWORD)
    for key in kwargs:
        if key not in known and not open_ended:
            raise ParameterError(f"agent {name!r} has no argument {key!r}; {nearest(key, known)}")
    missing = [n for n in known if parameters[n].default is inspect.Parameter.empty and n not in kwargs]
    if missing:
        raise ParameterError(f"agent {name!r} needs {missing[0]}=, the fitted artefact it works with")
