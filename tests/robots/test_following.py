"""Following a path: continuous, within limits, of least motion, in time; what cannot be followed is named."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from antgym import load_suite
from antgym.errors import ParameterError, ReachError
from antgym.maps.optimum import shortest_path
from antgym.robots import DOWN, follow, lr_mate_200id, place, wei2018_palletizer
from antgym.robots.branches import LARGEST_STEP, TOLERANCE, least_motion
from antgym.robots.following import MOST_SAMPLES

FANUC, PALLETIZER = lr_mate_200id(), wei2018_palletizer()
LINE = [[0.35, -0.2, 0.3], [0.35, 0.2, 0.3]]


def mountain(index=0, ahead=0.3):
    """The exact path over a map of the suite, in front of the arm, in metres."""
    scenario = load_suite("mountain-v0", "test")[index].scenario
    aside = -scenario.world.centre(scenario.start)[1] / 1000
    return place(scenario.world.centre(shortest_path(scenario)), 0.001, (ahead, aside, 0.2))


def leaves(points, samples):
    """How far the samples are from a polyline, at most."""
    begin, along = points[:-1, None], np.diff(points, axis=0)[:, None]
    share = np.clip(((samples - begin) * along).sum(axis=2) / (along**2).sum(axis=2), 0, 1)
    return np.linalg.norm(begin + share[:, :, None] * along - samples, axis=2).min(axis=0).max()


@pytest.mark.parametrize(("arm", "index"), [(FANUC, 0), (FANUC, 2), (PALLETIZER, 0)])
def test_a_planned_mountain_path_becomes_a_continuous_trajectory_within_the_limits(arm, index):
    points = mountain(index, 0.8 if arm is PALLETIZER else 0.3)
    found = follow(arm, points)
    tool = arm.forward(found.joints)
    assert np.abs(tool[:, :3, 3] - found.points).max() < 1e-9
    assert np.abs(tool[:, :3, :3] - DOWN).max() < 1e-9
    assert ((found.joints >= arm.limits[:, 0]) & (found.joints <= arm.limits[:, 1])).all()
    assert np.abs(np.diff(found.joints, axis=0)).max() < 0.1
    assert leaves(points, found.points) < 1e-12
    assert found.length == pytest.approx(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
    assert arm.margins(found.joints).min() == found.margin >= 0.05


@pytest.mark.parametrize("shares", [(0.5,), (0.1, 0.7)])
def test_between_samples_the_tool_stays_on_the_path(shares):
    points = mountain()
    found = follow(FANUC, points)
    for share in shares:
        between = found.joints[:-1] + share * np.diff(found.joints, axis=0)
        assert leaves(points, FANUC.forward(between)[:, :3, 3]) <= found.deviation + 1e-12
    assert 0 < found.deviation < 1e-5 < TOLERANCE


@given(seed=st.integers(0, 10**6))
@settings(max_examples=10, deadline=None)
def test_no_other_choice_of_branches_moves_less(seed):
    """Against all combinations, on samples that are near each other and far enough for all branches to differ."""
    rng = np.random.default_rng(seed)
    arm = replace(PALLETIZER, limits=np.radians([(-165, 165), (-45, 135), (-150, 150), (-720, 720)]))
    q = np.array([0.1, 0.5, -0.6, 0.2]) + np.cumsum(rng.uniform(-0.01, 0.01, (4, 4)), axis=0)
    poses = arm.forward(q)
    choices = arm.solutions(poses)
    picked = least_motion(arm, poses[:, :3, 3], choices)
    best = min(np.linalg.norm(np.diff(np.array(rows), axis=0), axis=1).sum() for rows in product(*choices))
    assert np.linalg.norm(np.diff(picked, axis=0), axis=1).sum() <= best + 1e-12


def test_a_branch_that_begins_well_and_ends_at_a_limit_is_not_taken():
    """The wrist could begin at -355° or 5°, equally well; it turns by -10°, and only the latter can."""
    points = [[0.8 * np.cos(a), 0.8 * np.sin(a), 0.6] for a in np.radians(np.linspace(0, 10, 50))]
    arm = replace(PALLETIZER, limits=np.radians([(-165, 165), (-45, 135), (-150, 0), (-360, 360)]))
    yaw = Rotation.from_euler("z", 5, degrees=True).as_matrix() @ DOWN
    starts = arm.solutions(np.block([[yaw, np.array([points[0]]).T], [np.zeros(3), 1]]))[0]
    assert np.degrees(starts[:, 3]) == pytest.approx([-355, 5])
    wrist = np.degrees(follow(arm, points, tool=yaw, spacing=0.01).joints[:, 3])
    assert (wrist[0], wrist[-1]) == pytest.approx((5, -5))


def test_rest_at_both_ends_and_no_limit_broken_in_between():
    found = follow(PALLETIZER, [[0.8, 0.1, 0.4], [0.8, 0.5, 1.0], [1.2, -0.5, 0.3]], speed=3, acceleration=9)
    assert found.speeds[0] == found.speeds[-1] == found.times[0] == 0
    assert (np.diff(found.times) > 0).all()
    assert found.speeds.max() <= 3
    assert found.load.max() == pytest.approx(1, abs=0.02)  # the joints are what limits it
    rates = np.abs(np.diff(found.joints, axis=0)) / np.diff(found.times)[:, None]
    assert (rates <= PALLETIZER.speeds * (1 + 1e-9)).all()
    steps = np.linalg.norm(np.diff(found.points, axis=0), axis=1)
    assert (np.abs(np.diff(found.speeds**2)) <= 2 * 9 * steps * (1 + 1e-9)).all()


def test_a_straight_line_is_a_trapeze():
    """0.4 m at 0.2 m/s, 1 m/s² up and down: 0.02 m either way, and 0.36 m between them."""
    found = follow(FANUC, LINE, speed=0.2, acceleration=1.0)
    assert found.seconds == pytest.approx(0.2 + 0.36 / 0.2 + 0.2)
    assert found.speeds.max() == pytest.approx(0.2)


def test_a_line_too_short_to_cruise_is_a_triangle():
    found = follow(FANUC, [[0.35, 0, 0.3], [0.35, 0.001, 0.3]], speed=9)
    assert found.seconds == pytest.approx(2 * np.sqrt(0.001))


def test_at_a_corner_the_tool_slows_down():
    corner = follow(FANUC, [[0.35, -0.1, 0.3], [0.35, 0.1, 0.3], [0.45, 0.1, 0.3]])
    at = np.abs(corner.points - [0.35, 0.1, 0.3]).sum(axis=1).argmin()
    assert corner.speeds[at] == pytest.approx(
        np.sqrt(0.002 / np.sqrt(2)), rel=0.01
    )  # √(acceleration · spacing / |turn|)
    assert corner.speeds.max() == pytest.approx(0.25)


def test_the_csv_is_the_trajectory():
    found = follow(FANUC, LINE)
    header, *rows = found.csv().splitlines()
    assert header == "t,joint_1,joint_2,joint_3,joint_4,joint_5,joint_6,x,y,z"
    table = np.array([[float(cell) for cell in row.split(",")] for row in rows])
    assert (table == np.column_stack([found.times, found.joints, found.points])).all()


def test_points_out_of_reach_are_named():
    with pytest.raises(
        ReachError, match=r"way-points 1 to 2, from \(0\.7\d+, 0, 0\.3\) m on: out of reach"
    ) as error:
        follow(FANUC, [[0.3, 0, 0.3], [0.5, 0, 0.3], [0.9, 0, 0.3]])
    assert "reaches 0.667 m from axis 2" in str(error.value)


def test_a_joint_past_its_limit_is_named():
    tight = FANUC.limits.copy()
    tight[0] = np.radians([-20, 20])
    with pytest.raises(
        ReachError, match=r"way-point 0, from \(0\.35, -0\.2, 0\.3\) m on: past the limit of joint 1"
    ):
        follow(replace(FANUC, limits=tight), LINE)


def test_a_singularity_on_the_way_is_named():
    with pytest.raises(ReachError, match=r"too near the shoulder singularity for margin 0\.05"):
        follow(FANUC, [[0.03, -0.3, 0.6], [0.03, 0.3, 0.6]])


def test_a_tilted_tool_is_what_a_palletizer_cannot_hold():
    with pytest.raises(ReachError, match=r"out of reach .*its tool points straight down"):
        follow(PALLETIZER, [[0.9, 0, 0.5], [1.0, 0, 0.5]], tool=np.eye(3))


def test_where_no_branch_leads_on_the_place_is_named():
    """A base that turns by ±180° reaches all round, but not on behind its back."""
    turns = PALLETIZER.limits.copy()
    turns[0] = -np.pi, np.pi
    angles = np.radians(np.linspace(150, 210, 60))
    around = [[0.9 * np.cos(a), 0.9 * np.sin(a), 0.6] for a in angles]
    with pytest.raises(
        ReachError, match=r"no continuous motion to \(-0\.9, -0\.00\d*, 0\.6\) m: some joint would turn 360°"
    ):
        follow(replace(PALLETIZER, limits=turns), around)


def test_samples_too_far_apart_are_not_joined():
    with pytest.raises(ReachError, match="sample more densely"):
        follow(FANUC, LINE, spacing=0.2)


def test_many_stretches_are_counted_not_listed():
    zigzag = [[0.5 + 0.4 * (i % 2), 0.01 * i, 0.3] for i in range(12)]
    with pytest.raises(ReachError, match=r"; and \d more stretches"):
        follow(FANUC, zigzag, margin=0)


@pytest.mark.parametrize(
    ("points", "options"),
    [
        ([[0.3, 0, 0.3]], {}),
        ([[0.3, 0, 0.3], [0.3, 0, 0.3]], {}),
        ([[0.3, 0], [0.4, 0]], {}),
        ([[0.3, 0, np.nan], [0.4, 0, 0]], {}),
        (LINE, {"spacing": 0}),
        (LINE, {"speed": -1}),
        (LINE, {"acceleration": np.inf}),
        (LINE, {"margin": 1.0}),
        (LINE, {"tool": [1, 2, 3]}),
        (LINE, {"tool": np.ones((3, 3))}),
        (LINE, {"spacing": 0.1 / MOST_SAMPLES}),
    ],
)
def test_what_cannot_be_used_is_said(points, options):
    with pytest.raises(ParameterError):
        follow(FANUC, points, **options)


def test_a_map_is_placed_by_unit_turn_and_origin():
    with pytest.raises(ParameterError, match="a scale above 0"):
        place([[1, 2, 3]], 0.0)
    assert place([[1000, 0, 500]], 0.001, (1, 2, 3), np.pi / 2) == pytest.approx(np.array([[1, 3, 3.5]]))


def test_of_branches_that_move_alike_the_one_that_begins_nearest_to_zero_is_taken():
    """The wrist turned over, 180° in joints 4 and 6, moves as much as the wrist as it is."""
    assert np.abs(follow(FANUC, LINE).joints[0, [3, 5]]).max() < np.pi / 2


def test_samples_keep_every_way_point():
    points = mountain()
    found = follow(FANUC, points, spacing=0.004)
    assert {tuple(p) for p in points} <= {tuple(p) for p in found.points}
    assert np.linalg.norm(np.diff(found.points, axis=0), axis=1).max() <= 0.004 + 1e-12
    assert np.abs(np.diff(found.joints, axis=0)).max() < LARGEST_STEP
