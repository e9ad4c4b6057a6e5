"""Experiments: train, sweep, leaderboards, tables and the pages made of them. Run from a checkout; not in the wheel."""
