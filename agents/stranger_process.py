"""The process of a stranger's agent: it holds tasks, trials and the agent, and nothing of the harness.

``python -m agents.stranger_process FD`` is a nursery: it imports what agents may import, once, and at every order on
its socket forks a process that does. An agent sees no run but its own: each begins in a process of its own.

This keeps honest agents honest and mishaps apart; it is no sandbox. Whoever wants to break out of Python can: run the
files of people you do not trust on a machine that has nothing to lose.
"""

import json
import os
import resource
import signal
import socket
import sys
from collections.abc import Sequence
from contextlib import suppress
from importlib.abc import MetaPathFinder
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Any

from agents.messages import Line, pack_array, unpack_array, unpack_task, unpack_trials
from antgym.errors import AgentError

OPEN = ("antgym", "antgym.errors", "antgym.tuning", "antgym.envs", "antgym.envs.extractors")
"""What an agent may import of antgym."""
_ORDER = 1 << 12  # bytes of an order to the nursery


class Guard(MetaPathFinder):
    """Refuses the import of what an agent may not use, with the reason: trials are asked for, not helped oneself to."""

    def find_spec(
        self,
        fullname: str,
        path: Sequence[str] | None,  # noqa: ARG002 - the import system hands it over
        target: ModuleType | None = None,  # noqa: ARG002 - likewise
    ) -> None:
        """Raise AgentError for a module of the harness; else let others find it."""
        if _closed(fullname):
            raise AgentError(
                f"an agent may not import {fullname}: planner runs are asked for and paid for; "
                f"open are {', '.join(OPEN[1:])}"
            )


def _closed(name: str) -> bool:
    root = name.partition(".")[0]
    return root == "experiments" or (root == "antgym" and name not in OPEN)


def stand_guard() -> None:
    """Forget what of the harness is imported already, and refuse to import it again."""
    for name in [name for name in sys.modules if _closed(name)]:
        package, _, attribute = name.rpartition(".")
        if package in sys.modules:
            vars(sys.modules[package]).pop(attribute, None)
        del sys.modules[name]
    sys.meta_path.insert(0, Guard())


def nurse(control: socket.socket) -> None:
    """Fork a process for every socket that comes in, end those that are named, until the harness is gone."""
    living: set[int] = set()
    try:
        while True:
            data, sockets, _, _ = socket.recv_fds(control, _ORDER, 1)
            if not data:
                return
            order = json.loads(data)
            if sockets:
                pid = _fork(control, sockets[0], order["memory"])
                living.add(pid)
                answer: dict[str, Any] = {"pid": pid}
            else:
                living.discard(order["pid"])
                answer = _end(order["pid"])
            control.sendall(json.dumps(answer).encode())
    finally:
        for pid in living:
            _end(pid)


def _fork(control: socket.socket, end: int, memory: int) -> int:
    pid = os.fork()
    if pid:
        os.close(end)
        _lead(pid)
        return pid
    try:
        control.close()
        _lead(0)
        resource.setrlimit(resource.RLIMIT_DATA, (memory, memory))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        serve(Line(socket.socket(fileno=end)))
    finally:
        os._exit(0)


def _lead(pid: int) -> None:
    """Make a process the leader of its group, as the other side of the fork does too: whoever comes first."""
    with suppress(ProcessLookupError, PermissionError):  # the other side did, and has moved on
        os.setpgid(pid, pid)


def _end(pid: int) -> dict[str, Any]:
    """Kill a process and what it started; return its exit code and the CPU seconds that it used."""
    with suppress(ProcessLookupError, PermissionError):  # it is over already
        os.killpg(pid, signal.SIGKILL)
    _, status, used = os.wait4(pid, 0)
    return {"code": os.waitstatus_to_exitcode(status), "cpu": used.ru_utime + used.ru_stime}


def serve(line: Line) -> None:
    """Do what comes in until the harness closes its end."""
    stand_guard()
    desk = Desk(line)
    while True:
        try:
            message = line.receive()
        except EOFError:
            return
        try:
            answer = desk.answer(message)
        except BaseException as error:  # SystemExit too is an answer
            answer = {"error": f"{type(error).__name__}: {error}"}
        line.send(answer)


class Desk:
    """One agent, and the calls that reach it."""

    def __init__(self, line: Line) -> None:
        self._line = line
        self._agent: Any = None

    def answer(self, message: dict[str, Any]) -> dict[str, Any]:
        """Make the call that a message asks for and return what it answers."""
        match message["call"]:
            case "make":
                self._agent = load_class(Path(message["file"]), message["kind"])()
            case "reset":
                self._agent.reset(unpack_task(message["task"], self._chart), seed=message["seed"])
            case "tell":
                self._agent.tell(unpack_trials(message["trials"]))
            case "ask" | "recommend" as name:
                return pack_array(getattr(self._agent, name)())
        return {}

    def _chart(self, flat: bool | None) -> Any:
        self._line.send({"map": None if flat is None else bool(flat)})
        return unpack_array(self._line.receive()).astype("float32")


def load_class(file: Path, kind: str) -> Any:
    """Run a stranger's file and return its class; files beside it can be imported."""
    sys.path.append(str(file.parent))
    spec = spec_from_file_location(
        "stranger", file
    )  # whatever the file is called, it takes no other module's place
    assert spec is not None
    assert spec.loader is not None
    module = sys.modules["stranger"] = module_from_spec(spec)
    spec.loader.exec_module(module)
    return getattr(module, kind)


if __name__ == "__main__":
    os.dup2(2, 1)  # what an agent prints is no answer, and no result of the harness
    nurse(socket.socket(fileno=int(sys.argv[1])))
