"""A board that comes to harm, again and again: run as a script, it prints what it saw as JSON.

It plays a small board once, to compare with, and to have everything imported and compiled. Then it forks children that
play the same board in other folders, and kills them, fills their disk, or sets two of them on one folder.
"""

import json
import os
import resource
import signal
import sys
import time
from pathlib import Path

import numpy as np

from antgym.console import main
from antgym.maps.suites import load_suite
from antgym.tuning.ledger import MANIFEST, TRIALS, Ledger
from experiments.contest import enter, jobs, play

AGENTS, MAPS, SEEDS, BUDGET, FRESH = ("random_search", "ga", "published_default"), 2, 2, 12, 2
KILLS, FULL, PAIRS = 20, 4, 3
LONGER = 1.5  # than before is a board let be that had no time to write
TORN = b'{"run":"ga/12/a line that the power'


def board(folder):
    items = load_suite("mountain-v0", "ood")[:MAPS]
    todo = list(jobs(enter(AGENTS, folder, {}), items, SEEDS, [BUDGET]))
    with Ledger(folder, {"maps": MAPS}, {}) as ledger:
        play(todo, ledger, FRESH, lambda _: None)


def child(folder, most=None):
    """Play the board in a process of its own that can write files of at most so many bytes; return its id."""
    pid = os.fork()
    if pid:
        return pid
    try:
        sys.stderr = (folder.parent / f"{folder.name}.{os.getpid()}").open("w")
        if most:
            resource.setrlimit(resource.RLIMIT_FSIZE, (most, resource.RLIM_INFINITY))
        main(lambda: board(folder))
        os._exit(0)
    except SystemExit as end:
        sys.stderr.close()
        os._exit(end.code)
    except BaseException:  # what is no AntgymError fails the test by its code
        os._exit(99)


def ended(pid, folder):
    """Wait for a child; return its exit code, or minus the signal that ended it, and what it said."""
    _, status = os.waitpid(pid, 0)
    signal.sigtimedwait([signal.SIGCHLD], 0)  # else it would end the next wait
    said = folder.parent / f"{folder.name}.{pid}"
    return os.waitstatus_to_exitcode(status), said.read_text() if said.exists() else ""


def whole_lines(folder):
    path = folder / TRIALS
    data = path.read_bytes() if path.exists() else b""
    return data[: data.rfind(b"\n") + 1].decode().splitlines()


def wait(seconds):
    """Wait so long, or until a child has ended."""
    signal.sigtimedwait([signal.SIGCHLD], seconds)


def kills(root, seconds, rng):
    """Kill boards at random moments, tear a line of every third; when one gets done, begin another.

    How long they are let be follows what they get done: machines are slower at one moment than at another.
    """
    seen, number = {"killed": 0, "lost": 0, "repeated": 0, "boards": [], "kept": [], "said": []}, 0
    longest = seconds / 2
    while seen["killed"] < KILLS:
        folder = root / f"killed-{number}"
        before = whole_lines(folder)
        pid = child(folder)
        wait(rng.uniform(0, longest))
        os.kill(pid, signal.SIGKILL)
        code, said = ended(pid, folder)
        after = whole_lines(folder)
        seen["lost"] += after[: len(before)] != before
        seen["said"] += [said] if "cut short" in said else []
        if code == 0:
            seen["boards"].append(sorted(after))
            number += 1
            longest /= LONGER
            continue
        assert code == -signal.SIGKILL, (code, said)
        longest *= LONGER if len(after) == len(before) else 1
        seen["killed"] += 1
        seen["kept"].append(len(after))
        keys = [(line["run"], line["kind"], line.get("index")) for line in map(json.loads, after)]
        seen["repeated"] += len(keys) - len(set(keys))
        if (folder / MANIFEST).exists() and seen["killed"] % 3 == 0:
            with (folder / TRIALS).open("ab") as file:
                file.write(TORN)
    seen["boards"].append(finished(root / f"killed-{number}"))
    return seen


def finished(folder):
    """Let a board be, and return its sorted lines."""
    code, said = ended(child(folder), folder)
    assert code == 0, said
    return sorted(whole_lines(folder))


def full_disks(root, size, rng):
    """Let the disk be full once a board's ledger has some size, and then not."""
    seen = []
    for number in range(FULL):
        folder = root / f"full-{number}"
        code, said = ended(child(folder, int(rng.integers(2_000, size))), folder)
        left = (folder / TRIALS).read_bytes()
        seen.append({"code": code, "said": said, "torn": not left.endswith(b"\n") and left != b""})
        seen[-1]["board"] = finished(folder)
    return seen


def pairs(root):
    """Set two processes on one folder at the same time."""
    seen = []
    for number in range(PAIRS):
        folder = root / f"pair-{number}"
        codes = [ended(pid, folder) for pid in [child(folder), child(folder)]]
        seen.append({"ends": codes, "board": finished(folder)})
    return seen


def harm(root):
    signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGCHLD])
    board(root / "whole")
    begun = time.perf_counter()
    board(root / "again")
    seconds = time.perf_counter() - begun
    rng = np.random.default_rng(0)
    size = (root / "whole" / TRIALS).stat().st_size
    return {
        "whole": sorted(whole_lines(root / "whole")),
        "kills": kills(root, seconds, rng),
        "full": full_disks(root, size, rng),
        "pairs": pairs(root),
        "seconds": seconds,
    }


if __name__ == "__main__":
    print(json.dumps(harm(Path(sys.argv[1]))))
