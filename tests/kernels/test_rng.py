"""Random numbers: SplitMix64 as published, uniform, and the same bits interpreted."""

import numpy as np
import pytest

from antgym.kernels import rng

KEYS = [0, 1, 2**63, 2**64 - 1]
BINS = 64


def draws(key, count):
    return np.array([rng.draw(np.uint64(key), np.uint64(n)) for n in range(count)], np.uint64)


def uniforms(function, key, count=20_000):
    return np.array([function(bits) for bits in draws(key, count)])


def interpreted(function):
    return getattr(function, "py_func", function)  # under NUMBA_DISABLE_JIT it is one already


@pytest.fixture(autouse=True)
def wrap_around_is_meant():
    with np.errstate(over="ignore"):
        yield


def test_draws_of_key_zero_are_splitmix64s_published_sequence():
    """The first outputs of splitmix64.c (Vigna 2015) seeded with 0."""
    published = [
        0xE220A8397B1DCDAF,
        0x6E789E6AA1B965F4,
        0x06C45D188009454F,
        0xF88BB8A8724C81EC,
        0x1B39896A51A8749B,
    ]
    assert draws(0, 5).tolist() == published


def test_a_draw_depends_on_key_and_counter_alone():
    assert draws(9, 10)[7] == rng.draw(np.uint64(9), np.uint64(7))
    assert len({*draws(9, 100).tolist(), *draws(10, 100).tolist()}) == 200


def test_the_counter_wraps_around():
    last = rng.draw(np.uint64(5), np.uint64(2**64 - 1))
    assert last == rng.mix(np.uint64(5))


@pytest.mark.parametrize("function", [rng.high_uniform, rng.low_uniform])
def test_uniforms_reach_from_zero_to_just_below_one(function):
    assert function(np.uint64(0)) == 0.0
    assert function(np.uint64(2**64 - 1)) == 1 - 2.0**-23


def test_the_highest_uniform_times_any_total_stays_below_it():
    """Else the last ant of a row would fall off its end."""
    bits = np.random.default_rng(0).integers(0x00800000, 0x7F7FFFFF, 20_000, dtype=np.int32)
    totals = bits.view(np.float32)
    assert (np.float32(1 - 2.0**-23) * totals < totals).all()


def test_the_highest_unit_times_any_total_stays_below_it():
    """Else an onlooker would look for a source behind the last one."""
    totals = np.random.default_rng(0).random(20_000) * 10.0 ** np.arange(-10, 10).repeat(1000)
    assert rng.unit(np.uint64(0)) == 0.0
    assert (rng.unit(np.uint64(2**64 - 1)) * totals < totals).all()


@pytest.mark.parametrize("count", [1, 3, 24, 2000])
def test_whole_numbers_below_a_count_are_all_drawn_alike(count):
    low = np.array([rng.below(bits & np.uint64(2**32 - 1), count) for bits in draws(4, 20_000)])
    assert (low.min(), low.max()) == (0, count - 1)
    assert rng.below(np.uint64(2**32 - 1), count) == count - 1
    counts, expected = np.bincount(low, minlength=count), len(low) / count
    assert abs(((counts - expected) ** 2 / expected).sum() - (count - 1)) <= 6 * np.sqrt(2 * (count - 1))


@pytest.mark.parametrize("function", [rng.high_uniform, rng.low_uniform, rng.unit])
@pytest.mark.parametrize("key", KEYS)
def test_uniforms_fill_all_bins_alike(function, key):
    """χ² with 63 degrees of freedom: 63 ± 11.2; six standard deviations would be a broken generator."""
    values = uniforms(function, key)
    counts = np.histogram(values, BINS, (0, 1))[0]
    expected = len(values) / BINS
    assert abs(((counts - expected) ** 2 / expected).sum() - (BINS - 1)) < 6 * np.sqrt(2 * (BINS - 1))


@pytest.mark.parametrize("key", KEYS)
def test_high_and_low_uniforms_of_a_draw_have_nothing_to_do_with_each_other(key):
    high, low = uniforms(rng.high_uniform, key), uniforms(rng.low_uniform, key)
    assert abs(np.corrcoef(high, low)[0, 1]) < 5 / np.sqrt(len(high))


@pytest.mark.parametrize("lag", [1, 2, 20])
def test_draws_have_nothing_to_do_with_earlier_ones(lag):
    values = uniforms(rng.high_uniform, 3)
    assert abs(np.corrcoef(values[lag:], values[:-lag])[0, 1]) < 5 / np.sqrt(len(values))


def test_runs_with_neighbouring_keys_have_nothing_to_do_with_each_other():
    one, other = uniforms(rng.high_uniform, 100), uniforms(rng.high_uniform, 101)
    assert abs(np.corrcoef(one, other)[0, 1]) < 5 / np.sqrt(len(one))


def test_interpreted_functions_give_the_same_bits():
    bits = draws(7, 500)
    assert [int(interpreted(rng.draw)(np.uint64(7), np.uint64(n))) for n in range(500)] == bits.tolist()
    for function in (rng.mix, rng.high_uniform, rng.low_uniform, rng.unit):
        assert [interpreted(function)(b) for b in bits] == [function(b) for b in bits]
