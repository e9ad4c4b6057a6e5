"""What every script's terminal face shares: a progress bar, errors as one line, files written as a whole."""

import io
import os
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, redirect_stderr
from pathlib import Path
from typing import Any, Protocol

from antgym.errors import AntgymError

BROKEN_PIPE = 141
PATIENCE = 2.0  # seconds that a script may work without a bar
RESUMES = "interrupted; the same command goes on where this one stopped"
_BOX = "╭╮╰╯│─"
_NUMBERS = 28  # columns of a terminal that a bar and its numbers need beside their title


class Advance(Protocol):
    """What moves a bar on by some steps, and says something else beside it where there is something to say."""

    def __call__(self, steps: int, title: str | None = None) -> None:
        """Move on."""
        ...


@contextmanager
def progress(title: str, total: int | None, after: float = 0.0) -> Iterator[Advance]:
    """Show a bar on stderr while the block runs; yields the function that advances it. No total: it pulses.

    Args:
        title: what is being done.
        total: steps in all.
        after: seconds to wait before the bar is shown; a block that ends sooner shows none.
    """
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
    from rich.table import Column

    console = Console(stderr=True)
    # where there is no room for all, the bar is shorter, and then the title, but no number
    words = Column(no_wrap=True, overflow="ellipsis", max_width=max(console.width - _NUMBERS, 1))
    counted, left = Column(no_wrap=True), Column(no_wrap=True)
    columns = (
        TextColumn("{task.description}", table_column=words),
        BarColumn(),
        MofNCompleteColumn(table_column=counted),
        TimeRemainingColumn(table_column=left),
    )
    bar, begun, shown = Progress(*columns, console=console), time.monotonic(), False
    task = bar.add_task(title, total=total)

    def advance(steps: int, title: str | None = None) -> None:
        nonlocal shown
        if not shown and time.monotonic() - begun >= after:
            bar.start()
            shown = True
        bar.update(task, advance=steps, description=title)

    advance(0)
    try:
        yield advance
    finally:
        if shown:
            bar.stop()


def main(script: Callable[[], None], interrupted: str = RESUMES) -> None:
    """Run a script: an AntgymError is one line and exit code 2, Ctrl-C the words of ``interrupted`` and 130.

    Where who reads the output has gone, as ``head`` does once it has its lines, the script ends without a word and with
    141, which is what a shell says of other tools then.
    """
    try:
        try:
            script()
        except AntgymError as error:
            print(f"error: {' '.join(str(error).split())}", file=sys.stderr)
            sys.exit(2)
        except KeyboardInterrupt:
            print(interrupted, file=sys.stderr)
            sys.exit(130)
        finally:
            sys.stdout.flush()
    except (BrokenPipeError, SystemExit) as error:
        # rich makes a SystemExit of it
        if not isinstance(error, BrokenPipeError) and not isinstance(error.__context__, BrokenPipeError):
            raise
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # Python flushes once more as it ends
        sys.exit(BROKEN_PIPE)


def parse(kind: Any, arguments: Sequence[str] | None, prog: str) -> Any:
    """Let tyro read a command line; what is wrong with it is one line, as every other error is.

    Raises:
        AntgymError: if the arguments cannot be used, with tyro's own words.
        SystemExit: after ``--help``.
    """
    import tyro

    said = io.StringIO()
    try:
        with redirect_stderr(said):
            return tyro.cli(kind, args=arguments, prog=prog)
    except SystemExit as exit_:
        if exit_.code in (None, 0):
            raise
        raise AntgymError(_first_words(said.getvalue(), prog)) from None


def write_whole(path: Path, data: bytes) -> None:
    """Write a file that is either there as a whole or not at all; its folder is made.

    Raises:
        AntgymError: if it cannot be written.
    """
    scratch = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            scratch.write_bytes(data)
            os.replace(scratch, path)
        finally:
            scratch.unlink(missing_ok=True)
    except OSError as error:
        raise AntgymError(f"{path} cannot be written: {error.strerror or error}") from None


def _first_words(box: str, prog: str) -> str:
    """Return what a box of tyro says above its first rule, as one line."""
    lines = [line.strip(_BOX + " ") for line in box.splitlines()[1:]]
    words = " ".join(lines[: lines.index("")] if "" in lines else lines).split()
    return f"{' '.join(words) or 'the arguments cannot be used'} (see {prog} --help)"
