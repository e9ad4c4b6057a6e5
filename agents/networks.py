"""Networks of published policies: built from closed tables of classes and arguments, filled with weights by name."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from agents.algorithms import EXTRACTORS, Algorithm, check_constructor, constructor_of, find_algorithm
from agents.published import PolicyCard, read_card, read_weights, stem_of, write
from antgym.errors import MissingExtraError, ParameterError, nearest
from antgym.tuning import choices


class Player:
    """A policy on one episode; a recurrent one remembers what it has seen of it."""

    def __init__(self, network: Any) -> None:
        self._network, self._state, self._first = network, None, True

    def act(self, observation: Any) -> NDArray[Any]:
        """Return the deterministic action for what is seen now."""
        action, self._state = self._network.predict(
            observation, state=self._state, episode_start=np.array([self._first]), deterministic=True
        )
        self._first = False
        return np.asarray(action)


def algorithm_class(name: str) -> Any:
    """Return the class of an algorithm; MissingExtraError where its library is not installed."""
    module = find_algorithm(name).module
    torch_alone()
    try:
        return getattr(import_module(module), name)
    except ModuleNotFoundError as error:
        raise MissingExtraError(module.replace("_", "-"), "rl") from error


def torch_alone() -> Any:
    """Return torch, kept to one thread: the nets are tiny, and more threads only fight the planner's."""
    try:
        import torch
    except ModuleNotFoundError as error:
        raise MissingExtraError("torch", "rl") from error
    torch.set_num_threads(1)
    return torch


def _safetensors() -> Any:
    try:
        return import_module("safetensors.torch")
    except ModuleNotFoundError as error:
        raise MissingExtraError("safetensors", "rl") from error


def to_bytes(state: Mapping[str, Any]) -> bytes:
    """Return weights by name as the content of a .safetensors file."""
    return bytes(
        _safetensors().save(
            {name: value.detach().cpu().contiguous().clone() for name, value in state.items()}
        )
    )


def load(path: str | Path) -> tuple[PolicyCard, Any]:
    """Return a published policy: its card, and its network, which ``predict`` asks.

    Raises:
        ParameterError: where the files are missing or damaged; the message names file and field.
        MissingExtraError: without the extra ``rl``.
    """
    card = read_card(path)
    try:
        network, data = _build(card), read_weights(path, card.sha256)
        fill(network, _needed(find_algorithm(card.algorithm), network.state_dict()), data)
        network.set_training_mode(False)
        return card, network
    except ParameterError as error:
        stem = str(stem_of(path))
        place = "" if str(error).startswith(stem) else f"{stem}: "
        raise ParameterError(f"{place}{error}") from None


def export(model: Any, path: str | Path, **facts: Any) -> PolicyCard:
    """Publish the policy of a model of stable-baselines3 or sb3-contrib: what acting needs of it, nothing else.

    Args:
        model: a trained algorithm.
        path: NAME of the two files.
        facts: fields of :class:`PolicyCard` that a model does not know: ``env``, ``regime``, ``evaluations``, ...

    Returns:
        The card, as written.

    Raises:
        ParameterError: where the policy is built from what a card cannot hold.
    """
    name = type(model).__name__
    weights = to_bytes(_needed(find_algorithm(name), model.policy.state_dict()))
    card = PolicyCard(
        algorithm=name,
        policy=_alias(model),
        constructor=constructor_of(model.policy_kwargs),
        **_spaces(model.observation_space, model.action_space),
    )
    card = replace(card, **facts)
    write(path, card, weights)
    return load(path)[0]


def _alias(model: Any) -> str:
    for alias, kind in type(model).policy_aliases.items():
        if kind is type(model.policy):
            return str(alias)
    raise ParameterError(f"{type(model.policy).__name__} is no policy of {type(model).__name__}'s own")


def _spaces(observation: Any, action: Any) -> dict[str, Any]:
    """Return the fields of a card that a model's spaces decide; a Control environment's changes are told by theirs.

    Spaces do not name parameters: they are taken for those of ants where the facts of the training tell no others.
    """
    found: dict[str, Any] = {"action": "setting", "parameters": ["alpha", "beta", "rho", "Q"]}
    parts = getattr(observation, "spaces", {"features": observation})
    if set(parts) - {"features", "map"} or len(parts["features"].shape) != 1:
        raise ParameterError(f"observations of {observation} are none of antgym's")
    found["size"] = int(parts["features"].shape[0])
    if "map" in parts:
        found["map"] = [int(side) for side in parts["map"].shape]
        found["observation"] = "map2d" if len(found["map"]) == 3 else "map3d"
    if hasattr(action, "nvec"):
        found["action"] = "each"
    elif hasattr(action, "n"):
        found["action"] = "one"
    return found


