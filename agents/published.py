"""Published policies: NAME.json, what a policy is and how it was made, beside NAME.safetensors, its weights.

Reading one runs nothing of it: the JSON is checked field by field, and weights are numbers under names.
"""

import hashlib
import json
import re
import sys
from collections.abc import Callable, Mapping
from dataclasses import MISSING, asdict, dataclass, field, fields
from pathlib import Path
from typing import Any, Literal

from agents.artefact import write_whole
from antgym.errors import ParameterError

FORMAT, COMMITTEE = "antgym policy 1", "antgym committee 1"
REGIMES = ("OneShot", "Trials", "Control")
OBSERVATIONS = ("features", "map2d", "map3d")
ACTIONS = ("setting", "moved", "each", "one")
SHIPPED = Path(__file__).parent / "policies"
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,99}")  # of a file in the same folder, and of nothing else
_LARGEST = 1 << 12  # of any size: beyond it a card is broken, not a network


@dataclass(frozen=True)
class PolicyCard:
    """What a published policy is, and how it was made.

    Attributes:
        algorithm: that trained it, a name of ``agents.networks.ALGORITHMS``.
        policy: its class, by the algorithm's own alias, as ``"MlpPolicy"``.
        constructor: arguments of that class, those of ``agents.networks.ARGUMENTS``.
        regime: ``"OneShot"``, ``"Trials"`` or ``"Control"``.
        observation: ``"features"``, a vector alone, or ``"map2d"`` or ``"map3d"`` beside it.
        size: of the vector.
        map: shape of the map, None where there is none.
        window: trials that the observation shows, 0 in other regimes than Trials.
        features: names of the first entries of the vector, as far as they have some.
        action: ``"setting"``; ``"moved"``, a move from the start; or what is changed of the last setting, of
            ``"each"`` parameter or of ``"one"``.
        parameters: that are chosen.
        start: the setting, each value in [0, 1], that changes begin from, or one by the name of the rules; None for the
            published default.
        follows: name of the policy of OneShot, or of the committee, whose choice they begin from in place of that; "".
        follows_sha256: hash of the cards behind it.
        start_evaluations: planner runs that finding it spent, apart from ``evaluations``.
        env: id of the environment it was trained in.
        arguments: of that environment.
        evaluations: planner runs of the training.
        validation_runs: planner runs by which the best checkpoint was chosen, apart from those.
        validation_gap: mean gap of that checkpoint on validation maps; None where none was measured.
        seconds: that training took.
        seed: of the training.
        settings: of the algorithm.
        versions: of the libraries.
        history: [evaluations, validation gap] of every checkpoint.
        sha256: of the weights' file.
    """

    algorithm: str
    policy: str
    constructor: dict[str, Any]
    size: int
    regime: str = "OneShot"
    observation: str = "features"
    map: list[int] | None = None
    window: int = 0
    features: list[str] = field(default_factory=list)
    action: Literal["setting", "moved", "each", "one"] = "setting"
    parameters: list[str] = field(default_factory=list)
    start: list[float] | dict[str, list[float]] | None = None
    follows: str = ""
    follows_sha256: str = ""
    start_evaluations: int = 0
    env: str = ""
    arguments: dict[str, Any] = field(default_factory=dict)
    evaluations: int = 0
    validation_runs: int = 0
    validation_gap: float | None = None
    seconds: float = 0.0
    seed: int = 0
    settings: dict[str, Any] = field(default_factory=dict)
    versions: dict[str, str] = field(default_factory=dict)
    history: list[list[float]] = field(default_factory=list)
    sha256: str = ""


def is_whole(value: Any, low: int = 0, high: int = _LARGEST) -> bool:
    """Whether this is a whole number, and no bool, in a range."""
    return isinstance(value, int) and not isinstance(value, bool) and low <= value <= high


def is_number(value: Any) -> bool:
    """Whether this is a finite number, and no bool."""
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= sys.float_info.max


def _is_text(value: Any) -> bool:
    return isinstance(value, str)


def _listed(value: Any, fits: Callable[[Any], bool]) -> bool:
    return isinstance(value, list) and all(map(fits, value))


def _is_share(value: Any) -> bool:
    return is_number(value) and 0 <= value <= 1


def _starts(value: Any) -> list[Any]:
    """Return every setting that changes may begin from."""
    return list(value.values()) if isinstance(value, dict) else [value]


def _is_dict(value: Any) -> bool:
    return isinstance(value, dict)


_COUNT = (lambda value: is_whole(value, 0, 1 << 60)), "a whole number from 0 on"
_OBJECT = _is_dict, "an object"
_NAMES = (lambda value: _listed(value, _is_text)), "a list of names"
_TEXT = _is_text, "text"
_CHECKS: dict[str, tuple[Callable[[Any], bool], str]] = {
    "algorithm": _TEXT,
    "policy": _TEXT,
    "constructor": _OBJECT,
    "size": ((lambda value: is_whole(value, 1)), "a whole number from 1 on"),
    "regime": ((lambda value: value in REGIMES), " or ".join(REGIMES)),
    "observation": ((lambda value: value in OBSERVATIONS), " or ".join(OBSERVATIONS)),
    "map": (
        lambda value: (
            value is None or (_listed(value, lambda n: is_whole(n, 1, 128)) and len(value) in (3, 4))
        ),
        "the three or four sides of a map, or null",
    ),
    "window": (is_whole, "a whole number from 0 on"),
    "features": _NAMES,
    "action": ((lambda value: value in ACTIONS), " or ".join(ACTIONS)),
    "parameters": ((lambda value: _listed(value, _is_text) and 1 <= len(value) <= 64), "a list of names"),
    "start": (
        lambda value: value is None or all(_listed(one, _is_share) for one in _starts(value)),
        "values from 0 to 1, such by rules, or null",
    ),
    "follows": (
        lambda value: _is_text(value) and (value == "" or NAME.fullmatch(value) is not None),
        "the name of a policy, or empty",
    ),
    "follows_sha256": _TEXT,
    "start_evaluations": _COUNT,
    "env": _TEXT,
    "arguments": _OBJECT,
    "evaluations": _COUNT,
    "validation_runs": _COUNT,
    "validation_gap": ((lambda value: value is None or is_number(value)), "a number or null"),
    "seconds": (is_number, "a number"),
    "seed": ((lambda value: is_whole(value, 0, 1 << 128)), "a whole number from 0 on"),
    "settings": _OBJECT,
    "versions": (
        lambda value: isinstance(value, dict) and all(map(_is_text, value.values())),
        "an object of texts",
    ),
    "history": ((lambda value: _listed(value, lambda row: _listed(row, is_number))), "a list of numbers"),
    "sha256": _TEXT,
}
"""By field: what its value has to be, and how that is said."""


