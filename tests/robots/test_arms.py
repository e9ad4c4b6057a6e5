"""Arms: forward and inverse kinematics against the published description, an independent library, and each other."""

from dataclasses import replace

import arm_data
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import linprog
from scipy.spatial.transform import RigidTransform, Rotation

from antgym.errors import ParameterError
from antgym.robots import ARMS, Chain, find_arm, lr_mate_200id, wei2018_palletizer

FANUC, PALLETIZER = lr_mate_200id(), wei2018_palletizer()
BOTH = pytest.mark.parametrize("arm", [FANUC, PALLETIZER], ids=lambda arm: arm.name)
DIGIT = 1e-9  # the last one that the files of poses give


def drawn(arm, count, seed=0):
    """Joint vectors within the limits; of the palletizer only those that do not reach over their own back."""
    q = np.random.default_rng(seed).uniform(*arm.limits.T, (count, arm.joints))
    if arm.joints == 4:
        q = q[np.cos(q[:, 1]) + np.cos(q[:, 1] + q[:, 2]) > 0]
    return q


def there(branches):
    """The branches of one pose that exist."""
    return branches[np.isfinite(branches).all(axis=1)]


def apart(one, other):
    """(a, b) the largest angle between any of one and any of the other."""
    return np.abs(arm_data.wrapped(one[:, None] - other[None])).max(axis=2)


@BOTH
def test_a_thousand_poses_are_solved_and_the_true_branch_is_among_the_solutions(arm):
    q = drawn(arm, 1000)
    poses = arm.forward(q)
    solutions = arm.solutions(poses)
    for true, pose, found in zip(q, poses, solutions, strict=True):
        reached = arm.forward(found)
        assert np.linalg.norm(reached[:, :3, 3] - pose[:3, 3], axis=1).max() <= 1e-9
        assert np.abs(reached - pose).max() <= 1e-9
        assert np.abs(found - true).max(axis=1).min() <= 1e-9
        assert ((found >= arm.limits[:, 0]) & (found <= arm.limits[:, 1])).all()
    assert len(q) > 500


def test_the_fanuc_stands_where_its_urdf_says(shared_data):
    joints, limits = arm_data.urdf_joints(shared_data)
    assert FANUC.limits == pytest.approx(limits[:, :2])
    assert FANUC.speeds == pytest.approx(limits[:, 2])
    q = drawn(FANUC, 100)
    expected = [arm_data.urdf_forward(joints, row) for row in q]
    assert np.abs(FANUC.forward(q) - expected).max() < 1e-14


def test_an_independent_library_finds_the_same_branches(shared_data):
    peer, q = arm_data.peer(shared_data), drawn(FANUC, 200)
    poses = FANUC.forward(q)
    assert np.abs(peer.batch_forward(q).as_matrix() - poses).max() < 1e-14
    for pose, branches in zip(poses, FANUC.branches(poses), strict=True):
        theirs, ours = np.array(peer.inverse(RigidTransform.from_matrix(pose))), there(branches)
        assert len(theirs) == len(ours)
        differences = apart(theirs, ours)
        assert max(differences.min(axis=0).max(), differences.min(axis=1).max()) <= 1e-9


def test_published_poses_have_the_published_solutions_to_the_last_digit(shared_data):
    """Poses and solutions have nine digits: some angles that round to those of the pose must lead to all solutions.

    What half a digit of the joints moves each solution by is its derivative; a linear programme picks the halves.
    """
    for told in arm_data.poses(shared_data):
        q, solutions = np.array(told["q_rad"]), np.array(told["closed_form_solutions"])
        pose = FANUC.forward(q)
        assert np.abs(pose - told["tool0_in_base_link"]).max() < 4 * DIGIT
        branches = FANUC.branches(pose)[0]
        picked = np.nanargmin(apart(solutions, branches), axis=1)
        assert len(set(picked)) == len(solutions)
        off = arm_data.wrapped(solutions - branches[picked]).ravel() / DIGIT
        slope = _slope(q, picked)
        sides = np.block([[slope, -np.ones((len(off), 1))], [-slope, -np.ones((len(off), 1))]])
        least = linprog(
            [0] * 6 + [1], sides, np.concatenate([off, -off]), bounds=[(-0.5, 0.5)] * 6 + [(0, None)]
        )
        assert least.fun <= 0.51
        within = np.abs(FANUC.excess(pose)[0][picked]).max(axis=1) == 0
        assert within.tolist() == told["within_limits"]
        others = np.delete(branches, picked, axis=0)  # the files leave out where axes 4 and 6 are one
        assert (FANUC.margins(there(others))[:, 2] < 1e-6).all()


def _slope(q, picked, step=1e-6):
    """(6 s, 6) what every angle of s solutions changes per radian of every joint."""
    columns = []
    for along in np.eye(6) * step:
        ahead, behind = (FANUC.branches(FANUC.forward(q + d))[0][picked] for d in (along, -along))
        columns.append(arm_data.wrapped(ahead - behind).ravel() / (2 * step))
    return np.stack(columns, axis=1)


def test_the_palletizer_stands_where_the_paper_says():
    """wei2018, (6), with its slips mended."""
    l1, l2, l3 = 0.5, 0.7, 0.9
    arm, q = wei2018_palletizer(l1, l2, l3), drawn(PALLETIZER, 50)
    (t1, t2, t3, t4), poses = q.T, arm.forward(q)
    out = l2 * np.cos(t2) + l3 * np.cos(t2 + t3)
    expected = [np.cos(t1) * out, np.sin(t1) * out, l1 + l2 * np.sin(t2) + l3 * np.sin(t2 + t3)]
    assert np.abs(poses[:, :3, 3] - np.stack(expected, axis=1)).max() < 1e-14
    down = Rotation.from_euler("xz", np.stack([np.full(len(q), np.pi), t1 + t4], axis=1))
    assert np.abs(poses[:, :3, :3] - down.as_matrix()).max() < 1e-14


