"""Infos of a batch are laid out as Gymnasium does it, and those of one environment come back plain."""

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import data_equivalence

from antgym.envs.infos import gathered, row, some

N = 6
FACTS = {
    "scenario": [f"map {i}" for i in range(N)],
    "seed": [2**62 + i for i in range(N)],
    "gap": np.linspace(0, 1, N),
    "solved": np.arange(N) % 2 == 0,
    "parameters": {"alpha": np.arange(N) / 2, "nested": {"deep": list(range(N))}},
}


def gymnasiums(parts):
    """What Gymnasium's own vectors make of the same infos, slot by slot."""
    vector, batch = gymnasium.vector.VectorEnv(), {}
    vector.num_envs = N
    for slots, columns in parts:
        for place, slot in enumerate(slots.tolist()):
            batch = vector._add_info(batch, row(columns, place), slot)
    return batch


@pytest.mark.parametrize("slots", [[0, 1, 2, 3, 4, 5], [4], [5, 0, 2]])
def test_one_part_is_laid_out_as_gymnasium_does(slots):
    slots = np.array(slots)
    parts = [(slots, some(FACTS, np.arange(len(slots))))]
    assert data_equivalence(gathered(N, parts), gymnasiums(parts), exact=True)


def test_parts_that_tell_different_things_share_one_layout():
    begun = {"scenario": ["new", "newer"], "seed": [1, 2], "begun": [True, False]}
    parts = [(np.array([1, 3]), begun), (np.array([0, 2]), some(FACTS, np.array([5, 4])))]
    assert data_equivalence(gathered(N, parts), gymnasiums(parts), exact=True)


def test_nothing_told_is_an_empty_dict():
    assert gathered(N, [(np.array([], int), {}), (np.array([], int), {"seed": []})]) == {}


def test_a_row_is_plain():
    assert row(FACTS, 3) == {
        "scenario": "map 3",
        "seed": 2**62 + 3,
        "gap": pytest.approx(0.6),
        "solved": False,
        "parameters": {"alpha": 1.5, "nested": {"deep": 3}},
    }
    assert [type(value) for value in row(FACTS, 3).values()] == [str, int, float, bool, dict]


def test_arrays_of_the_slots_stay_whole():
    """Observations among infos are objects, whatever their lengths are."""
    shown = [np.full(2, i) for i in range(2)]
    column = gathered(2, [(np.arange(2), {"final_obs": shown})])["final_obs"]
    assert column.dtype == object
    assert [each.tolist() for each in column] == [[0, 0], [1, 1]]


def test_names_in_an_array_are_laid_out_as_in_a_list():
    names = np.array(FACTS["scenario"], object)
    slots = np.array([5, 0, 2])
    columns = [gathered(N, [(slots, {"scenario": each})]) for each in (names[:3], names[:3].tolist())]
    assert data_equivalence(*columns, exact=True)
    assert type(row({"scenario": names}, 0)["scenario"]) is str


def test_masks_are_not_one_array():
    batch = gathered(N, [(np.array([1]), some(FACTS, np.array([1])))])
    batch["_gap"][:] = False
    assert batch["_seed"].tolist() == [i == 1 for i in range(N)]
