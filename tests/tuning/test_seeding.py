"""Seeds of a batch are those that NumPy's own seed sequences give one by one."""

from unittest.mock import patch

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from antgym.tuning import seeding
from antgym.tuning.seeding import child_states

SEEDS = st.integers(0, 2**128 - 1) | st.integers(0, 2**200) | st.integers(0, 2**32) | st.just(2**63)


@given(
    seeds=st.lists(SEEDS, min_size=1, max_size=5),
    key=st.lists(st.integers(0, 2**32 - 1), min_size=1, max_size=4),
    count=st.integers(1, 5),
)
def test_many_children_at_once_are_numpys_to_the_bit(seeds, key, count):
    keys = [[(part + i) % 2**32 for part in key] for i in range(len(seeds))]
    expected = [
        np.random.SeedSequence(seed, spawn_key=tuple(k)).generate_state(count, np.uint64).tolist()
        for seed, k in zip(seeds, keys, strict=True)
    ]
    for few in (0, 16):
        with patch.object(seeding, "_FEW", few):
            assert child_states(seeds, keys, count).tolist() == expected


@pytest.mark.parametrize("few", [0, 16])
def test_no_seeds_have_no_children(monkeypatch, few):
    monkeypatch.setattr(seeding, "_FEW", few)
    assert child_states([], np.empty((0, 2)), 3).shape == (0, 3)
