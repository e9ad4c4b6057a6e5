"""Agents see only what an agent may see: the public names of ``antgym.tuning`` and the errors."""

import ast
from pathlib import Path

import pytest

import agents
import antgym.tuning

FILES = sorted(Path(agents.__file__).parent.glob("*.py"))
LIBRARIES = {
    "cmaes",
    "gymnasium",
    "matplotlib",
    "numpy",
    "optuna",
    "pymoo",
    "safetensors",
    "scipy",
    "sklearn",
    "stable_baselines3",
    "torch",
}


def _imports(path):
    """(module, names) of every import in a file; names is None for a plain import."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from ((alias.name, None) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path.name}: relative import"
            yield node.module, [alias.name for alias in node.names]


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_agents_import_only_public_names_of_tuning(path):
    for module, names in _imports(path):
        if module.split(".")[0] == "antgym":
            assert module in ("antgym.tuning", "antgym.errors")
            assert names is not None
            if module == "antgym.tuning":
                assert set(names) <= set(antgym.tuning.__all__)


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_agents_import_no_other_library(path):
    import sys

    roots = {module.split(".")[0] for module, _ in _imports(path)}
    assert roots <= LIBRARIES | {"agents", "antgym"} | set(sys.stdlib_module_names)


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_heavy_libraries_are_imported_inside_functions(path):
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Import | ast.ImportFrom):
            module = node.names[0].name if isinstance(node, ast.Import) else node.module
            assert module.split(".")[0] not in LIBRARIES - {"numpy"}
