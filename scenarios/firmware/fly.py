"""The wire loop of `scenarios fly`: a vehicle beside a firmware's own simulation, the companion, and the score."""

import math
import time
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from companion.situation.phases import Phase
from link.errors import UserError
from link.frames.geodesy import Datum
from link.payloads import json_messages
from link.program.cli import Patience
from link.program.toml_config import dump_toml
from link.records import replace
from link.transports.opening import Transport, open_transport
from link.zenoh.keys import Keys, Publication
from link.zenoh.session import ZenohOptions, ZenohSession, open_session
from scenarios.config import Scenario
from scenarios.firmware.ship import PARAMETERS, ship_at, ship_at_rest
from scenarios.firmware.truth import DRAG_PER_MASS_HZ, NAMES
from scenarios.firmware.watch import FirmwareWatch
from scenarios.processes.programs import MODULES, ProcessGroup, Program, free_tcp_endpoint
from scenarios.recordings.recording import EndWatch, Recording
from scenarios.recordings.result import result_table, write_json, write_text
from scenarios.recordings.run_folder import Progress, RunOutcome
from scenarios.recordings.truth_file import TruthFile
from scenarios.recordings.watcher import Watcher
from scenarios.scoring.touchdown import rules_of
from scenarios.simulation.vehicle_node import STEP_PERIOD_NS, VehicleNode, datum_of
from sim_autopilot.runtime.config import DatumConfig

_WAIT_S = 0.004  # for bytes
_READY_S = 120.0  # of wall time for the autopilot's clock, receiver and truth
_PROGRESS_S = 0.2
# The ground is the roof, with the pad on it.
_BODY = {"roof_height_m": 0.0, "antenna_flu_m": (0.0, 0.0, 0.0), "length_m": 400.0, "width_m": 400.0}
# The simulations tell the place of the feet, and PX4's own height wanders by half a metre.
_RANGE_FINDER = {"height_m": 0.0, "off_max_m": 1.0}


@dataclass(frozen=True, slots=True, kw_only=True)
class FlyOptions:
    """How a flight is made.

    Attributes:
        mavlink: the companion's device.
        watch: device of a second link, for the simulation's truth.
        ship_speed_m_s: of ArduPilot's simulated ship, which then is the vehicle; None is the scenario's vehicle.
        seed: of the vehicle's sensors.
        folder: to be made for the flight.
        record: write what goes in and out of the companion, and the truth, as MCAP.
    """

    mavlink: str
    watch: str
    ship_speed_m_s: float | None
    seed: int
    folder: Path
    record: bool = False


def fly(scenario: Scenario, options: FlyOptions, progress: Progress) -> RunOutcome:
    """Fly a scenario's vehicle against an autopilot that runs already, and score it on the simulation's truth.

    Raises:
        UserError: the autopilot tells no truth, or the companion ended by itself.
    """
    endpoint, keys = free_tcp_endpoint(), Keys()
    with open_transport(options.watch) as transport, open_session(ZenohOptions(listen=(endpoint,))) as zenoh:
        watch = FirmwareWatch()
        with Patience("scenarios", f"waiting up to {_READY_S:g} s for the simulation's truth on {options.watch}"):
            datum = _datum(watch, transport)
        firmware = NAMES.get(watch.session.autopilot or 0, scenario.firmware)
        placed = _place(scenario, datum).model_copy(update={"firmware": firmware})
        write_text(options.folder / "scenario.toml", dump_toml(placed))
        write_text(options.folder / "companion.toml", dump_toml(placed.system.companion))
        flight = _Flight(placed, options, watch, keys, zenoh)
        with ProcessGroup([_companion(options, endpoint)], options.folder) as processes:
            ended = flight.run(transport, processes, progress)
        if options.record:
            _write_truth(placed, options, keys, flight.recording)
    # The drag over a mass of 1 kg; there is no tier for a drone that came near and did not land.
    drag_hz = DRAG_PER_MASS_HZ.get(watch.session.autopilot or 0, 0.0)
    carries = options.ship_speed_m_s is not None
    rules = replace(rules_of(placed), mass_kg=1.0, drag_n_s_m=drag_hz, report_rule=False, carries=carries)
    result = result_table(placed, options.seed, flight.recording, ended, rules)
    write_json(options.folder / "result.json", result)
    return RunOutcome(result=result, timing={"real_time_factor": 1.0})


def _companion(options: FlyOptions, endpoint: str) -> Program:
    arguments = (
        *("--config", str(options.folder / "companion.toml"), "--mavlink", options.mavlink, "-e", endpoint),
        *("--start", "--tlog", str(options.folder / "flight.tlog"), "--timeout", "0"),
        *(("--record", str(options.folder)) if options.record else ()),
    )
    return Program(name="companion", module=MODULES["companion"], arguments=arguments)


def _write_truth(scenario: Scenario, options: FlyOptions, keys: Keys, recording: Recording) -> None:
    with closing(TruthFile(options.folder, scenario, options.seed, keys)) as truth:
        truth.take(recording)


