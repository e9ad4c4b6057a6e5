"""The virtual best setting of every map: the best that anybody recommended there, a bound and no agent.

Who is the best of many by a few noisy runs was mostly lucky in them. So a setting is chosen on all but one of its fresh
runs and scored on that one, each in turn: a mean over choices that never saw what they are scored by. It tells what
such a choice is worth, and nothing of settings that nobody recommended, which a longer search may find.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from antgym.tuning.ledger import Ledger
from experiments import contest
from experiments.tracks import Round

Floats = NDArray[np.float64]


def virtual_best(candidates: Sequence[Floats]) -> tuple[float, float] | None:
    """Return the gap and the success of a map's best candidate, cross-fitted; None without two runs of one.

    Args:
        candidates: (2, seeds, n) each, gaps and whether they found a path (1 or 0); n the same for all of them, the
            numbers of seeds of their own.
    """
    folds = candidates[0].shape[2] if candidates else 0
    if folds < 2:
        return None
    scored = np.array([each.mean(axis=1) for each in candidates])  # (candidates, 2, folds)
    others = (scored[:, 0].sum(axis=1, keepdims=True) - scored[:, 0]) / (folds - 1)
    chosen = others.argmin(axis=0)
    gap, success = scored[chosen, :, np.arange(folds)].mean(axis=0).tolist()
    return gap, success


def candidates(rounds: Sequence[Round], item: int, ledger: Ledger) -> list[Floats]:
    """Return the fresh runs of every setting that anybody recommended on a map, for :func:`virtual_best`.

    Of one setting each seed's runs count once, whoever recommended it. In track C a candidate is a controller, and
    what it steered, a run for every seed, are its runs. An agent that failed recommended nothing.
    """
    found: dict[tuple[float, ...] | str, dict[int, Floats]] = {}
    for played in rounds:
        for entrant in played.entrants:
            for seed in range(played.seeds):
                job = played.job(entrant, played.items[item], seed)
                outcome = ledger.run(job.key).outcome
                assert outcome is not None, f"{job.key} is not finished"
                if outcome.failure and played.track != "C":  # nothing was recommended
                    continue
                name = outcome.unit if isinstance(job, contest.Job) else entrant.name
                found.setdefault(name, {})[seed] = np.array([outcome.gaps, np.isfinite(outcome.lengths)])
    runs = [np.stack(list(seeds.values()), axis=1) for seeds in found.values()]
    if rounds[0].track != "C":
        return runs
    return [each.transpose(0, 2, 1) for each in runs if each.shape[1] == rounds[0].seeds]
