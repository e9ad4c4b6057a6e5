"""A counter-based random generator: the n-th number of a run is a pure function of (key, n).

So the numbers do not depend on threads, on the batch or on the order in which ants move. The mixing function is
the finaliser of SplitMix64 (Steele, Lea & Flood 2014, doi 10.1145/2660193.2660195).
"""

import numpy as np

from antgym.kernels import formula

GOLDEN = np.uint64(0x9E3779B97F4A7C15)
_MIX1, _MIX2 = np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB)
_S30, _S27, _S31 = np.uint64(30), np.uint64(27), np.uint64(31)
_HIGH, _LOW_MASK = np.uint64(41), np.uint64(0x7FFFFF)
_SCALE = np.float32(2.0**-23)
_S11, _S32, _SCALE53 = np.uint64(11), np.uint64(32), np.float64(2.0**-53)


@formula
def mix(bits: np.uint64) -> np.uint64:
    """Return 64 well mixed bits of 64 bits."""
    bits = (bits ^ (bits >> _S30)) * _MIX1
    bits = (bits ^ (bits >> _S27)) * _MIX2
    return bits ^ (bits >> _S31)


@formula
def draw(key: np.uint64, counter: np.uint64) -> np.uint64:
    """Return the counter-th 64 random bits of the run ``key``."""
    return mix(key + GOLDEN * (counter + np.uint64(1)))


@formula
def high_uniform(bits: np.uint64) -> np.float32:
    """Return a float32 in [0, 1 - 2^-23] from the upper bits.

    23 bits, not 24: then uniform × total rounds to less than total for every float32 total.
    """
    return np.float32(np.int32(bits >> _HIGH)) * _SCALE


@formula
def low_uniform(bits: np.uint64) -> np.float32:
    """Return a float32 in [0, 1 - 2^-23] from the lower bits, independent of :func:`high_uniform`."""
    return np.float32(np.int32(bits & _LOW_MASK)) * _SCALE


@formula
def unit(bits: np.uint64) -> np.float64:
    """Return a float64 in [0, 1 - 2^-53]; times any total it rounds to less than the total."""
    return np.float64(np.int64(bits >> _S11)) * _SCALE53


@formula
def below(bits: np.uint64, count: int) -> np.int64:
    """Return a whole number in [0, count) from 32 random bits, for 1 <= count < 2^31."""
    return np.int64((bits * np.uint64(count)) >> _S32)
