"""Tracks: who plays at which budgets, and the bound that everybody together sets."""

import numpy as np
import pytest

from antgym.errors import AntgymError
from antgym.maps.suites import load_suite
from antgym.tuning.ledger import Ledger, Outcome
from experiments import contest, tracks
from experiments.bound import candidates, virtual_best
from experiments.rows import to_row
from experiments.tracks import Round, budgets_of, jobs, per_map, read_key

NAMES = {
    "rl": "agent",
    "ga": "agent",
    "uniform_random": "agent",
    "random_search": "agent",
    "best_static": "reference",
}
ENTRANTS = tuple(contest.Entrant(name, kind, "", None, 0) for name, kind in NAMES.items())


@pytest.mark.parametrize(
    ("track", "largest", "asked", "budgets"),
    [
        ("A", 100, (), (1, 5, 20, 100)),
        ("A", 12, (), (1, 5, 12)),
        ("B", 100, (), (0, 1, 5, 20)),
        ("B", 12, (), (0, 1, 5)),
        ("A", 100, (50, 0, 2), (2, 50)),
        ("B", 100, (50, 0, 2), (0, 2, 50)),
        ("C", 100, (50,), (1,)),
    ],
)
def test_budgets_of_a_track(track, largest, asked, budgets):
    assert budgets_of(track, largest, asked) == budgets


@pytest.mark.parametrize(
    ("key", "parts"),
    [
        ("ga/20/mountain-v0/ood/3/1", ("ga", 20, "mountain-v0/ood/3", 1)),
        ("ga/20/32room.map.scen:5/0", ("ga", 20, "32room.map.scen:5", 0)),
        ("ga/7/0", ("ga", None, "7", 0)),
        ("ga/20//data/x.map/0", ("ga", 20, "/data/x.map", 0)),
        ("my/a.py:A/0/flat/12", ("my/a.py:A", 0, "flat", 12)),
        ("my/a.py:A/flat/12", ("my/a.py:A", None, "flat", 12)),
        ("my/a.py:A/deep/20/flat/12", ("my/a.py:A/deep", 20, "flat", 12)),
    ],
)
def test_a_key_is_read_as_it_was_made(key, parts):
    assert read_key(key, ["my/a.py:A", "my/a.py:A/deep"]) == parts


@pytest.mark.parametrize("key", ["exact planner", "exact planner/flat", "ga/20/flat/first"])
def test_what_no_contest_calls_a_run_is_no_key(key):
    with pytest.raises(AntgymError, match="is none of a contest"):
        read_key(key, [])


def test_on_track_b_who_did_not_learn_is_there_to_compare_with():
    kinds = {entrant.name: entrant.kind for entrant in per_map("B", ENTRANTS, 5)}
    assert kinds == {
        **dict.fromkeys(("uniform_random", "random_search", "best_static"), "reference"),
        "rl": "agent",
    }
    assert "random_search" not in {entrant.name for entrant in per_map("B", ENTRANTS, 0)}
    assert per_map("A", ENTRANTS, 5) == ENTRANTS


def test_who_comes_from_outside_competes_in_b_only_where_learning_is_charged():
    own = contest.Entrant("theirs/agent.py:Their", "agent", "", None, 0)
    learnt = contest.Entrant("theirs", "agent", "", None, 512, "B")
    for budget in (0, 5):
        assert per_map("B", [own, learnt], budget) == (own._replace(kind="reference"), learnt)


def test_a_submission_has_a_place_in_its_track_alone_and_not_below_its_trials():
    """What was tuned on exactly these maps took trials that a board of fewer, or one after training, did not allow."""
    tuned = contest.Entrant("tuned", "agent", "", None, 0, "A", 12)
    learnt = contest.Entrant("learnt", "agent", "", None, 512, "B", 0)
    assert per_map("A", [tuned, learnt], 5) == ()
    assert per_map("A", [tuned, learnt], 12) == (tuned,)
    assert per_map("B", [tuned, learnt], 20) == (learnt,)
    assert [(one.name, one.kind) for one in tracks.within_runs([tuned, learnt], "", ())] == [
        ("learnt", "reference")
    ]


def test_runs_that_two_rounds_share_are_played_once():
    items = load_suite("mountain-v0", "test")[:2]
    rounds = [Round("A", 5, ENTRANTS, items, 3), Round("B", 5, per_map("B", ENTRANTS, 5), items, 3)]
    assert len(jobs(rounds)) == len(ENTRANTS) * len(items) * 3
    rounds.append(Round("B", 0, per_map("B", ENTRANTS, 0), items, 3))
    assert len({job.key for job in jobs(rounds)}) == (len(ENTRANTS) + 3) * len(items) * 3


def test_seconds_that_were_lost_are_not_nought(tmp_path):
    played = Round("A", 5, ENTRANTS[1:2], load_suite("mountain-v0", "test")[:2], 2)
    keys = [job.key for job in played.jobs]
    with Ledger(tmp_path, {}, {}) as ledger:
        for key in keys:
            ledger.run(key).finish(Outcome((0.5,), (1.0,), (0.0,)))
        row = to_row(played, ENTRANTS[1], ledger, {keys[0]: {"tuner": 1.0}, keys[3]: {"tuner": 3.0}})
    assert (row.tuner_seconds, row.planner_seconds) == (2.0, None)


def test_the_virtual_best_by_eye():
    """The second candidate leads but for its last run, which alone it is not chosen for."""
    first, second = np.full((1, 3), 0.5), np.array([[0.1, 0.2, 0.9]])
    found = virtual_best([np.stack([gaps, gaps < 0.9]) for gaps in (first, second)])
    assert found == pytest.approx(((0.5 + 0.5 + 0.9) / 3, 2 / 3))


def test_the_virtual_best_is_not_the_luckiest():
    """Of a hundred equal settings the best mean is far below what any is worth; what was not looked at tells."""
    rng = np.random.default_rng(0)
    scores, luckiest = [], []
    for _ in range(200):
        gaps = rng.normal(0.5, 0.1, (100, 1, 8))
        scores.append(virtual_best(list(np.stack([gaps, np.ones_like(gaps)], axis=1)))[0])
        luckiest.append(gaps.mean(axis=(1, 2)).min())
    assert np.mean(scores) == pytest.approx(0.5, abs=0.01)
    assert np.mean(luckiest) < 0.42


@pytest.mark.parametrize("pool", [[], [np.zeros((2, 3, 1))]])
def test_without_two_runs_of_one_there_is_no_bound(pool):
    assert virtual_best(pool) is None


def test_an_agent_that_failed_recommended_nothing(tmp_path):
    """Not even the setting that stands in its outcome, which another agent recommended."""
    played = Round("A", 5, ENTRANTS[:2], load_suite("mountain-v0", "test")[:1], 1)
    sound, broken = played.jobs
    with Ledger(tmp_path, {}, {}) as ledger:
        ledger.run(sound.key).finish(Outcome((contest.DEFAULT,) * 4, (1.0, 1.0), (0.1, 0.2)))
        ledger.run(broken.key).finish(contest.failed(4, 2, "hung"))
        (found,) = candidates([played], 0, ledger)
    assert found.tolist() == [[[0.1, 0.2]], [[1.0, 1.0]]]
