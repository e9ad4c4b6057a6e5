"""The transfer graph: the numbers of liu2020's Tables 1-2, and the behaviour of the agents on it."""

import dataclasses
import json
import sys

import numpy as np
import pytest

from agents.laplacian import affinities, laplacian, map_affinities, regrets, relabel, transfers
from agents.transfer import TransferAgent, TransferGraph, eq14, paper_weights, sound_weights, trials_needed
from antgym.errors import BudgetError, MissingExtraError, ParameterError
from antgym.tuning import COST_CAP, Session, tune

TABLE_1 = np.array(
    [
        [0.0, -0.0034, 0.1077, -0.00038, 0.0188],
        [0.0207, 0.0, 0.1077, 0.0015, -0.0434],
        [-0.0506, 0.1167, 0.0, -0.0122, 0.0048],
        [0.0107, 0.0229, 0.1156, 0.0, 0.0100],
        [-0.0061, 0.0302, 0.0595, 0.0109, 0.0],
    ]
)
TABLE_2 = np.array([0.0254, 0.0679, 0.1131, -0.0245, 0.0542])
INVENTED = np.array(
    [
        [1.0, 7.0, 0.30, 120],
        [1.5, 9.0, 0.50, 150],
        [1.2, 8.5, 0.40, 200],
        [2.0, 6.0, 0.70, 100],
        [0.8, 8.0, 0.30, 180],
    ]
)
EXPECTED = {
    "paper": ((1.086, 8.698, 0.363, 184.0), (3, 3, 3, 1)),
    "abs": ((1.1302, 8.3163, 0.3784, 172.51), (4, 4, 4, 2)),
}


@pytest.mark.parametrize("mode", EXPECTED)
def test_eq_14_on_the_papers_tables(mode):
    answer = eq14(affinities(TABLE_1), TABLE_2, INVENTED, mode)
    values, decimals = EXPECTED[mode]
    assert tuple(map(round, answer, decimals)) == values


@pytest.mark.parametrize(
    ("mode", "weights"),
    [("paper", (0.094, 0.314, 0.478, -0.120, 0.233)), ("abs", (0.161, 0.242, 0.386, -0.021, 0.233))],
)
def test_weights_on_the_papers_tables(mode, weights):
    found = paper_weights(affinities(TABLE_1), TABLE_2, mode)
    np.testing.assert_allclose(found, weights, atol=6e-4)
    assert found.sum() == pytest.approx(1)


def test_eq_14_as_printed_equals_one_linear_solve():
    edges = np.zeros((6, 6))
    edges[:5, :5], edges[5, :5], edges[:5, 5] = affinities(TABLE_1), TABLE_2, TABLE_2
    system = np.diag([1.0] * 5 + [0.0]) + np.diag(edges.sum(axis=1)) - edges
    solved = np.linalg.solve(system, np.vstack([INVENTED, np.zeros((1, 4))]))[5]
    np.testing.assert_allclose(eq14(affinities(TABLE_1), TABLE_2, INVENTED), solved, rtol=1e-8)


@pytest.mark.parametrize("reference", [1.5, 0.96, 0.94])
def test_eq_14_depends_on_the_random_reference(reference):
    """tuning.md A3: the same lengths, another reference: a mean, an explosion, a reversal."""
    lengths = 1 - TABLE_2
    answer = eq14(affinities(TABLE_1), 1 - lengths / reference, INVENTED)
    expected = {
        1.5: (1.287, 7.76, 0.435, 152),
        0.96: (-0.73, 17.2, -0.29, 473),
        0.94: (1.98, 4.52, 0.686, 42),
    }
    np.testing.assert_allclose(answer, expected[reference], rtol=0.02)


def test_sources_that_all_transfer_alike_give_their_mean():
    answer = eq14(np.zeros((5, 5)), np.full(5, 0.1), INVENTED)
    np.testing.assert_allclose(answer, INVENTED.mean(axis=0))


def test_an_unknown_mode_is_refused():
    with pytest.raises(ParameterError, match="valid: paper, abs"):
        eq14(np.zeros((2, 2)), np.ones(2), np.eye(2), "fixed")


def test_equations_9_and_10_on_a_table_by_eye():
    costs = np.array([[2.0, 3.0], [1.0, 2.0]])
    assert transfers(costs).tolist() == [[0.0, -0.5], [0.5, 0.0]]
    assert affinities(transfers(costs)).tolist() == [[0.0, -0.5], [-0.5, 0.0]]


COSTS = 1.2 * np.array([[1.00, 1.10, 1.30], [1.05, 1.00, 1.20], [1.20, 1.15, 1.00]])
TARGET = np.array([1.3, 1.2, 1.5])


