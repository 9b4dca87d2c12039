"""Compiles the numerical kernels once after an installation: `python -m scenarios.lockstep.warm_up`.

Two processes share the work. What is compiled is kept for the user who runs it: in the folder NUMBA_CACHE_DIR, else
beside the sources, else in the user's cache. What was compiled for other sources goes. A mark beside them says for
which sources that was done.
"""

import hashlib
import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path

from link.errors import UserError
from link.program.clock import collect_rarely, spare_present_objects
from link.program.exit_codes import EXIT_OK, EXIT_USER_ERROR
from link.program.interrupts import EndingAtOnce, take_interrupts

_ROOT = Path(__file__).parents[2]
_MODULE = "scenarios.lockstep.warm_up"
_BESIDE = "beside"
"""The argument of the second process."""

_TOLD_EVERY_S = 15.0


@cache
def warm_process() -> None:
    """Make a step of the whole stack in this process, which loads what is loaded once, as the programs do at start.

    Raises:
        UserError: there is no place to keep what is compiled.
    """
    collect_rarely()
    # Loaded here, so that what is wrong with the place for machine code is told as one line.
    from scenarios.catalogue.catalogue import load_scenario  # noqa: PLC0415 (see above)
    from scenarios.lockstep.lockstep import Lockstep  # noqa: PLC0415 (see above)

    Lockstep(load_scenario("straight_5"), seed=1).step()
    spare_present_objects()


def _compile_in_two() -> None:
    """Compile the estimator's kernels here, and what else there is in a process beside.

    Raises:
        UserError: there is no place to keep what is compiled.
    """
    from companion.config.estimation import EstimatorConfig  # noqa: PLC0415 (see above)
    from companion.vehicle.factory import make_estimator  # noqa: PLC0415 (see above)

    with subprocess.Popen([sys.executable, "-m", _MODULE, _BESIDE]) as beside:
        try:
            make_estimator(EstimatorConfig())
        except UserError:
            beside.kill()
            raise


def _compile_simulator_and_planner() -> None:
    from companion.runtime.build import make_guidance, warm_up  # noqa: PLC0415 (see above)
    from link.zenoh.keys import Keys  # noqa: PLC0415 (see above)
    from scenarios.catalogue.catalogue import load_scenario  # noqa: PLC0415 (see above)
    from scenarios.lockstep.lockstep import START_NS  # noqa: PLC0415 (see above)
    from scenarios.simulation.simulation import Simulation  # noqa: PLC0415 (see above)

    scenario = load_scenario("straight_5")
    Simulation(scenario, 1, Keys(), START_NS, instant=False, publishes_truth=False).step()
    config = scenario.system.companion
    warm_up(make_guidance(config.guidance.kind, config.guidance), config)


def compile_once() -> None:
    """Compile the kernels, unless they are compiled for the present sources; in a process of its own, which tells it.

    Programs that start together would each do it, and miss the beginning of what they are started for.

    Raises:
        UserError: they cannot be compiled.
    """
    if any(mark.exists() for mark in _marks()):
        return
    if subprocess.run([sys.executable, "-m", _MODULE], check=False).returncode:
        raise UserError("the numerical kernels could not be compiled: see above")


def _marks() -> list[Path]:
    """Return the files of which one is there if the kernels are compiled, the best place first."""
    state = [sys.version]
    for package in ("companion", "link", "scenarios", "sim_autopilot"):
        for path in sorted((_ROOT / package).rglob("*.py")):
            about = path.stat()
            state.append(f"{path} {about.st_size} {about.st_mtime_ns}")
    name = f"compiled_{hashlib.sha256(chr(10).join(state).encode()).hexdigest()[:16]}"
    chosen = os.environ.get("NUMBA_CACHE_DIR")
    folders = (
        [Path(chosen)] if chosen else [Path(__file__).parent / "__pycache__", Path.home() / ".cache" / "decklander"]
    )
    return [folder / name for folder in folders]


def leave_mark() -> None:
    """Say that the kernels are compiled, where that can be written; else each run over the wire looks again."""
    for mark in _marks():
        try:
            mark.parent.mkdir(parents=True, exist_ok=True)
            for other in mark.parent.glob("compiled_*"):
                other.unlink()
            mark.touch()
        except OSError:
            continue
        return


@contextmanager
def _told() -> Iterator[None]:
    """Tell every 15 s how far the block is, once it has loaded what it compiles."""
    ended = threading.Event()

    def tell() -> None:
        while not ended.wait(_TOLD_EVERY_S):
            from link.compiled import count_compiled  # noqa: PLC0415 (it loads numba)

            compiled, of = count_compiled()
            sys.stderr.write(f"compiled {compiled} of {of} kernels\n")

    teller = threading.Thread(target=tell, daemon=True)
    teller.start()
    try:
        yield
    finally:
        ended.set()
        teller.join()


def main() -> int:
    """Compile what a step needs into the cache and return the exit code."""
    try:
        with _told():
            _compile_in_two()
            warm_process()
    except UserError as error:
        sys.stderr.write(f"{_MODULE}: {error}\n")
        return EXIT_USER_ERROR
    from link.compiled import remove_outdated  # noqa: PLC0415 (it loads numba)

    remove_outdated()
    leave_mark()
    return EXIT_OK


def _main_beside() -> int:
    try:
        _compile_simulator_and_planner()
    except UserError:  # the process that waits for this one comes to the same, and tells it
        return EXIT_USER_ERROR
    return EXIT_OK


if __name__ == "__main__":
    is_beside = sys.argv[1:] == [_BESIDE]
    collect_rarely()
    take_interrupts("" if is_beside else _MODULE)  # one of the two tells it
    with EndingAtOnce():
        sys.exit(_main_beside() if is_beside else main())