def stem_of(path: str | Path) -> Path:
    """Return NAME of NAME, NAME.json or NAME.safetensors."""
    return Path(str(path).removesuffix(".safetensors").removesuffix(".json"))


def beside(stem: Path, suffix: str) -> Path:
    """Return the file NAME plus a suffix; a name may have dots of its own."""
    return stem.with_name(stem.name + suffix)


def read_card(path: str | Path) -> PolicyCard:
    """Return the card of a published policy.

    Raises:
        ParameterError: where the file is missing or is no JSON object of this format; on a wrong field, by name.
    """
    file = beside(stem_of(path), ".json")
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise ParameterError(f"{file}: no such policy") from None
    except OSError as error:
        raise ParameterError(f"{file}: cannot be read ({error.strerror})") from None
    except (ValueError, RecursionError) as error:
        raise ParameterError(f"{file}: no JSON ({error})") from None
    form = content.pop("format", None) if isinstance(content, dict) else None
    if form == COMMITTEE:
        raise ParameterError(
            f"{file}: is a committee, which 'rl_committee' follows, and no policy; where agents are named, it is "
            f"rl_committee:{file.stem}"
        )
    if form != FORMAT:
        raise ParameterError(f"{file}: field 'format' is not {FORMAT!r}; export the policy anew")
    known = {each.name: each for each in fields(PolicyCard)}
    for name in content:
        if name not in known:
            raise ParameterError(f"{file}: unknown field {name!r}")
    for name, each in known.items():
        if name not in content and each.default is MISSING and each.default_factory is MISSING:
            raise ParameterError(f"{file}: field {name!r} is missing")
    card = PolicyCard(**content)
    _check(file, card)
    return card


def check_fields(file: Path, values: Mapping[str, Any]) -> None:
    """Raise ParameterError where the value of a field is none that it may have; it names the file and the field."""
    for name, value in values.items():
        fits, wanted = _CHECKS[name]
        if not fits(value):
            raise ParameterError(f"{file}: field {name!r} = {value!r:.80}: has to be {wanted}")


def _check(file: Path, card: PolicyCard) -> None:
    check_fields(file, vars(card))
    sides = {"features": None, "map2d": 3, "map3d": 4}[card.observation]
    if (None if card.map is None else len(card.map)) != sides:
        raise ParameterError(
            f"{file}: field 'map' = {card.map} does not fit observation {card.observation!r}"
        )
    if card.start is not None and card.follows:
        raise ParameterError(f"{file}: fields 'start' and 'follows': changes begin from one of them")
    if card.action == "moved" and card.start is None and not card.follows:
        raise ParameterError(f"{file}: field 'action' = 'moved' needs a start, or a policy that it follows")
    if card.start is not None and any(len(one) != len(card.parameters) for one in _starts(card.start)):
        raise ParameterError(f"{file}: field 'start' holds no value for each of {card.parameters}")


def read_weights(path: str | Path, sha256: str) -> bytes:
    """Return the content of the weights' file; ParameterError where its hash is not the one that the card holds."""
    file = beside(stem_of(path), ".safetensors")
    try:
        data = file.read_bytes()
    except OSError as error:
        raise ParameterError(f"{file}: cannot be read ({error.strerror})") from None
    if (found := hashlib.sha256(data).hexdigest()) != sha256:
        raise ParameterError(
            f"{file}: its hash is {found[:16]}…, but field 'sha256' of the card says {sha256[:16]!r}"
        )
    return data


def write(path: str | Path, card: PolicyCard, weights: bytes) -> None:
    """Write a policy as :func:`write_both` does; ParameterError on a field that reading it would refuse."""
    _check(beside(stem_of(path), ".json"), card)
    write_both(path, FORMAT, card, weights)


def write_both(path: str | Path, form: str, card: Any, weights: bytes) -> None:
    """Write a card and weights, each whole or not at all; a card beside weights of another shows by their hash.

    Args:
        path: NAME of NAME.json and NAME.safetensors.
        form: format that the card names.
        card: a dataclass with a field ``sha256``, which is told here.
        weights: content of the weights' file.

    Raises:
        ParameterError: on a value that is no JSON; nothing is written then.
    """
    stem = stem_of(path)
    content = {"format": form, **asdict(card), "sha256": hashlib.sha256(weights).hexdigest()}
    try:
        text = json.dumps(content, indent=1, ensure_ascii=False) + "\n"
    except TypeError as error:
        raise ParameterError(f"{beside(stem, '.json')}: holds what JSON has no form for ({error})") from None
    stem.parent.mkdir(parents=True, exist_ok=True)
    for suffix, data in ((".safetensors", weights), (".json", text.encode())):
        write_whole(beside(stem, suffix), data)
