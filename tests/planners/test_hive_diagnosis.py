"""How a paused hive stands, and that it flies in the memory of another one without a trace."""

import numpy as np
import pytest
from discs import among, scattered

from antgym.errors import ParameterError
from antgym.planners.diagnosis import Diagnosis
from antgym.planners.hive import Hive

SETTING = (20.0, 1.0, 0.5, 1.0)


def flown(scenario, blocks, **kwargs):
    hive = Hive(scenario, **{"ants": 12, "iterations": 60, "seed": 3, **kwargs})
    for count in blocks:
        hive.advance(SETTING, count)
    return hive


def test_an_untouched_hive_stands_as_an_untouched_colony():
    assert flown(scattered(1), []).diagnosis() == Diagnosis()


@pytest.mark.parametrize("seed", range(4))
def test_a_diagnosis_is_what_the_history_says(seed):
    hive = flown(scattered(seed), [20, 20])
    told, plan = hive.diagnosis(), hive.result()
    assert (told.done, told.best) == (40 / 60, plan.length)
    assert told.mean == plan.mean[-1]
    assert told.arrived == pytest.approx(plan.arrived[20:].mean() / 6)
    if plan.best[19] < np.inf:
        assert told.first == plan.best[19]
        assert told.gained == pytest.approx(max(1 - plan.best[39] / plan.best[19], 0))
    since = np.flatnonzero(plan.best == plan.best[-1])[0]
    assert told.stagnation == pytest.approx((39 - since) / 60 if plan.solved else 40 / 60)


def test_the_first_path_gains_everything():
    assert flown(among(), [1]).diagnosis().gained == 1


def test_sources_spread_at_first_and_agree_in_the_end():
    scenario = among()
    begun = flown(scenario, [1], iterations=3000).diagnosis()
    ended = flown(scenario, [3000], iterations=3000, rules="abc_gbest").diagnosis()
    assert begun.branching > 0.7
    assert begun.distinct == 1
    assert ended.branching < begun.branching


@pytest.mark.parametrize("points", [40, 4])
def test_a_hive_in_the_memory_of_another_flies_as_in_its_own(points):
    """Whether the other was larger or smaller."""
    other = flown(scattered(2, count=points), [30], ants=points, rules="wu2018")
    mine, own = (
        flown(scattered(1), [30, 30], buffers=buffers, rules="wu2018") for buffers in (other.release(), None)
    )
    assert mine.result().path.tolist() == own.result().path.tolist()
    assert mine.diagnosis() == own.diagnosis()
    assert mine.sources.tolist() == own.sources.tolist()


def test_nothing_can_be_asked_of_a_hive_that_gave_its_memory_away():
    hive = flown(scattered(1), [5])
    hive.release()
    with pytest.raises(ParameterError, match="released its buffers"):
        hive.advance(SETTING, 1)