def test_sound_weights_are_a_mean():
    weights = sound_weights(COSTS, TARGET, 0.02, 0.1)
    assert (weights >= 0).all()
    assert weights.sum() == pytest.approx(1)
    assert weights.argmax() == TARGET.argmin()


def test_a_small_tau_copies_the_best_source():
    np.testing.assert_allclose(sound_weights(COSTS, TARGET, 1e-4, 0.1), [0, 1, 0], atol=1e-9)


def test_a_large_tau_takes_the_mean():
    np.testing.assert_allclose(sound_weights(COSTS, TARGET, 1e6, 0.1), [1 / 3] * 3, atol=1e-6)


def test_maps_are_labelled_with_the_set_that_does_best_on_them():
    costs = COSTS.copy()
    costs[1, 0] = 1.1  # set 1 beats map 0's own
    assert relabel(costs).tolist() == [1, 1, 2]
    assert sound_weights(costs, TARGET, 0.05, 0.1)[0] == 0


def test_of_some_sets_alone_every_map_is_labelled_with_the_best_of_them():
    weights = sound_weights(COSTS[[0, 2]], TARGET[[0, 2]], 0.05, 0.1)
    assert weights.shape == (2,)
    assert weights.sum() == pytest.approx(1)
    assert sound_weights(COSTS[:1], TARGET[:1], 0.05, 0.1).tolist() == [pytest.approx(1)]


def test_two_maps_are_joined_by_their_labels_regret_on_each_other():
    """By hand: set 0 costs 1.10 of the best on map 1, set 1 costs 1.05 of the best on map 0."""
    assert map_affinities(COSTS, 0.1)[0, 1] == pytest.approx(np.exp(-(0.10 + 0.05) / 0.2))
    assert map_affinities(COSTS, 0.1).diagonal().tolist() == [0, 0, 0]


def test_the_smoothest_function_on_two_maps_by_hand():
    """One set a map, no regret anywhere: all edges 1, (S + gamma L) z = S u has the mean as its answer."""
    assert sound_weights(np.ones((2, 2)), np.ones(2), 0.02, 0.1).tolist() == [pytest.approx(1), 0]
    costs = np.array([[1.0, 1.0 + 1e-12], [1.0 + 1e-12, 1.0]])
    np.testing.assert_allclose(sound_weights(costs, np.ones(2), 0.02, 0.1), [0.5, 0.5])


def test_regrets_are_zero_for_the_best_of_each_map():
    assert regrets(COSTS).min(axis=0).tolist() == [0, 0, 0]


def test_fitting_pays_for_every_run(graph):
    assert graph.evaluations == 3 * trials_needed(3, search=16, repeats=4)
    assert graph.table.shape == (3, 3)


def test_fitting_stops_before_spending_where_a_session_is_too_short(bowl):
    sessions = [bowl(200), bowl(20)]
    with pytest.raises(BudgetError, match="session 1: 20 trials left"):
        TransferGraph.fit(sessions)
    assert sessions[0].left == 200


def test_fitting_needs_sources():
    with pytest.raises(ParameterError, match="at least one source"):
        TransferGraph.fit([])


def test_fitting_is_deterministic_and_one_source_is_enough(bowl):
    first, second = (TransferGraph.fit([bowl(40, noise=0.1)], search=10, repeats=2, seed=1) for _ in range(2))
    assert first == second
    assert tune(TransferAgent(first), bowl(20), seed=0).recommendation.shape == (4,)


def test_without_checks_the_default_scales_stay(bowl):
    graph = TransferGraph.fit([bowl(60, noise=0.1) for _ in range(3)], search=10, repeats=2, check=0)
    assert (graph.tau, graph.gamma) == (0.02, 0.1)
    assert graph.evaluations == 3 * (10 + 2 * 3)


def test_a_graph_survives_a_round_trip_through_its_file(graph, tmp_path):
    path = tmp_path / "graph.json"
    graph.save(path)
    assert TransferGraph.load(path) == graph
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        ("{", "no JSON"),
        ("[]", "not an 'antgym transfer graph 2'"),
        ('{"format": "antgym transfer graph 2"}', "with the fields"),
    ],
)
def test_a_damaged_file_says_where_and_what(content, reason, tmp_path):
    path = tmp_path / "graph.json"
    path.write_text(content)
    with pytest.raises(ParameterError, match=rf"graph\.json: .*{reason}"):
        TransferGraph.load(path)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("units", [[2, 0, 0, 0]] * 3),
        ("costs", [[[1]]]),
        ("units", "x"),
        ("costs", [[[-1] * 4] * 3] * 3),
        ("tau", 0),
    ],
)
def test_a_file_with_impossible_content_is_refused(name, value, graph, tmp_path):
    path = tmp_path / "graph.json"
    graph.save(path)
    path.write_text(json.dumps({**json.loads(path.read_text()), name: value}))
    with pytest.raises(ParameterError, match=r"graph\.json"):
        TransferGraph.load(path)