def _build(card: PolicyCard) -> Any:
    """Return the policy that a card describes, its weights as they come."""
    kind = algorithm_class(card.algorithm)
    if card.policy not in kind.policy_aliases:
        known = tuple(kind.policy_aliases)
        raise ParameterError(
            f"field 'policy': {card.algorithm} has no {card.policy!r}; {nearest(card.policy, known)}"
        )
    if card.action not in find_algorithm(card.algorithm).actions:
        raise ParameterError(f"field 'action': {card.algorithm} does not learn {card.action!r}")
    check_constructor(card.constructor)
    import torch

    given = dict(card.constructor)
    if "activation_fn" in given:
        given["activation_fn"] = getattr(torch.nn, given["activation_fn"])
    if "features_extractor_class" in given:
        reader = given["features_extractor_class"]
        given["features_extractor_class"] = getattr(import_module(EXTRACTORS[reader]), reader)
    if card.algorithm != "ARS":  # which has no optimiser
        given["lr_schedule"] = _no_learning
    try:
        return kind.policy_aliases[card.policy](_seen(card), _done(card), **given)
    except (TypeError, ValueError, AssertionError, RuntimeError, KeyError, AttributeError) as error:
        raise ParameterError(f"field 'constructor': builds no {card.policy} ({error})") from None


def _no_learning(_: float) -> float:
    return 0.0


def _seen(card: PolicyCard) -> Any:
    from gymnasium import spaces

    features = spaces.Box(-np.inf, np.inf, (card.size,), np.float32)
    if card.map is None:
        return features
    return spaces.Dict({"features": features, "map": spaces.Box(0.0, 1.0, tuple(card.map), np.float32)})


def _done(card: PolicyCard) -> Any:
    from gymnasium import spaces

    dimension = len(card.parameters)
    if card.action in ("setting", "moved"):
        return spaces.Box(-1.0, 1.0, (dimension,), np.float32)
    if card.action == "each":
        return spaces.MultiDiscrete(list(choices("each", dimension)))
    return spaces.Discrete(choices("one", dimension)[0])


def fill(network: Any, wanted: Mapping[str, Any], data: bytes) -> None:
    """Fill a network with weights, which are those it needs, no more and no fewer.

    Args:
        network: a module of torch.
        wanted: those entries of its state dict that it needs.
        data: content of a .safetensors file.

    Raises:
        ParameterError: where the content is none, or holds other names, shapes or types, or what is not finite.
    """
    parse = _safetensors().load
    from safetensors import SafetensorError

    try:
        weights = parse(data)
    except (SafetensorError, ValueError, KeyError) as error:
        raise ParameterError(f"the weights are no safetensors ({error})") from None
    _require_same(sorted(weights), sorted(wanted))
    for name, value in wanted.items():
        if weights[name].shape != value.shape or weights[name].dtype != value.dtype:
            found = f"{tuple(weights[name].shape)} of {weights[name].dtype}"
            raise ParameterError(
                f"weights {name!r} are {found}, the network's {tuple(value.shape)} of {value.dtype}"
            )
        if value.is_floating_point() and not weights[name].isfinite().all():
            raise ParameterError(f"weights {name!r} are not finite")
    network.load_state_dict(weights, strict=False)  # what is left out acting does not need


def _require_same(found: Sequence[str], wanted: Sequence[str]) -> None:
    for name in wanted:
        if name not in found:
            raise ParameterError(f"weights {name!r} are missing")
    for name in found:
        if name not in wanted:
            raise ParameterError(f"weights {name!r} belong to no part of the network")


def _needed(algorithm: Algorithm, state: Mapping[str, Any]) -> dict[str, Any]:
    """Return the entries of a state dict that acting needs."""
    return {
        name: value
        for name, value in state.items()
        if name.startswith(algorithm.actor) and not name.startswith(algorithm.without)
    }
