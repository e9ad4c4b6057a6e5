"""ROS: map_server's and nav2's maps, a yaml file beside a picture.

A pixel's occupancy is p = (255 - grey) / 255, or grey / 255 where the map is negated. Only what is known to be free
is free here: unknown cells are blocked. ROS 1 (map_server, image_loader.cpp) takes p < free_thresh, and alpha into the
mean of the channels; ROS 2 (nav2, map_io.cpp) takes p <= free_thresh, and any transparency as unknown. Image row 0 is
the top, the map's row 0 the bottom; ``origin`` is the pose of the lower left corner.
"""

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antgym.errors import MapError, MissingExtraError, nearest
from antgym.maps.formats.files import is_file, real, text
from antgym.maps.formats.movingai import require_square
from antgym.maps.formats.pictures import Pixels, encoded, pixels
from antgym.maps.map import Frame, Map
from antgym.maps.motion import Motion
from antgym.maps.world import GridWorld

REQUIRED = ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh")
KEYS = (*REQUIRED, "mode")
MODES = ("trinary", "scale", "raw")
MOST_YAML = 64_000  # bytes: more is no map's yaml, and takes long to parse
_FREE, _OCCUPIED = 254, 0  # levels that map_saver writes
_THRESHOLDS = "occupied_thresh: 0.65\nfree_thresh: 0.196\n"

Values = dict[str, tuple[Any, str]]
"""Every key that counts with its value and its place, file:line."""


class _Terms(NamedTuple):
    """How grey levels become free cells."""

    negate: bool
    free_thresh: float
    mode: str
    ros: int


def read_ros(path: Path, ros: int = 2) -> Map:
    """Read a map's yaml file and its picture, in metres.

    Args:
        path: the yaml file; the picture's path is relative to it.
        ros: 1 for the rules of map_server, 2 for those of nav2.

    Raises:
        MapError: if the yaml or the picture is missing, damaged, or a key is missing or unfit; it names the line.
        MissingExtraError: if PyYAML or Pillow is not installed.
    """
    if ros not in (1, 2):
        raise MapError(f"{path}: ros = {ros}: the rules of ROS 1 or of ROS 2")
    values = _required(_values(path), path)
    resolution = _positive(values["resolution"])
    x, y, yaw = _origin(values["origin"])
    free = _free(pixels(_image(path, values["image"])), _terms(values, ros))
    world = GridWorld(free[::-1].T, (resolution, resolution, resolution))
    return Map(world, Motion("grid8"), Frame((x, y, 0.0), yaw, "m"), path.name, f"ROS {ros} map")


def picture_of(path: Path) -> Path:
    """Return the picture of a map's yaml file; errors as for :func:`read_ros`."""
    return _image(path, _required(_values(path), path)["image"])


def _required(values: Values, path: Path) -> Values:
    for key in REQUIRED:
        if key not in values:
            raise MapError(f"{path}: the key {key!r} is missing; found {', '.join(values)[:80] or 'none'}")
    return values


def _values(path: Path) -> Values:
    try:
        import yaml
    except ImportError:
        raise MissingExtraError("PyYAML", "maps") from None
    written = text(path, MOST_YAML)
    try:
        loader = yaml.SafeLoader(written)
        root = loader.get_single_node()
        if not isinstance(root, yaml.MappingNode):
            raise MapError(f"{path}:1: a map's yaml holds keys and values, {', '.join(REQUIRED)}")
        return {
            key.value: _plain(loader, value, f"{path}:{key.start_mark.line + 1}: {key.value}")
            for key, value in root.value
            if key.value in KEYS
        }
    except MapError:
        raise
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else 1
        raise MapError(f"{path}:{line}: not YAML ({error.problem})") from None
    except yaml.reader.ReaderError as error:
        line = written.count("\n", 0, error.position) + 1
        raise MapError(f"{path}:{line}: not YAML ({error.reason})") from None
    except (ValueError, TypeError, AttributeError, OverflowError, RecursionError) as error:
        raise MapError(f"{path}: not YAML ({error})") from None  # a date that is none, or nested too deep


