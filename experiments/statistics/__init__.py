"""Statistics of a leaderboard: (maps, seeds) arrays of gaps in, means and intervals out.

A board speaks about maps that it has not seen, so maps are what is resampled, each with all of its seeds (the first
strategy of Davison & Hinkley 1997, section 3.8). Seeds are not drawn again within a map: what they differ by is in the
means of maps already, and would count twice. Where two agents differ from seed to seed alone, such an interval of
their difference was measured to cover 98 % where 95 % were asked, over 100 maps.

Ends are percentiles of the resamples, moved out for few maps (``bootstrap.expanded_tail``). Of 2,000 simulations with
log-normal gaps and 5 seeds a map (deviations of the logarithm: 0.5 between maps, 0.3 map x agent, 0.5 between seeds),
nominal 95 % intervals covered the truth in per cent:

    maps                            6    12    30   100
    mean                           89    92    93    94
    paired difference              91    93    93    95
    share closed                   92    94    94    95
    probability of improvement     92    95    96    95
    interquartile mean             94    95    96    95

(The share was refused in 9 % of the cases at 6 maps, where SBS and VBS were not told apart, and hardly ever above.)
Plain percentiles covered 82, 88, 91, 93 % for the mean and 83, 88, 91, 95 % for the difference. Few maps with a long
tail remain too few: where the logarithms of maps deviate by 1.0, as on Mountain, intervals of means and differences
covered 86 % at 12 maps and 92 % at 100. A studentised bootstrap covered 89 % there at 12 maps, but leaves the range of
what it measures, was wider than [0, 1] for a probability over 6 maps, and has no form for the interquartile mean; BCa
was no better on the whole. Below six maps no interval of resamples covers 95 %: it ends where the maps themselves end,
and five have their truth on one side of them all in one case of sixteen.

References: Hesterberg 2015 (What teachers should know about the bootstrap), Agarwal et al. 2021 (Deep reinforcement
learning at the edge of the statistical precipice), Holm 1979, Hansen et al. 2016 (COCO: performance assessment).
"""

from experiments.statistics.bootstrap import Estimate, Values
from experiments.statistics.comparisons import (
    holm,
    paired_difference,
    paired_p_value,
    probability_of_improvement,
    share_closed,
)
from experiments.statistics.curves import TARGETS, Band, anytime, performance_profile, targets_reached
from experiments.statistics.means import (
    cluster_interval,
    interquartile_interval,
    interquartile_mean,
    optimality_gap,
)
from experiments.statistics.shares import wilson_interval

__all__ = [
    "TARGETS",
    "Band",
    "Estimate",
    "Values",
    "anytime",
    "cluster_interval",
    "holm",
    "interquartile_interval",
    "interquartile_mean",
    "optimality_gap",
    "paired_difference",
    "paired_p_value",
    "performance_profile",
    "probability_of_improvement",
    "share_closed",
    "targets_reached",
    "wilson_interval",
]
