"""Diagnosis: how a paused colony stands, for those who steer it."""

from typing import NamedTuple

import numpy as np


class Diagnosis(NamedTuple):
    """How a paused run stands: plain numbers, none of which depends on the optimum.

    Attributes:
        done: share of its iterations that are walked.
        best: shortest length so far in world units, inf before any ant arrived.
        first: the first such length that a block ended with, inf before.
        gained: share by which the last block shortened the best; 1 where it found the first path.
        mean: mean length over the ants of the last iteration that arrived, inf where none did.
        stagnation: iterations since the best improved, as a share of the run's.
        arrived: share of the last block's ants that arrived.
        branching: how open the choices of the last iteration's ants were: where n moves were legal, the (Σ τ)² / Σ τ²
            effective ones less 1, over n - 1; the mean over all choices, 1 where nothing was to choose.
        distinct: share of different walks among the last iteration's ants, those that died included; it and
            ``branching`` look at the first 32 ants.
    """

    done: float = 0.0
    best: float = np.inf
    first: float = np.inf
    gained: float = 0.0
    mean: float = np.inf
    stagnation: float = 0.0
    arrived: float = 0.0
    branching: float = 1.0
    distinct: float = 1.0
