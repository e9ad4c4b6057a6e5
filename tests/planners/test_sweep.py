"""Every map of the train split, planned: valid ends, valid paths, never below the exact optimum."""

from itertools import pairwise

import numpy as np
import pytest
from reference import ground

from antgym.maps.optimum import shortest_path
from antgym.maps.suites import load_suite
from antgym.planners.colony import plan_many

SETTING = (0.1, 0.2, 0.3, 3000.0)  # found by a race: most maps are solved by it


def assert_valid(scenario, path, length):
    cells = [tuple(cell) for cell in path.tolist()]
    assert (cells[0], cells[-1]) == (scenario.start, scenario.goal)
    for here, there in pairwise(cells):
        assert ground.legal(scenario, here, tuple(b - a for a, b in zip(here, there, strict=True)))
    steps = np.diff(scenario.world.centre(path), axis=0)
    assert length == pytest.approx(np.sqrt((steps**2).sum(axis=1)).sum())


@pytest.mark.slow
def test_two_hundred_maps_have_valid_ends_paths_and_optima():
    items = load_suite("mountain-v0", "train")[:]
    assert len(items) == 200
    scenarios = [item.scenario for item in items]
    effort = {"ants": [item.ants for item in items], "iterations": [item.iterations for item in items]}
    plans = plan_many(scenarios, [SETTING] * 200, **effort, seeds=range(200))
    for i, scenario in enumerate(scenarios):
        assert scenario.world.free[scenario.start]
        assert scenario.world.free[scenario.goal]
        assert_valid(scenario, shortest_path(scenario), scenario.optimum)
        found = plans.plan(i)
        assert found.length >= scenario.optimum
        if found.solved:
            assert_valid(scenario, found.path, found.length)
    assert np.isfinite(plans.lengths).mean() > 0.75
