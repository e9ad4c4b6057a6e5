"""A fleet on a page: the paths of its robots are lines apart from each other, with the ends of each."""

import json
from collections import Counter

import numpy as np
from boards import board, row

from antgym import load_suite
from antgym.maps.optimum import shortest_path
from experiments.board import EXACT, Picture
from experiments.report.picture import figure


def test_robots_paths_do_not_run_into_each_other():
    fleet = load_suite("fleet-v0", "test")[2].scenario
    best = {EXACT: shortest_path(fleet)}
    lengths = {EXACT: fleet.optimum}
    picture = Picture("f", None, fleet.world.free, fleet.world.cell, best, lengths, 1.0)
    drawn = json.loads(json.dumps(figure(board(row()), picture), allow_nan=False))
    assert drawn["lines"][0]["x"].count(None) == 2
    labels = drawn["layout"]["scene"]["annotations"]
    assert Counter(label["text"] for label in labels) == {"start": 3, "goal": 3}
    starts = [(label["x"], label["y"]) for label in labels if label["text"] == "start"]
    assert np.allclose(starts, [fleet.world.centre(robot.start)[:2] for robot in fleet.robots])
