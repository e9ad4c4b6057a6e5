"""Slow, obvious twins of the kernels.

``twin`` walks the same ants as the compiled colony, bit for bit, one ant after the other and one move after the other,
driven by the same ``Rules``; it shares only the random numbers and the float32 logarithm and power with it.
``textbook`` is the colony as the equations print it, in float64, with its own random numbers: the two agree in
distribution. ``paths`` finds optima by going through all moves, ``diagnosis`` follows a steered colony.
"""
