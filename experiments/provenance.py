"""Provenance: which code and which machine made a result, as what is kept of it says."""

import hashlib
import os
import platform
import subprocess
from collections.abc import Iterable
from importlib.metadata import version
from modulefinder import ModuleFinder
from pathlib import Path
from typing import Any

import agents
import antgym
from antgym.kernels import sources_hash
from antgym.planners.threads import thread_count

CONTEST = tuple(
    Path(__file__).with_name(f"{name}.py") for name in ("artefacts", "contest", "steering", "stopwatch")
)
"""The files of experiments that decide how a run of a contest goes: its seeds, its judging, its failures."""


def code_hash(*more: Path) -> str:
    """Return the hash of all code that decides a trial: what was begun with it goes on with nothing else.

    Args:
        more: files that decide this result beside those of antgym and agents.
    """
    root, digest = Path(__file__).parents[1], hashlib.sha256()
    paths = [
        path
        for folder in (Path(antgym.__file__).parent, root / "agents")
        for path in sorted(folder.rglob("*.py"))
    ]
    for path in (*paths, *more):
        digest.update(path.name.encode() + path.read_bytes())
    return digest.hexdigest()[:16]


def imported_beside(file: Path) -> list[Path]:
    """Return the files beside a Python file that it imports, as far as its text says so; nothing of it is run."""
    finder = ModuleFinder(path=[str(file.parent)])
    try:
        finder.run_script(str(file))
    except (OSError, SyntaxError, ValueError):
        return []  # nor can it be played, which is told there
    found = (getattr(module, "__file__", None) for module in finder.modules.values())
    return sorted({Path(path) for path in found if path} - {file})


def file_hash(path: Path) -> str:
    """Return the hash of a file's content, 16 hexadecimal digits."""
    return hashlib.sha256(path.read_bytes()).hexdigest()[:16]


def versions(names: Iterable[str]) -> dict[str, str]:
    """Return the versions that the results of some agents depend on."""
    found = {"antgym": antgym.__version__, "kernels": sources_hash(), "python": platform.python_version()}
    found.update({name: version(name) for name in ("gymnasium", "matplotlib", "numba", "scipy")})
    for name in names:
        found.update(agents.versions(name))
    return found


def facts() -> dict[str, Any]:
    """Return commit, CPU, cores and planner threads."""
    return {"commit": _commit(), "cpu": _cpu(), "cores": os.cpu_count(), "threads": thread_count()}


def _commit() -> str:
    here = Path(__file__).parent
    done = subprocess.run(
        ["git", "describe", "--always", "--dirty"], cwd=here, capture_output=True, text=True, check=False
    )
    return done.stdout.strip() or "no git checkout"


def _cpu() -> str:
    path = Path("/proc/cpuinfo")
    if path.exists():
        for line in path.read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()
