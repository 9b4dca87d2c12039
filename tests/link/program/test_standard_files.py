"""A program whose standard files are closed ends as any other, and opens no device in their place."""

import subprocess
import sys
from pathlib import Path

import pytest

import link

_PROGRAM = """
import os, sys
from link.errors import UserError
from link.program.cli import make_app
from link.program.start import start
app = make_app("Tests closed files.")

@app.command()
def run(path: str) -> None:
    opened = os.open(path, os.O_WRONLY | os.O_CREAT)
    os.write(1, b"out")
    os.write(2, b"a library's complaint")
    sys.stdout.write("out")
    os.write(opened, str(opened).encode())
    raise UserError("a mistake")

if __name__ == "__main__":
    start("tool", "program")
"""


@pytest.mark.parametrize("closed", ["<&-", ">&-", "2>&-", "<&- >&- 2>&-"])
def test_program_with_closed_files_tells_a_mistake_by_its_code_and_writes_into_no_other_file(
    closed: str, tmp_path: Path
) -> None:
    (tmp_path / "program.py").write_text(_PROGRAM, encoding="utf-8")
    device = tmp_path / "device"
    package = Path(link.__file__).parent.parent
    command = f'PYTHONPATH="{package}" exec "{sys.executable}" program.py "{device}" {closed}'
    ended = subprocess.run(["sh", "-c", command], cwd=tmp_path, check=False, capture_output=True)  # noqa: S607 (any shell)
    assert ended.returncode == 2
    assert int(device.read_text(encoding="utf-8")) > 2
