"""Nets that predict what the settings of an experience cost on a map, from its features; fitted once, kept as data.

NAME.json says what they are and how they were made, NAME.safetensors holds their weights. Reading both runs nothing of
them, see ``agents.artefact`` and ``agents.networks``.
"""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from importlib.metadata import version
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from agents import artefact
from agents.artefact import as_array, as_tuples
from agents.experience import FAR, Experience, Spread, require_alike
from agents.networks import fill, to_bytes, torch_alone
from agents.published import beside, is_number, is_whole, read_weights, stem_of, write_both
from antgym.errors import ParameterError
from antgym.tuning import Task

Floats = NDArray[np.float64]
FORMAT = "antgym ensemble 1"
NETS, HIDDEN, EPOCHS, BATCH = 4, (128, 128), 60, 64
DROPOUT, RATE, DECAY = 0.1, 2e-3, 1e-2
LIBRARIES = ("numpy", "torch")


@dataclass(frozen=True)
class EnsembleCard:
    """What an ensemble is, and how it was made.

    Attributes:
        parameters: names of the d parameters.
        described: names of the f features.
        mean: (f,) what is subtracted from features.
        scale: (f,) what they are then multiplied by; 0 where all maps were alike.
        units: k settings, each of d values in [0, 1], whose log regrets are predicted.
        noise: variance of the log costs of runs, see :class:`agents.experience.Spread`.
        between: variance of a setting's rank from map to map.
        nets: how many there are.
        hidden: units of each net's hidden layers.
        evaluations: trials of the experience that they were fitted to: what training spent.
        seconds: that fitting took.
        seed: of the fitting.
        settings: of the fitting.
        versions: of the libraries.
        provenance: of the experience.
        sha256: of the weights' file.

    Raises:
        ParameterError: names the field that is not what it has to be.
    """

    parameters: tuple[str, ...]
    described: tuple[str, ...]
    mean: tuple[float, ...]
    scale: tuple[float, ...]
    units: tuple[tuple[float, ...], ...]
    noise: float
    between: float
    nets: int = NETS
    hidden: tuple[int, ...] = HIDDEN
    evaluations: int = 0
    seconds: float = 0.0
    seed: int = 0
    settings: Mapping[str, Any] = field(default_factory=dict, hash=False)
    versions: Mapping[str, str] = field(default_factory=dict, hash=False)
    provenance: Mapping[str, Any] = field(default_factory=dict, hash=False)
    sha256: str = ""

    def __post_init__(self) -> None:
        for each in fields(self):
            fits, wanted = _CHECKS[each.name]
            if not fits(value := getattr(self, each.name)):
                raise ParameterError(f"field {each.name!r} = {value!r:.80}: has to be {wanted}")
        for name, shape in (
            ("mean", (len(self.described),)),
            ("scale", (len(self.described),)),
            ("units", (max(1, len(self.units)), len(self.parameters))),
        ):
            values = as_array(getattr(self, name), f"field {name!r}")
            if values.shape != shape or not np.isfinite(values).all():
                raise ParameterError(f"field {name!r}: has to be {shape} finite numbers, is {values.shape}")
        if not ((as_array(self.units, "units") >= 0) & (as_array(self.units, "units") <= 1)).all():
            raise ParameterError("field 'units': settings have to lie in [0, 1]")


def _are_names(value: Any) -> bool:
    return isinstance(value, tuple) and len(value) > 0 and all(isinstance(name, str) for name in value)


def _are_sizes(value: Any) -> bool:
    return isinstance(value, tuple) and len(value) <= 8 and all(is_whole(size, 1) for size in value)


_NAMES = _are_names, "a list of names"
_TABLE = (lambda value: isinstance(value, tuple)), "a list of numbers"
_VARIANCE = (lambda value: is_number(value) and value >= 0), "a number from 0 on"
_COUNT = (lambda value: is_whole(value, 0, 1 << 60)), "a whole number from 0 on"
_OBJECT = (lambda value: isinstance(value, Mapping)), "an object"
_CHECKS: dict[str, tuple[Callable[[Any], bool], str]] = {
    **dict.fromkeys(("parameters", "described"), _NAMES),
    **dict.fromkeys(("mean", "scale", "units"), _TABLE),
    **dict.fromkeys(("noise", "between", "seconds"), _VARIANCE),
    **dict.fromkeys(("evaluations", "seed"), _COUNT),
    **dict.fromkeys(("settings", "versions", "provenance"), _OBJECT),
    "nets": ((lambda value: is_whole(value, 1, 64)), "a whole number from 1 to 64"),
    "hidden": (_are_sizes, "a list of whole numbers from 1 on, eight at most"),
    "sha256": ((lambda value: isinstance(value, str)), "text"),
}
"""By field: what its value has to be, and how that is said."""


