"""What verdicts of different problems are worth together is what each is worth alone."""

import numpy as np
import pytest

from antgym.envs.draws import load_problems
from antgym.envs.infos import row
from antgym.envs.verdicts import REWARDS, Verdicts, judged, worths
from antgym.maps.suites import load_suite
from antgym.tuning.problem import COST_CAP


@pytest.fixture(scope="module")
def problems():
    drawn = load_problems(load_suite("open-v0", "train"), (3, 4), 1)
    return [drawn.at(i, i) for i in range(6)]


@pytest.fixture(scope="module")
def verdicts(problems):
    """Solved and not, compared with the default and not, default solved and not."""
    optima = np.array([problem.scenario.optimum for problem in problems])
    lengths, defaults = [1.0, 1.2, 3.0, np.inf, 1.5, np.inf], [np.nan, 1.1, np.inf, np.nan, np.inf, np.inf]
    units = np.random.default_rng(0).random((6, 4))
    naturals = np.concatenate([p.space.decode(unit) for p, unit in zip(problems, units, strict=True)])
    return Verdicts(
        naturals, np.multiply(lengths, optima), np.multiply(defaults, optima), {"block": list(range(6))}
    )


def alone(verdicts, i):
    """The verdict of one of them."""
    parts = (part[i : i + 1] for part in verdicts[:3])
    return Verdicts(*parts, {name: values[i : i + 1] for name, values in verdicts.facts.items()})


def test_together_they_tell_what_each_tells_alone(problems, verdicts):
    told = judged(problems, verdicts)
    for i, problem in enumerate(problems):
        assert row(told, i) == row(judged([problem], alone(verdicts, i)), 0)


def test_info_of_a_verdict_is_that_of_its_problem(problems, verdicts):
    told = judged(problems, verdicts)
    for i, (problem, length) in enumerate(zip(problems, verdicts.lengths, strict=True)):
        info, scenario = row(told, i), problem.scenario
        assert info["length"] == min(length, COST_CAP * scenario.straight_line)
        assert info["optimum"] == scenario.optimum
        assert info["gap"] == problem.gap(np.array([length]))[0]
        assert info["solved"] == np.isfinite(length)
        assert list(info["parameters"].values()) == verdicts.parameters[i].tolist()
        assert info["block"] == i


def test_worth_is_read_off_the_verdict(problems, verdicts):
    told = judged(problems, verdicts)
    gaps = [0.0, 0.2, 1.0, 1.0, 0.5, 1.0]
    defaults = [0.0, 0.1, 1.0, 0.0, 1.0, 1.0]  # 0 where there is nothing to compare with
    expected = {
        "gap": -np.add(gaps, 0),
        "length": -told["length"],
        "improvement": np.subtract(defaults, gaps),
    }
    for reward in REWARDS:
        given = verdicts if reward == "improvement" else verdicts._replace(defaults=None)
        assert worths(reward, problems, given, told) == pytest.approx(expected[reward], abs=1e-12)
