"""Worlds as the kernels read them: one bit a cell, in the order of the padded storage."""

from antgym.kernels import inlined


@inlined
def is_free(bits, cell):
    """Whether a cell is free; ``bits`` is a flat uint8 array, cell 0 its first byte's lowest bit."""
    return (bits[cell >> 3] >> (cell & 7)) & 1 != 0
