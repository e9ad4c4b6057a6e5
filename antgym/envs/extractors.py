"""What policies of stable-baselines3 read observations with; beside ``sb3.py`` the only module that has torch."""

from collections.abc import Sequence
from typing import Any

import gymnasium
import numpy as np

from antgym.errors import MissingExtraError, ParameterError

try:
    import torch
    from stable_baselines3.common.torch_layers import BaseFeaturesExtractor
except ImportError:
    raise MissingExtraError("stable-baselines3", "rl") from None

FARTHEST = 5.0  # deviations from the mean that a policy is shown


class FeatureExtractor(BaseFeaturesExtractor):
    """Standardised features: (value - mean) / deviation, held within ±5. Both are part of a policy's weights.

    Use it by ``policy_kwargs={"features_extractor_class": FeatureExtractor, "features_extractor_kwargs": {...}}``.

    Args:
        observation_space: a vector.
        mean: of every feature, 0 where nothing is given.
        deviation: of every feature, above 0; 1 where nothing is given.
    """

    def __init__(
        self,
        observation_space: gymnasium.spaces.Box,
        mean: Sequence[float] | None = None,
        deviation: Sequence[float] | None = None,
    ) -> None:
        (size,) = observation_space.shape
        super().__init__(observation_space, size)
        _standardise(self, size, mean, deviation)

    def forward(self, observations: torch.Tensor) -> torch.Tensor:
        """Return (n, features) numbers of n observations."""
        return _standardised(self, observations)


class MapExtractor(BaseFeaturesExtractor):
    """Convolutions over the map, beside the features; ``MultiInputPolicy`` alone would flatten a map of floats.

    Use it by ``policy_kwargs={"features_extractor_class": MapExtractor}``.

    Args:
        observation_space: of an environment with ``observation="map"``, ``"map2d"`` or ``"map3d"``.
        width: numbers that the map is turned into; the features follow them.
        mean: of the features, see :class:`FeatureExtractor`.
        deviation: of the features.
    """

    def __init__(
        self,
        observation_space: gymnasium.spaces.Dict,
        width: int = 64,
        mean: Sequence[float] | None = None,
        deviation: Sequence[float] | None = None,
    ) -> None:
        spaces = getattr(observation_space, "spaces", {})
        if set(spaces) != {"features", "map"}:
            raise ParameterError(
                'MapExtractor: no map is observed; make the environment with observation="map"'
            )
        size = spaces["features"].shape[0]
        super().__init__(observation_space, width + size)
        _standardise(self, size, mean, deviation)
        channels, *sides = spaces["map"].shape
        convolution = torch.nn.Conv2d if len(sides) == 2 else torch.nn.Conv3d
        layers: list[torch.nn.Module] = []
        for filters in (8, 16, 32):  # each halves the sides
            layers += [convolution(channels, filters, 3, stride=2, padding=1), torch.nn.ReLU()]
            channels, sides = filters, [(side + 1) // 2 for side in sides]
        whole = torch.nn.Linear(channels * int(np.prod(sides)), width)
        self.picture = torch.nn.Sequential(*layers, torch.nn.Flatten(), whole, torch.nn.ReLU())

    def forward(self, observations: dict[str, torch.Tensor]) -> torch.Tensor:
        """Return (n, width + features) numbers of n observations."""
        features = _standardised(self, observations["features"])
        return torch.cat([self.picture(observations["map"]), features], dim=1)


def _standardise(
    module: torch.nn.Module, size: int, mean: Sequence[float] | None, deviation: Sequence[float] | None
) -> None:
    for name, values, default in (("mean", mean, 0.0), ("deviation", deviation, 1.0)):
        filled = [default] * size if values is None else values
        module.register_buffer(name, torch.tensor(filled, dtype=torch.float32))


def _standardised(module: Any, features: torch.Tensor) -> torch.Tensor:
    scaled = (features - module.mean) / module.deviation
    return torch.clamp(scaled, -FARTHEST, FARTHEST)
