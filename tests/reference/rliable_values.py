"""Write ``rliable.json``: what rliable and statsmodels say about gaps that the tests draw again.

    python -m venv /tmp/rliable && /tmp/rliable/bin/pip install rliable==1.2.0 "pandas<3" "arch<8"
    /tmp/rliable/bin/python tests/reference/rliable_values.py

rliable works with scores, higher is better, in (runs, tasks); gaps go in as 1 - gap, transposed. Its intervals resample
runs and tasks apart, so with one run a task they are of resampled tasks, as ours are.
"""

import json
from importlib.metadata import version
from pathlib import Path

import numpy as np

TAUS = (0.05, 0.1, 0.2, 0.4)
EFFECTS = (0.1, 0.5, 1.5)  # true differences over their standard deviation
P_VALUES = (0.01, 0.04, 0.03, 0.005, 0.5, 0.03)


def drawn(maps, seeds, seed):
    """(maps, seeds) gaps, some of them at the cap and some tied."""
    rng = np.random.default_rng(seed)
    gaps = 0.1 * rng.lognormal(0, 0.7, (maps, 1)) * rng.lognormal(0, 0.5, (maps, seeds))
    return np.minimum(np.round(gaps, 2) + 0.001, 1.0)


def intervals(gaps):
    """Low and high of mean, interquartile mean, optimality gap at 0.9 and profile, from 50,000 resamples."""
    from rliable import library, metrics

    np.random.seed(0)  # noqa: NPY002  rliable draws from the global generator

    def measured(scores):
        profile = library.score_distributions(scores, [1 - tau for tau in TAUS])
        gap = metrics.aggregate_optimality_gap(scores, 0.9)
        return np.array([metrics.aggregate_mean(scores), metrics.aggregate_iqm(scores), gap, *profile])

    _, found = library.get_interval_estimates({"a": 1 - gaps.T}, measured, task_bootstrap=True)
    return found["a"].T.tolist()


def main():
    """Measure and write."""
    from rliable import library, metrics
    from statsmodels.stats.multitest import multipletests
    from statsmodels.stats.power import TTestPower

    a, b, alone = drawn(12, 5, 1), drawn(12, 3, 2), drawn(30, 1, 3)
    profile = library.score_distributions(1 - a.T, [1 - tau for tau in TAUS])
    numbers = {
        "versions": {name: version(name) for name in ("rliable", "arch", "numpy", "scipy", "statsmodels")},
        "interquartile_mean": 1 - metrics.aggregate_iqm(1 - a.T),
        "optimality_gap_0.9": metrics.aggregate_optimality_gap(1 - a.T, 0.9),
        "performance_profile": profile.tolist(),
        "probability_of_improvement": metrics.probability_of_improvement(1 - a.T, 1 - b.T),
        "intervals": intervals(alone),
        "pairs_needed": [float(TTestPower().solve_power(e, power=0.8, alpha=0.05)) for e in EFFECTS],
        "holm": multipletests(P_VALUES, method="holm")[1].tolist(),
    }
    text = json.dumps(numbers, indent=1) + "\n"
    Path(__file__).with_name("rliable.json").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
