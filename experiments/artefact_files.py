"""Files of trained agents: which of them an agent follows, where it lies, and what its making spent.

An agent follows a file of a folder. One with a name of its own, as ``rl:open-trials``, follows what comes with antgym
under that name where the folder has none.
"""

import difflib
import json
import shlex
from collections.abc import Callable, Collection, Iterable, Sequence
from pathlib import Path

import agents
from agents import committee, ensemble, policy
from agents.choosing import Committee, members_of
from agents.experience import Experience
from agents.graph import TransferGraph
from agents.published import SHIPPED, beside, stem_of
from agents.shipped import agent_name, find_policy, shipped_names
from agents.static import StaticSetting, StaticSettings
from antgym.envs.catalogue import world_of
from antgym.errors import ParameterError
from experiments import provenance

TRAINED = Path("out/trained")
MADE = "made.json"
POLICY, COMMITTEE = "policy.json", "committee.json"
ARGUMENTS = {
    "agents.static:StaticAgent": ("setting", "static.json"),
    "agents.static:StaticByRules": ("settings", "static_by_rules.json"),
    "agents.transfer:TransferAgent": ("graph", "graph.json"),
    "agents.portfolio:PortfolioAgent": ("experience", "experience.json"),
    "agents.neighbours:NeighbourAgent": ("experience", "experience.json"),
    "agents.regression:ForestAgent": ("experience", "experience.json"),
    "agents.regression:EnsembleAgent": ("ensemble", "neural.json"),
    "agents.warm_start:WarmCmaEs": ("experience", "experience.json"),
    "agents.transfer_gp:TransferGP": ("experience", "experience.json"),
    "agents.policy:PolicyAgent": ("path", POLICY),
    "agents.committee:CommitteeAgent": ("path", COMMITTEE),
}
"""Which argument of a trained agent takes which file."""
FLAGSHIPS = {POLICY: f"{policy.FLAGSHIP}.json", COMMITTEE: f"{committee.FLAGSHIP}.json"}
"""Which of these files come with antgym, and by what name."""
MAKEABLE = frozenset(kind for _, kind in ARGUMENTS.values()) - {COMMITTEE}
"""Files that experiments.artefacts makes; a committee is seated by its own command."""


def files_needed(names: Sequence[str]) -> dict[str, str]:
    """Return the files that these agents need, and by what name each is known where it has none of its own."""
    return {_file(name): kind_of(name) for name in names if agents.find_card(name).trained}


def kind_of(name: str) -> str:
    """Return by what name the file of a trained agent is known where it has none of its own."""
    return ARGUMENTS[agents.find_card(name).entry_point][1]


def _own(name: str) -> str:
    return name.partition(":")[2]


def _file(name: str) -> str:
    return f"{_own(name)}.json" if _own(name) else kind_of(name)


def file_of(name: str, folder: Path | None) -> Path:
    """Return the file that a trained agent follows, there or not.

    Without a folder it is what comes with antgym, for ``rl``, ``rl_committee`` and names of what is shipped, or a file
    of TRAINED. In a folder, a file of its own is the shipped one only where the folder has none.
    """
    here, kind = (folder or TRAINED) / _file(name), kind_of(name)
    if kind not in FLAGSHIPS or (folder and (here.exists() or not _own(name))):
        return here
    shipped = SHIPPED / (here.name if _own(name) else FLAGSHIPS[kind])
    return shipped if shipped.is_file() else here


def trained_argument(name: str, folder: Path | None) -> dict[str, Path]:
    """Return the keyword argument by which an agent finds its file, see :func:`file_of`; empty where it needs none."""
    card = agents.find_card(name)
    return {ARGUMENTS[card.entry_point][0]: file_of(name, folder)} if card.trained else {}


def policy_file(name: str, folder: Path | None) -> Path:
    """Return NAME of a policy's files, which is named as such or as the agent that follows it, ``rl:NAME``.

    Raises:
        ParameterError: where there is none; it names the nearest that is shipped, or the nearest agent.
    """
    if name.startswith("rl:"):
        require_there([name], folder)
        return stem_of(file_of(name, folder))
    return stem_of(find_policy(name, *agents.CATALOGUE))


