"""Robots: arms that follow a planned path; forward and inverse kinematics, and joint angles over time."""

from antgym.robots.arms import ARMS, Arm, find_arm, lr_mate_200id, wei2018_palletizer
from antgym.robots.chain import Chain
from antgym.robots.following import DOWN, follow, place
from antgym.robots.trajectory import Trajectory

__all__ = [
    "ARMS",
    "DOWN",
    "Arm",
    "Chain",
    "Trajectory",
    "find_arm",
    "follow",
    "lr_mate_200id",
    "place",
    "wei2018_palletizer",
]
