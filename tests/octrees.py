"""Octrees written the obvious way, one node after the other: the slow twin of the decoder."""

import struct

import numpy as np

HEADER = "# Octomap OcTree binary file\n# a comment\nid OcTree\nsize {size}\nres {res}\ndata\n"
DEPTH, CENTRE = 16, 1 << 15


def tree_bytes(kinds, low, res=0.5):
    """The bytes of a .bt file: (n, n, n) of 0 unknown, 1 free, 2 occupied, whose first cell has the keys ``low``."""
    low = np.asarray(low)

    def kind_of(corner, side):
        first = np.clip(corner - low, 0, kinds.shape)
        last = np.clip(corner + side - low, 0, kinds.shape)
        inside = kinds[tuple(slice(a, b) for a, b in zip(first, last, strict=True))]
        whole = inside.size == side**3
        values = np.unique(inside) if whole else np.unique(np.append(inside, 0))
        return int(values[0]) if len(values) == 1 else 3

    def node(corner, side):
        half = side // 2
        corners = [corner + half * np.array([i & 1, i >> 1 & 1, i >> 2]) for i in range(8)]
        codes = [kind_of(child, half) for child in corners]
        yield sum(code << 2 * i for i, code in enumerate(codes))
        for child, code in zip(corners, codes, strict=True):
            if code == 3:
                yield from node(child, half)

    words = list(node(np.zeros(3, int), 1 << DEPTH))
    return HEADER.format(size=len(words), res=res).encode() + struct.pack(f"<{len(words)}H", *words)
