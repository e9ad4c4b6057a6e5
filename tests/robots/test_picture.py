"""Pictures of trajectories: a PNG, with the ground or without."""

import sys

import numpy as np
import pytest

from antgym.errors import MissingExtraError
from antgym.robots import follow, lr_mate_200id, wei2018_palletizer
from antgym.robots.picture import draw

LINE = [[0.45, -0.1, 0.3], [0.45, 0.1, 0.3]]


@pytest.mark.parametrize(
    "arm", [lr_mate_200id(), wei2018_palletizer(0.3, 0.4, 0.4)], ids=lambda arm: arm.name
)
def test_a_picture_of_any_arm_is_a_png(arm):
    pytest.importorskip("matplotlib")
    x, y = np.meshgrid([0.3, 0.5], [-0.2, 0.2])
    with_ground = draw(follow(arm, LINE), "a line", (x, y, 0.1 * x))
    assert with_ground.startswith(b"\x89PNG")
    assert with_ground != draw(follow(arm, LINE), "a line")


def test_without_matplotlib_one_line_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(MissingExtraError, match=r"antgym\[viz\]"):
        draw(follow(lr_mate_200id(), LINE))
