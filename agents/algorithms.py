"""Closed tables of what a published policy may be made of: algorithms, classes, and the arguments of these."""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from agents.published import is_number, is_whole
from antgym.errors import ParameterError, nearest

_CRITIC = ("value_net.", "mlp_extractor.value_net.", "vf_features_extractor.", "lstm_critic.", "critic.")
_UNUSED = (*_CRITIC, "pi_features_extractor.")  # the last: the same tensors under another name


class Algorithm(NamedTuple):
    """An algorithm of stable-baselines3 or sb3-contrib.

    Attributes:
        module: that holds its class.
        actions: kinds of actions that it learns, see ``PolicyCard.action``.
        actor: prefix of the weights that acting needs; the empty one means all but those of ``without``.
        without: prefixes of weights that acting does not need.
        recurrent: whether its policies remember an episode.
    """

    module: str
    actions: tuple[str, ...]
    actor: str = ""
    without: tuple[str, ...] = ()
    recurrent: bool = False


_SB3, _CONTRIB = "stable_baselines3", "sb3_contrib"
_ANY, _BOX = ("setting", "moved", "each", "one"), ("setting", "moved")
ALGORITHMS = {
    "PPO": Algorithm(_SB3, _ANY, without=_UNUSED),
    "A2C": Algorithm(_SB3, _ANY, without=_UNUSED),
    "TRPO": Algorithm(_CONTRIB, _ANY, without=_UNUSED),
    "RecurrentPPO": Algorithm(_CONTRIB, _ANY, without=_UNUSED, recurrent=True),
    "ARS": Algorithm(_CONTRIB, ("setting", "moved", "one")),
    "SAC": Algorithm(_SB3, _BOX, "actor."),
    "TD3": Algorithm(_SB3, _BOX, "actor."),
    "DDPG": Algorithm(_SB3, _BOX, "actor."),
    "TQC": Algorithm(_CONTRIB, _BOX, "actor."),
    "CrossQ": Algorithm(_CONTRIB, _BOX, "actor."),
    "DQN": Algorithm(_SB3, ("one",), "q_net."),
    "QRDQN": Algorithm(_CONTRIB, ("one",), "quantile_net."),
}
EXTRACTORS = {
    "FeatureExtractor": "antgym.envs.extractors",
    "MapExtractor": "antgym.envs.extractors",
}
"""What reads observations, and its module: layers of a network, which see what the policy is shown and no more."""
ACTIVATIONS = ("ReLU", "Tanh", "ELU", "LeakyReLU", "SiLU", "GELU")


def _is_layers(value: Any) -> bool:
    return isinstance(value, list) and len(value) <= 8 and all(is_whole(n, 1, 1024) for n in value)


def _is_architecture(value: Any) -> bool:
    if isinstance(value, dict):
        return set(value) <= {"pi", "vf", "qf"} and all(map(_is_layers, value.values()))
    return _is_layers(value)


def _is_count(value: Any) -> bool:
    return is_whole(value, 1, 1024)


def _is_bool(value: Any) -> bool:
    return isinstance(value, bool)


ARGUMENTS: dict[str, Callable[[Any], bool]] = {
    "net_arch": _is_architecture,
    "activation_fn": lambda value: value in ACTIVATIONS,
    "log_std_init": is_number,
    "features_extractor_class": lambda value: value in EXTRACTORS,
    "features_extractor_kwargs": lambda value: (
        isinstance(value, dict) and set(value) <= {"width"} and all(map(_is_count, value.values()))
    ),
    **dict.fromkeys(("n_quantiles", "lstm_hidden_size"), _is_count),
    **dict.fromkeys(("n_critics", "n_lstm_layers"), lambda value: is_whole(value, 1, 8)),  # each a net
    **dict.fromkeys(
        ("enable_critic_lstm", "shared_lstm", "ortho_init", "with_bias", "squash_output"), _is_bool
    ),
}
"""Constructor arguments that a card may hold, and what each has to be."""


def find_algorithm(name: str) -> Algorithm:
    """Return a row of ``ALGORITHMS``; ParameterError names the nearest."""
    if name not in ALGORITHMS:
        raise ParameterError(f"unknown algorithm {name!r}; {nearest(name, tuple(ALGORITHMS))}")
    return ALGORITHMS[name]


def constructor_of(kwargs: Mapping[str, Any]) -> dict[str, Any]:
    """Return the arguments of a policy as JSON."""
    given = {name: value for name, value in kwargs.items() if not name.startswith("optimizer")}
    if given.pop("use_sde", False):
        raise ParameterError("use_sde: state-dependent exploration cannot be published")
    for name in ("activation_fn", "features_extractor_class"):
        if name in given:
            given[name] = given[name].__name__
    if "features_extractor_kwargs" in given:
        kept = dict(given["features_extractor_kwargs"])
        given["features_extractor_kwargs"] = {k: v for k, v in kept.items() if k not in ("mean", "deviation")}
    check_constructor(given)
    return given


def check_constructor(constructor: Mapping[str, Any]) -> None:
    """Raise ParameterError on an argument that is not in ``ARGUMENTS``, or not what it has to be."""
    for name, value in constructor.items():
        if name not in ARGUMENTS:
            raise ParameterError(f"field 'constructor': no policy takes {name!r} from a file")
        if not ARGUMENTS[name](value):
            raise ParameterError(f"field 'constructor': {name} = {value!r:.80} is none that can be published")
