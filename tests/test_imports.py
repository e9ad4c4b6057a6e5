"""Who imports what: heavy libraries only on demand, layers only downwards, numba only in the kernels."""

import ast
import json
import subprocess
import sys
from importlib import import_module
from itertools import pairwise
from pathlib import Path

import pytest

import antgym
from antgym.errors import AntgymError

ROOT = Path(antgym.__file__).parent
FILES = sorted(path.relative_to(ROOT) for path in ROOT.rglob("*.py"))
LAYERS = ("kernels", "maps", "planners", "tuning", "envs")
HEAVY = ("torch", "optuna", "matplotlib", "pymoo", "stable_baselines3", "numba", "scipy")
TORCH = (Path("envs/sb3.py"), Path("envs/changing.py"), Path("envs/extractors.py"))


def imports(file):
    """Every module that a file imports, anywhere in it; ``from a import b`` counts as a and as a.b."""
    for node in ast.walk(ast.parse((ROOT / file).read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{file}: relative import"
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def python(script):
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", script], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_importing_antgym_imports_nothing_heavy():
    script = f"import antgym, json, sys; print(json.dumps([name for name in {HEAVY} if name in sys.modules]))"
    assert python(script) == []


def test_importing_antgym_registers_every_environment():
    script = (
        "import gymnasium, json; before = set(gymnasium.registry); import antgym\n"
        "print(json.dumps(sorted(set(gymnasium.registry) - before)))"
    )
    from antgym.envs.catalogue import CATALOGUE

    assert python(script) == sorted(entry.id for entry in CATALOGUE)


@pytest.mark.parametrize("file", FILES, ids=str)
def test_the_package_imports_neither_agents_nor_their_libraries(file):
    allowed = {"stable_baselines3", "torch"} if file in TORCH else set()
    roots = {module.split(".")[0] for module in imports(file)}
    assert not roots & (
        {"agents", "experiments", "tests", "torch", "optuna", "pymoo", "stable_baselines3"} - allowed
    )


@pytest.mark.parametrize("file", [f for f in FILES if f.parts[0] in LAYERS], ids=str)
def test_layers_import_only_what_lies_below_them(file):
    reachable = LAYERS[: LAYERS.index(file.parts[0]) + 1]
    for module in imports(file):
        root, *rest = module.split(".")
        if root == "antgym":
            assert rest, f"{file} imports antgym itself"
            assert rest[0] in (*reachable, "errors"), f"{file} imports {module}"


@pytest.mark.parametrize("file", [f for f in FILES if f.parts[0] == "robots"], ids=str)
def test_robots_take_paths_as_arrays_and_import_no_layer(file):
    ours = {module.split(".")[1] for module in imports(file) if module.startswith("antgym.")}
    assert ours <= {"errors", "robots"}


@pytest.mark.parametrize("file", [f for f in FILES if f.parts[0] == "kernels"], ids=str)
def test_kernels_import_nothing_of_antgym(file):
    for module in imports(file):
        assert not module.startswith("antgym") or module.startswith("antgym.kernels")


@pytest.mark.parametrize("file", [f for f in FILES if f.parts[0] != "kernels"], ids=str)
def test_numba_is_imported_in_the_kernels_alone(file):
    assert "numba" not in {module.split(".")[0] for module in imports(file)}


def test_every_public_name_resolves():
    for name in antgym.__all__:
        assert getattr(antgym, name) is not None
    assert set(antgym.__all__) <= set(dir(antgym))


def test_public_names_are_sorted_and_unique():
    assert all(one < other for one, other in pairwise(antgym.__all__))


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="module 'antgym' has no attribute 'plna'"):
        antgym.plna  # noqa: B018


def from_kernels(file):
    """(module, name) of whatever a file takes from the kernels, by ``from … import`` or off an imported module."""
    tree, modules = ast.parse(file.read_text(encoding="utf-8")), {}
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("antgym.kernels."):
            yield from ((node.module, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module == "antgym.kernels":
            modules |= {alias.name: f"antgym.kernels.{alias.name}" for alias in node.names}
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id in modules:
            yield modules[node.value.id], node.attr


def test_python_calls_only_kernels_that_have_a_way_to_be_called():
    """Any other ends the process: it was compiled without."""
    folders = [ROOT, *(ROOT.parent / name for name in ("agents", "experiments", "tests"))]
    files = [
        path for folder in folders for path in folder.rglob("*.py") if ROOT / "kernels" not in path.parents
    ]
    taken = {pair for file in files for pair in from_kernels(file)}
    options = {
        (module, name): getattr(getattr(import_module(module), name), "targetoptions", {})
        for module, name in taken
    }
    assert ("antgym.kernels.ants", "plan_range") in options
    assert ("antgym.kernels.floats", "log2") in options
    assert [pair for pair, given in options.items() if given.get("no_cpython_wrapper")] == []


def test_star_import_brings_the_public_names():
    script = "from antgym import *; import json; print(json.dumps(sorted(n for n in dir() if n[0] != '_')))"
    assert python(script) == sorted([*antgym.__all__, "json"])


def test_a_missing_library_is_one_line_with_its_cure():
    script = (
        "import json, sys; sys.modules['stable_baselines3'] = None\n"
        "try:\n    import antgym.envs.sb3\n"
        "except ImportError as error:\n    print(json.dumps([type(error).__name__, str(error)]))"
    )
    assert python(script) == [
        "MissingExtraError",
        'stable-baselines3 is not installed; mend it with: pip install "antgym[rl]"',
    ]


def test_all_our_errors_are_one_family():
    import antgym.errors

    kinds = [
        kind
        for kind in vars(antgym.errors).values()
        if isinstance(kind, type) and issubclass(kind, Exception)
    ]
    assert len(kinds) > 5
    assert all(issubclass(kind, AntgymError) for kind in kinds)