def _plain(loader: Any, node: Any, place: str) -> tuple[Any, str]:
    """Return a value that is a word, or a list of words, and its place; nothing that refers to others is followed."""
    import yaml

    if isinstance(node, yaml.ScalarNode):
        return loader.construct_object(node), place
    if isinstance(node, yaml.SequenceNode) and all(isinstance(part, yaml.ScalarNode) for part in node.value):
        return [loader.construct_object(part) for part in node.value], place
    raise MapError(f"{place}: must be a plain value")


def _number(value: tuple[Any, str]) -> float:
    given, place = value
    if isinstance(given, bool) or not isinstance(given, int | float | str):
        raise MapError(f"{place} = {given!r:.40}: must be a number")
    return real(str(given), place)  # YAML 1.1 takes 1e-3 for a text


def _positive(value: tuple[Any, str]) -> float:
    number = _number(value)
    if not 1e-9 < number < 1e9:
        raise MapError(f"{value[1]} = {number}: must be a positive number of metres")
    return number


def _origin(value: tuple[Any, str]) -> tuple[float, float, float]:
    given, place = value
    if not isinstance(given, list) or len(given) != 3:
        raise MapError(f"{place} = {given!r:.40}: must be [x, y, yaw], metres and radians")
    x, y, yaw = (_number((part, place)) for part in given)
    return x, y, yaw


def _image(path: Path, value: tuple[Any, str]) -> Path:
    given, place = value
    if not isinstance(given, str) or not given:
        raise MapError(f"{place} = {given!r:.40}: must be the path of a picture")
    picture = path.parent / given
    if not is_file(picture):
        raise MapError(f"{place}: no such file {str(picture)[:200]} (the path is relative to the yaml)")
    return picture


def _terms(values: Values, ros: int) -> _Terms:
    negate, place = values["negate"]
    if negate not in (0, 1):  # True and False are
        raise MapError(f"{place} = {negate!r:.40}: must be 0 or 1")
    mode, place = values.get("mode", ("trinary", ""))
    if mode not in MODES:
        raise MapError(f"{place} = {mode!r:.40}: unknown mode; {nearest(str(mode)[:40], MODES)}")
    low, high = (_number(values[key]) for key in ("free_thresh", "occupied_thresh"))
    if not 0 <= low <= high <= 1:
        raise MapError(
            f"{values['free_thresh'][1]} = {low}, occupied_thresh = {high}: need 0 <= free <= occupied <= 1"
        )
    return _Terms(bool(negate), low, mode, ros)


def _free(shown: Pixels, terms: _Terms) -> NDArray[np.bool_]:
    """Return which pixels are known to be free."""
    grey = shown.channels.mean(axis=2, dtype=np.float64)
    if terms.ros == 1 and terms.mode == "trinary" and shown.alpha is not None:
        count = shown.channels.shape[2]
        grey = (grey * count + shown.alpha) / (count + 1)
    if terms.mode == "raw":  # the level is the occupancy in per cent; above 100, unknown
        level = np.round(255 - grey if terms.negate and terms.ros == 1 else grey)
        return np.asarray((level <= 100) & _below(level / 100, terms))
    free = _below((grey if terms.negate else 255 - grey) / 255, terms)
    if shown.alpha is not None and terms.ros == 2:
        free &= shown.alpha == 255
    return free


def _below(occupancy: NDArray[np.float64], terms: _Terms) -> NDArray[np.bool_]:
    if terms.ros == 1 and terms.mode != "raw":
        return np.asarray(occupancy < terms.free_thresh)
    return np.asarray(occupancy <= terms.free_thresh)


def ros_bytes(world: GridWorld, frame: Frame, image: str) -> tuple[bytes, bytes]:
    """Return a flat world as the bytes of a yaml file and of the PGM picture that it names ``image``.

    Raises:
        MapError: if the world is not flat, or its cells are not square.
        MissingExtraError: if Pillow is not installed.
    """
    require_square(world, flat=True)
    x, y, _ = frame.origin
    pose = f"resolution: {world.cell[0]!r}\norigin: [{x!r}, {y!r}, {frame.yaw!r}]\n"
    yaml = f"image: {image}\n{pose}negate: 0\n{_THRESHOLDS}"
    levels = np.where(world.free[:, ::-1, 0].T, np.uint8(_FREE), np.uint8(_OCCUPIED))
    return yaml.encode(), encoded(np.ascontiguousarray(levels), "PPM")
