"""The kernels are compiled before a run over the wire, once for the sources that there are."""

import subprocess
import sys
from pathlib import Path

import pytest

from link.errors import UserError
from scenarios.lockstep import warm_up


class Compiler:
    """Stands in for the process that compiles; as that does, it leaves a mark when it succeeds."""

    def __init__(self, returncode: int) -> None:
        self.returncode = returncode
        self.runs = 0

    def __call__(self, *_: object, **__: object) -> "Compiler":
        self.runs += 1
        if not self.returncode:
            warm_up.leave_mark()
        return self


@pytest.fixture
def sources(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "kept"))
    monkeypatch.setattr(warm_up, "_ROOT", tmp_path)
    (tmp_path / "link").mkdir()
    source = tmp_path / "link" / "source.py"
    source.write_text("one = 1\n")
    return source


def test_kernels_are_compiled_once_and_again_after_a_change_of_the_sources(
    sources: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    compiler = Compiler(0)
    monkeypatch.setattr("subprocess.run", compiler)
    warm_up.compile_once()
    warm_up.compile_once()
    assert compiler.runs == 1
    sources.write_text("one = 1.0\n")
    warm_up.compile_once()
    assert compiler.runs == 2
    assert len(list((sources.parents[1] / "kept").iterdir())) == 1  # the mark of other sources went


@pytest.mark.usefixtures("sources")
def test_kernels_that_could_not_be_compiled_are_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("subprocess.run", Compiler(2))
    with pytest.raises(UserError, match="compiled"):
        warm_up.compile_once()


_IN_TWO = """
from companion.config.estimation import EstimatorConfig
from companion.vehicle.factory import make_estimator
from link.compiled import count_compiled
from scenarios.lockstep import warm_up
make_estimator(EstimatorConfig())
of_the_estimator, _ = count_compiled()
warm_up._compile_simulator_and_planner()
of_both, _ = count_compiled()
warm_up.warm_process()
print(of_the_estimator, of_both, *count_compiled())
"""


def test_two_processes_that_share_the_work_leave_nothing_to_compile() -> None:
    told = subprocess.run([sys.executable, "-c", _IN_TWO], capture_output=True, text=True, check=True).stdout
    of_the_estimator, of_both, of_a_step, _ = map(int, told.split())
    assert 0 < of_the_estimator < of_both == of_a_step


_PREPARED = """
import sys
from numba.core import event
from link.compiled import _kept_kernels

class Compiler(event.Listener):
    def on_start(self, about):
        print("compiles", about.data["dispatcher"].py_func.__qualname__)

    def on_end(self, about):
        pass

def prepared():
    return {(kernel.py_func.__module__, kernel.py_func.__name__, str(one)) for kernel, _ in _kept_kernels
            for one in kernel.signatures}

def tell_new(before):
    for module, name, _ in sorted(prepared() - before):
        print(module, name)
"""
_FLIGHT = (
    _PREPARED
    + """
from scenarios.campaigns.cells import draw, load_cell
from scenarios.lockstep.lockstep import Lockstep

flight = Lockstep(draw(load_cell(sys.argv[1]), 3).scenario, 3)
flight.step()
before = prepared()
event.register("numba:compile", Compiler())
flight.run()
tell_new(before)
"""
)
_SPIN = (
    _PREPARED
    + """
import numpy as np
from companion.config.estimation import EstimatorConfig
from companion.core.data import Measurement, Quantity
from companion.vehicle.factory import make_estimator

estimator, memory = make_estimator(EstimatorConfig()), None
before = prepared()
event.register("numba:compile", Compiler())
for i in range(100):
    told = {Quantity.POSITION: [0.0] * 3, Quantity.VELOCITY: [0.0] * 3, Quantity.HEADING: [0.05 * max(i - 50, 0)]}
    told[Quantity.YAW_RATE] = [0.5 if i > 50 else 0.0]
    memory = estimator.fuse(memory, [
        Measurement(t_ns=i * 10**8, quantity=one, value=np.array(value), covariance=1e-4 * np.eye(len(value)))
        for one, value in told.items()
    ])
    estimator.forecast(memory, i * 10**8, np.array([0.0, 1.0]))
spin_rad_s = memory.newest.state.spin.rad_s
print("" if spin_rad_s else "it does not turn", end="")
tell_new(before)
"""
)


@pytest.mark.parametrize(
    "cell",
    [
        "straight_5+sensors=nominal+wind=nominal+link=nominal",
        "rough_road_8+sensors=nominal+firmware=ardupilot",
        "ship_ss5+sensors=nominal",
    ],
)
def test_no_step_of_a_flight_compiles_or_loads_a_kernel(cell: str) -> None:
    """A kernel that is new in a flight is compiled in it after an update: the companion is silent for a second."""
    told = subprocess.run([sys.executable, "-c", _FLIGHT, cell], capture_output=True, text=True, check=True).stdout
    assert told == ""


def test_no_turn_on_the_spot_compiles_or_loads_a_kernel() -> None:
    told = subprocess.run([sys.executable, "-c", _SPIN], capture_output=True, text=True, check=True).stdout
    assert told == ""
