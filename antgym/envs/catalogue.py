"""The table of environment ids: one row is one world in one regime."""

from typing import Any, NamedTuple

import gymnasium


class Entry(NamedTuple):
    """One environment id: its regime's entry points and the keyword arguments that make it this world."""

    id: str
    entry_point: str
    vector_entry_point: str
    kwargs: dict[str, Any]


_ONE_SHOT = ("antgym.envs.one_shot:OneShotEnv", "antgym.envs.vector:make_one_shot")
_TRIALS = ("antgym.envs.trials:TrialsEnv", "antgym.envs.vector:make_trials")
_CONTROL = ("antgym.envs.control:ControlEnv", "antgym.envs.vector:make_control")

CATALOGUE = (
    Entry("antgym/MountainOneShot-v0", *_ONE_SHOT, {"suite": "mountain-v0"}),
    Entry("antgym/MountainTrials-v0", *_TRIALS, {"suite": "mountain-v0"}),
    Entry("antgym/MountainControl-v0", *_CONTROL, {"suite": "mountain-v0"}),
)


def register_all() -> None:
    """Register every id; entry points are strings, so nothing is imported before ``gymnasium.make``."""
    for entry in CATALOGUE:
        if entry.id not in gymnasium.registry:
            gymnasium.register(
                entry.id,
                entry_point=entry.entry_point,
                vector_entry_point=entry.vector_entry_point,
                kwargs=dict(entry.kwargs),
            )
