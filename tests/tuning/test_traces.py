"""Traces: there as a whole or not at all, and one that is damaged is named."""

import numpy as np
import pytest
from full_disk import most_bytes

from antgym.errors import LedgerError
from antgym.tuning.traces import TRACES, copy_traces, read_trace, trace_path, write_trace

KEY = "ga/5/valley/0"
BEST = np.array([[np.inf, 12.5, 12.25], [14.0, 14.0, 11.0]])


@pytest.fixture
def part(tmp_path):
    """The folder of a ledger with one trace."""
    (tmp_path / "part").mkdir()
    write_trace(tmp_path / "part", KEY, BEST)
    return tmp_path / "part"


def test_a_trace_is_read_as_it_was_written_here_and_where_its_part_is_taken_in(part, tmp_path):
    (tmp_path / "whole").mkdir()
    copy_traces(part, tmp_path / "whole")
    for folder in (part, tmp_path / "whole"):
        assert read_trace(folder, KEY).tolist() == BEST.tolist()
    with pytest.raises(LedgerError, match="no trace of 'another'"):
        read_trace(part, "another")


def test_a_torn_or_changed_trace_is_named(part):
    path = trace_path(part, KEY)
    data = path.read_bytes()
    end = data.index(b"PK\x01\x02")  # of what is packed
    flipped = [bytearray(data) for _ in range(12)]
    for i, one in enumerate(flipped, start=2):  # the last byte is filled up
        one[end - i] ^= 0xFF
    for damaged in (b"", *(data[: len(data) * part // 8] for part in range(1, 8)), *flipped):
        path.write_bytes(damaged)
        with pytest.raises(LedgerError, match="is damaged"):
            read_trace(part, KEY)


def test_a_full_disk_leaves_no_part_of_a_trace(part, tmp_path):
    (tmp_path / "whole").mkdir()
    with most_bytes(64), pytest.raises(LedgerError, match=r"cannot be written: .*; make room"):
        write_trace(tmp_path / "whole", KEY, BEST)
    with most_bytes(64), pytest.raises(LedgerError, match=r"cannot be written: .*; make room"):
        copy_traces(part, tmp_path / "whole")
    assert list((tmp_path / "whole" / TRACES).iterdir()) == []
