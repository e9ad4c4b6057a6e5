"""Sessions: trials are charged once, recorded in order, and the same however they are run."""

import numpy as np
import pytest

from antgym.errors import BudgetError, ParameterError
from antgym.maps.world import GridWorld, Scenario
from antgym.tuning import problem as problems
from antgym.tuning.budget import Budget
from antgym.tuning.problem import COST_CAP, FRESH, GAP_CAP, TRIAL, TuningProblem
from antgym.tuning.session import Session, Trial, evaluate_together, incumbent

DEFAULT = (0.5,) * 4


@pytest.fixture
def problem(valley):
    return TuningProblem(valley, ants=3, iterations=4, seed=5)


@pytest.fixture
def walled_in():
    """No path: the layer in the middle is blocked."""
    free = np.ones((5, 3, 3), bool)
    free[2] = False
    return TuningProblem(Scenario(GridWorld(free), (0, 1, 1), (4, 1, 1)), ants=2, iterations=2)


def settings(count, seed=0):
    return np.random.default_rng(seed).random((count, 4))


def test_every_trial_is_charged_once(problem):
    session = Session(problem, 7)
    session.evaluate(settings(3))
    session.evaluate(DEFAULT)
    assert (session.left, len(session.trials), session.task.budget) == (3, 4, 7)


def test_trials_keep_their_order_and_settings(problem):
    session, units = Session(problem, 5), settings(5)
    told = session.evaluate(units[:2]) + session.evaluate(units[2:])
    assert told == session.trials
    assert [trial.index for trial in told] == list(range(5))
    assert [trial.unit for trial in told] == [tuple(unit) for unit in units.tolist()]


def test_a_batch_is_cut_to_what_is_left(problem):
    session, units = Session(problem, 3), settings(5)
    assert [trial.unit for trial in session.evaluate(units)] == [tuple(unit) for unit in units[:3].tolist()]
    assert session.left == 0


def test_nothing_can_be_spent_twice(problem):
    session = Session(problem, 1)
    session.evaluate(DEFAULT)
    with pytest.raises(BudgetError, match="all 1 trials are spent"):
        session.evaluate(DEFAULT)
    assert len(session.trials) == 1


@pytest.mark.parametrize("units", [[0.5] * 3, [1.1, 0, 0, 0], [float("nan")] * 4, np.full((1, 1, 4), 0.5)])
def test_settings_that_cannot_be_used_cost_nothing(problem, units):
    session = Session(problem, 2)
    with pytest.raises(ParameterError):
        session.evaluate(units)
    assert (session.left, session.trials) == (2, ())


def test_an_empty_batch_is_refused_and_costs_nothing(problem):
    session = Session(problem, 2)
    with pytest.raises(BudgetError, match="empty batch"):
        session.evaluate(np.empty((0, 4)))
    assert session.left == 2


@pytest.mark.parametrize("total", [0, -3, 2.5, float("nan"), float("inf"), "many", None])
def test_a_session_without_a_budget_is_refused(problem, total):
    with pytest.raises(BudgetError, match="budget = "):
        Session(problem, total)
    with pytest.raises(BudgetError, match="budget = "):
        Budget(total)


def test_a_whole_float_is_a_budget(problem):
    assert Session(problem, 3.0).left == 3


def test_sessions_run_together_give_what_each_gives_alone(problem, walled_in):
    requests = [(problem, settings(3)), (walled_in, settings(2, 1)), (problem, settings(4, 2))]
    together = evaluate_together([(Session(p, 4), units) for p, units in requests])
    assert together == [Session(p, 4).evaluate(units) for p, units in requests]


def test_trials_do_not_depend_on_how_they_are_batched(problem):
    units, alone, whole = settings(6), Session(problem, 6), Session(problem, 6)
    for unit in units:
        alone.evaluate(unit)
    assert whole.evaluate(units) == alone.trials
    assert whole.lengths == alone.lengths


