"""Presets of the leaderboard: how much of everything."""

from typing import NamedTuple


class Preset(NamedTuple):
    """Sizes of one leaderboard run; all of them are part of its ledger's config."""

    scenarios: int  # maps; of real terrain, beyond 16 they are the same windows turned, no maps of their own
    seeds: int  # tuner seeds per scenario
    budget: int  # trials per scenario and seed, the largest of the tracks' budgets
    fresh: int  # uncharged runs that judge a recommendation
    policy_evaluations: int  # planner runs the RL tuner may train with
    sources: int  # maps of the transfer graph
    source_search: int  # trials to find each source's own set
    race_maps: int  # train maps of the race for the best static setting
    race_settings: int
    experience_maps: (
        int  # train maps, if there are so many, of what portfolio, neighbours and their like share
    )
    experience_trials: int  # on all of them: the fewer maps, the more settings


PRESETS = {
    "smoke": Preset(2, 1, 12, 4, 512, 3, 8, 8, 8, 6, 96),
    "quick": Preset(12, 3, 100, 16, 64_000, 16, 64, 200, 64, 60, 7_680),
    "full": Preset(16, 20, 100, 16, 200_000, 24, 200, 200, 256, 1_600, 204_800),
}
"""Seconds of one core for all tracks on real terrain, kernels compiled, measured while the machine had other work: smoke 12
with training, quick 136 beside some 80 of training. What full takes, ``experiments.sweep --dry-run`` tells."""
