"""Amortisation: evaluations are the currency, and a search from nothing sets the rate."""

import json

import numpy as np
import pytest

from agents.static import StaticSetting, StaticSettings
from antgym.errors import ParameterError
from experiments.amortisation import Arguments, Standing, report, standings, worth

pytest.importorskip("matplotlib", reason="needs the extra viz")


def test_worth_is_read_off_the_searchs_own_curve():
    budgets, gaps = [1, 5, 20], [0.5, 0.3, 0.2]
    assert [worth(gap, budgets, gaps) for gap in gaps] == [pytest.approx((b, False)) for b in budgets]
    between, beyond = worth(0.25, budgets, gaps)
    assert np.log1p(between) == pytest.approx((np.log1p(5) + np.log1p(20)) / 2)
    assert not beyond
    assert worth(0.1, budgets, gaps) == pytest.approx((20, True))
    assert worth(0.9, budgets, gaps) == pytest.approx((1, False))


def test_training_pays_once_what_it_saved_covers_it():
    learnt = Standing("regression", 2, 0.2, 900, 20.0, False)
    static = Standing("best_static_by_rules", 0, 0.4, 100, 3.0, False)
    assert learnt.pays_after() == 900 / 18
    assert learnt.pays_after(static) == 800 / 15
    assert static.pays_after(learnt) == np.inf
    assert learnt._replace(trials=20).pays_after() == np.inf


@pytest.fixture
def measured(tmp_path):
    """What a small transfer measured, and the files of a trained agent."""
    gaps = {
        "optuna_tpe/1": 0.6,
        "optuna_tpe/20": 0.2,
        "best_static_by_rules/0": 0.4,
        "published_default/0": 0.5,
    }
    (tmp_path / "transfer.json").write_text(json.dumps({key: [[gap], [gap]] for key, gap in gaps.items()}))
    StaticSettings({"liu2020": StaticSetting((0.5,) * 4, 250, ("alpha", "beta", "rho", "Q"))}).save(
        tmp_path / "static_by_rules.json"
    )
    return tmp_path


def test_a_report_holds_the_trained_agents_and_what_each_is_worth(measured, capsys):
    found = standings(Arguments(measured, measured))
    assert [(s.agent, s.trials, s.gap, s.training) for s in found] == [
        ("best_static_by_rules", 0, pytest.approx(0.4), 250)
    ]
    assert 1 < found[0].worth < 20
    text = report(Arguments(measured, measured)).read_text()
    assert f"| `best_static_by_rules` | 0 | 40.0 | 250 | {found[0].worth:.1f} |" in text
    assert (measured / "amortisation.png").stat().st_size > 1000
    said = capsys.readouterr().out
    assert str(measured / "amortisation.png") in said
    assert "\N{CITYSCAPE AT DUSK}" not in said  # what rich shows of a picture


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"search": "cma_es"}, "cma_es was not measured"),
        ({"static": "best_static"}, "best_static was not measured"),
    ],
)
def test_what_was_not_measured_is_named(measured, change, message):
    with pytest.raises(ParameterError, match=message):
        standings(Arguments(measured, measured, **change))


def test_a_folder_without_a_measurement_is_named(tmp_path):
    with pytest.raises(ParameterError, match=r"transfer.json: no gaps by agent and budget"):
        standings(Arguments(tmp_path, tmp_path))
