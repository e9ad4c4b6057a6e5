"""What each regime shows whoever learns in it: the names of its features, and how many numbers they come with."""

from collections.abc import Sequence
from typing import NamedTuple

from antgym.errors import ParameterError, nearest
from antgym.planners.parameters import BeeParameters, ColonyParameters
from antgym.tuning.features import task_table
from antgym.tuning.observation import bounds
from antgym.tuning.run_features import control_table

REGIMES = ("OneShot", "Trials", "Control")
CHOSEN = (ColonyParameters._fields, BeeParameters._fields[:-1], BeeParameters._fields)
"""Names of what is chosen: by whoever tunes ants, bees, and bees that keep a tabu list."""


class Shown(NamedTuple):
    """What a regime shows of a task under some parameters.

    Attributes:
        regime: ``"OneShot"``, ``"Trials"`` or ``"Control"``.
        parameters: names of what is chosen.
        window: trials that are shown, 0 in other regimes than Trials.
        features: names of the first numbers of the vector; in OneShot and Control of all.
        size: of the vector.
    """

    regime: str
    parameters: tuple[str, ...]
    window: int
    features: tuple[str, ...]
    size: int


def shown_in(regime: str, parameters: Sequence[str], window: int = 0) -> Shown:
    """Return what a regime shows.

    Args:
        regime: one of ``REGIMES``.
        parameters: names of what is chosen, in the order of their space; they tell ants from bees.
        window: trials that the observation shows: at least one in Trials, 0 elsewhere.

    Raises:
        ParameterError: where there is no such regime, nothing with such parameters, or the window is another.
    """
    if regime not in REGIMES:
        raise ParameterError(f"unknown regime {regime!r}; {nearest(regime, REGIMES)}")
    names = tuple(parameters)
    if names not in CHOSEN:
        known = " or ".join(", ".join(each) for each in CHOSEN)
        raise ParameterError(f"parameters = {list(names)}: what is chosen is {known}, in this order")
    if (window > 0) != (regime == "Trials"):
        wanted = "one at least, TrialsEnv's own is 5" if regime == "Trials" else "0, none is shown"
        raise ParameterError(f"window = {window}: trials that {regime} shows; {wanted}")
    discs = names != ColonyParameters._fields
    table = control_table(discs, names) if regime == "Control" else task_table(discs)
    size = len(bounds(len(names), window=window, features=table)[0])
    return Shown(regime, names, window, tuple(feature.name for feature in table), size)
