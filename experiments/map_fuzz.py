"""Throw damaged map files, and settings of their folders, at the readers and see what breaks; by hand, never in CI.

    python -m experiments.map_fuzz --cases 100000
    python -m experiments.map_fuzz --guided 300    # seconds of atheris, which looks for new ways through the readers

A reader may return a map or raise an AntgymError, nothing else, within seconds and a gigabyte. Every case is a function
of its number, so that a failure can be looked at alone: ``--first N --cases 1``; atheris leaves its case in a file.
"""

import resource
import struct
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from antgym.console import main, parse, progress
from antgym.errors import AntgymError, MissingExtraError

SECONDS, MEMORY = 10.0, 1 << 20  # of one file: CPU time, KiB
MAP = b"type octile\nheight 3\nwidth 4\nmap\n....\n.@T.\nSWG.\n"
SCEN = b"version 1\n0\tsample.map\t4\t3\t0\t0\t3\t0\t3.0\n0\tsample.map\t4\t3\t0\t0\t0\t0\t0\n"
YAML = (
    b"image: sample.pgm\nresolution: 0.05\norigin: [-1.0, 2.0, 0.5]\nnegate: 0\noccupied_thresh: 0.65\n"
    b"free_thresh: 0.196\n"
)
TREE = b"# Octomap OcTree binary file\nid OcTree\nsize 17\nres 0.1\ndata\n"
SCENE = b"""{"bounds_xmin_xmax_ymin_ymax": [0, 4, 0, 3],
 "circles_x_y_r": [[1, 1, 0.5]], "rects_x_y_w_h": [[2, 2, 1, 0.5]]}"""
ASC = b"ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 5\nNODATA_value -9999\n1 2 3\n4 5 6\n"
SETTINGS = b"""rules = ["max_min"]
ants = 5
longest = 60.5
split = { train = 0.5, test = 0.25 }
["s*.map"]
start = [1, 2]
goal = [0.5, 1e3]
unit = "map"
crop = [0, 1, 2, 3]
negate = true
"""
PICTURES = {".png": "PNG", ".jpg": "JPEG", ".bmp": "BMP", ".pgm": "PPM", ".gif": "GIF"}
WORDS = (
    b"-1",
    b"0",
    b"1e999",
    b"nan",
    b"999999999",
    b"\xff\xfe",
    b"[",
    b"{",
    b"&a *a",
    b"\n",
    b"\0",
    b" ",
    b"#",
    b"inf",
)


@dataclass(frozen=True)
class Arguments:
    """Fuzz the readers: no traceback, no hang, no gigabyte."""

    cases: int = 20_000
    """How many cases."""
    first: int = 0
    """Number of the first."""
    guided: int = 0
    """Seconds of atheris (extra "fuzz") in the place of cases."""


def samples(folder: Path) -> dict[str, bytes]:
    """Return a small whole file of every kind, by the end of its name."""
    from antgym.maps.formats.pictures import encoded

    levels = np.arange(48, dtype=np.uint8).reshape(6, 8) * 5
    np.save(folder / "made.npy", levels[:2] / 7)
    np.savez_compressed(folder / "made.npz", heights=levels, dx=2.0, dy=3.0)
    words = [3] * 15 + [0b10_01_00_10_01_01_10_01]
    return {
        ".map": MAP,
        ".scen": SCEN,
        ".3dmap": b"voxel 4 3 2\n0 0 0\n3 2 1\n",
        ".3dscen": b"version 1\nsample.3dmap\n0 0 1 3 2 0 4.1 1.2\n",
        ".yaml": YAML,
        ".bt": TREE + struct.pack("<16H", *words),
        ".json": SCENE,
        ".asc": ASC,
        ".npy": (folder / "made.npy").read_bytes(),
        ".npz": (folder / "made.npz").read_bytes(),
        ".toml": SETTINGS,
        **{suffix: encoded(levels, kind) for suffix, kind in PICTURES.items()},
    }


