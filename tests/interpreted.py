"""Scripts in an interpreter of their own: what is decided on import, as JIT on or off, can differ there."""

import json
import os
import subprocess
import sys
from pathlib import Path


def run_script(script, **environment):
    """What a script prints as JSON, run by a fresh interpreter in which warnings are errors."""
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", script.format(tests=str(Path(__file__).parent))],
        check=False,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)
