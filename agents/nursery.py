"""The nursery as the harness sees it: processes for strangers' agents, started quickly and ended for good."""

import atexit
import json
import os
import signal
import socket
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from threading import Lock, RLock
from typing import Any, NamedTuple

from agents.messages import Line
from antgym.errors import AntgymError

_ANSWER = 1 << 12  # bytes
_SECONDS = 60.0  # for an order: the first waits until everything is imported
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS")


class Ended(NamedTuple):
    """How a process ended: its exit code, minus the signal where one killed it, and its CPU seconds."""

    code: int
    cpu: float


class Child(NamedTuple):
    """A process for one agent on one task: the line to it, and its number in its nursery."""

    line: Line
    pid: int
    nursery: "Nursery"

    def end(self) -> Ended:
        """Kill it, and what it started."""
        self.line.close()
        return self.nursery.end(self.pid)


class Nursery:
    """A process that has imported what agents may import, and forks: a start takes milliseconds, not a second."""

    def __init__(self) -> None:
        self._lock = RLock()  # reentrant: the garbage collector may end a child at any moment
        self._control, theirs = socket.socketpair()
        self._control.settimeout(_SECONDS)
        root = Path(__file__).parents[1]
        paths = os.pathsep.join([str(root), *filter(None, [os.environ.get("PYTHONPATH")])])
        with theirs:
            self._process = subprocess.Popen(
                [sys.executable, "-P", "-m", "agents.stranger_process", str(theirs.fileno())],
                pass_fds=[theirs.fileno()],
                stdin=subprocess.DEVNULL,
                env={**os.environ, "PYTHONPATH": paths, **dict.fromkeys(_THREADS, "1")},
                start_new_session=True,  # Ctrl-C is the harness's; the nursery goes when the harness has gone
            )

    @property
    def open(self) -> bool:
        """Whether it still runs; a stranger may have ended it."""
        return self._process.poll() is None

    def start(self, memory: int) -> Child:
        """Start a process that may use so many bytes of memory; EOFError where the nursery is gone."""
        ours, theirs = socket.socketpair()
        with theirs:
            try:
                return Child(Line(ours), self._order({"memory": memory}, theirs.fileno())["pid"], self)
            except EOFError:
                ours.close()
                raise

    def end(self, pid: int) -> Ended:
        """End a process; what it used is unknown, 0, where the nursery is gone."""
        if self._control.fileno() < 0:  # closed, and all its processes with it
            return Ended(-signal.SIGKILL, 0.0)
        try:
            return Ended(**self._order({"pid": pid}))
        except EOFError:
            with suppress(ProcessLookupError, PermissionError):
                os.killpg(pid, signal.SIGKILL)
            return Ended(-signal.SIGKILL, 0.0)

    def close(self) -> None:
        """End the nursery, and with it every process of its."""
        self._control.close()
        self._process.wait()

    def _order(self, order: dict[str, int], *handles: int) -> Any:
        try:
            with self._lock:  # answers come in the order of the orders; threads share the nursery
                socket.send_fds(self._control, [json.dumps(order).encode()], handles)
                answer = self._control.recv(_ANSWER)
        except OSError:
            answer = b""
        if not answer:
            self._process.kill()
            self._process.wait()
            raise EOFError
        return json.loads(answer)


_NURSERIES: dict[int, Nursery] = {}  # by process: one that was forked needs its own
_LOCK = Lock()  # of threads that want the first


def nursery() -> Nursery:
    """Return this process's nursery, a new one where it has none that runs."""
    here = os.getpid()
    with _LOCK:
        if here not in _NURSERIES or not _NURSERIES[here].open:
            _NURSERIES[here] = Nursery()
            atexit.register(_NURSERIES[here].close)
        return _NURSERIES[here]


def start(memory: int) -> Child:
    """Start a process that may use so many bytes of memory; a nursery that a stranger has ended is replaced.

    Raises:
        AntgymError: where the new one ends as well, which is then no stranger's doing.
    """
    for _ in range(2):
        with suppress(EOFError):
            return nursery().start(memory)
    raise AntgymError("the process for agents of files cannot be started; what it said is above")
