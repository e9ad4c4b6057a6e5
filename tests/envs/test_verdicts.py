"""What verdicts of different problems are worth together is what each is worth alone."""

import numpy as np
import pytest

from antgym.envs.draws import load_problems
from antgym.envs.infos import row
from antgym.envs.verdicts import REWARDS, Verdict, judged, worths
from antgym.maps.suites import load_suite
from antgym.tuning.problem import COST_CAP


@pytest.fixture(scope="module")
def problems():
    drawn = load_problems(load_suite("open-v0", "train"), (3, 4), 1)
    return [drawn.at(i, i) for i in range(6)]


@pytest.fixture(scope="module")
def verdicts(problems):
    """Solved and not, compared with the default and not, default solved and not."""
    factors = [1.0, 1.2, 3.0, np.inf, 1.5, np.inf]
    defaults = [None, 1.1, np.inf, None, np.inf, np.inf]
    units = np.random.default_rng(0).random((6, 4)).tolist()
    return [
        Verdict(unit, f * p.scenario.optimum, d and d * p.scenario.optimum, {"block": i})
        for i, (unit, f, d, p) in enumerate(zip(units, factors, defaults, problems, strict=True))
    ]


def test_together_they_tell_what_each_tells_alone(problems, verdicts):
    told = judged(problems, verdicts)
    for i, (problem, verdict) in enumerate(zip(problems, verdicts, strict=True)):
        assert row(told, i) == row(judged([problem], [verdict]), 0)


def test_info_of_a_verdict_is_that_of_its_problem(problems, verdicts):
    told = judged(problems, verdicts)
    for i, (problem, verdict) in enumerate(zip(problems, verdicts, strict=True)):
        info, scenario = row(told, i), problem.scenario
        assert info["length"] == min(verdict.length, COST_CAP * scenario.straight_line)
        assert info["gap"] == problem.gap(np.array([verdict.length]))[0]
        assert info["solved"] == np.isfinite(verdict.length)
        assert list(info["parameters"].values()) == problem.space.decode(verdict.unit)[0].tolist()
        assert (info["block"], info["scenario"], info["seed"]) == (i, scenario.name, i)


def test_parameters_that_are_known_are_those_decoded(problems, verdicts):
    known = [
        verdict._replace(parameters=problem.space.decode(verdict.unit)[0].tolist())
        for problem, verdict in zip(problems, verdicts, strict=True)
    ]
    for i in range(len(problems)):
        assert row(judged(problems, known), i) == row(judged(problems, verdicts), i)


def test_worth_is_read_off_the_verdict(problems, verdicts):
    told = judged(problems, verdicts)
    gaps = [0.0, 0.2, 1.0, 1.0, 0.5, 1.0]
    defaults = [0.0, 0.1, 1.0, 0.0, 1.0, 1.0]  # 0 where there is nothing to compare with
    expected = {
        "gap": -np.add(gaps, 0),
        "length": -told["length"],
        "improvement": np.subtract(defaults, gaps),
    }
    plain = [verdict._replace(default=None) for verdict in verdicts]
    for reward in REWARDS:
        given = verdicts if reward == "improvement" else plain
        assert worths(reward, problems, given, told) == pytest.approx(expected[reward], abs=1e-12)
