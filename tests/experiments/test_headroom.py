"""Cards: the statistics on numbers with answers by eye, the search on a landscape with a known best, a tiny card."""

import json

import numpy as np
import pytest

from antgym.errors import ParameterError
from antgym.maps.suites import load_suite
from experiments.headroom import __main__ as script
from experiments.headroom import card, measures, pool
from experiments.headroom.pool import Pool, Stage, cost, design, search
from experiments.headroom.schedules import BLOCKS, Schedule, dynamic, family


def test_headroom_is_the_share_that_an_oracle_saves():
    static, oracle = np.full(20, 0.2), np.full(20, 0.05)
    assert measures.headroom(static, oracle) == pytest.approx((0.75, 0.75, 0.75))
    assert measures.headroom(np.zeros(5), np.zeros(5)).value == 0.0


def test_an_interval_widens_with_what_maps_differ():
    rng = np.random.default_rng(0)
    narrow, wide = (measures.mean_interval(0.3 + rng.normal(0, sd, 100)) for sd in (0.01, 0.2))
    assert narrow.high - narrow.low < wide.high - wide.low
    assert wide.low < 0.3 < wide.high


@pytest.mark.parametrize("part", ["map", "setting", "map x setting", "run"])
def test_variance_goes_to_the_part_that_has_it(part):
    rng = np.random.default_rng(1)
    shape = {"map": (40, 1, 1), "setting": (1, 40, 1), "map x setting": (40, 40, 1), "run": (40, 40, 4)}[part]
    gaps = rng.normal(0, 1, shape) + rng.normal(0, 0.05, (40, 40, 4))
    shares = measures.variance_shares(gaps)
    assert sum(shares.values()) == pytest.approx(1)
    assert shares[part] > 0.95


def test_the_parameter_that_matters_is_found():
    units = design(128, 4)
    rng = np.random.default_rng(2)
    gaps = np.array([(units[:, 1] - 0.3) ** 2 * scale for scale in (1, 2)]) + rng.normal(0, 1e-3, (2, 128))
    effects = measures.sensitivity(units, gaps)
    assert effects[1] > 0.9
    assert effects[[0, 2, 3]].max() < 0.15


@pytest.mark.parametrize("share", [0.05, 0.2])
def test_a_small_effect_beside_a_large_one_is_measured(share):
    """On a design that fills the cube evenly the large one would hide it."""
    weights = np.sqrt([share, 1 - 3 * share, share, share])
    found = []
    for seed in range(40):
        units = np.random.default_rng(seed).random((128, 4))
        found.append(measures.sensitivity(units, ((units - 0.5) @ weights)[None].repeat(3, axis=0)))
    mean = np.mean(found, axis=0)
    assert mean[1] == pytest.approx(1 - 3 * share, rel=0.08)
    assert mean[[0, 2, 3]] == pytest.approx([share] * 3, rel=0.3)


def test_two_errors_tell_what_differs_from_what_does_not():
    rng = np.random.default_rng(3)
    runs = rng.normal(0, 0.1, (2, 32))
    shift = np.array([[0.5], [0.0]])
    assert measures.better_by_two_errors(runs, runs + shift).tolist() == [True, False]


class Bowl:
    """A problem whose gap is the squared distance from a point, and some noise."""

    def __init__(self, centre):
        self.centre = np.array(centre)

    def gaps(self, units, first):
        noise = np.random.default_rng(first).normal(0, 0.01, len(units))
        return ((units - self.centre) ** 2).sum(axis=1) + np.abs(noise)


def test_the_search_finds_each_pools_own_best(monkeypatch):
    spent = []

    def run_gaps(requests, advance):
        spent.append(sum(len(units) for _, units, _, _ in requests))
        return [problem.gaps(units, first) for problem, units, _, first in requests]

    monkeypatch.setattr(pool, "run_gaps", run_gaps)
    centres = [(0.2, 0.8, 0.5, 0.3), (0.9, 0.1, 0.6, 0.7)]
    stages = (Stage(0, 2), Stage(24, 4, 16, 0.08), Stage(12, 8), Stage(8, 8, 8, 0.04), Stage(6, 24))
    winners = search(
        [Pool([Bowl(c)], design(64, 4), seed=i) for i, c in enumerate(centres)], stages, lambda _: None
    )
    assert np.abs(winners - np.array(centres)).max() < 0.15
    assert sum(spent) == 2 * cost(64, stages)


