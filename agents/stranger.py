"""Agents of strangers: a class in a Python file, played in a process of its own behind the protocol of all agents.

``agents.make("path/to/my_agent.py:MyAgent")`` returns one, so it can be named wherever an agent is. Its process sees
what an agent sees, a task and its trials, and has no session, ledger or planner to reach for. What it answers is
checked here; whatever is wrong with it is an :class:`antgym.errors.AgentError`, and ends that run alone.
"""

import ast
import re
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from agents.messages import Line, pack_array, pack_task, pack_trials, unpack_array
from agents.nursery import Child, start
from antgym.errors import AgentError, ParameterError, nearest
from antgym.tuning import Task, Trial

Floats = NDArray[np.float64]
CALL_SECONDS = 60.0  # of one call, the import of torch on a busy machine among them
MOST_HANGS = 3  # of an agent and its copies; a board of a thousand runs would wait for days
MEMORY = 4 << 30  # bytes
_SAID = 300  # characters of what a stranger says


class Stranger:
    """An agent of a file, in a process that begins with every task and ends with :meth:`close` or with this object.

    Args:
        file: Python, run in the process alone.
        kind: name of its class, which is made without arguments.
        seconds: that one call may take; then it counts as hung, and its process is ended.
        memory: bytes that its process may use.

    Attributes:
        cpu: seconds of CPU time that its processes have used, in calls and between them; counted as they end.
    """

    _child: Child | None = None

    def __init__(
        self, file: str | Path, kind: str, *, seconds: float = CALL_SECONDS, memory: int = MEMORY
    ) -> None:
        self.file, self.kind = Path(file).resolve(), kind
        self.seconds, self.memory = seconds, memory
        self.cpu = 0.0
        self._hung: list[str] = []

    def __copy__(self) -> "Stranger":
        """Return the same agent without a process: nobody shares one, but how often it hung is known to all."""
        other = Stranger(self.file, self.kind, seconds=self.seconds, memory=self.memory)
        other._hung = self._hung
        return other

    def __del__(self) -> None:
        self.close()

    @property
    def name(self) -> str:
        """File and class, as messages name it."""
        return f"{self.file.name}:{self.kind}"

    def reset(self, task: Task, *, seed: int) -> None:
        """Begin a process, load the file in it, and hand over the task."""
        self.close()
        self._require_patience("reset")
        self._task, self._child = task, start(self.memory)
        self._call("make", file=str(self.file), kind=self.kind)
        self._call("reset", task=pack_task(task), seed=seed)

    def ask(self) -> Floats:
        """Return the next settings, (k, d)."""
        units = self._settings("ask")
        return units if units.size else np.empty((0, len(self._task.space)))

    def tell(self, trials: Sequence[Trial]) -> None:
        """Pass trials on."""
        self._call("tell", trials=pack_trials(trials))

    def recommend(self) -> Floats:
        """Return the setting, (d,)."""
        units = self._settings("recommend")
        if len(units) != 1:
            self._fail("recommend", f"answered {len(units)} settings where one is due")
        return np.array(units[0])

    def close(self) -> str:
        """End the process; return how it ended, in words."""
        if self._child is None:
            return "it had none"
        ended, self._child = self._child.end(), None
        self.cpu += ended.cpu
        return f"signal {-ended.code}" if ended.code < 0 else f"exit status {ended.code}"

    def _settings(self, name: str) -> Floats:
        answer = self._call(name)
        try:
            array = unpack_array(answer)
        except (TypeError, ValueError, KeyError, OverflowError):
            self._fail(name, "answered what is no array of numbers")
        try:
            return self._task.space.check(array) if array.size else array
        except ParameterError as error:
            self._fail(name, f"answered what cannot be run: {error}")

    def _call(self, name: str, **given: Any) -> dict[str, Any]:
        if self._child is None:
            self._fail(name, "has no process; reset it first")
        self._require_patience(name)
        try:
            answer = self._converse(self._child.line, {"call": name, **given})
        except TimeoutError:
            self._hung.append(name)
            self._fail(name, f"hung: no answer within {self.seconds:g} s, so it was stopped")
        except (EOFError, OSError):
            self._fail(name, f"ended its process ({self.close()})")
        except ValueError as error:
            self._fail(name, f"answered what cannot be read: {error}")
        if "error" in answer:
            self._fail(name, f"raised {answer['error']}")
        return answer

    def _require_patience(self, name: str) -> None:
        if len(self._hung) >= MOST_HANGS:
            self._fail(name, f"was not called: it hung before, {len(self._hung)} times")

    def _converse(self, line: Line, message: dict[str, Any]) -> dict[str, Any]:
        """Send a call and return its answer; a map that the agent looks at meanwhile is handed over."""
        deadline = time.monotonic() + self.seconds
        line.send(message, deadline)
        while "map" in (answer := line.receive(deadline)):
            flat = answer["map"]
            line.send(pack_array(self._task.map(flat if flat is None else bool(flat))), deadline)
        return answer

    def _fail(self, call: str, what: str) -> NoReturn:
        self.close()
        raise AgentError(f"{self.name}: {call}() {harmless(what)}")


def harmless(text: str) -> str:
    """Return what a stranger says as one line that a terminal can show, cut, without the addresses of a single run."""
    line = "".join(c if c.isprintable() else " " for c in re.sub(r"\b0x[0-9a-f]{6,}", "0x…", text))
    return line if len(line) <= _SAID else line[: _SAID - 1] + "…"


def find_class(name: str) -> tuple[Path, str, str]:
    """Return file, class and summary of ``path/to/file.py:ClassName``; the file is parsed and not run.

    Raises:
        ParameterError: where there is no such file, it is no Python, or it has no such class.
    """
    path, _, kind = name.rpartition(":") if name.count(":") else (name, "", "")
    file = Path(path)
    try:
        tree = ast.parse(file.read_bytes())
    except OSError as error:
        raise ParameterError(f"agent {name!r}: {file} cannot be read ({error.strerror})") from None
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise ParameterError(f"agent {name!r}: {file} is no Python ({harmless(str(error))})") from None
    classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
    if kind not in classes:
        known = tuple(classes)
        hint = nearest(kind, known) if known else "it defines no class"
        raise ParameterError(f"agent {name!r}: {file} has no class {kind!r}; {hint}")
    said = (ast.get_docstring(classes[kind]) or "").partition("\n")[0]
    return file, kind, harmless(said) or "an agent from a file"
