"""The compiled cache: never stale, never in the way of the user's own functions."""

import importlib.util
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from antgym import kernels

SOURCES = sorted(path.name for path in Path(kernels.__file__).parent.glob("*.py"))


def hash_of(folder):
    """What the package copied to a folder says its sources' hash is."""
    spec = importlib.util.spec_from_file_location("copied_kernels", folder / "__init__.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.sources_hash()


def python(script, **environment):
    done = subprocess.run(
        [sys.executable, "-c", script],
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.fixture
def copied(tmp_path):
    return Path(shutil.copytree(Path(kernels.__file__).parent, tmp_path / "kernels"))


def test_a_copy_of_the_sources_has_the_same_hash(copied):
    assert hash_of(copied) == kernels.sources_hash()


@pytest.mark.parametrize("name", SOURCES)
def test_an_edit_of_any_source_changes_the_hash(copied, name):
    """Numba itself would not notice an edit of a function that another file's kernel calls."""
    (copied / name).write_text((copied / name).read_text() + "# edited\n")
    assert hash_of(copied) != kernels.sources_hash()


def test_a_new_or_renamed_source_changes_the_hash(copied):
    (copied / "wasps.py").write_text("")
    with_wasps = hash_of(copied)
    (copied / "wasps.py").rename(copied / "hornets.py")
    assert len({with_wasps, hash_of(copied), kernels.sources_hash()}) == 3


def test_importing_the_kernels_leaves_the_users_cache_folder_alone(tmp_path):
    script = (
        "import json, numba\nbefore = numba.config.CACHE_DIR\nimport antgym.kernels.ants, antgym.kernels.paths\n"
        "print(json.dumps([before, numba.config.CACHE_DIR]))"
    )
    assert python(script, NUMBA_CACHE_DIR=str(tmp_path)) == [str(tmp_path)] * 2


COMPILE = """
import json
from conftest import random_scenario
from antgym.kernels import paths
from antgym.maps.motion import Motion
scenario = random_scenario(0)
_ = scenario.optimum, scenario.with_motion(Motion("grid26")).optimum
found = (paths.layered_distances, paths.grid_search)
print(json.dumps([[sum(f.stats.cache_hits.values()), sum(f.stats.cache_misses.values())] for f in found]))
"""


@pytest.mark.slow
def test_a_second_process_compiles_nothing(tmp_path):
    environment = {"NUMBA_CACHE_DIR": str(tmp_path), "PYTHONPATH": str(Path(__file__).parents[1])}
    assert python(COMPILE, **environment) == [[0, 1]] * 2
    assert [folder.name for folder in tmp_path.iterdir()] == [f"kernels-{kernels.sources_hash()}"]
    assert python(COMPILE, **environment) == [[1, 0]] * 2
