"""The table of environment ids: every world in every regime."""

from typing import Any, NamedTuple

import gymnasium


class Entry(NamedTuple):
    """One environment id: its regime's entry points and the keyword arguments that make it this world.

    ``flat`` says why choosing well is worth little in this world; it is empty where it is worth something.
    """

    id: str
    entry_point: str
    vector_entry_point: str
    kwargs: dict[str, Any]
    world: str
    regime: str
    flat: str = ""


WORLDS = {
    "Mountain": "mountain-v0",
    "PotentialField": "potential-field-v0",
    "Room": "room-v0",
    "Fleet": "fleet-v0",
    "Pallet": "pallet-v0",
    "Open": "open-v0",
    "Bee": "bee-v0",
    "TabuBee": "tabu-bee-v0",
}
"""Every world and the suite that its scenarios come from."""

REGIMES = {
    "OneShot": ("antgym.envs.one_shot:OneShotEnv", "antgym.envs.vector:make_one_shot"),
    "Trials": ("antgym.envs.trials:TrialsEnv", "antgym.envs.vector:make_trials"),
    "Control": ("antgym.envs.control:ControlEnv", "antgym.envs.vector:make_control"),
}
"""Every regime and its entry points: one environment, and the native batch."""

_SELF_SCALING = (
    "a bee moves by a share of the distance between two sources, which shrinks as they agree, so that one setting "
    "suits nearly every map and effort"
)
FLAT = {"Bee": _SELF_SCALING, "TabuBee": _SELF_SCALING}
"""Worlds whose headroom stayed below the bar after they were widened twice, and why; their cards log what was tried."""

AT_ONCE = ("Fleet",)
"""Worlds that Control lacks: a fleet's robots are planned one after another, so that there is no one run to steer."""

CATALOGUE = tuple(
    Entry(f"antgym/{world}{regime}-v0", *entry_points, {"suite": suite}, world, regime, FLAT.get(world, ""))
    for world, suite in WORLDS.items()
    for regime, entry_points in REGIMES.items()
    if not (world in AT_ONCE and regime == "Control")
)


def world_of(suite: Any) -> str:
    """Return the world whose suite this is, "" where it is of none."""
    return next((world for world, its in WORLDS.items() if its == suite), "")


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
