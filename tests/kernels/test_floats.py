"""The kernels' own logarithm and power: accurate over their whole range, and the same bits interpreted."""

import numpy as np
import pytest

from antgym.kernels import floats

F = np.float32
RNG_SEED, COUNT = 0, 20_000
SMALLEST, LARGEST = 0x00800000, 0x7F7FFFFF  # bits of the normal float32 numbers, the first and the last


def normal_numbers(count=COUNT):
    """Positive normal float32, all exponents alike, the neighbours of 1 among them."""
    bits = np.random.default_rng(RNG_SEED).integers(SMALLEST, LARGEST, count, endpoint=True, dtype=np.int32)
    near_one = np.arange(0x3F800000 - 200, 0x3F800000 + 200, dtype=np.int32)
    return np.concatenate([bits, near_one, np.array([SMALLEST, LARGEST], np.int32)]).view(F)


def wide_numbers(count=COUNT):
    """Positive normal float64, all exponents alike."""
    bits = np.random.default_rng(RNG_SEED).integers(
        0x0010000000000000, 0x7FEFFFFFFFFFFFFF, count, dtype=np.int64
    )
    edges = np.array(
        [np.finfo(float).tiny, np.nextafter(1.0, 0), 1.0, np.nextafter(1.0, 2), np.finfo(float).max]
    )
    return np.concatenate([bits.view(np.float64), edges])


def exponents(count=COUNT):
    """Float32 between -126 and 126, many of them near whole and half numbers."""
    rng = np.random.default_rng(RNG_SEED)
    near = rng.integers(-252, 253, count) / 2 + rng.normal(0, 1e-6, count)
    return np.clip(np.concatenate([rng.uniform(-126, 126, count), near]), -126, 126).astype(F)


def each(function, numbers):
    return np.array([function(number) for number in numbers], F)


def interpreted(function):
    return getattr(function, "py_func", function)  # under NUMBA_DISABLE_JIT it is one already


def beyond_rounding(found, exact):
    """How far results lie from exact, less the half unit in the last place that any float32 is allowed."""
    return np.abs(found.astype(float) - exact) - np.spacing(np.abs(found)) / 2


@pytest.mark.parametrize(
    ("logarithm", "numbers"),
    [(floats.log2, normal_numbers()), (floats.log2_wide, wide_numbers())],
    ids=["log2", "wide"],
)
def test_logarithms_err_by_less_than_2e7_beyond_rounding(logarithm, numbers):
    assert beyond_rounding(each(logarithm, numbers), np.log2(numbers.astype(float))).max() < 2e-7


def test_powers_err_by_less_than_2e7_of_the_result():
    exact = np.exp2(exponents().astype(float))
    assert (np.abs(each(floats.exp2, exponents()) - exact) / exact).max() < 2e-7


def test_powers_of_two_are_exact_both_ways():
    whole = np.arange(-126, 127)
    powers = [2.0**n for n in whole.tolist()]
    assert each(floats.exp2, whole.astype(F)).tolist() == powers
    assert each(floats.log2, np.array(powers, F)).tolist() == whole.tolist()


def test_wide_logarithms_of_powers_of_two_are_exact():
    whole = range(-1022, 1024)
    assert [floats.log2_wide(2.0**n) for n in whole] == list(whole)


def test_logarithms_never_fall_between_neighbours():
    numbers = normal_numbers()[:-1]
    above = np.nextafter(numbers, F(np.inf))
    assert (each(floats.log2, numbers) <= each(floats.log2, above)).all()


def test_powers_fall_by_at_most_one_unit_between_neighbours():
    below, above = exponents(), np.nextafter(exponents(), F(np.inf))
    fall = each(floats.exp2, below) - each(floats.exp2, above)
    assert (fall <= np.spacing(each(floats.exp2, above))).all()


def test_powers_end_at_nothing_and_at_2_to_the_126():
    beyond = np.array([-np.inf, -1e30, np.nextafter(F(-126), F(-127)), -126, 126, 126.5, 1e30, np.inf], F)
    low, high = 2.0**-126, 2.0**126
    assert each(floats.exp2, beyond).tolist() == [0, 0, 0, low, high, high, high, high]


@pytest.mark.parametrize(
    ("function", "numbers"),
    [
        (floats.log2, normal_numbers(2000)),
        (floats.log2_wide, wide_numbers(2000)),
        (floats.exp2, exponents(1000)),
    ],
    ids=["log2", "log2_wide", "exp2"],
)
def test_interpreted_functions_give_the_same_bits(function, numbers):
    assert each(interpreted(function), numbers).tobytes() == each(function, numbers).tobytes()
