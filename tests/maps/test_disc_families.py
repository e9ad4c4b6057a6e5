"""Families of disc worlds: seeded, solvable, and as described."""

import numpy as np
import pytest

from antgym.errors import MapError
from antgym.maps.generators.discs import DISC_FAMILIES, SAFE, corridors, rings, scatter, wu2018


@pytest.mark.parametrize("family", DISC_FAMILIES)
@pytest.mark.parametrize("count", [8, 20, 41])
def test_every_draw_has_a_path_and_the_discs_asked_for(family, count):
    for seed in range(5):
        scenario = DISC_FAMILIES[family](np.random.default_rng(seed), count)
        assert len(scenario.world.discs) == count
        assert scenario.optimum >= scenario.straight_line * (1 - 1e-12)
        assert scenario.world.clearances([scenario.start, scenario.start])[0] > 0


@pytest.mark.parametrize("family", DISC_FAMILIES)
def test_the_same_seed_gives_the_same_world(family):
    one, same, other = (DISC_FAMILIES[family](np.random.default_rng(seed), 20).digest for seed in (3, 3, 4))
    assert one == same != other


def test_the_paper_world_has_twenty_obstacles_and_a_clearance_to_keep():
    world = wu2018(np.random.default_rng(0)).world
    assert (len(world.discs), world.safe_distance) == (20, SAFE)
    assert world.discs[:, 2].min() >= 1
    assert world.discs[:, 2].max() <= 3


def test_a_scatter_may_hold_no_disc_and_corridors_need_some():
    assert len(scatter(np.random.default_rng(0), 0).world.discs) == 0
    for family in (corridors, rings):
        with pytest.raises(MapError, match="at least 8 discs, got 3"):
            family(np.random.default_rng(0), 3)


@pytest.mark.parametrize("family", [corridors, rings])
def test_walls_force_a_detour(family):
    detours = [
        scenario.optimum / scenario.straight_line
        for scenario in (family(np.random.default_rng(seed), 24) for seed in range(20))
    ]
    assert np.median(detours) > 1.05
