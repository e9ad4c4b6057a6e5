"""Formats: a file a kind of map, read with suspicion: what a file claims is bounded before memory is taken for it."""
