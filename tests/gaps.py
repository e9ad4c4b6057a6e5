"""Gaps made up for the statistics, and what other libraries said about such gaps."""

import json
from pathlib import Path

import numpy as np
import scipy.stats

STORED = Path(__file__).with_name("reference") / "rliable.json"


def drawn(maps, seeds, seed):
    """Log-normal gaps with mean 1: hard and easy maps, lucky and unlucky seeds."""
    rng = np.random.default_rng(seed)
    return rng.lognormal(-0.125, 0.5, (maps, 1)) * rng.lognormal(-0.125, 0.5, (maps, seeds))


def level_of_percentiles(maps, level=0.95):
    """The level at which our intervals, wider for few maps, are the plain percentiles that others give."""
    z = scipy.stats.norm.ppf((1 + level) / 2) * np.sqrt((maps - 1) / maps)
    return 2 * scipy.stats.t.cdf(z, maps - 1) - 1


def remembered():
    """What ``reference/rliable_values.py`` wrote."""
    return json.loads(STORED.read_text(encoding="utf-8"))
