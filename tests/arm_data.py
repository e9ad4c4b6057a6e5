"""The FANUC LR Mate as others describe it: the files beside a developer's checkout, and py-opw-kinematics."""

import json
from xml.etree import ElementTree

import numpy as np
import pytest
from scipy.spatial.transform import Rotation


def folder_of(data):
    """The folder of the robot's files; skips where it is absent."""
    folder = data / "robot"
    if not folder.is_dir():
        pytest.skip(f"{folder} is absent")
    return folder


def record(data):
    """Limits and OPW parameters."""
    return json.loads((folder_of(data) / "lrmate200id.json").read_text())


def poses(data):
    """21 joint vectors with their pose and every solution of the inverse, all of nine digits."""
    return json.loads((folder_of(data) / "lrmate200id_poses.json").read_text())


def urdf_joints(data):
    """(origin, axis) of every joint from base_link to tool0, and (lower, upper, speed) of those that turn."""
    root = ElementTree.parse(folder_of(data) / "lrmate200id.urdf").getroot()
    joints, limits = [], []
    for joint in root.findall("joint"):
        if joint.get("name") == "base_link-base":
            continue
        origin, axis, limit = joint.find("origin"), joint.find("axis"), joint.find("limit")
        pose = np.eye(4)
        pose[:3, 3] = [float(c) for c in origin.get("xyz").split()]
        pose[:3, :3] = Rotation.from_euler("xyz", [float(c) for c in origin.get("rpy").split()]).as_matrix()
        joints.append((pose, None if axis is None else np.array([float(c) for c in axis.get("xyz").split()])))
        if limit is not None:
            limits.append([float(limit.get(name)) for name in ("lower", "upper", "velocity")])
    return joints, np.array(limits)


def urdf_forward(joints, q):
    """Where the URDF puts tool0, joint by joint."""
    pose, angles = np.eye(4), iter(q)
    for origin, axis in joints:
        pose = pose @ origin
        if axis is not None:
            turn = np.eye(4)
            turn[:3, :3] = Rotation.from_rotvec(axis * next(angles)).as_matrix()
            pose = pose @ turn
    return pose


def peer(data):
    """The arm as py-opw-kinematics knows it, by the parameters of the record."""
    opw = pytest.importorskip("py_opw_kinematics", reason="py-opw-kinematics is in the extra dev")
    told = record(data)
    model = opw.KinematicModel(
        **told["opw_geometric_parameters"],
        offsets=tuple(told["opw_joint_offsets_rad"]),
        flip_axes=tuple(sign < 0 for sign in told["opw_sign_corrections"]),
    )
    return opw.Robot(model, degrees=False)


def wrapped(angles):
    """Angles in (-π, π]."""
    return np.pi - np.remainder(np.pi - np.asarray(angles), 2 * np.pi)
