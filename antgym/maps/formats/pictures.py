"""Pictures: pixels of image files by Pillow, as grey levels from 0 (black) to 255 (white), and small files of them.

Sizes are read before pixels. Only plain picture formats are opened: nothing that draws by running a program, and no
TIFF, whose library writes to the terminal what it thinks of a file.
"""

import io
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antgym.errors import MapError, MissingExtraError
from antgym.maps.formats.files import MOST_BYTES, MOST_FLAT, require_file

if TYPE_CHECKING:
    from PIL.Image import Image

SUFFIXES = (".png", ".jpg", ".jpeg", ".bmp", ".pgm", ".ppm", ".pnm", ".pbm", ".gif")
_KINDS = ("PNG", "JPEG", "BMP", "PPM", "GIF")
Grey = NDArray[np.float32]


class Pixels(NamedTuple):
    """A picture.

    Attributes:
        channels: (H, W, 1) or (H, W, 3) from 0, black, to 255, uint8, or float32 of 16 bits; row 0 is the top.
        alpha: (H, W) uint8 from 0, transparent, to 255, None where the file has none.
    """

    channels: NDArray[np.uint8] | Grey
    alpha: NDArray[np.uint8] | None

    @property
    def grey(self) -> Grey:
        """(H, W), the mean of the channels."""
        return self.channels.mean(axis=2, dtype=np.float32)


def pixels(path: Path) -> Pixels:
    """Read a picture; 16-bit levels are scaled to 255, transparency is kept apart.

    Raises:
        MapError: if the file is missing, damaged, too large or no picture.
        MissingExtraError: if Pillow is not installed.
    """
    require_file(path, MOST_BYTES)
    try:
        from PIL import Image
    except ImportError:
        raise MissingExtraError("Pillow", "maps") from None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of metadata; what damages pixels is an error
            with Image.open(path, formats=_KINDS) as image:
                _require_size(image, path)
                image.load()
                return _unpacked(image)
    except MapError:
        raise
    except Exception as error:  # of a damaged file, its decoders raise what they like
        raise MapError(f"{path}: not a readable picture ({type(error).__name__}: {error})") from None


def _require_size(image: "Image", path: Path) -> None:
    width, height = image.size
    if width * height > MOST_FLAT:
        raise MapError(
            f"{path}: {width:,} x {height:,} pixels are more than {MOST_FLAT:,}; shrink the picture"
        )


def _unpacked(image: "Image") -> Pixels:
    if image.mode.startswith(("I", "F")):
        return Pixels(_deep(image)[:, :, None], None)
    transparent = image.mode in ("LA", "PA", "RGBA") or "transparency" in image.info
    if transparent and image.mode != "LA":
        image = image.convert("RGBA")
    elif image.mode not in ("L", "LA", "RGB"):
        image = image.convert("L" if image.mode == "1" else "RGB")
    levels: NDArray[np.uint8] = np.asarray(image).reshape(image.height, image.width, -1)
    return Pixels(levels[:, :, :-1], levels[:, :, -1]) if transparent else Pixels(levels, None)


def _deep(image: "Image") -> Grey:
    levels = np.asarray(image, dtype=np.float32)
    if not (levels.min() >= 0 and levels.max() <= 65535):
        raise ValueError("levels beyond 16 bits")
    return levels / np.float32(257)


def encoded(levels: NDArray[np.uint8], kind: str = "PNG") -> bytes:
    """Return (H, W) or (H, W, 3) levels as the bytes of a picture file; ``"PPM"`` is PGM where they are grey.

    Raises:
        MissingExtraError: if Pillow is not installed.
    """
    try:
        from PIL import Image
    except ImportError:
        raise MissingExtraError("Pillow", "maps") from None
    buffer = io.BytesIO()
    Image.fromarray(levels).save(buffer, kind)
    return buffer.getvalue()
