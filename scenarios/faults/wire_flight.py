"""A run over the wire in which programs can be made to fail: the simulated world, a Zenoh router and the companion."""

import signal
import time
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Self

from companion.situation.phases import Phase
from link.errors import UserError
from link.messages import Order
from link.payloads import json_messages
from link.program.toml_config import dump_toml
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohOptions, open_session
from scenarios.config import Scenario
from scenarios.faults.flight import COMMANDED
from scenarios.faults.matrix import OVER_WIRE_ONLY, Fault
from scenarios.faults.relay import Relay
from scenarios.processes.programs import MODULES, ProcessGroup, Program, free_tcp_endpoint
from scenarios.recordings.recording import Recording
from scenarios.recordings.watcher import Watcher

_REACHED_MAX_S = 120.0  # of wall time, the programs' start included
_COMPANION, _WORLD = "companion", "world"
_ANSWER_S = 2.0
_ROUTER_GONE_S = 3.0
_STOPS_S: Mapping[Fault, float] = {
    Fault.COMPANION_STOPPED_SHORTLY: 0.5,
    Fault.COMPANION_STOPPED: 2.0,
    Fault.COMPANION_STOPPED_LONG: 10.0,
}
_WORLD_STOPS_S = 2.0
WIRE_FAULTS = frozenset({*_STOPS_S, *OVER_WIRE_ONLY, Fault.COMPANION, Fault.ROUTER})


class WireFlight:
    """Real programs, UDP and Zenoh at the speed of the clock; use as a context manager.

    Args:
        scenario: what is flown.
        seed: of everything random.
        folder: for configurations and logs.
    """

    def __init__(self, scenario: Scenario, seed: int, folder: Path) -> None:
        self.scenario = scenario
        self.recording = Recording()
        self._stack = ExitStack()
        self._relay = self._stack.enter_context(Relay(scenario.firmware))
        self._direct, self._by_router = free_tcp_endpoint(), free_tcp_endpoint()
        for name, config in (("scenario", scenario), (_COMPANION, scenario.system.companion)):
            (folder / f"{name}.toml").write_text(dump_toml(config), encoding="utf-8")
        world = ("world", str(folder / "scenario.toml"), "--seed", str(seed), "-l", self._direct)
        files = ("--config", str(folder / "companion.toml"), "--record", str(folder / "flight"))
        self._words = (*files, "--mavlink", self._relay.companion_device)
        programs = [
            Program(
                name=_WORLD, module=MODULES["scenarios"], arguments=(*world, "--mavlink", self._relay.world_device)
            ),
            self._companion("--start"),
        ]
        self._programs = self._stack.enter_context(ProcessGroup(programs, folder))
        self._zenoh = self._stack.enter_context(open_session(ZenohOptions(connect=(self._direct,))))
        self._watcher = Watcher(self._zenoh, Keys(), self.recording)
        self._router = self._stack.enter_context(ExitStack())
        self._open_router()
        self._later: list[tuple[float, Callable[[], None]]] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for _, do in self._later:
            do()
        self._stack.close()

    @property
    def phase(self) -> Phase:
        """The companion's, as it told last."""
        status = self.recording.status
        return Phase.IDLE if status is None else Phase(status.phase)

    @property
    def uninvited(self) -> int:
        """What a second companion flew by: there is none."""
        return 0

    @property
    def setpoints(self) -> int:
        """Of the companion, so far."""
        return self._relay.setpoints

    @property
    def follows_setpoints(self) -> bool:
        """Whether the autopilot tells the mode in which it flies setpoints."""
        return self._relay.follows_setpoints

    @property
    def companion_is_stopped(self) -> bool:
        """Whether something is still to be set right again."""
        return bool(self._later)

    @property
    def height_m(self) -> float:
        """Of the drone above the road, on truth."""
        return self.recording.drone[-1].position_enu_m[2] if self.recording.drone else 0.0

    def step(self) -> None:
        """Let the programs go on for some milliseconds."""
        self._relay.turn()
        self._watcher.take()
        due = [one for one in self._later if one[0] <= time.monotonic()]
        for one in due:
            self._later.remove(one)
            one[1]()

    def fly(self, duration_s: float) -> None:
        """Go on for `duration_s`."""
        until_s = self.recording.elapsed_s + duration_s
        while self.recording.elapsed_s < until_s:
            self.step()

    def fly_to(self, phase: Phase) -> None:
        """Go on to `phase`.

        Raises:
            UserError: it is not reached, or a program has ended.
        """
        before, command = COMMANDED.get(phase, (phase, None))
        self._wait_for(before)
        if command is not None:
            self._zenoh.ask(Keys().landing_command, json_messages.encode(Order(command=command)), _ANSWER_S)
            self._wait_for(phase)

    def inject(self, fault: Fault) -> float:
        """Let one of `WIRE_FAULTS` happen now, and return for how many seconds it lasts."""
        if fault in _STOPS_S:
            return self._stop(_COMPANION, _STOPS_S[fault])
        if fault is Fault.WORLD_STOPPED:
            return self._stop(_WORLD, _WORLD_STOPS_S)
        if fault is Fault.DISK_FULL:
            self._programs.limit_files(_COMPANION, 0)
            return 0.0
        if fault is Fault.ROUTER:
            self._router.close()
            self._after(_ROUTER_GONE_S, self._open_router)
            return _ROUTER_GONE_S
        self._programs.restart(self._companion())
        return 0.0

    def _stop(self, name: str, duration_s: float) -> float:
        self._programs.send(name, signal.SIGSTOP)
        self._after(duration_s, lambda: self._programs.send(name, signal.SIGCONT))
        return duration_s

    def _companion(self, *more: str) -> Program:
        return Program(
            name=_COMPANION, module=MODULES[_COMPANION], arguments=(*self._words, "-e", self._by_router, *more)
        )

    def _open_router(self) -> None:
        options = ZenohOptions(mode="router", listen=(self._by_router,), connect=(self._direct,))
        self._router.enter_context(open_session(options))

    def _after(self, duration_s: float, do: Callable[[], None]) -> None:
        self._later.append((time.monotonic() + duration_s, do))

    def _wait_for(self, phase: Phase) -> None:
        until_s = time.monotonic() + _REACHED_MAX_S
        while self.phase is not phase:
            self.step()
            self._programs.check()
            if time.monotonic() > until_s:
                raise UserError(f"phase {phase.value} is not reached in {_REACHED_MAX_S:g} s")