class Ensemble:
    """Nets, each of which predicts the log regrets of all k settings of an experience on a map, from its features.

    Args:
        card: what they are.
        network: a list of modules of torch, one a net.
    """

    def __init__(self, card: EnsembleCard, network: Any) -> None:
        self.card, self._network = card, network.train(False)

    @cached_property
    def settings(self) -> Floats:
        """The settings, (k, d) in [0, 1]."""
        return np.array(self.card.units)

    @property
    def spread(self) -> Spread:
        """How far runs and maps differ, of the experience."""
        return Spread(self.card.noise, self.card.between)

    def predict(self, task: Task) -> Floats:
        """Return every net's log regrets, (nets, k); ParameterError where a task does not fit the experience."""
        require_alike(task, self.card.parameters, self.card.described)
        torch = torch_alone()
        shown = torch.from_numpy(_shown(self.card, task.features[None]))
        with torch.inference_mode():
            return np.array([net(shown)[0].numpy() for net in self._network], dtype=np.float64)

    @classmethod
    def fit(
        cls,
        experience: Experience,
        *,
        nets: int = NETS,
        seed: int = 0,
        epochs: int = EPOCHS,
        advance: Callable[[int], None] = lambda _: None,
    ) -> "Ensemble":
        """Fit nets to the regrets of an experience by squared error; the same seed gives the same nets.

        Each begins with weights of its own and sees all maps, in an order of its own.

        Args:
            experience: costs on train maps.
            nets: how many, ≥ 1.
            seed: of weights, orders and dropout.
            epochs: how often each sees every map, ≥ 1.
            advance: called with the number of epochs of one net that are done.

        Raises:
            ParameterError: where there is nothing to fit.
            MissingExtraError: without the extra ``rl``.
        """
        if epochs < 1:
            raise ParameterError(f"epochs = {epochs}: every net has to see the maps once")
        torch, begun = torch_alone(), time.perf_counter()
        card = _card_of(experience, nets, seed, epochs)
        maps = torch.from_numpy(_shown(card, np.array(experience.features)))
        level, unit = experience.regrets.mean(axis=0), max(float(experience.regrets.std()), 1e-12)
        wanted = torch.from_numpy(((experience.regrets - level) / unit).astype(np.float32))
        with torch.random.fork_rng(devices=[]):  # what else draws from torch does not notice
            torch.manual_seed(seed)
            network = _network(card)
            for net in network:
                _train(net, maps, wanted, epochs, advance)
                with torch.no_grad():  # the nets that are kept predict regrets as they are
                    net[-1].weight.mul_(unit)
                    net[-1].bias.mul_(unit).add_(torch.from_numpy(level.astype(np.float32)))
        return cls(replace(card, seconds=round(time.perf_counter() - begun, 1)), network)

    def save(self, path: str | Path) -> None:
        """Write NAME.json and NAME.safetensors, each whole or not at all."""
        write_both(path, FORMAT, self.card, to_bytes(self._network.state_dict()))

    @classmethod
    def load(cls, path: str | Path) -> "Ensemble":
        """Read both; ParameterError names the file and what is wrong with it."""
        card = read_card(path)
        network, data = _network(card), read_weights(path, card.sha256)
        try:
            fill(network, network.state_dict(), data)
        except ParameterError as error:
            raise ParameterError(f"{stem_of(path)}: {error}") from None
        return cls(card, network)


def read_card(path: str | Path) -> EnsembleCard:
    """Return the card of an ensemble; ParameterError names the file and what is wrong with it."""
    return artefact.load(beside(stem_of(path), ".json"), FORMAT, EnsembleCard)


def as_ensemble(source: Ensemble | str | Path) -> Ensemble:
    """Return an ensemble, or the one in a file."""
    return source if isinstance(source, Ensemble) else Ensemble.load(source)


def _card_of(experience: Experience, nets: int, seed: int, epochs: int) -> EnsembleCard:
    mean, deviation = experience.scales
    return EnsembleCard(
        parameters=experience.parameters,
        described=experience.described,
        mean=as_tuples(mean),
        scale=as_tuples(1 / deviation),
        units=experience.units,
        noise=experience.spread.noise,
        between=experience.spread.between,
        nets=nets,
        evaluations=experience.evaluations,
        seed=seed,
        settings={"epochs": epochs, "batch": BATCH, "rate": RATE, "decay": DECAY, "dropout": DROPOUT},
        versions={name: version(name) for name in LIBRARIES},
        provenance=experience.provenance,
    )


def _shown(card: EnsembleCard, features: NDArray[Any]) -> NDArray[np.float32]:
    """Return what nets are shown of (n, f) features: :meth:`agents.experience.Experience.standardise`."""
    away = (features.astype(np.float64) - np.array(card.mean)) * np.array(card.scale)
    return np.clip(away, -FAR, FAR).astype(np.float32)


def _network(card: EnsembleCard) -> Any:
    """Return the nets of a card, untrained."""
    nn = torch_alone().nn

    def net() -> Any:
        layers: list[Any] = []
        for inputs, outputs in pairwise((len(card.described), *card.hidden, len(card.units))):
            layers += [nn.Linear(inputs, outputs), nn.SiLU(), nn.Dropout(DROPOUT)]
        return nn.Sequential(*layers[:-2])

    return nn.ModuleList([net() for _ in range(card.nets)])


def _train(net: Any, maps: Any, wanted: Any, epochs: int, advance: Callable[[int], None]) -> None:
    torch = torch_alone()
    optimiser = torch.optim.AdamW(net.parameters(), lr=RATE, weight_decay=DECAY)
    steps = epochs * -(-len(maps) // BATCH)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimiser, RATE, total_steps=steps)
    for _ in range(epochs):
        for chosen in torch.randperm(len(maps)).split(BATCH):
            loss = (net(maps[chosen]) - wanted[chosen]).square().mean()
            optimiser.zero_grad()
            loss.backward()
            optimiser.step()
            schedule.step()
        advance(1)
