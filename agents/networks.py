"""Networks of published policies: built from closed tables of classes and arguments, filled with weights by name."""

from collections.abc import Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from agents.algorithms import EXTRACTORS, Algorithm, check_constructor, find_algorithm
from agents.facts import card_of, done_by, seen_by
from agents.published import PolicyCard, beside, read_card, read_weights, stem_of, write
from antgym.errors import MissingExtraError, ParameterError, nearest


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
        return card, _network(card, read_weights(path, card.sha256))
    except ParameterError as error:
        stem = str(stem_of(path))
        place = "" if str(error).startswith(stem) else f"{stem}: "
        raise ParameterError(f"{place}{error}") from None


def export(model: Any, path: str | Path, **facts: Any) -> PolicyCard:
    """Publish the policy of a model of stable-baselines3 or sb3-contrib: what acting needs of it, nothing else.

    A card says where a policy may be played. With ``env`` the environment says so, as it is made with ``arguments``::

        export(model, "out/mine", env="antgym/RoomTrials-v0", arguments={"window": 3}, evaluations=8192)

    Without, the policy is taken for one of OneShot of ants, unless ``regime``, ``parameters`` and ``window`` say what
    else it is.

    Args:
        model: a trained algorithm.
        path: NAME of the two files.
        facts: fields of :class:`PolicyCard` that a model does not know: ``env``, ``arguments``, ``evaluations``, ...;
            ``action="moved"`` and ``start`` where its actions are moves from a start.

    Returns:
        The card, as written.

    Raises:
        ParameterError: where the policy is built from what a card cannot hold, on an unknown field or environment, and
            where the model's spaces are not those of the environment or regime. Nothing is written then.
    """
    card = card_of(model, beside(stem_of(path), ".json"), facts)
    weights = to_bytes(_needed(find_algorithm(card.algorithm), model.policy.state_dict()))
    _network(card, weights)  # what cannot be read again is not written
    write(path, card, weights)
    return read_card(path)


def _network(card: PolicyCard, data: bytes) -> Any:
    """Return the network that a card describes, filled with the content of its weights' file."""
    network = _build(card)
    fill(network, _needed(find_algorithm(card.algorithm), network.state_dict()), data)
    network.set_training_mode(False)
    return network


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
        return kind.policy_aliases[card.policy](seen_by(card), done_by(card), **given)
    except (TypeError, ValueError, AssertionError, RuntimeError, KeyError, AttributeError) as error:
        raise ParameterError(f"field 'constructor': builds no {card.policy} ({error})") from None


def _no_learning(_: float) -> float:
    return 0.0


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