def test_a_graph_that_is_not_there_is_named(tmp_path):
    with pytest.raises(ParameterError, match="no such transfer graph"):
        TransferAgent(tmp_path / "absent.json")


def test_one_trial_recommends_the_source_that_is_best_on_average(graph, bowl):
    for mode in ("sound", "paper", "abs", "copy"):
        result = tune(TransferAgent(graph, mode), bowl(1), seed=0)
        assert result.recommendation == pytest.approx(graph.settings[graph.ranking[0]], abs=1e-12)


@pytest.mark.parametrize("mode", ["paper", "abs"])
def test_the_printed_modes_run_every_set_and_one_random_set_equally_often(mode, graph, bowl):
    session = bowl(100)
    tune(TransferAgent(graph, mode), session, seed=0)
    units, counts = np.unique(np.concatenate(session.batches), axis=0, return_counts=True)
    assert counts.tolist() == [10] * 4
    assert {tuple(u) for u in graph.units} < {tuple(u) for u in units.tolist()}


def test_the_guard_runs_its_candidates_afresh_and_keeps_the_winner(graph, bowl):
    """A target whose optimum is the published default: no mean of sources can beat it."""
    session = bowl(60, optimum=(0.5, 0.5, 0.5, 0.5), noise=0.01)
    result = tune(TransferAgent(graph), session, seed=0)
    assert result.recommendation.tolist() == [0.5] * 4
    assert session.left == 0


def test_the_blend_is_never_believed_untested(graph, bowl):
    """However small the budget, sound mode recommends a setting that it ran."""
    for budget in range(1, 12):
        session = bowl(budget, noise=0.05)
        recommendation = tune(TransferAgent(graph), session, seed=0).recommendation
        assert tuple(recommendation.tolist()) in {trial.unit for trial in session.trials}


def test_sound_mode_spends_all_and_probes_with_two_fifths(graph, bowl):
    agent, session = TransferAgent(graph), bowl(20)
    agent.reset(session.task, seed=0)
    assert len(agent.ask()) == 6
    assert tune(TransferAgent(graph), session, seed=0).trials == session.trials
    assert session.left == 0


def test_with_few_trials_sets_come_first_that_complement_each_other(graph, bowl):
    """Set 0 is best on average, set 2 helps where it fails, set 1 is as good as set 0 in nothing."""
    costs = [[(1.1,), (1.1,), (1.6,)], [(1.15,), (1.15,), (1.6,)], [(1.8,), (1.8,), (1.1,)]]
    graph = dataclasses.replace(graph, costs=tuple(map(tuple, costs)), left_out=())
    assert graph.ranking == [0, 1, 2]
    assert graph.order == [0, 2, 1]
    session = bowl(2)
    tune(TransferAgent(graph, "copy"), session, seed=0)
    assert [trial.unit for trial in session.trials] == [graph.units[0], graph.units[2]]


@pytest.mark.parametrize("budget", range(1, 30))
def test_the_guard_never_asks_for_more_than_is_left(budget, graph, bowl):
    agent, session = TransferAgent(graph), bowl(budget)
    agent.reset(session.task, seed=0)
    asked = 0
    while len(units := agent.ask()):
        asked += len(units)
        agent.tell(session.evaluate(units))
    assert asked <= budget


def test_copying_takes_the_source_that_is_best_on_the_target(graph, bowl):
    best = list(graph.units[2])
    session = bowl(9, optimum=best)
    assert tune(TransferAgent(graph, "copy"), session, seed=0).recommendation.tolist() == best


def test_the_mean_of_sources_costs_nothing(graph, bowl):
    session = bowl(9)
    result = tune(TransferAgent(graph, "mean"), session, seed=0)
    expected = session.space.mean(graph.settings, np.full(3, 1 / 3))
    np.testing.assert_allclose(result.recommendation, expected)
    assert session.left == 9


def _flat(graph, sources=3):
    """The same sources, all equal on each other's maps: no edges between them."""
    costs = tuple(tuple((1.2,) for _ in range(sources)) for _ in range(sources))
    return dataclasses.replace(graph, costs=costs)


def test_q_is_transferred_as_kappa(graph, bowl):
    """The straight line of the target scales every Q alike, so the setting found does not depend on it."""
    near, far = (
        tune(TransferAgent(graph, "paper"), bowl(40, straight_line=length), seed=0).recommendation
        for length in (10.0, 1e4)
    )
    np.testing.assert_allclose(near, far, rtol=1e-9)


