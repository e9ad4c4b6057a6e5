"""Parameter spaces: the unit cube and back, exact at the knots, and errors that name the parameter."""

import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from antgym.errors import ParameterError
from antgym.planners.rules import PAPERS
from antgym.planners.space import Parameter, ParameterSpace, check_together, decode_together, named_values

SPACES = [
    *(
        rules.ranges.space(straight, tau)
        for rules in PAPERS.values()
        for straight, tau in ((1.0, 1.0), (437.3, 0.01))
    ),
    ParameterSpace((Parameter("share", -2.0, 0.1, 7.0, "linear", "of something"),)),
]
spaces = st.sampled_from(SPACES)
units = st.floats(0, 1)


@settings(deadline=None)
@given(space=spaces, unit=units)
def test_decoding_and_encoding_again_gives_the_setting(space, unit):
    setting = np.full((1, len(space)), unit)
    assert space.encode(space.decode(setting)) == pytest.approx(setting, abs=1e-9)


@settings(deadline=None)
@given(space=spaces, shares=st.lists(units, min_size=2, max_size=2))
def test_encoding_and_decoding_again_gives_the_natural_values(space, shares):
    low, high = (np.array([getattr(p, end) for p in space.parameters]) for end in ("low", "high"))
    naturals = low + np.array(shares)[:, None] * (high - low)
    assert space.decode(space.encode(np.clip(naturals, low, high))) == pytest.approx(naturals, rel=1e-9)


@pytest.mark.parametrize("space", SPACES)
@pytest.mark.parametrize(("unit", "name"), [(0.0, "low"), (0.5, "default"), (1.0, "high")])
def test_ends_and_middle_are_exact_both_ways(space, unit, name):
    naturals = [getattr(p, name) for p in space.parameters]
    assert space.decode([unit] * len(space))[0].tolist() == naturals
    assert space.encode(naturals)[0].tolist() == [unit] * len(space)


@settings(deadline=None)
@given(space=spaces, pair=st.tuples(units, units).map(sorted))
def test_decoding_never_falls(space, pair):
    one, other = space.decode([[unit] * len(space) for unit in pair])
    assert (one <= other).all()


