"""Ground: the box over a height field."""

import numpy as np
import pytest

from antgym.errors import MapError
from antgym.maps.formats.elevation import HeightField
from antgym.maps.ground import over
from antgym.maps.world import Scenario


def test_the_box_fits_the_relief_and_keeps_the_file_s_datum():
    heights = np.full((5, 4), 103.0)
    heights[2, 2] = 131.0
    terrain = over(HeightField(heights, (10.0, 10.0), "a"))
    assert terrain.frame.origin == (0.0, 0.0, 100.0)
    assert terrain.world.shape == (5, 4, 6)  # 31 above the floor fill four levels, two are air
    assert terrain.world.free[2, 2].tolist() == [0, 0, 0, 0, 1, 1]
    assert terrain.points(np.array([[0, 0, 1]])).tolist() == [[5.0, 5.0, 115.0]]
    assert Scenario(terrain.world, (0, 0, 1), (4, 0, 1)).optimum == 40.0


def test_missing_heights_are_filled_only_when_asked():
    field = HeightField(np.array([[1.0, np.nan], [2.0, 3.0]]), (1.0, 1.0), "a.npy")
    with pytest.raises(MapError, match=r"a\.npy: 1 heights are missing; .*--fill"):
        over(field)
    assert over(field, fill=9.0).heights[0, 1] == 9.0


def test_units_that_do_not_match_are_noticed_before_memory_is_taken():
    for far, spacing in ((9e9, 1e-3), (1e300, 1e-300), (-1e300, 1e-300)):
        field = HeightField(np.array([[0.0, far], [2.0, 3.0]]), (spacing, spacing), "a.npy")
        with pytest.raises(MapError, match="must share a unit"):
            over(field)
