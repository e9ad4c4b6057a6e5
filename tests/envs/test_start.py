"""How long a user waits for the first observation."""

import subprocess
import sys

import pytest

SCRIPT = """
import time
begun = time.perf_counter()
import gymnasium as gym, antgym
env = gym.make("antgym/MountainOneShot-v0")
env.reset(seed=0)
print(time.perf_counter() - begun)
"""


@pytest.mark.slow
def test_make_and_reset_take_three_seconds_at_most_once_kernels_are_compiled():
    runs = [
        subprocess.run([sys.executable, "-c", SCRIPT], capture_output=True, text=True, check=True)
        for _ in "123"
    ]
    assert min(float(run.stdout) for run in runs[1:]) < 3.0