def require_there(
    names: Iterable[str], folder: Path | None, suite: str = "", makes: Collection[str] = ()
) -> None:
    """Raise ParameterError where a file that an agent needs is not there; it names the command that makes it.

    Args:
        names: of agents.
        folder: of their files.
        suite: that is learnt from, for the command; "" for the command's own.
        makes: files that are made where they are missing.
    """
    for name in names:
        for path in trained_argument(name, folder).values():
            if path.name not in makes and not path.exists():
                raise ParameterError(f"agent {name!r}: {path} is not there; {way_to(name, path, suite)}")


def way_to(name: str, path: Path, suite: str = "") -> str:
    """Return the clause that says how an agent comes by its file."""
    known, folder = name.partition(":")[0], path.parent
    if kind_of(name) in FLAGSHIPS:
        shipped = [
            one
            for one in (agent_name(SHIPPED / stem) for stem in shipped_names())
            if one.startswith(f"{known}:")
        ]
        close = difflib.get_close_matches(name, shipped, n=1) if _own(name) else []
        meant = f"did you mean {close[0]!r}? " if close else ""
        world = world_of(suite)
        other = f"--kwargs {shlex.quote(json.dumps({'suite': suite}))} " if suite else ""
        made_on = f"antgym/{world}OneShot-v0 " if world else other
        make = f"train PPO {made_on}--out {path.with_suffix('')}"
        if kind_of(name) == COMMITTEE:
            make = f"committee {folder}/POLICY {folder}/POLICY"
        return f"{meant}shipped: {', '.join(shipped)}; one of your own: python -m experiments.{make}"
    make = f"python -m experiments.artefacts {known}{f' --suite {suite}' if suite else ''} --out"
    if _own(name):
        return (
            f"what has a name of its own is made apart: {make} ANOTHER makes a {kind_of(name)} to put there"
        )
    return f"make it with: {make} {folder}"


def trained_hashes(folder: Path, names: Sequence[str] = ()) -> dict[str, str]:
    """Return the hashes of the files that agents were trained to, by name, which a ledger is tied to.

    They are those of a folder, and what these agents follow of what is shipped.
    """
    files = [path for path in sorted(folder.iterdir()) if path.is_file() and path.name != MADE]
    return followed_hashes(folder, names) | {path.name: provenance.file_hash(path) for path in files}


def followed_hashes(folder: Path, names: Iterable[str]) -> dict[str, str]:
    """Return the hashes of the files that these agents follow, by name; of members by that of their committee, too."""
    files: dict[str, Path] = {}
    for name in names:
        for path in trained_argument(name, folder).values():
            files[path.name] = path
            if kind_of(name) == COMMITTEE:  # a member may be shipped where the folder has another of its name
                cards = (beside(member, ".json") for member in members_of(path))
                files |= {f"{path.name}: {card.name}": card for card in cards}  # with the hashes of weights
    return {name: provenance.file_hash(path) for name, path in files.items()}


def spent(folder: Path, names: Sequence[str]) -> dict[str, int]:
    """Return what the making of each file that these agents need has spent; ParameterError where one is missing."""
    evaluations: dict[str, Callable[[Path], int]] = {
        "static.json": lambda path: StaticSetting.load(path).evaluations,
        "static_by_rules.json": lambda path: StaticSettings.load(path).evaluations,
        "graph.json": lambda path: TransferGraph.load(path).evaluations,
        "experience.json": lambda path: Experience.load(path).evaluations,
        "neural.json": lambda path: ensemble.read_card(path).evaluations,
        POLICY: _policy_evaluations,
        COMMITTEE: Committee.evaluations,
    }
    require_there(names, folder)
    trained = {_file(name): name for name in names if agents.find_card(name).trained}
    return {file: evaluations[kind_of(name)](file_of(name, folder)) for file, name in sorted(trained.items())}


def _policy_evaluations(card: Path) -> int:
    return int(json.loads(card.read_text(encoding="utf-8"))["evaluations"])
