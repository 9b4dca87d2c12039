"""Ctrl-C ends a program with exit code 130 and no traceback, whatever it is in."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import link
from link.program.interrupts import COMPILING
from scenarios.processes.programs import MODULES

_WHILE_IMPORTING = """
import os, signal
try:
    os.kill(os.getpid(), signal.SIGINT)
except BaseException:  # as some modules do
    pass
from tests.link.program.test_cli import program
app = program([])
"""

_MEETS_EXEC = """
import sys
from link.program.cli import make_app
from link.program.start import start
app = make_app("Tests Ctrl-C.")

@app.command()
def run() -> None:
    sys.stdout.write("so far\\n")
    exec("import os, signal; os.kill(os.getpid(), signal.SIGINT)")

if __name__ == "__main__":
    start("tool", "program")
"""

_WHILE_COMPILING = """
import os, signal
from numba.core import event
from link.compiled import kernel
from link.program.interrupts import take_interrupts

class Interrupt(event.Listener):
    def on_start(self, event):
        os.kill(os.getpid(), signal.SIGINT)
    def on_end(self, event):
        pass

take_interrupts("tool")
event.register("numba:run_pass", Interrupt())
kernel(lambda one: one + one)(1.0)
"""

_WHILE_BOXING = """
import os, pickle, signal
from numba.core.serialize import _numba_unpickle
from link.program.interrupts import take_interrupts

class Interrupt:
    def __reduce__(self):
        return os.kill, (os.getpid(), signal.SIGINT)

take_interrupts("tool")
_numba_unpickle(0, pickle.dumps(Interrupt()), b"")
"""

_AFTERWARDS = """
import os, signal
from link.compiled import kernel
from link.program.interrupts import take_interrupts

take_interrupts("tool")
kernel(lambda one: one + one)(1.0)
kernel(lambda one: one * one)(1.0)
try:
    os.kill(os.getpid(), signal.SIGINT)
except KeyboardInterrupt:
    print("in order")
"""


def run(code: str) -> tuple[int, str, str]:
    """Return exit code and output of a process that runs `code`."""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def test_ctrl_c_while_a_program_is_imported_ends_it_without_a_word(tmp_path: Path) -> None:
    (tmp_path / "interrupted.py").write_text(_WHILE_IMPORTING)
    code = f"import sys; sys.path.insert(0, {str(tmp_path)!r}); from link.program.start import start"
    assert run(f"{code}; start('tool', 'interrupted')") == (130, "", "")


def test_ctrl_c_that_meets_an_exec_ends_a_program_with_its_exit_code_all_the_same(tmp_path: Path) -> None:
    (tmp_path / "program.py").write_text(_MEETS_EXEC)
    command = [sys.executable, "-m", "program"]
    done = subprocess.run(
        command,
        capture_output=True,
        text=True,
        check=False,
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(Path(link.__file__).parents[1])},
    )
    assert (done.returncode, done.stdout, done.stderr) == (130, "so far\n", "")


def test_ctrl_c_while_numerics_are_compiled_ends_the_program() -> None:
    assert run(_WHILE_COMPILING) == (130, "", f"tool: {COMPILING}\n")


def test_ctrl_c_while_a_result_of_machine_code_becomes_a_value_ends_the_program() -> None:
    assert run(_WHILE_BOXING) == (130, "", "")


def test_compiling_is_told_once_and_ctrl_c_after_it_ends_in_order() -> None:
    assert run(_AFTERWARDS) == (0, "in order\n", f"tool: {COMPILING}\n")


@pytest.mark.parametrize("module", MODULES.values())
def test_a_program_settles_ctrl_c_before_it_imports_what_takes_time(module: str) -> None:
    main = module if module == "scenarios.ground_vehicle" else f"{module}.__main__"
    code = f"import sys, {main}; print([one for one in ('typer', 'numpy', 'numba', 'pydantic') if one in sys.modules])"
    assert run(code) == (0, "[]\n", "")


def test_a_program_that_is_to_ignore_ctrl_c_goes_on_ignoring_it() -> None:
    code = "import signal; signal.signal(signal.SIGINT, signal.SIG_IGN); from link.program.interrupts import *; "
    told = run(f"{code} take_interrupts('tool'); print(signal.getsignal(signal.SIGINT) is signal.SIG_IGN)")
    assert told == (0, "True\n", "")
