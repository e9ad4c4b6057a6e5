"""Orders: which runs were asked of a ledger, and which of them broke off; beside what it holds, not part of it."""

from collections.abc import Iterable
from pathlib import Path

from antgym.console import write_whole
from antgym.tuning.lines import append, read_fields

ASKED, BROKEN = "asked.txt", "broken.jsonl"


def ask(folder: Path, keys: Iterable[str], *, anew: bool = False) -> None:
    """Note that runs are asked of a ledger, beside those of before; whoever calls holds the ledger open.

    Args:
        folder: of the ledger.
        keys: of the runs.
        anew: whether those of before do not count, nor why they broke off: they were of other settings, and none of
            them ran.
    """
    if anew:
        (folder / BROKEN).unlink(missing_ok=True)
    before = [] if anew else asked(folder)
    more = dict.fromkeys([*before, *keys])
    if anew or len(more) > len(before):
        write_whole(folder / ASKED, "".join(f"{key}\n" for key in more).encode())


def asked(folder: Path) -> list[str]:
    """Return the keys of the runs that were ever asked of a ledger; none where it does not say."""
    path = folder / ASKED
    return path.read_text(encoding="utf-8").splitlines() if path.exists() else []


def note_broken(folder: Path, keys: Iterable[str], reason: str) -> None:
    """Note that runs broke off, and why."""
    with (folder / BROKEN).open("a+b", buffering=0) as file:
        append(file, [{"run": key, "reason": reason} for key in keys])


def broken(folder: Path) -> dict[str, str]:
    """Return why runs broke off, by key: the last reason of each; the same run may have ended since."""
    return {line["run"]: line["reason"] for line in read_fields(folder / BROKEN, "run", "reason")}
