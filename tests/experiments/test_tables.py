"""The paper's tables: a hundredth of the effort, every table and figure."""

import json

import numpy as np
import pytest

pytest.importorskip("pymoo")
pytest.importorskip("optuna")
pytest.importorskip("matplotlib")

from experiments.tables import MAPS, Arguments, liu2020, six_maps


@pytest.mark.slow
@pytest.mark.parametrize("rules", ["liu2020", "liu2020-paper"])
def test_liu2020_writes_its_three_tables_and_the_figure(tmp_path, rules):
    path = liu2020(Arguments("liu2020", tmp_path, rules, share=0.01))
    text, numbers = path.read_text(), json.loads((tmp_path / "liu2020.json").read_text())
    assert all(f"## Table {i}" in text for i in (1, 2, 3))
    assert np.shape(numbers["transfers"]) == (MAPS - 1, MAPS - 1)
    assert len(numbers["methods"]) == 10
    assert all(0 <= gap <= 1 for method in numbers["methods"] for gap in method["gaps"])
    assert (tmp_path / "liu2020.png").stat().st_size > 10_000


def test_the_six_maps_stay_the_same():
    assert [s.digest for s in six_maps()] == [s.digest for s in six_maps()]
    assert len({s.digest for s in six_maps()}) == MAPS