def test_a_setting_that_was_dropped_does_not_win_by_its_few_runs():
    """Of settings run once, eight times and eight times, the first has the lowest mean."""
    few = Pool([Bowl((0.5,) * 4)], np.eye(4)[:3])
    few.record(np.array([0]), 1, [np.array([0.0])])
    few.record(np.array([1, 2]), 8, [np.repeat([0.2, 0.1], 8)])
    assert few.best(1).tolist() == [0]
    assert few.best(1, among=np.array([1, 2])).tolist() == [2]


def test_a_pool_without_a_problem_is_refused():
    with pytest.raises(ParameterError, match="needs a problem"):
        Pool([], design(8, 4))


def test_rules_are_raced_on_maps_of_their_own():
    train = load_suite("open-v0", "train")
    found = card._by_rule(train, ["max_min", "wei2018"], 5)
    assert {rule: len(indices) for rule, indices in found.items()} == {"max_min": 5, "wei2018": 5}
    assert all(train[i].rules == rule for rule, indices in found.items() for i in indices)


def test_a_pool_over_several_problems_minds_them_all(monkeypatch):
    monkeypatch.setattr(
        pool, "run_gaps", lambda requests, _: [p.gaps(u, first) for p, u, _, first in requests]
    )
    both = Pool([Bowl((0.2,) * 4), Bowl((0.6,) * 4)], design(64, 4))
    winner = search([both], (Stage(0, 2), Stage(16, 4, 8, 0.08), Stage(8, 8, 8, 0.04)), lambda _: None)[0]
    assert np.abs(winner - 0.4).max() < 0.15


def test_a_design_begins_with_the_default_and_fills_the_cube():
    units = design(65, 4)
    assert units.shape == (65, 4)
    assert units[0].tolist() == [0.5] * 4
    assert np.abs(units[1:].mean(axis=0) - 0.5).max() < 0.02


def test_schedules_begin_with_the_static_setting():
    schedules = family()
    assert schedules[0] == Schedule((1.0, 1.0), (1.0, 1.0), BLOCKS)
    assert len(set(schedules)) == len(schedules) == 49


def test_dynamic_headroom_needs_runs_long_enough_to_steer():
    suite = load_suite("mountain-v0", "validation")
    short = [p for p in card.problems(suite, range(12)) if p.iterations < 40]
    assert dynamic(short, short, np.full(4, 0.5), 5, lambda _: None) is None


def test_the_bar_knows_how_many_runs_a_card_takes():
    counted = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(card, "at_bounds", lambda *_: {})
        card.measure("Mountain", "mountain-v0", "smoke", counted.append)
    assert sum(counted) == card.runs_needed("mountain-v0", card.PRESETS["smoke"])


def test_a_tiny_card_is_whole_and_the_same_again(tmp_path):
    for folder in ("one", "two"):
        script.run(script.Arguments(("antgym/MountainOneShot-v0",), "smoke", tmp_path / folder))
    text = (tmp_path / "one" / "Mountain.json").read_text()
    assert text == (tmp_path / "two" / "Mountain.json").read_text()
    made = json.loads(text)
    assert list(made["gap"]) == ["uniform random", "published default", "SBS", "SBS by rule", "VBS"]
    assert all(0 <= low <= mean <= high <= 1 for mean, low, high in made["gap"].values())
    assert made["fingerprint"] == card.fingerprint("mountain-v0", "smoke")
    assert sum(made["variance"].values()) == pytest.approx(1, abs=1e-3)


@pytest.mark.parametrize("world", ["Bee", "TabuBee"])
def test_a_card_of_bees_has_their_parameters(world, tmp_path):
    (made,) = script.run(script.Arguments((world,), "smoke", tmp_path))
    names = ["limit", "xi_max", "xi_min", "tabu_radius"][: 3 + (world == "TabuBee")]
    assert list(made["main effects"]) == list(made["bounds"]) == names
    assert len(made["SBS"]) == len(names)
    assert made["dynamic"]["schedule"].startswith("limit x ")


def test_a_smoke_card_never_takes_the_place_of_a_real_one(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    script.run(script.Arguments(("Mountain",), "smoke"))
    assert [str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*.json")] == [
        "out/cards/Mountain.json"
    ]


def test_an_unknown_world_is_named():
    with pytest.raises(ParameterError, match="did you mean 'Mountain'"):
        script.run(script.Arguments(("Mountan",), "smoke"))
