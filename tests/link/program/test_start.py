"""A program calculates its matrices on one thread, unless somebody says otherwise."""

import os
import subprocess
import sys
from pathlib import Path

import link
from link.program.start import ONE_THREAD

_PROGRAM = """
import os, sys
from link.program.cli import make_app
from link.program.start import start
app = make_app("Tests threads.")

@app.command()
def run() -> None:
    before = len(os.listdir("/proc/self/task"))
    import numpy
    sys.stdout.write(f"{len(os.listdir('/proc/self/task')) - before} {os.environ['OMP_NUM_THREADS']}")

if __name__ == "__main__":
    start("tool", "program")
"""


def test_numerics_start_no_threads_and_what_the_user_has_set_is_kept(tmp_path: Path) -> None:
    (tmp_path / "program.py").write_text(_PROGRAM, encoding="utf-8")
    environment = {name: value for name, value in os.environ.items() if name not in ONE_THREAD}
    environment |= {"PYTHONPATH": str(Path(link.__file__).parent.parent), "OMP_NUM_THREADS": "3"}
    ended = subprocess.run(
        [sys.executable, "program.py"], cwd=tmp_path, env=environment, check=True, capture_output=True, text=True
    )
    assert ended.stdout == "0 3"
