"""Scenes: scenarios among discs as JSON files, in and out.

A scene is one object. ``start``, ``goal`` and ``circles_x_y_r`` must be there; ``bounds_xmin_xmax_ymin_ymax``,
``robot_radius``, ``safe_distance`` and ``name`` may. What else a benchmark writes beside them (where it comes from,
known lengths) is not read. Nothing in a file is ever run.
"""

import json
from pathlib import Path
from typing import Any

import numpy as np

from antgym.errors import MapError, ScenarioError, nearest
from antgym.maps.discs import DiscScenario, DiscWorld, Floats
from antgym.maps.world import Scenario

REQUIRED = ("start", "goal", "circles_x_y_r")
OPTIONAL = ("bounds_xmin_xmax_ymin_ymax", "robot_radius", "safe_distance", "name")
REMARKS = ("source", "licence", "straight_line", "x_range", "y_range")
"""What else a scene may say of itself, besides ``optimal_…``, ``reference_…`` and ``…_note``."""
MOST_BYTES = 50_000_000


def read_discs(path: str | Path) -> DiscScenario:
    """Read a scene from a JSON file.

    Where it gives no bounds, they are the smallest box around start, goal and discs: no shortest path leaves it.

    Raises:
        MapError: if the file is missing, too large, no JSON, or a field is missing, unknown or unfit.
        ScenarioError: if start or goal cannot be one.
    """
    path = Path(path)
    if not path.is_file():
        raise MapError(f"{path}: no such file (looked in {path.parent.resolve()})")
    if path.stat().st_size > MOST_BYTES:
        raise MapError(
            f"{path}: {path.stat().st_size:,} bytes are more than {MOST_BYTES:,}; is this a scene?"
        )
    try:
        return scene_of(path.read_text(encoding="utf-8"), path.stem)
    except (MapError, ScenarioError) as error:
        raise type(error)(f"{path}: {error}") from None
    except (UnicodeDecodeError, OSError) as error:
        raise MapError(f"{path}: not a readable text file ({error})") from None


def scene_of(text: str, name: str = "scene") -> DiscScenario:
    """Return the scenario that a JSON text describes; errors as for :func:`read_discs`, without the file's name."""
    try:
        scene = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise MapError(f"not JSON ({error})") from None
    if not isinstance(scene, dict):
        raise MapError(f"a scene is a JSON object with {', '.join(REQUIRED)}, got {type(scene).__name__}")
    _require_known(scene)
    discs = scene["circles_x_y_r"]
    ends = {label: _point(scene[label], label) for label in ("start", "goal")}
    distances = {key: scene[key] for key in ("robot_radius", "safe_distance") if key in scene}
    bounds = scene.get("bounds_xmin_xmax_ymin_ymax")
    if bounds is None:
        everywhere = DiscWorld(discs, (-1e9, 1e9, -1e9, 1e9), **distances)
        bounds = _box(everywhere.grown, list(ends.values()))
    title = scene.get("name", name)
    if not isinstance(title, str):
        raise MapError(f"name must be a text, got {title!r:.40}")
    return Scenario(DiscWorld(discs, bounds, **distances), ends["start"], ends["goal"], name=title)


def scene_text(scenario: DiscScenario) -> str:
    """Return a scenario among discs as JSON that :func:`scene_of` makes the same scenario of."""
    world = scenario.world
    scene = {
        "name": scenario.name,
        "start": list(scenario.start),
        "goal": list(scenario.goal),
        "bounds_xmin_xmax_ymin_ymax": list(world.bounds),
        "robot_radius": world.robot_radius,
        "safe_distance": world.safe_distance,
        "circles_x_y_r": world.discs.tolist(),
    }
    return json.dumps(scene, indent=1) + "\n"


def _require_known(scene: dict[str, Any]) -> None:
    for field in REQUIRED:
        if field not in scene:
            raise MapError(f"the field {field!r} is missing; found {', '.join(map(repr, scene)) or 'none'}")
    for field in scene:
        if "rects" in field or "polygons" in field:
            raise MapError(f"the field {field!r}: only discs can be obstacles; cover the rest with discs")
        remark = field in REMARKS or field.startswith(("optimal_", "reference_")) or field.endswith("_note")
        if field not in (*REQUIRED, *OPTIONAL) and not remark:
            raise MapError(f"unknown field {field!r}; {nearest(field, (*REQUIRED, *OPTIONAL))}")


def _point(value: Any, label: str) -> tuple[float, float]:
    if (
        not isinstance(value, list)
        or len(value) != 2
        or not all(type(part) in (int, float) for part in value)
    ):
        raise MapError(f"{label} = {value!r:.40}: must be two numbers [x, y]")
    return value[0], value[1]


def _box(grown: Floats, ends: list[tuple[float, float]]) -> tuple[float, float, float, float]:
    circles = np.vstack([grown, [(*end, 0.0) for end in ends]])
    low, high = (
        (circles[:, :2] - circles[:, 2:]).min(axis=0),
        (circles[:, :2] + circles[:, 2:]).max(axis=0),
    )
    # a start, a goal and nothing else may lie on a line
    margin = max(*(high - low), 1.0) / 10
    low, high = low - margin, high + margin
    return float(low[0]), float(high[0]), float(low[1]), float(high[1])
