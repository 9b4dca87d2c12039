"""`scenarios fly`: a firmware's own simulation, a vehicle and the companion; what is flown, and the score."""

import math
import time
from contextlib import closing
from typing import Any

from link.errors import UserError
from link.frames.geodesy import Datum
from link.program.cli import Patience
from link.program.toml_config import dump_toml
from link.records import replace
from link.transports.opening import Transport, open_transport
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohOptions, open_session
from scenarios.config import FirmwareName, Scenario
from scenarios.firmware.flight import FirmwareFlight, listen
from scenarios.firmware.options import FlyOptions
from scenarios.firmware.sortie import FirmwareSortie, departing_from_under, start_of
from scenarios.firmware.truth import AIRFRAMES, NAMES
from scenarios.firmware.watch import FirmwareWatch
from scenarios.processes.programs import MODULES, ProcessGroup, Program, free_tcp_endpoint
from scenarios.recordings.recording import Recording
from scenarios.recordings.result import result_table, write_json, write_text
from scenarios.recordings.run_folder import Progress, RunOutcome
from scenarios.recordings.truth_file import TruthFile
from scenarios.scoring.touchdown import ScoreRules, rules_of
from scenarios.sortie.score import landing_from_ns, score_sortie
from scenarios.sortie.script import SortieOperator, stations_of
from sim_autopilot.runtime.config import DatumConfig, DroneConfig

_READY_S = 120.0  # of wall time for the autopilot's clock, receiver and truth, and for the companion to meet it
# The ground is the roof, with the pad on it.
_BODY = {"roof_height_m": 0.0, "antenna_flu_m": (0.0, 0.0, 0.0), "length_m": 400.0, "width_m": 400.0}
# The simulations tell the place of the feet, and PX4's own height wanders by half a metre.
_RANGE_FINDER = {"height_m": 0.0, "off_max_m": 1.0}


def fly(scenario: Scenario, options: FlyOptions, progress: Progress) -> RunOutcome:
    """Fly a scenario's vehicle against an autopilot that runs already, and score it on the simulation's truth.

    Raises:
        UserError: the autopilot tells no truth, the vehicle of a sortie stands, or the companion ended by itself.
    """
    endpoint, keys = free_tcp_endpoint(), Keys()
    scenario = departing_from_under(scenario, options.seed) if options.sortie else scenario
    operator = SortieOperator(stations_of(_flat(scenario))) if options.sortie else None
    with open_transport(options.watch) as transport, open_session(ZenohOptions(listen=(endpoint,))) as zenoh:
        watch = FirmwareWatch()
        with Patience("scenarios", f"waiting up to {_READY_S:g} s for the simulation's truth on {options.watch}"):
            datum = _wait_for_truth(watch, transport)
        if options.sortie and options.ship_speed_m_s is None:
            datum = watch.let_it_stand_at(start_of(scenario, options.seed))
        firmware = NAMES.get(watch.session.autopilot or 0, scenario.firmware)
        placed = _flown(_place(scenario, datum), firmware)
        write_text(options.folder / "scenario.toml", dump_toml(placed))
        write_text(options.folder / "companion.toml", dump_toml(placed.system.companion))
        flown = (placed, options, watch, keys, zenoh)
        flight = FirmwareFlight(*flown) if operator is None else FirmwareSortie(*flown, operator=operator)
        with ProcessGroup([_companion(options, watch, endpoint)], options.folder) as processes:
            ended = flight.run(transport, processes, progress)
        if options.record:
            _write_truth(placed, options, keys, flight.recording)
    # There is no tier for a drone that came near and did not land. The firmware's own wind knows no vehicle.
    rules = replace(rules_of(placed), report_rule=False, obstacle=None, carries=options.ship_speed_m_s is not None)
    if operator is None:
        result = result_table(placed, options.seed, flight.recording, ended, rules)
    else:
        rules = replace(rules, fence_drives_along=True)
        result = _sortie_result(placed, options.seed, flight.recording, rules, ended=ended, operator=operator)
    write_json(options.folder / "result.json", result)
    return RunOutcome(result=result, timing={"real_time_factor": 1.0})


def _sortie_result(
    scenario: Scenario, seed: int, recording: Recording, rules: ScoreRules, *, ended: str, operator: SortieOperator
) -> dict[str, Any]:
    """Return the result of the way home and its landing, and what the whole sortie was worth."""
    from_ns = landing_from_ns(operator)
    home = result_table(scenario, seed, recording.since(from_ns), ended, rules, started_ns=from_ns)
    home["time_to_contact_s"] = None  # a sortie's is its `return_s`
    return home | {"sortie": score_sortie(recording, operator, rules, ended).to_json()}


def _companion(options: FlyOptions, watch: FirmwareWatch, endpoint: str) -> Program:
    arguments = (
        *("--config", str(options.folder / "companion.toml"), "--mavlink", options.mavlink, "-e", endpoint),
        *(() if options.sortie else ("--start",)),
        *("--system-id", str(watch.session.target_system_id)),
        *("--tlog", str(options.folder / "flight.tlog"), "--timeout", f"{_READY_S:g}"),
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


def _flown(scenario: Scenario, firmware: FirmwareName) -> Scenario:
    """Return the scenario with the firmware that flies, and the drone that it simulates."""
    drone = DroneConfig(airframe=AIRFRAMES[firmware])
    system = scenario.system.model_copy(update={"drone": drone})
    return scenario.model_copy(update={"firmware": firmware, "system": system})


def _flat(scenario: Scenario) -> Scenario:
    """Return the scenario with its vehicle's roof at the height of the ground."""
    return scenario.model_copy(update={"vehicle": scenario.vehicle.model_copy(update={"roof_height_m": 0.0})})


def _wait_for_truth(watch: FirmwareWatch, transport: Transport) -> Datum:
    """Wait until the simulation has told where the drone stands, and return W's origin."""
    until_s = time.monotonic() + _READY_S
    while watch.datum is None or watch.drone is None:
        listen(watch, transport)
        if time.monotonic() > until_s:
            raise UserError(f"no truth of the drone within {_READY_S:g} s: check --watch, and that it is a simulation")
    return watch.datum
