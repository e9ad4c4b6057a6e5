"""Cards: what a world is worth to a tuner, measured.

    python -m experiments.headroom Mountain Room

For every world: how far uniform random settings, the published default, the best static setting (SBS), the best one
per rule and an oracle per scenario (VBS) are from the optimum, where the variance of a run comes from, which parameters
matter, and what schedules could add. SBS is found on train, everything is scored on test, on seeds that no search saw.
"""
