"""How often intervals hold the truth: as often as the package's docstring says."""

import numpy as np
import pytest
from scipy.special import ndtr

from experiments.statistics import (
    cluster_interval,
    paired_difference,
    probability_of_improvement,
    share_closed,
)

SEEDS, SIMULATIONS, REPS = 5, 2000, 400
MEANS = {"own": 0.07, "sbs": 0.10, "vbs": 0.04}
MAPS, RUNS = 0.5, 0.5  # deviations of the logarithms of gaps: between maps, and between seeds


def simulated(maps, interaction, seed):
    """Log-normal gaps of three agents: maps are hard for all, harder for one of them, and seeds are lucky or not."""
    rng = np.random.default_rng([seed, maps])

    def factor(deviation, *shape):
        return rng.lognormal(-(deviation**2) / 2, deviation, shape)

    hardness = factor(MAPS, maps, 1)
    return {
        name: mean * hardness * factor(interaction, maps, 1) * factor(RUNS, maps, SEEDS)
        for name, mean in MEANS.items()
    }


def truths(interaction):
    """What the intervals are about."""
    apart = np.log(MEANS["sbs"] / MEANS["own"]) / np.sqrt(2 * (interaction**2 + RUNS**2))
    return {"mean": 0.07, "difference": -0.03, "share": 0.5, "chance": ndtr(apart)}


def intervals(gaps, seed):
    how = {"reps": REPS, "seed": seed}
    own, sbs, vbs = gaps["own"], gaps["sbs"], gaps["vbs"]
    return {
        "mean": cluster_interval(own, **how),
        "difference": paired_difference(own, sbs, **how)[1:],
        "share": share_closed(own, sbs, vbs, **how)[1:],
        "chance": probability_of_improvement(own, sbs, **how)[1:],
    }


def covered(maps, interaction, simulations):
    """Shares of the simulations whose intervals hold the truth."""
    truth = truths(interaction)
    hits = dict.fromkeys(truth, 0)
    for seed in range(simulations):
        for name, (low, high) in intervals(simulated(maps, interaction, seed), seed).items():
            hits[name] += low <= truth[name] <= high
    return {name: count / simulations for name, count in hits.items()}


@pytest.mark.slow
@pytest.mark.parametrize("interaction", [0.3, 0.0], ids=["maps differ by agent", "seeds alone differ"])
def test_intervals_over_a_hundred_maps_cover_what_they_say(interaction):
    found = covered(100, interaction, SIMULATIONS)
    assert {name: share for name, share in found.items() if not 0.92 <= share <= 0.97} == {}


@pytest.mark.slow
def test_intervals_over_thirty_maps_cover_a_little_less():
    found = covered(30, 0.3, SIMULATIONS)
    assert list(found.values()) == pytest.approx([0.93, 0.93, 0.945, 0.955], abs=0.012)


def test_intervals_cover_about_what_they_say():
    """The same in a blink, for whoever changes something."""
    found = covered(100, 0.3, 100)
    assert {name: share for name, share in found.items() if not 0.88 <= share <= 1} == {}