def damaged(rng: np.random.Generator, data: bytes) -> bytes:
    """Return a file with a few bytes changed, cut, doubled, or words of ill repute put in."""
    content = bytearray(data)
    for _ in range(int(rng.integers(1, 6))):
        at = int(rng.integers(len(content) + 1))
        to = min(len(content), at + int(rng.integers(1, 12)))
        kind = int(rng.integers(5))
        if kind == 0:
            content[at:to] = rng.bytes(to - at)
        elif kind == 1:
            del content[at : to if rng.random() < 0.8 else len(content)]
        elif kind == 2:
            content[at:at] = content[at:to] * int(rng.integers(1, 9))
        elif kind == 3:
            content[at:to] = WORDS[int(rng.integers(len(WORDS)))]
        elif at < len(content):
            content[at] ^= 1 << int(rng.integers(8))
    return bytes(content)


def check(suffix: str, data: bytes, folder: Path) -> bool:
    """Read a file; return whether it was readable. AssertionError where a reader does what it must not."""
    from antgym.maps.readers import read_map, read_scenarios

    path = folder / f"sample{suffix}"
    path.write_bytes(data)
    read: Callable[[Path], object] = read_map
    if suffix in (".scen", ".3dscen"):
        read = _planned(read_scenarios)
    elif suffix == ".toml":
        read = _settled
    begun, held = time.process_time(), _held()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            read(path)
        said = ""
    except MissingExtraError:
        raise
    except AntgymError as error:
        said = str(error)
    assert not said or str(folder) in said, f"the message names no file: {said}"
    seconds = time.process_time() - begun
    assert seconds < SECONDS, f"{seconds:.1f} s"
    grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - held
    assert grown < MEMORY, f"over a gigabyte: {grown >> 10} MiB"
    return not said


def _held() -> int:
    """Return the KiB that are held now, from which the peak counts; where a system forgets no peak, the peak so far."""
    with suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5")
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def _planned(read: Callable[[Path], object]) -> Callable[[Path], object]:
    def rows(path: Path) -> object:
        found = read(path)
        return found.scenario(0)  # type: ignore[attr-defined]  # rows have it

    return rows


def _settled(path: Path) -> object:
    from antgym.maps.suite_file import read_suite_file

    settings = read_suite_file(path)
    return settings.terms(path.with_name("sample.map"))


def blind(arguments: Arguments, folder: Path) -> None:
    """Check cases by number, and say how many were readable."""
    whole = samples(folder)
    for suffix, data in whole.items():
        (folder / f"sample{suffix}").write_bytes(data)
    readable = 0
    with progress("damaged map files", arguments.cases, after=1.0) as advance:
        for number in range(arguments.first, arguments.first + arguments.cases):
            rng = np.random.default_rng(number)
            suffix = list(whole)[int(rng.integers(len(whole)))]
            data = damaged(rng, whole[suffix])
            try:
                readable += check(suffix, data, folder)
            except Exception:
                print(f"case {number}, {suffix}: {data[:300]!r}", file=sys.stderr)
                raise
            finally:
                (folder / f"sample{suffix}").write_bytes(whole[suffix])  # others may need it beside them
            advance(1)
    print(f"{arguments.cases:,} damaged files: {readable:,} read as maps, the others refused")


def guided(seconds: int, folder: Path) -> None:
    """Let atheris look for inputs; it ends the process."""
    try:
        import atheris
    except ImportError:
        raise MissingExtraError("atheris", "fuzz") from None
    with atheris.instrument_imports(include=["antgym.maps"]):
        import antgym.maps.readers  # noqa: F401 - instrumented as it is imported
    whole = samples(folder)
    corpus = folder / "corpus"
    corpus.mkdir()
    for i, (suffix, data) in enumerate(whole.items()):
        (folder / f"sample{suffix}").write_bytes(data)
        (corpus / suffix.strip(".")).write_bytes(bytes([i]) + data)

    def one(data: bytes) -> None:
        if data:
            suffix = list(whole)[data[0] % len(whole)]
            check(suffix, data[1:], folder)
            (folder / f"sample{suffix}").write_bytes(whole[suffix])

    atheris.Setup([sys.argv[0], f"-max_total_time={seconds}", "-max_len=4096", str(corpus)], one)
    atheris.Fuzz()


def run(arguments: Arguments) -> None:
    """Fuzz as asked."""
    with tempfile.TemporaryDirectory() as name:
        if arguments.guided:
            guided(arguments.guided, Path(name))
        else:
            blind(arguments, Path(name))


if __name__ == "__main__":
    main(lambda: run(parse(Arguments, None, "python -m experiments.map_fuzz")))
