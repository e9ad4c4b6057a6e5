"""What actions ask for: settings on a grid that float32 holds, and factorised changes that stay on it."""

import numpy as np
import pytest

from antgym.tuning.actions import CHANGES, KEEP, changed, choices, moved, settings_of, starts_of
from antgym.tuning.features import TASK_FEATURES


def test_a_setting_survives_being_shown_in_float32():
    units = settings_of(np.random.default_rng(0).uniform(-1, 1, (100, 4)))
    assert (units.astype(np.float32).astype(np.float64) == units).all()
    assert (settings_of((2 * units - 1).astype(np.float32)) == units).all()


def test_actions_outside_are_clipped():
    assert settings_of([-3.0, 3.0]).tolist() == [0.0, 1.0]


def test_each_parameter_moves_by_its_own_change_and_stays_within():
    moved = changed([[0.5, 0.5, 0.0, 1.0]], [[0, 4, 0, 4]], "each")
    assert moved.tolist() == [[0.25, 0.75, 0.0, 1.0]]
    assert changed([[0.3] * 4], [[KEEP] * 4], "each").tolist() == [[0.3] * 4]


def test_one_number_keeps_or_moves_one_parameter():
    count = choices("one", 4)[0]
    assert count == 17
    moved = changed(np.full((count, 4), 0.5), np.arange(count), "one") - 0.5
    assert moved[0].tolist() == [0.0] * 4
    assert ((moved[1:] != 0).sum(axis=1) == 1).all()
    found = {(int(row.nonzero()[0][0]), float(row.sum())) for row in moved[1:]}
    assert found == {(i, change) for i in range(4) for change in CHANGES if change}


@pytest.mark.parametrize("how", ["each", "one"])
def test_a_walk_over_changes_stays_on_the_grid(how):
    rng, units = np.random.default_rng(1), settings_of(np.zeros((5, 4)))
    for _ in range(20):
        picked = np.stack([rng.integers(0, n, 5) for n in choices(how, 4)], axis=1)
        units = changed(units, picked, how)
        assert (settings_of(2 * units - 1) == units).all()


def test_changes_begin_from_the_setting_of_the_rules_or_the_default():
    shown = np.array([[feature.name == "rules_max_min" for feature in TASK_FEATURES]], np.float32)
    starts = {"max_min": [0.1] * 4, "elitist": [0.9] * 4}
    assert starts_of(starts, shown, 4)[0] == pytest.approx([0.1] * 4, abs=1e-7)
    assert starts_of({"elitist": [0.9] * 4}, shown, 4).tolist() == [[0.5] * 4]
    assert starts_of(None, shown, 4).tolist() == [[0.5] * 4]
    assert starts_of([0.25] * 4, shown, 4).tolist() == [[0.25] * 4]


def test_changes_begin_from_what_is_chosen_for_each_task():
    shown = np.zeros((3, len(TASK_FEATURES)), np.float32)
    shown[:, 0] = 0.25, 0.5, 0.75
    begun = starts_of(lambda features: np.repeat(features[:, :1].astype(float), 4, axis=1), shown, 4)
    assert begun.tolist() == [[0.25] * 4, [0.5] * 4, [0.75] * 4]


def test_a_move_goes_half_a_range_at_most_and_stays_in_the_cube():
    starts = settings_of([[0.0, 0.5, -0.5, 0.0]])
    assert moved(starts, [[0.0, 0.25, 1.0, 9.0]]).tolist() == [[0.5, 0.875, 0.75, 1.0]]
    assert moved(starts, np.zeros((1, 4))).tolist() == starts.tolist()
