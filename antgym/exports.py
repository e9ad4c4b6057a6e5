"""Exports: paths as CSV and as poses, worlds and scenarios as the map files of others."""

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antgym.console import write_whole
from antgym.errors import MapError, nearest
from antgym.maps.formats import elevation, movingai, octomap, ros, voxels
from antgym.maps.formats.rows import scen_bytes, voxel_scen_bytes
from antgym.maps.map import Frame, Map
from antgym.maps.readers import suffix_of
from antgym.maps.world import GridWorld, Scenario

MAPS = (".map", ".3dmap", ".bt", ".yaml", ".asc")
SCENARIOS = (".scen", ".3dscen")


def path_csv(cells: NDArray[np.int64], points: NDArray[np.float64]) -> bytes:
    """Return (n, 3) cells and their (n, 3) points as CSV: i, j, k, x, y, z."""
    rows = [
        f"{i},{j},{k},{x!r},{y!r},{z!r}"
        for (i, j, k), (x, y, z) in zip(cells.tolist(), points.tolist(), strict=True)
    ]
    return "\n".join(("i,j,k,x,y,z", *rows, "")).encode()


def poses(points: NDArray[np.float64], frame_id: str = "map") -> dict[str, Any]:
    """Return a path as ROS has it (nav_msgs/Path, without stamps): a frame, and a pose for every way-point.

    A pose heads for the next way-point, the last as the one before it; headings turn about z alone.

    Args:
        points: (n, 3) in metres, in the map's frame.
        frame_id: name of that frame.
    """
    header = {"frame_id": frame_id}
    ahead = np.diff(points, axis=0)
    yaws = np.arctan2(ahead[:, 1], ahead[:, 0]).tolist()
    found = []
    for (x, y, z), yaw in zip(points.tolist(), [*yaws, *(yaws[-1:] or [0.0])][: len(points)], strict=True):
        turned = {"x": 0.0, "y": 0.0, "z": math.sin(yaw / 2), "w": math.cos(yaw / 2)}
        pose = {"position": {"x": x, "y": y, "z": z}, "orientation": turned}
        found.append({"header": header, "pose": pose})
    return {"header": header, "poses": found}


def poses_json(points: NDArray[np.float64]) -> bytes:
    """Return :func:`poses` as JSON."""
    return (json.dumps(poses(points), indent=1) + "\n").encode()


def write_map(path: str | Path, world: Map | GridWorld) -> tuple[Path, ...]:
    """Write a world as a map file, as the end of its name says: MovingAI ``.map`` or ``.3dmap``, OctoMap ``.bt``, ROS.

    ``.map`` and ``.3dmap`` know cells of edge 1 alone. Beside a ROS ``.yaml`` its picture is written. ``.asc`` holds
    the heights of a map that has some.

    Args:
        path: the file.
        world: a world, or a map, whose place in the world a ``.yaml`` or a ``.bt`` keeps.

    Returns:
        The files, each written as a whole or not at all.

    Raises:
        MapError: if the file is of no such kind, or the world does not fit it.
        AntgymError: if a file cannot be written.
    """
    path = Path(path)
    for file, data in map_files(path, world).items():
        write_whole(file, data)
    return tuple(map_files(path, world))


def map_files(path: Path, world: Map | GridWorld) -> dict[Path, bytes]:
    """Return what :func:`write_map` writes, by path."""
    grid, frame = (world.world, world.frame) if isinstance(world, Map) else (world, Frame())
    kind = suffix_of(path)
    if kind == ".map":
        return {path: movingai.map_bytes(grid)}
    if kind == ".3dmap":
        return {path: voxels.voxel_bytes(grid)}
    if kind == ".bt":
        return {path: octomap.octomap_bytes(grid, frame)}
    if kind == ".yaml":
        picture = path.with_suffix(".pgm")
        yaml, levels = ros.ros_bytes(grid, frame, picture.name)
        return {picture: levels, path: yaml}
    if kind == ".asc":
        if not isinstance(world, Map) or world.heights is None:
            raise MapError(f"{path}: only a map of heights is written as such a file")
        x, y, _ = grid.cell
        return {path: elevation.ascii_bytes(elevation.HeightField(world.heights, (x, y), world.source))}
    raise MapError(f"{path}: unknown kind of map file {kind!r}; {nearest(kind, MAPS)}")


def write_scenarios(path: str | Path, scenarios: Sequence[Scenario], map_name: str | None = None) -> Path:
    """Write scenarios in one world as a ``.scen`` file, or ``.3dscen`` for voxels, with their exact optima in cells.

    Optima are those of MovingAI's moves (8 or 26 neighbours, no corner cut), whatever the scenarios' own motion is.

    Args:
        path: the file.
        scenarios: at least one.
        map_name: that the rows give to the map; by default the file's name without its end.

    Raises:
        MapError: if the file is of no such kind, there are no scenarios or their worlds differ or do not fit it.
        ScenarioError: if no path leads from a start to its goal.
        AntgymError: if the file cannot be written.
    """
    path = Path(path)
    write = {".scen": scen_bytes, ".3dscen": voxel_scen_bytes}
    if path.suffix.lower() not in write:
        raise MapError(
            f"{path}: unknown kind of scenario file {path.suffix!r}; {nearest(path.suffix, SCENARIOS)}"
        )
    if not scenarios or any(scenario.world is not scenarios[0].world for scenario in scenarios):
        raise MapError(f"{path}: a scenario file holds scenarios, at least one, in one and the same world")
    write_whole(path, write[path.suffix.lower()](scenarios, map_name or path.stem))
    return path