def test_a_parameter_that_leaves_its_range_is_clipped_and_noted(graph, bowl):
    """One source better than the reference, one almost as much worse: their difference leaves the box."""
    agent, session = TransferAgent(_flat(graph), "paper", repeats=1), bowl(4)
    agent.reset(session.task, seed=0)
    trials = session.evaluate(agent.ask())
    costs = (2.0, 1.0, 2.9, 2.0)
    agent.tell([trial._replace(cost=cost) for trial, cost in zip(trials, costs, strict=True)])
    session.space.check(agent.recommend())
    assert any("left its range and was clipped" in note for note in agent.notes)


def test_a_reference_better_than_the_sources_is_noted(graph, bowl):
    agent, session = TransferAgent(_flat(graph), "paper", repeats=1), bowl(4)
    agent.reset(session.task, seed=0)
    trials = session.evaluate(agent.ask())
    agent.tell([trial._replace(cost=cost) for trial, cost in zip(trials, (1.0, 1.5, 1.6, 1.7), strict=True)])
    assert any("at most 0" in note for note in agent.notes)


def test_sources_no_better_than_the_reference_leave_eq_14_without_a_solution(graph, bowl):
    agent, session = TransferAgent(_flat(graph), "paper", repeats=1), bowl(4, fails=True)
    tune(agent, session, seed=0)
    assert all(trial.cost == COST_CAP for trial in session.trials)
    assert any("no solution" in note for note in agent.notes)


def test_a_task_with_other_parameters_is_refused(graph, bowl):
    agent = TransferAgent(dataclasses.replace(graph, parameters=("a", "b", "c", "d")))
    with pytest.raises(ParameterError, match="the graph transfers"):
        agent.reset(bowl(5).task, seed=0)


def test_a_graph_fitted_through_real_sessions_transfers_to_a_real_target(valley):
    from antgym.tuning.problem import TuningProblem

    def session(seed, budget):
        return Session(TuningProblem(valley, ants=4, iterations=3, seed=seed), budget)

    sources = [session(seed, trials_needed(3, search=5, repeats=2, check=1)) for seed in range(3)]
    graph = TransferGraph.fit(sources, search=5, repeats=2, check=1)
    assert all(source.left == 0 for source in sources)
    target = session(9, 20)
    recommendation = tune(TransferAgent(graph), target, seed=0).recommendation
    target.task.space.check(recommendation)


def test_each_source_is_left_out_once_and_paid_for(graph):
    assert [row.name for row in graph.negative_transfer] == list(graph.names)
    assert np.shape(graph.left_out) == (3, 3, 4)
    assert all(row.transferred > 0 for row in graph.negative_transfer)


def test_negative_transfer_is_what_two_standard_errors_cannot_explain(graph):
    """Transferred, copied, default: clearly worse than both, within the noise of both, better than both."""
    left_out = (
        ((1.5, 1.5), (1.2, 1.2), (1.3, 1.3)),
        ((1.2, 1.4), (1.2, 1.3), (1.1, 1.3)),
        ((1.1, 1.1), (1.2, 1.2), (1.3, 1.3)),
    )
    rows = dataclasses.replace(graph, left_out=left_out).negative_transfer
    assert [row.worse_than_copy for row in rows] == [True, False, False]
    assert [row.worse_than_default for row in rows] == [True, False, False]
    assert rows[0][1:4] == pytest.approx((1.5, 1.2, 1.3))


def test_the_spectrum_counts_the_parts_of_the_graph(graph):
    """Three maps, the third apart from the others: two eigenvalues are 0."""
    costs = [[(1.0,), (1.0,), (2.0,)], [(1.0,), (1.0,), (2.0,)], [(2.0,), (2.0,), (1.0,)]]
    apart = dataclasses.replace(graph, costs=tuple(map(tuple, costs)), tau=0.01)
    np.testing.assert_allclose(apart.spectrum, [0, 0, 2], atol=1e-9)
    assert laplacian(apart.affinities).sum() == pytest.approx(0)


def test_a_graph_is_drawn(graph, tmp_path):
    pytest.importorskip("matplotlib")
    for drawn in (graph, dataclasses.replace(graph, left_out=())):
        assert drawn.plot(tmp_path / "graph.png").read_bytes().startswith(b"\x89PNG")


def test_a_picture_without_matplotlib_says_how_to_mend_it(graph, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(MissingExtraError, match=r"antgym\[viz\]"):
        graph.plot(tmp_path / "graph.png")
