"""Every fenced block of README.md and docs/ runs: what we tell people to type must work.

A Python block runs alone, in a fresh process in the repository's root. A shell block runs line by line, its
``&&`` parts apart: what makes an environment or runs the tests is CI's own work and is left out, presets shrink to
``smoke`` and trainings to a few updates, and ``out/`` becomes a temporary folder. A block after ``<!-- long -->`` is
only parsed.
"""

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pytest

ROOT = Path(__file__).parents[1]
SHELL = ("sh", "bash", "console")
LONG = "<!-- long -->"
CI_DOES = ("-m venv ", "pip install ", "git clone ", "cd ", "-m pytest")
RUN_STDIN = "import sys; exec(compile(sys.stdin.read(), sys.argv[1], 'exec'))"
SECONDS = 240


class Block(NamedTuple):
    """A fenced block: its file, the number of its first line, its language, its text, and whether it is long."""

    file: str
    line: int
    language: str
    text: str
    long: bool

    def __str__(self):
        return f"{self.file}:{self.line}"


def blocks(text, file):
    """Yield the fenced blocks of a Markdown text."""
    lines = text.splitlines()
    i = 0
    while i < len(lines):
        if lines[i].startswith("```"):
            end = lines.index("```", i + 1)
            body = "\n".join(lines[i + 1 : end]) + "\n"
            yield Block(file, i + 2, lines[i][3:].strip(), body, i > 0 and lines[i - 1].strip() == LONG)
            i = end
        i += 1


def commands(text, out):
    """Yield what of a shell block is run here, its output folders under ``out``."""
    for line in text.replace("\\\n", " ").splitlines():
        for part in line.removeprefix("$ ").split(" && "):
            command = part.strip()
            if command and not command.startswith("#") and not any(words in command for words in CI_DOES):
                command = re.sub(r"^(\.venv/bin/)?python3? ", f"{sys.executable} ", command)
                command = re.sub(r"^(\.venv/bin/)?antgym ", f"{sys.executable} -m antgym.cli ", command)
                command = re.sub(r"--preset \w+", "--preset smoke", command)
                command = re.sub(r"--evaluations \d+", "--evaluations 1024", command)
                yield re.sub(r"\bout/", f"{out}/", command)


def run(command, name, text=None):
    done = subprocess.run(
        command,
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": ""},
        input=text,
        capture_output=True,
        text=True,
        check=False,
        timeout=SECONDS,
    )
    if done.returncode:
        pytest.fail(f"{name} fails\n{done.stdout[-1500:]}\n{done.stderr[-3000:]}", pytrace=False)


FILES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("**/*.md"))]
BLOCKS = [b for f in FILES for b in blocks(f.read_text(encoding="utf-8"), str(f.relative_to(ROOT)))]
PYTHON = [b for b in BLOCKS if b.language == "python"]
SHORT = [b for b in BLOCKS if b.language in SHELL and not b.long]


def test_every_block_says_what_it_is():
    """A block without a language that is known here would silently not be tested."""
    assert [str(b) for b in BLOCKS if b.language not in ("python", "text", *SHELL)] == []


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.name)
def test_what_is_linked_to_is_there(file):
    """Files beside the text, and headings as GitHub names them."""
    for path, heading in re.findall(
        r"\]\((?!https?:)([^)#]*)(?:#([^)]*))?\)", file.read_text(encoding="utf-8")
    ):
        target = file.parent / path if path else file
        assert target.exists(), f"{file.name} links to {path}"
        if heading:
            titles = re.findall(r"^#+ (.*)$", target.read_text(encoding="utf-8"), flags=re.MULTILINE)
            assert heading in [re.sub(r"[^\w -]", "", title).lower().replace(" ", "-") for title in titles]


@pytest.mark.parametrize("block", [b for b in BLOCKS if b.language in ("python", *SHELL)], ids=str)
def test_block_parses(block):
    if block.language == "python":
        compile("\n" * (block.line - 1) + block.text, block.file, "exec")
    else:
        text = re.sub(r"^\$ ", "", block.text, flags=re.MULTILINE)
        run(["bash", "-n"], str(block), text)


@pytest.mark.readme
@pytest.mark.parametrize("block", [b for b in PYTHON if not b.long], ids=str)
def test_python_block_runs(block):
    """Blank lines stand in for what precedes the block, so that a traceback names the file's own lines."""
    padded = "\n" * (block.line - 1) + block.text
    run([sys.executable, "-c", RUN_STDIN, block.file], str(block), padded)


@pytest.mark.readme
@pytest.mark.parametrize("block", SHORT, ids=str)
def test_shell_block_runs(block, tmp_path):
    for command in commands(block.text, tmp_path):
        run(["bash", "-euo", "pipefail", "-c", command], f"{block}: {command}")


def test_set_up_is_left_out_and_the_rest_is_made_small():
    line = "$ python3 -m venv .venv && .venv/bin/pip install -e . && .venv/bin/python -m a --preset quick --out out/b\n"
    assert list(commands(line, "/tmp")) == [f"{sys.executable} -m a --preset smoke --out /tmp/b"]
    long = list(commands(".venv/bin/python -m b --evaluations 8192 --out out/c\n", "/tmp"))
    assert long == [f"{sys.executable} -m b --evaluations 1024 --out /tmp/c"]


def test_the_console_script_is_run_as_a_module():
    assert list(commands(".venv/bin/antgym envs\n", "/tmp")) == [f"{sys.executable} -m antgym.cli envs"]


def test_a_long_block_and_its_line_are_noticed():
    found = list(blocks(f"text\n{LONG}\n```sh\nsleep 9\n```\n\n```python\n1\n```\n", "a.md"))
    assert [(b.line, b.language, b.long) for b in found] == [(4, "sh", True), (8, "python", False)]
