"""What a harness and the process of a stranger's agent tell each other: JSON objects, one a line, and nothing else.

Numbers and text come back as they went, to the bit; nothing that arrives is ever unpickled or run.
"""

import json
import socket
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antgym.tuning import Parameter, ParameterSpace, Task, Trial

MOST_BYTES = 1 << 22  # of a line: some 50,000 settings, of which budgets pay for a few thousand
_PART = 1 << 16


class Line:
    """A connected socket that carries one JSON object a line.

    Args:
        ends_here: the socket; this object closes it.
    """

    def __init__(self, ends_here: socket.socket) -> None:
        self._socket, self._buffer = ends_here, bytearray()

    def send(self, message: dict[str, Any], deadline: float | None = None) -> None:
        """Send; TimeoutError where the other end does not take it until a moment of the monotonic clock."""
        self._socket.settimeout(_seconds_to(deadline))
        self._socket.sendall(json.dumps(message, separators=(",", ":")).encode() + b"\n")

    def receive(self, deadline: float | None = None) -> dict[str, Any]:
        """Return the next object.

        Raises:
            TimeoutError: where none has come until a moment of the monotonic clock.
            EOFError: where the other end is closed.
            ValueError: on what is no JSON object, or longer than ``MOST_BYTES``.
        """
        seen = 0
        while (end := self._buffer.find(b"\n", seen)) < 0:
            seen = len(self._buffer)
            if seen > MOST_BYTES:
                raise ValueError(f"more than {MOST_BYTES:,} bytes in one message")
            self._socket.settimeout(_seconds_to(deadline))
            part = self._socket.recv(_PART)
            if not part:
                raise EOFError
            self._buffer += part
        data = bytes(self._buffer[:end])
        del self._buffer[: end + 1]
        return _object(data)

    def close(self) -> None:
        """Close this end."""
        self._socket.close()


def _seconds_to(deadline: float | None) -> float | None:
    if deadline is None:
        return None
    left = deadline - time.monotonic()
    if left <= 0:
        raise TimeoutError
    return left


def _object(data: bytes) -> dict[str, Any]:
    try:
        message = json.loads(data)
    except RecursionError:
        raise ValueError("JSON that is nested too deeply") from None
    if not isinstance(message, dict):
        raise ValueError("JSON that is no object")
    return message


def pack_task(task: Task) -> dict[str, Any]:
    """Return a task as JSON, without its map, which is drawn when it is asked for."""
    return {
        "space": [list(parameter) for parameter in task.space.parameters],
        "features": task.features.tolist(),
        "ants": task.ants,
        "iterations": task.iterations,
        "budget": task.budget,
    }


def unpack_task(fields: dict[str, Any], chart: Callable[[bool | None], NDArray[np.float32]]) -> Task:
    """Return the task of :func:`pack_task`; ``chart`` fetches its map."""
    space = ParameterSpace(tuple(Parameter(*parameter) for parameter in fields["space"]))
    features = np.array(fields["features"], np.float32)

    def draw(flat: bool | None = None) -> NDArray[np.float32]:
        return chart(flat)

    return Task(space, features, fields["ants"], fields["iterations"], fields["budget"], draw)


def pack_trials(trials: Sequence[Trial]) -> list[list[Any]]:
    """Return trials as JSON."""
    return [list(trial) for trial in trials]


def unpack_trials(rows: Sequence[Sequence[Any]]) -> tuple[Trial, ...]:
    """Return the trials of :func:`pack_trials`."""
    return tuple(Trial(index, tuple(unit), cost, work) for index, unit, cost, work in rows)


def pack_array(array: Any) -> dict[str, Any]:
    """Return what an array holds as JSON; it may be infinite or no number at all, which JSON in Python can say.

    Raises:
        TypeError, ValueError: where it cannot be read as an array of float64.
    """
    values = np.asarray(array, dtype=np.float64)
    return {"shape": list(values.shape), "values": values.ravel().tolist()}


def unpack_array(fields: dict[str, Any]) -> NDArray[np.float64]:
    """Return the array of :func:`pack_array`, float64.

    Raises:
        TypeError, ValueError, KeyError, OverflowError: where these are no fields of one.
    """
    shape, values = fields["shape"], fields["values"]
    if not all(type(n) is int and n >= 0 for n in shape) or not all(type(v) in (int, float) for v in values):
        raise TypeError("no sizes and numbers")
    return np.array(values, dtype=np.float64).reshape(shape)
