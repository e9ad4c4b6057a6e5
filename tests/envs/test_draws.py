"""What episodes draw: the same alone and together, every scenario alike, and problems made once."""

import pickle

import numpy as np
import pytest

from antgym.envs.draws import load_problems
from antgym.envs.infos import row
from antgym.maps.suites import load_suite
from antgym.tuning.problem import TRIAL, TuningProblem

SUITE = "mountain-v0"


@pytest.fixture
def problems():
    return load_problems(load_suite(SUITE, "train"), None, 1)


def test_episodes_drawn_together_are_those_drawn_alone(problems):
    roots, episodes = [5, 2**127, 2**140, 0] * 8, list(range(32))
    alone = [problems.draw([root], [episode]) for root, episode in zip(roots, episodes, strict=True)]
    for together, *each in zip(problems.draw(roots, episodes), *alone, strict=True):
        assert together.tolist() == np.concatenate(each).tolist()


def test_every_scenario_is_drawn_as_often_as_any_other(problems):
    indices, _ = problems.draw([3] * 20_000, range(20_000))
    counts = np.bincount(indices, minlength=len(problems))
    assert len(counts) == len(problems)
    expected = 20_000 / len(problems)
    assert ((counts - expected) ** 2 / expected).sum() < 2 * len(problems)  # chi-square; the mean is 1 each


def test_seeds_of_episodes_are_unrelated_and_fit_an_int64(problems):
    seeds = np.concatenate([problems.draw([root] * 1000, range(1000))[1] for root in (0, 1)]).tolist()
    assert len(set(seeds)) == 2000
    assert 2**61 < np.mean(seeds) < max(seeds) < 2**63


def test_a_drawn_problem_is_that_of_the_scenario_and_its_effort(problems):
    item, drawn = load_suite(SUITE, "train")[3], problems.at(3, 8)
    alike = TuningProblem(item.scenario, item.rules, item.ants, item.iterations, 8)
    fields = ("scenario", "rules", "ants", "iterations", "seed")
    assert [getattr(drawn, name) for name in fields] == [getattr(alike, name) for name in fields]
    assert drawn.seeds(TRIAL, 0, 3).tolist() == alike.seeds(TRIAL, 0, 3).tolist()
    assert (load_problems(load_suite(SUITE, "train"), (4, 2), 1).at(3, 8).ants, drawn.ants) == (4, item.ants)


def test_least_iterations_bind_a_scenarios_own_effort_alone(problems):
    iterations = [problems.at(i, 0).iterations for i in range(len(problems))]
    most = max(iterations)
    raised = load_problems(load_suite(SUITE, "train"), None, most)
    assert min(iterations) < most
    assert {raised.at(i, 0).iterations for i in range(len(raised))} == {most}


def test_what_does_not_depend_on_the_seed_is_shared_by_all_episodes(problems):
    one, other = problems.at(7, 1), problems.at(7, 2)
    assert one.task(3) is other.task(3)
    assert one.space is other.space
    assert one.task(3) is not one.task(4)
    with pytest.raises(ValueError, match="read-only"):
        one.task(3).features[0] = 7


def test_what_is_told_and_shown_of_drawn_problems_is_theirs(problems):
    indices = np.array([5, 2, 5, 9])
    drawn, told = problems.of(indices), problems.told(indices, np.arange(4))
    for i, (index, problem) in enumerate(zip(indices, drawn, strict=True)):
        alike = TuningProblem(problem.scenario, problem.rules, problem.ants, problem.iterations, i)
        assert problem is problems.of(np.array([index]))[0]
        assert row(told, i) == {
            "scenario": alike.scenario.name,
            "seed": i,
            "ants": alike.ants,
            "iterations": alike.iterations,
            "rules": alike.rules,
        }
        assert problems.features(indices)[i].tolist() == alike.task(1).features.tolist()


def test_what_is_shown_may_be_written_to(problems):
    indices = np.array([1])
    problems.of(indices)
    problems.features(indices)[:] = 7.0
    assert problems.features(indices).max() <= 1.0


def test_problems_are_loaded_once_and_pickled_as_a_name(problems):
    assert pickle.loads(pickle.dumps(problems)) is problems
    assert len(pickle.dumps(problems)) < 300