@pytest.mark.parametrize("knot", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("space", SPACES)
def test_decoding_never_falls_beside_a_knot(space, knot):
    """exp(log(x)) may round to the wrong side of x."""
    near = [np.nextafter(knot, -1), knot, np.nextafter(knot, 2)]
    values = space.decode([[min(max(unit, 0.0), 1.0)] * len(space) for unit in near])
    assert (np.diff(values, axis=0) >= 0).all()


@settings(deadline=None)
@given(space=spaces, unit=units)
def test_decoded_values_stay_in_their_ranges(space, unit):
    for p, value in zip(space.parameters, space.decode([unit] * len(space))[0], strict=True):
        assert p.low <= value <= p.high


@settings(deadline=None)
@given(chosen=st.lists(st.sampled_from(SPACES[:-1]), min_size=1, max_size=6), data=st.data())
def test_settings_decoded_together_are_what_each_space_makes_of_its_own(chosen, data):
    knots = units | st.sampled_from([0.0, 0.5, 1.0])
    rows = np.array([[data.draw(knots) for _ in range(4)] for _ in chosen])
    alone = [space.decode(row)[0].tolist() for space, row in zip(chosen, rows, strict=True)]
    assert decode_together(chosen, rows).tolist() == alone


def test_spaces_of_different_scales_decode_together_too():
    linear = ParameterSpace(tuple(Parameter(name, -1.0, 0.0, 3.0) for name in "abcd"))
    rows = np.full((2, 4), 0.75)
    together = decode_together([linear, SPACES[0]], rows)
    assert together.tolist() == [linear.decode(rows[0])[0].tolist(), SPACES[0].decode(rows[1])[0].tolist()]


@pytest.mark.parametrize("value", [-1e-9, 1.5, float("nan"), float("inf")])
def test_a_setting_outside_the_unit_cube_is_named(value):
    settings = [[0.5] * 4, [0.5, 0.5, value, 0.5]]
    with pytest.raises(ParameterError, match=rf"setting 1: rho = {value}"):
        SPACES[0].decode(settings)


@pytest.mark.parametrize("value", [0.0, 1e9, float("nan")])
def test_a_natural_value_outside_its_range_is_named(value):
    with pytest.raises(
        ParameterError, match=re.escape(f"beta = {value:g} lies outside its range [0.02, 10]")
    ):
        SPACES[0].encode([1.0, value, 0.5, 1.0])


@pytest.mark.parametrize("method", ["decode", "encode"])
@pytest.mark.parametrize("values", [[0.5] * 3, [[0.5] * 5], np.full((1, 4, 4), 0.5), []])
def test_a_wrong_shape_is_refused(method, values):
    with pytest.raises(ParameterError, match="alpha"):
        getattr(SPACES[0], method)(values)


@pytest.mark.parametrize(
    ("parameter", "message"),
    [
        (Parameter("a", 1, 1, 2), "a: needs finite low < default < high, got 1, 1, 2"),
        (Parameter("a", float("nan"), 1, 2), "a: needs finite low"),
        (Parameter("a", 0, 1, 2, "log"), "a: bounds 0, 2 do not fit the log scale"),
        (Parameter("a", 0.1, 0.5, 1, "logit"), "a: bounds 0.1, 1 do not fit the logit scale"),
        (Parameter("a", 1, 2, float("inf")), "a: needs finite low"),
        (Parameter("a", 1, 2, 3, "logg"), "unknown scale 'logg'; did you mean 'log'"),
    ],
)
def test_a_parameter_without_room_or_scale_is_named(parameter, message):
    with pytest.raises(ParameterError, match=message):
        ParameterSpace((parameter,))


def test_samples_fill_the_unit_cube_and_follow_the_generator():
    one, other = (SPACES[0].sample(np.random.default_rng(7), 500) for _ in range(2))
    assert one.tolist() == other.tolist()
    assert one.shape == (500, 4)
    assert (one.min(axis=0) < 0.02).all()
    assert (one.max(axis=0) > 0.98).all()


def test_the_table_has_one_row_per_parameter():
    rows = SPACES[-1].to_markdown().splitlines()
    assert rows[0] == "| num | parameter | low | default | high | scale | meaning |"
    assert rows[2:] == ["| 0 | share | -2 | 0.1 | 7 | linear | of something |"]


def test_names_and_defaults_come_in_order():
    space = SPACES[0]
    assert space.names == ("alpha", "beta", "rho", "Q")
    assert space.default.tolist() == [p.default for p in space.parameters]
    assert named_values(space, space.default)["Q"] == space.parameters[3].default


def test_a_mean_is_taken_on_each_scale():
    space = SPACES[0]
    pair = space.encode([[0.1, 1.0, 0.2, space.default[3]], [0.4, 9.0, 0.8, space.default[3]]])
    mean = space.decode(space.mean(pair, [0.5, 0.5]))[0]
    assert mean == pytest.approx([0.2, 3.0, 0.5, space.default[3]])
    assert space.mean(pair, [1.0, 0.0]) == pytest.approx(pair[0])


def test_settings_of_several_spaces_are_checked_as_each_alone_does():
    four, one = SPACES[0], SPACES[-1]
    good = [np.zeros((2, 4)), [[0.25]]]
    assert [each.tolist() for each in check_together([four, one], good)] == [[[0.0] * 4] * 2, [[0.25]]]
    assert check_together([four], [[0.5] * 4])[0].tolist() == [[0.5] * 4]  # one row, as check() takes it
    assert check_together([], []) == []
    with pytest.raises(ParameterError, match=r"setting 0: share = 1.5 lies outside the unit interval"):
        check_together([four, one], [good[0], [[1.5]]])
    with pytest.raises(ParameterError, match="must have shape"):
        check_together([one, four], good)
