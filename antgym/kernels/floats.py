"""Float32 logarithm and power of two that give the same bits compiled and interpreted, scalar and vectorised.

libm's functions differ between platforms and are eight times slower. Beyond the rounding of the result to
float32, the logarithms err by less than 2e-7; :func:`exp2` errs by less than 2e-7 of the result. The logarithms
never fall between neighbouring numbers; :func:`exp2` may, by one unit in the last place.
"""

import numpy as np

from antgym.kernels import formula

_F = np.float32
_ONE, _HALF_BITS = _F(1.0), np.int32(0x3F3504F3)  # bits of sqrt(1/2): mantissas go to [0.707, 1.414)
_EXPONENT, _SHIFT, _BIAS = np.int32(-0x800000), np.int32(23), np.int32(127)
# 2/ln 2 · (1, 1/3, 1/5, 1/7, 1/9): the series of the area hyperbolic tangent
_L1, _L3, _L5, _L7, _L9 = (_F(2.8853900817779268 / n) for n in (1, 3, 5, 7, 9))
# ln(2)^n / n!: the series of 2^f, |f| <= 1/2
_E1, _E2, _E3, _E4 = (_F(0.6931471805599453**n / f) for n, f in ((1, 1), (2, 2), (3, 6), (4, 24)))
_E5, _E6, _E7 = (_F(0.6931471805599453**n / f) for n, f in ((5, 120), (6, 720), (7, 5040)))
_ROUND = _F(12582912.0)  # 1.5 · 2^23: adding it leaves round(x) in the low bits
_LOWEST, _HIGHEST, _ZERO = _F(-126.0), _F(126.0), _F(0.0)
_BITS52, _BIAS64 = np.int64(52), np.int64(1023)
_MANTISSA64, _ONE64 = np.int64(0xFFFFFFFFFFFFF), np.int64(0x3FF0000000000000)


@formula
def log2(x: np.float32) -> np.float32:
    """Return the binary logarithm of a positive normal float32."""
    bits = _F(x).view(np.int32)
    exponent = np.int32(np.int32(bits - _HALF_BITS) & _EXPONENT)
    mantissa = np.int32(bits - exponent).view(np.float32)
    s = (mantissa - _ONE) / (mantissa + _ONE)
    z = s * s
    series = s * (_L1 + z * (_L3 + z * (_L5 + z * (_L7 + z * _L9))))
    return _F(np.int32(exponent >> _SHIFT)) + series


@formula
def log2_wide(x: np.float64) -> np.float32:
    """Return log2(x), rounded to float32, of a positive normal float64 over its whole range."""
    bits = np.float64(x).view(np.int64)
    exponent = (bits >> _BITS52) - _BIAS64
    mantissa = np.int64((bits & _MANTISSA64) | _ONE64).view(np.float64)
    return _F(exponent) + log2(_F(mantissa))


@formula
def exp2(x: np.float32) -> np.float32:
    """Return 2^x; zero below x = -126, 2^126 above x = 126."""
    clipped = min(max(x, _LOWEST), _HIGHEST)
    shifted = clipped + _ROUND
    f = clipped - (shifted - _ROUND)
    p = _ONE + f * (_E1 + f * (_E2 + f * (_E3 + f * (_E4 + f * (_E5 + f * (_E6 + f * _E7))))))
    scaled = np.int32(_F(p).view(np.int32) + np.int32(_F(shifted).view(np.int32) << _SHIFT)).view(np.float32)
    return scaled if x >= _LOWEST else _ZERO