def test_the_palletizer_s_wrist_makes_up_for_its_base():
    for angle in (-1.0, 0.3, 2.0):
        pose = PALLETIZER.forward([0.0, 0.6, -0.9, 0.0])
        turned = np.eye(4)
        turned[:3, :3] = Rotation.from_euler("z", angle).as_matrix()
        pose[:3, 3] = turned[:3, :3] @ pose[:3, 3]  # elsewhere, with the same yaw
        branches = there(PALLETIZER.branches(pose)[0])
        assert branches[:, 3] == pytest.approx([-angle, -angle])
        assert sorted(branches[:, 2]) == pytest.approx([-0.9, 0.9])


@BOTH
@given(seed=st.integers(0, 10**6))
def test_margins_are_what_the_jacobian_s_determinant_is_made_of(arm, seed):
    q, h = np.random.default_rng(seed).uniform(*arm.limits.T, arm.joints), 1e-6
    here = arm.forward(q)
    columns = []
    for along in np.eye(arm.joints) * h:
        moved = (arm.forward(q + along) - arm.forward(q - along)) / (2 * h)
        spin = moved[:3, :3] @ here[:3, :3].T
        columns.append([*moved[:3, 3], spin[2, 1], spin[0, 2], spin[1, 0]])
    jacobian = np.array(columns).T[[0, 1, 2, 3, 4, 5] if arm.joints == 6 else [0, 1, 2, 5]]
    a, forearm = arm.chain.a, np.hypot(0.035, 0.335) if arm.joints == 6 else 1.0
    scale = a[1] * forearm * (a[0] + a[1] + forearm)
    assert abs(np.linalg.det(jacobian)) == pytest.approx(scale * arm.margins(q).prod(), abs=1e-8)


def test_whole_turns_are_solutions_of_their_own():
    q = np.array([0.2, 0.3, 0.4, np.radians(185), 0.5, 1.0])
    (found,) = FANUC.solutions(FANUC.forward(q))
    same = found[np.abs(arm_data.wrapped(found - q)).max(axis=1) < 1e-9]
    assert {tuple(np.round(np.degrees(row[[3, 5]] - q[[3, 5]]))) for row in same} == {
        (a, b) for a in (0, -360) for b in (0, -360)
    }


def test_a_joint_at_its_limit_is_within_it():
    for corner in FANUC.limits.T:
        (found,) = FANUC.solutions(FANUC.forward(corner))
        assert np.abs(found - corner).max(axis=1).min() < 1e-9


def test_a_wrist_whose_axes_coincide_gives_all_to_the_last_joint():
    pose = FANUC.forward([0.1, 0.5, 0.2, 0.4, 0.0, 0.3])
    branches = FANUC.branches(pose)[0]
    straight = branches[np.abs(branches[:, 4]) < 1e-6]
    assert straight[:, 3] == pytest.approx([0.0, np.pi])
    assert np.abs(FANUC.forward(straight) - pose).max() < 1e-9


def test_out_of_reach_no_branch_exists():
    pose = FANUC.forward(np.zeros(6))
    pose[0, 3] += 1.0
    assert np.isnan(FANUC.branches(pose)).all()
    assert FANUC.solutions(pose)[0].shape == (0, 6)
    tilted = PALLETIZER.forward([0, 0.5, -1, 0]) @ np.diag([1.0, -1, -1, 1])
    assert np.isnan(PALLETIZER.branches(tilted)).all()


def test_past_a_limit_the_excess_says_by_how_much():
    q = np.array([0.2, 0.3, 0.4, 0.5, 0.6, 0.7])
    tight = replace(FANUC, limits=np.stack([q - 1e-3, q + 1e-3], axis=1))
    tight.limits[4] += 0.1
    excess = tight.excess(FANUC.forward(q))[0]
    assert excess[np.abs(excess).max(axis=1).argmin()] == pytest.approx([0, 0, 0, 0, -0.099, 0])


def test_a_fully_stretched_arm_is_reached():
    pose = PALLETIZER.forward([0.3, 0.4, 0.0, 0.1])
    assert np.abs(PALLETIZER.forward(there(PALLETIZER.branches(pose)[0])) - pose).max() < 1e-7


def test_arms_are_found_by_name():
    assert [find_arm(name).name for name in ARMS] == list(ARMS)
    with pytest.raises(ParameterError, match="unknown arm 'lr_mate'; did you mean 'lr_mate_200id'"):
        find_arm("lr_mate")


@pytest.mark.parametrize(
    "call",
    [
        lambda: FANUC.forward([1.0, 2.0]),
        lambda: FANUC.branches(np.eye(3)),
        lambda: FANUC.branches(np.full((4, 4), np.nan)),
        lambda: FANUC.branches(np.diag([1.0, 1.0, -1.0, 1.0])),
        lambda: FANUC.branches(np.diag([2.0, 1.0, 1.0, 1.0])),
        lambda: wei2018_palletizer(1.0, 0.0, 1.0),
        lambda: wei2018_palletizer(np.nan),
    ],
)
def test_what_cannot_be_used_is_said(call):
    with pytest.raises(ParameterError):
        call()


def test_a_chain_s_frames_are_read_along_it():
    planar = Chain([1.0, 2.0], [0, 0], [0, 0], [1, 1], [0, 0])
    frames = planar.frames([[np.pi / 2, -np.pi / 2], [0.0, 0.0]])
    assert frames[:, :, :2, 3] == pytest.approx(
        np.array([[(0, 0), (0, 1), (2, 1)], [(0, 0), (1, 0), (3, 0)]])
    )
