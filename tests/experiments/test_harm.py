"""A board that is killed, whose disk is full, that two processes want: no trial lost, none twice, each damage said."""

import json
import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("pymoo")  # an agent
pytest.importorskip("matplotlib")  # the real terrain
if not hasattr(signal, "sigtimedwait"):
    pytest.skip("macOS cannot wait for a signal or a time", allow_module_level=True)

TESTS = Path(__file__).parents[1]
pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def harm(tmp_path_factory):
    """What tests/harm.py saw."""
    env = {**os.environ, "PYTHONPATH": str(TESTS.parent), "ANTGYM_THREADS": "1"}
    done = subprocess.run(
        [sys.executable, TESTS / "harm.py", tmp_path_factory.mktemp("harm")],
        env=env,
        cwd=TESTS.parent,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_killed_at_twenty_moments_a_board_loses_no_line_and_repeats_none(harm):
    kills = harm["kills"]
    assert (kills["killed"], kills["lost"], kills["repeated"]) == (20, 0, 0)
    assert any(0 < kept < len(harm["whole"]) for kept in kills["kept"]), "none was killed half way"
    assert all(board == harm["whole"] for board in kills["boards"])


def test_a_torn_line_is_dropped_and_said(harm):
    said = harm["kills"]["said"]
    assert said
    dropped = r"trials\.jsonl: a last line of \d+ bytes was cut short by a crash; it is dropped"
    assert all(re.search(dropped, text) for text in said)


def test_a_full_disk_is_one_line_and_takes_back_what_does_not_fit(harm):
    for seen in harm["full"]:
        assert seen["code"] == 2
        assert "cannot be written: File too large; nothing of this batch is kept; make room" in seen["said"]
        assert not seen["torn"]
        assert seen["board"] == harm["whole"]


def test_of_two_processes_on_one_folder_one_is_told_that_it_is_in_use(harm):
    refused = 0
    for pair in harm["pairs"]:
        codes = sorted(code for code, _ in pair["ends"])
        assert codes in ([0, 0], [0, 2])
        told = [said for code, said in pair["ends"] if code == 2]
        assert all("in use by another process; wait for it or use another folder" in said for said in told)
        refused += len(told)
        assert pair["board"] == harm["whole"]
    assert refused, "the two never met"
