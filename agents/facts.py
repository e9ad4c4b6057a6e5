"""Facts of a card: what a model's spaces and its environment say of a policy, and what is told beside them."""

from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

from agents.algorithms import constructor_of, find_algorithm
from agents.published import PolicyCard, check_fields
from antgym.errors import ParameterError, nearest
from antgym.tuning import Shown, choices, shown_in

TOLD = tuple(each.name for each in fields(PolicyCard) if each.name != "sha256")
ANTS = ("alpha", "beta", "rho", "Q")
_BY_ENV = "env= and arguments= have to be those of its training"
_BY_HAND = "env= says where it was trained, or regime=, parameters= and window= do"


def card_of(model: Any, file: Path, told: Mapping[str, Any]) -> PolicyCard:
    """Return the card of a model's policy.

    Args:
        model: a trained algorithm of stable-baselines3 or sb3-contrib.
        file: that the card is for.
        told: fields of :class:`PolicyCard`; with ``env`` and its ``arguments``, regime, parameters, window and
            features follow from the environment, without they may be among these.

    Raises:
        ParameterError: on an unknown field or environment, where a field is told that the model or its environment
            says otherwise, and where the model's spaces are not those of the environment or the regime.
    """
    for name in told:
        if name not in TOLD:
            raise ParameterError(f"unknown field {name!r} of a policy's card; {nearest(name, TOLD)}")
    check_fields(file, told)
    seen, action = seen_in(model.observation_space), _kind_of(model.action_space)
    if action == "setting" and told.get("action") == "moved":  # both are a Box: only who trained it knows
        action = "moved"
    of_model = {
        "algorithm": type(model).__name__,
        "policy": _alias(model),
        "constructor": constructor_of(model.policy_kwargs),
        **seen,
        "action": action,
    }
    _require_same("the model", of_model, told)
    shown, known = _of_training(told)
    place = told.get("env") or f"{shown.regime} of {', '.join(shown.parameters)}"
    of_training = {
        "regime": shown.regime,
        "window": shown.window,
        "features": list(shown.features),
        "parameters": list(shown.parameters),
    }
    _require_same(place, of_training, told)
    card = PolicyCard(**{**told, **of_model, **of_training})
    _require_spaces(model, card, place, known if told.get("env") else {**seen, **known})
    return card


def _of_training(told: Mapping[str, Any]) -> tuple[Shown, dict[str, Any]]:
    """Return what was shown in the training, and as much as is known of its observations, see :func:`seen_in`."""
    if told.get("env"):
        env = _environment(told["env"], told.get("arguments", {}))
        return env.shown, seen_in(env.observation_space)
    shown = shown_in(told.get("regime", "OneShot"), told.get("parameters", ANTS), told.get("window", 0))
    return shown, {"size": shown.size}


def _environment(name: str, arguments: Mapping[str, Any]) -> Any:
    import gymnasium

    known = tuple(each for each in gymnasium.registry if each.startswith("antgym/"))
    if name not in known:
        raise ParameterError(f"unknown environment {name!r}; {nearest(name, known)}")
    return gymnasium.make(name, disable_env_checker=True, **arguments).unwrapped


def _require_same(place: str, found: Mapping[str, Any], told: Mapping[str, Any]) -> None:
    for name, value in found.items():
        if name in told and told[name] != value:
            way = f", or give arguments={{'window': {told[name]}}}" if name == "window" and value else ""
            raise ParameterError(
                f"{name} = {told[name]!r:.80}: {place} says {value!r:.80}; leave {name} out{way}"
            )


def _require_spaces(model: Any, card: PolicyCard, place: str, seen: Mapping[str, Any]) -> None:
    """Raise ParameterError where a model sees or does something else than the place that it is to be played in."""
    way = _BY_ENV if card.env else _BY_HAND
    for name in ("observation", "map", "size"):
        if getattr(card, name) != seen[name]:
            raise ParameterError(f"the model sees {_said(vars(card))}, {place} shows {_said(seen)}; {way}")
    if card.action in ("each", "one") and card.regime != "Control":
        raise ParameterError(
            f"the model changes settings (action {card.action!r}), as in Control alone, and {place} is of "
            f"{card.regime}; {way}"
        )
    if model.action_space != (space := done_by(card)):
        raise ParameterError(f"the model picks of {model.action_space}, {place} takes {space}; {way}")


def _said(seen: Mapping[str, Any]) -> str:
    return f"{seen['size']} numbers" + (f" and a map of {seen['map']}" if seen["map"] else "")


def _alias(model: Any) -> str:
    find_algorithm(type(model).__name__)
    for alias, kind in type(model).policy_aliases.items():
        if kind is type(model.policy):
            return str(alias)
    raise ParameterError(f"{type(model.policy).__name__} is no policy of {type(model).__name__}'s own")


def seen_in(space: Any) -> dict[str, Any]:
    """Return the fields ``size``, ``map`` and ``observation`` of a card for a space of observations."""
    parts = getattr(space, "spaces", {"features": space})
    if set(parts) - {"features", "map"} or len(parts["features"].shape) != 1:
        raise ParameterError(f"observations of {space} are none of antgym's")
    found: dict[str, Any] = {"size": int(parts["features"].shape[0]), "map": None, "observation": "features"}
    if "map" in parts:
        found["map"] = [int(side) for side in parts["map"].shape]
        found["observation"] = "map2d" if len(parts["map"].shape) == 3 else "map3d"
    return found


def _kind_of(space: Any) -> str:
    """Return what actions of a space are; a Control environment's changes are told by theirs."""
    return "each" if hasattr(space, "nvec") else "one" if hasattr(space, "n") else "setting"


def seen_by(card: PolicyCard) -> Any:
    """Return the space of what a policy sees."""
    from gymnasium import spaces

    features = spaces.Box(-float("inf"), float("inf"), (card.size,))
    if card.map is None:
        return features
    return spaces.Dict({"features": features, "map": spaces.Box(0.0, 1.0, tuple(card.map))})


def done_by(card: PolicyCard) -> Any:
    """Return the space of what a policy does."""
    from gymnasium import spaces

    dimension = len(card.parameters)
    if card.action in ("setting", "moved"):
        return spaces.Box(-1.0, 1.0, (dimension,))
    if card.action == "each":
        return spaces.MultiDiscrete(list(choices("each", dimension)))
    return spaces.Discrete(choices("one", dimension)[0])