@pytest.mark.parametrize("bad", [[2.0] * 4, np.empty((0, 4))])
def test_one_request_that_cannot_be_used_charges_nobody(problem, bad):
    good, other = Session(problem, 2), Session(problem, 2)
    with pytest.raises((ParameterError, BudgetError)):
        evaluate_together([(good, DEFAULT), (other, bad)])
    assert (good.left, other.left) == (2, 2)


def test_a_session_that_is_spent_charges_nobody_else(problem):
    good, spent = Session(problem, 2), Session(problem, 1)
    spent.evaluate(DEFAULT)
    with pytest.raises(BudgetError, match="spent"):
        evaluate_together([(good, DEFAULT), (spent, DEFAULT)])
    assert good.left == 2


def test_a_session_may_not_appear_twice_in_a_batch(problem):
    session = Session(problem, 4)
    with pytest.raises(ParameterError, match="appears twice"):
        evaluate_together([(session, DEFAULT), (session, DEFAULT)])
    assert session.left == 4


def test_trials_do_not_depend_on_the_number_of_threads(problem, monkeypatch):
    found = []
    for threads in "12":
        monkeypatch.setenv("ANTGYM_THREADS", threads)
        found.append(Session(problem, 20).evaluate(settings(20)))
    assert found[0] == found[1]


def test_a_setting_tried_again_is_measured_again(problem):
    trials = Session(problem, 8).evaluate([[0.2, 0.1, 0.5, 0.5]] * 8)
    assert len({trial.work for trial in trials} | {trial.cost for trial in trials}) > 2


def test_a_run_without_a_path_costs_the_cap(walled_in):
    session = Session(walled_in, 1)
    (trial,) = session.evaluate(DEFAULT)
    assert trial.cost == COST_CAP
    assert session.lengths == (np.inf,)


def test_costs_are_lengths_over_the_straight_line(problem):
    session = Session(problem, 5)
    costs = [trial.cost for trial in session.evaluate(settings(5))]
    assert costs == [min(length / problem.scenario.straight_line, COST_CAP) for length in session.lengths]


def test_work_counts_the_moves_of_all_ants():
    """In the open nobody dies: every ant makes one move a layer."""
    scenario = Scenario(GridWorld(np.ones((7, 5, 5))), (0, 2, 2), (6, 2, 2))
    (trial,) = Session(TuningProblem(scenario, ants=3, iterations=4), 1).evaluate(DEFAULT)
    assert trial.work == 3 * 4 * 6


def test_records_are_plain_and_frozen(problem):
    (trial,) = Session(problem, 1).evaluate(DEFAULT)
    assert [type(value) for value in trial] == [int, tuple, float, int]
    assert {type(value) for value in trial.unit} == {float}
    with pytest.raises(AttributeError):
        trial.cost = 0.0


def test_the_incumbent_has_the_lowest_mean_over_its_trials():
    """One lucky run of a setting that is worse on average does not make it the best."""
    a, b = (0.1,) * 4, (0.2,) * 4
    trials = [
        Trial(i, unit, cost, 1) for i, (unit, cost) in enumerate([(a, 1.0), (b, 1.3), (a, 2.0), (b, 1.5)])
    ]
    assert incumbent(trials[:3]) == (b, 1.3)
    assert incumbent(trials) == (b, 1.4)


def test_on_a_tie_the_earliest_is_the_incumbent():
    trials = [Trial(i, (0.1 * i,) * 4, 2.0, 1) for i in range(3)]
    assert incumbent(trials) == (trials[0].unit, 2.0)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"rules": "lui2020"}, "did you mean 'liu2020'"),
        ({"ants": 0}, "ants = 0"),
        ({"ants": 2.5}, "ants = 2.5"),
        ({"iterations": -1}, "iterations = -1"),
    ],
)
def test_a_problem_that_cannot_be_run_is_named(valley, arguments, message):
    with pytest.raises(ParameterError, match=message):
        TuningProblem(valley, **arguments)