def _place(scenario: Scenario, datum: Datum) -> Scenario:
    """Return the scenario about the drone's place, for ground at a fixed height and positions told of the feet."""
    vehicle = scenario.vehicle.model_copy(update=_BODY)
    companion = scenario.system.companion
    range_finder = companion.touchdown.range_finder.model_copy(update=_RANGE_FINDER)
    touchdown = companion.touchdown.model_copy(update={"gear_height_m": 0.0, "range_finder": range_finder})
    system = scenario.system.model_copy(update={"companion": companion.model_copy(update={"touchdown": touchdown})})
    place = DatumConfig(
        latitude_deg=math.degrees(datum.latitude_rad),
        longitude_deg=math.degrees(datum.longitude_rad),
        altitude_m=datum.altitude_m,
    )
    return scenario.model_copy(update={"vehicle": vehicle, "system": system}).with_run(datum=place)


def _datum(watch: FirmwareWatch, transport: Transport) -> Datum:
    """Wait until the simulation has told where the drone stands."""
    until_s = time.monotonic() + _READY_S
    while watch.datum is None or watch.drone is None:
        _listen(watch, transport)
        if time.monotonic() > until_s:
            raise UserError(f"no truth of the drone within {_READY_S:g} s: check --watch, and that it is a simulation")
    return watch.datum


def _listen(watch: FirmwareWatch, transport: Transport) -> int:
    """Take what comes within a few milliseconds; return the local time."""
    received = transport.receive_by_peer(_WAIT_S)
    local_ns = time.time_ns()
    for _, data in received:
        watch.receive(data, local_ns, is_datagram=transport.is_datagram)
    watch.session.poll(local_ns)
    for frame in watch.session.take_output():
        transport.send(frame)
    return local_ns


class _Flight:
    def __init__(
        self, scenario: Scenario, options: FlyOptions, watch: FirmwareWatch, keys: Keys, zenoh: ZenohSession
    ) -> None:
        self.recording = Recording()
        self._scenario = scenario
        self._options = options
        self._watch = watch
        self._zenoh = zenoh
        self._vehicle = VehicleNode(scenario, options.seed, keys)
        self._watcher = Watcher(zenoh, keys, self.recording)
        self._datum = datum_of(scenario.run.datum)
        self._stepped_ns = 0
        self._ship_lies = self._ship_sails = False
        pad = json_messages.encode(self._vehicle.pad)
        zenoh.serve(keys.pad, lambda _: pad)
        zenoh.declare_alive(keys.alive)

    def run(self, transport: Transport, processes: ProcessGroup, progress: Progress) -> str:
        """Return why the flight ended."""
        end, shown_s = EndWatch(self._scenario.run.time_limit_s), 0.0
        while (reason := end.reason(self.recording)) is None:
            local_ns = _listen(self._watch, transport)
            processes.check()
            for truth in self._watch.take_truths():
                self.recording.add(truth)
            self._step(local_ns)
            self._watcher.take()
            if end.must_break_off(self.recording):
                self._watcher.break_off()
            if time.monotonic() - shown_s >= _PROGRESS_S:
                shown_s = time.monotonic()
                progress(self.recording, 1.0)
        return reason

    def _step(self, local_ns: int) -> None:
        t_ns = self._watch.utc_ns(local_ns)
        if t_ns is None or t_ns - self._stepped_ns < STEP_PERIOD_NS:
            return
        self._stepped_ns = t_ns
        if self._options.ship_speed_m_s is None:
            publications = self._vehicle.step(t_ns, self._watch.drone)
        else:
            self._set_sail(self._options.ship_speed_m_s)
            publications = self._on_deck(t_ns, self._options.ship_speed_m_s)
        for publication in publications:
            self._zenoh.publish(publication.key, publication.payload, publication.encoding)

    def _set_sail(self, speed_m_s: float) -> None:
        """Let the ship begin once the drone waits for it; first it only reports, lest it leap to its first report."""
        status = self.recording.status
        waits = status is not None and status.phase == Phase.WAITING.value
        if waits and not self._ship_lies:
            self._ship_lies = True
            for name, value in (PARAMETERS | {"SIM_SHIP_SPEED": 0.0, "SIM_SHIP_ENABLE": 1.0}).items():
                self._watch.set_parameter(name, value)
        elif self._watch.ship is not None and not self._ship_sails:
            self._ship_sails = True
            self._watch.set_parameter("SIM_SHIP_SPEED", speed_m_s)

    def _on_deck(self, t_ns: int, ordered_m_s: float) -> list[Publication]:
        report, clock = self._watch.ship, self._watch.session.clock
        reported_ns = None if report is None else clock.boot_to_utc_ns(report.boot_ns)
        if report is None or reported_ns is None:
            return self._vehicle.published(ship_at_rest(t_ns), None)
        radius_m = 0.5 * PARAMETERS["SIM_SHIP_PSIZE"]
        ship = ship_at(report, reported_ns, t_ns, self._datum, turn_radius_m=radius_m, ordered_m_s=ordered_m_s)
        return self._vehicle.published(ship, self._watch.drone)
