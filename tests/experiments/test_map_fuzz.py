"""Damaged map files of every kind: read or refused, never more than that; the whole command, and Hypothesis."""

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

pytest.importorskip("yaml")
pytest.importorskip("PIL")

from experiments import map_fuzz
from experiments.map_fuzz import WORDS, Arguments, check, samples

EDITS = st.lists(
    st.tuples(
        st.integers(0, 400),
        st.integers(0, 12),
        st.sampled_from(WORDS)
        | st.binary(max_size=6)
        | st.integers(0, 10**20).map(lambda n: str(n).encode()),
        st.integers(1, 40),
    ),
    max_size=6,
)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A folder with a whole file of every kind, and their bytes."""
    folder = tmp_path_factory.mktemp("fuzz")
    found = samples(folder)
    for suffix, data in found.items():
        (folder / f"sample{suffix}").write_bytes(data)
    return folder, found


def read_damaged(whole, suffix, edits):
    folder, found = whole
    content = bytearray(found[suffix])
    for at, length, put, times in edits:
        place = at % (len(content) + 1)
        content[place : place + length] = put * times
    try:
        check(suffix, bytes(content), folder)
    finally:
        (folder / f"sample{suffix}").write_bytes(found[suffix])


SUFFIXES = st.sampled_from(
    [
        ".map",
        ".scen",
        ".3dmap",
        ".3dscen",
        ".yaml",
        ".bt",
        ".json",
        ".asc",
        ".npy",
        ".npz",
        ".toml",
        *map_fuzz.PICTURES,
    ]
)
HEALTH = {"deadline": None, "suppress_health_check": list(HealthCheck)}


def test_whole_files_are_read(whole):
    folder, found = whole
    assert [suffix for suffix, data in found.items() if not check(suffix, data, folder)] == []


@settings(max_examples=120, **HEALTH)
@given(suffix=SUFFIXES, edits=EDITS)
def test_damaged_files_are_read_or_refused_and_nothing_else(whole, suffix, edits):
    read_damaged(whole, suffix, edits)


@pytest.mark.slow
@settings(max_examples=1500, **HEALTH)
@given(suffix=SUFFIXES, edits=EDITS)
def test_many_damaged_files_are_read_or_refused_and_nothing_else(whole, suffix, edits):
    read_damaged(whole, suffix, edits)


def test_the_command_says_how_many_were_readable(capsys):
    map_fuzz.run(Arguments(cases=60))
    assert "60 damaged files: " in capsys.readouterr().out


def test_a_reader_that_breaks_is_noticed(whole, monkeypatch):
    folder, found = whole
    monkeypatch.setattr("antgym.maps.readers.read_map", lambda path: {}["a"])
    with pytest.raises(KeyError):
        check(".map", found[".map"], folder)