def test_a_task_may_have_no_trials_but_not_fewer(problem):
    assert problem.task(0).budget == 0
    with pytest.raises(BudgetError, match="budget = -1"):
        problem.task(-1)


def test_planner_seeds_are_unrelated_between_problems_domains_and_indices(problem, valley):
    other = TuningProblem(valley, ants=3, iterations=4, seed=6)
    seeds = [p.seeds(domain, 0, 50).tolist() for p in (problem, other) for domain in (TRIAL, FRESH)]
    assert len({seed for group in seeds for seed in group}) == 200


def test_planner_seeds_depend_on_the_index_alone(problem):
    assert problem.seeds(TRIAL, 3, 4).tolist() == problem.seeds(TRIAL, 0, 9)[3:7].tolist()


def test_fresh_runs_are_charged_to_nobody_and_repeat_themselves(problem):
    one, other = (problem.fresh(np.array(DEFAULT), 5).lengths.tolist() for _ in range(2))
    assert one == other
    assert len(one) == 5


def test_gaps_are_capped_and_never_negative(problem):
    optimum = problem.scenario.optimum
    assert problem.gap(np.array([optimum, 1.25 * optimum, 9 * optimum, np.inf])).tolist() == [
        0,
        0.25,
        GAP_CAP,
        GAP_CAP,
    ]


def test_a_length_below_the_optimum_is_a_bug_that_stops_the_run(problem):
    with pytest.raises(AssertionError, match="below the exact optimum"):
        problem.gap(np.array([np.nextafter(problem.scenario.optimum, 0)]))


def test_running_nothing_together_gives_nothing():
    assert problems.run_together([]) == []


def test_a_problem_with_the_printed_rules_checks_end_points_alone(valley):
    sound, paper = (TuningProblem(valley, rules) for rules in ("liu2020", "liu2020-paper"))
    assert sound.scenario.motion.check_segments
    assert not paper.scenario.motion.check_segments
    assert paper.scenario.optimum <= sound.scenario.optimum


@pytest.mark.parametrize(
    "changes", [{"ants": 20.0}, {"iterations": True}, {"ants": 2_000_000}, {"seed": -1}, {"seed": 1.5}]
)
def test_a_problem_that_no_planner_would_run_is_refused_before_anything_is_paid(valley, changes):
    with pytest.raises(ParameterError, match=next(iter(changes))):
        TuningProblem(valley, **changes)


def test_costs_and_gaps_of_several_problems_are_each_its_own(problem, valley):
    other = TuningProblem(valley, ants=3, iterations=4, seed=6)
    lengths = np.array([1.5, 40.0]) * valley.straight_line
    assert problems.costs([problem, other], lengths).tolist() == [1.5, COST_CAP]
    found = problems.gaps([problem, other], lengths)
    assert found.tolist() == [problem.gap(lengths[:1])[0], other.gap(lengths[1:])[0]]


def test_a_length_below_the_optimum_is_named_among_others(problem):
    optimum = problem.scenario.optimum
    with pytest.raises(AssertionError, match=f"{problem.scenario.name}: length {0.5 * optimum}"):
        problems.gaps([problem] * 3, np.array([optimum, 0.5 * optimum, np.inf]))


def test_a_problem_under_another_seed_is_one_made_with_it(problem, valley):
    one, other = problem.seeded(9), TuningProblem(valley, ants=3, iterations=4, seed=9)
    assert one.seeds(TRIAL, 0, 3).tolist() == other.seeds(TRIAL, 0, 3).tolist()
    assert Session(one, 2).evaluate(settings(2)) == Session(other, 2).evaluate(settings(2))
    assert problem.seed != 9
    with pytest.raises(ParameterError, match="seed = -1"):
        problem.seeded(-1)


def test_nobody_asks_for_nothing():
    assert evaluate_together([]) == []
