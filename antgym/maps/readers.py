"""Readers: one entry point for every kind of map file, told by the end of its name."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from antgym.errors import MapError, nearest
from antgym.maps import camera, ground
from antgym.maps.formats import movingai, octomap, pictures, ros, shapes, voxels
from antgym.maps.formats.rows import Rows, read_rows, read_voxel_rows
from antgym.maps.map import Map


class Kind(NamedTuple):
    """A kind of map file.

    Attributes:
        read: (path, **options) -> Map.
        options: what else it takes.
    """

    read: Callable[..., Map]
    options: tuple[str, ...] = ()


_GROUND = ("levels", "rise", "fill", "pixel")
_HEIGHTS = Kind(ground.read_ground, _GROUND)
_PICTURE = Kind(camera.read_picture, ("pixel", "cell", "threshold", "negate", "crop", "relief"))
_RELIEF = Kind(ground.read_ground, (*_GROUND, "relief"))

KINDS: dict[str, Kind] = {
    ".map": Kind(movingai.read_movingai),
    ".3dmap": Kind(voxels.read_voxels),
    ".3dmap.gz": Kind(voxels.read_voxels),
    ".yaml": Kind(ros.read_ros, ("ros",)),
    ".yml": Kind(ros.read_ros, ("ros",)),
    ".bt": Kind(octomap.read_octomap, ("unknown",)),
    ".json": Kind(shapes.read_shapes, ("cell",)),
    **dict.fromkeys((".asc", ".txt", ".npy", ".npz"), _HEIGHTS),
    **dict.fromkeys(pictures.SUFFIXES, _PICTURE),
}
"""By the end of a file's name."""


def read_map(path: str | Path, radius: float = 0.0, **options: Any) -> Map:
    """Read a map file: what it is, the end of its name says.

    ``.map`` MovingAI; ``.3dmap``, ``.3dmap.gz`` Warframe voxels; ``.yaml``, ``.yml`` ROS (Pillow and PyYAML); ``.bt``
    OctoMap; ``.asc``, ``.txt``, ``.npy``, ``.npz`` elevations; ``.json`` scenes of shapes; pictures (Pillow), as plans
    of a floor or, with ``relief``, as elevations.

    Args:
        path: the file.
        radius: of the robot, in the map's unit: obstacles are grown by it.
        **options: of elevations ``levels``, ``rise``, ``fill`` and ``pixel``, see
            :func:`antgym.maps.ground.read_ground`; of pictures ``pixel``, ``cell``, ``threshold``, ``negate`` and
            ``crop``, see :func:`antgym.maps.camera.read_picture`, or ``relief``, the heights of black and white, with
            those of elevations; of ROS maps ``ros``, 1 or 2; of OctoMaps ``unknown``, ``"blocked"`` or ``"free"``; of
            scenes ``cell``. Options that are None are left out.

    Raises:
        MapError: if the file is missing, damaged, too large or of no such kind, or an option is unknown to its kind; it
            names the file and the line or the byte.
        MissingExtraError: if the library that reads it is not installed.
    """
    path = Path(path)
    given = {name: value for name, value in options.items() if value is not None}
    kind = _kind(path)
    if kind is _PICTURE and "relief" in given:
        kind = _RELIEF
    for name in given:
        if name not in kind.options:
            hint = nearest(name, kind.options) if kind.options else "it takes none"
            raise MapError(f"{path}: a {suffix_of(path)} file has no option {name!r}; {hint}")
    return kind.read(path, **given).grown(radius)


def read_scenarios(path: str | Path, map_path: str | Path | None = None) -> Rows:
    """Read the rows of a MovingAI or MAPF ``.scen`` file, or a Warframe ``.3dscen`` file, as they are.

    Rows whose start is their goal, or leads nowhere, are kept; ``scenario(index)`` refuses them.

    Args:
        path: the file.
        map_path: its map; by default the one beside it, under the name that the file gives.

    Raises:
        MapError: if the file is missing or damaged; it names the line.
    """
    path = Path(path)
    readers = {".scen": read_rows, ".3dscen": read_voxel_rows}
    if path.suffix.lower() not in readers:
        raise MapError(f"{path}: unknown kind of scenario file {path.suffix!r}; valid: {', '.join(readers)}")
    return readers[path.suffix.lower()](path, None if map_path is None else Path(map_path))


def options_of(path: Path) -> tuple[str, ...]:
    """Return the names of the options that :func:`read_map` takes for such a file."""
    kind = KINDS.get(suffix_of(path))
    return ("radius", *(kind.options if kind else ()))


def suffix_of(path: Path) -> str:
    """Return the end of a file's name that says what it is."""
    return "".join(path.suffixes[-2:]).lower() if path.suffix.lower() == ".gz" else path.suffix.lower()


def _kind(path: Path) -> Kind:
    suffix = suffix_of(path)
    if suffix not in KINDS:
        raise MapError(f"{path}: unknown kind of map file {suffix!r}; {nearest(suffix, tuple(KINDS))}")
    return KINDS[suffix]
