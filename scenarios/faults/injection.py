"""How each fault is made to happen in a flight in lockstep."""

from collections.abc import Callable, Mapping

from link.mavlink.dialect import Message, mavlink
from scenarios.config import FirmwareName
from scenarios.faults.flight import FaultFlight
from scenarios.faults.matrix import Fault
from scenarios.faults.sortie_flight import SortieFaultFlight

_PILOTS_MODES: Mapping[FirmwareName, float] = {"px4": 3.0, "ardupilot": 17.0}  # POSCTL, BRAKE: neither needs sticks
_SPEED_LIMITS: Mapping[FirmwareName, tuple[bytes, float]] = {  # less than the vehicle's 5 m/s
    "px4": (b"MPC_XY_VEL_MAX", 4.0),
    "ardupilot": (b"WPNAV_SPEED", 400.0),
}
_ORIGIN_MOVED_ENU_M = (30.0, -20.0, 4.0)
_ESTIMATE_RESET_ENU_M = (3.0, -2.0, 1.0)
_HOUR_S = 3600.0
_STAMPS_OFF_S = -0.06  # a receiver's stamps may be those of its output instead of its measurement
_SLEW = -5e-4  # the most by which an NTP daemon changes a clock's rate: ntpd(8), adjtimex(2)
_SLIDE_ENU_M_S = (0.2, 0.0, 0.0)  # ahead of a vehicle that drives east: a receiver still states centimetres
_SPOILT_SHARE = 0.01


_LOW_SHARE = 0.21  # a percent above the reserve by default, which BATTERY_STATUS rounds away
_COARSE_WHITE_M, _COARSE_BIAS_M = 0.5, 1.2  # a receiver without corrections, as the benchmark's


def inject_in_sortie(fault: Fault, flight: SortieFaultFlight) -> float:
    """Let `fault` happen now in a sortie; as `inject`."""
    if fault not in _INJECT_IN_SORTIE:
        return inject(fault, flight)
    _INJECT_IN_SORTIE[fault](flight)
    return 0.0


def inject(fault: Fault, flight: FaultFlight) -> float:
    """Let `fault` happen now, and return for how many seconds it lasts; what stays as it is then lasts no time."""
    duration_s = _DURATIONS_S.get(fault, 0.0)
    _INJECT[fault](flight, duration_s)
    return duration_s


def _command(number: int, *parameters: float) -> Message:
    return mavlink.MAVLink_command_long_message(1, 1, number, 0, *(*parameters, *[0.0] * (7 - len(parameters))))


def _change_mode(flight: FaultFlight) -> None:
    flight.tell(_command(mavlink.MAV_CMD_DO_SET_MODE, 1.0, _PILOTS_MODES[flight.scenario.firmware]))


def _lower_speed_limit(flight: FaultFlight) -> None:
    name, value = _SPEED_LIMITS[flight.scenario.firmware]
    flight.tell(mavlink.MAVLink_param_set_message(1, 1, name, value, mavlink.MAV_PARAM_TYPE_REAL32))


def _silence_vehicle(flight: FaultFlight) -> None:
    flight.vehicle_is_silent = True


def _kill_vehicle(flight: FaultFlight) -> None:
    flight.vehicle_is_silent = True
    flight.vehicle_is_alive = False


_DURATIONS_S: Mapping[Fault, float] = {
    Fault.SILENT: 2.0,
    Fault.COMPANION_STOPPED_SHORTLY: 0.5,
    Fault.COMPANION_STOPPED: 2.0,
    Fault.COMPANION_STOPPED_LONG: 10.0,
    Fault.VEHICLE_STOPPED_SHORTLY: 0.5,
    Fault.VEHICLE_STOPPED: 2.0,
    Fault.VEHICLE_STOPPED_LONG: 10.0,
    Fault.ROUTER: 3.0,
}

_INJECT: Mapping[Fault, Callable[[FaultFlight, float], None]] = {
    Fault.PILOT: lambda flight, _: _change_mode(flight),
    Fault.RESTART: lambda flight, _: flight.simulation.autopilot.restart(),
    Fault.SILENT: FaultFlight.cut_link,
    Fault.LOST: lambda flight, _: flight.cut_link(),
    Fault.ORIGIN: lambda flight, _: flight.set_origin(_ORIGIN_MOVED_ENU_M),
    Fault.ESTIMATE: lambda flight, _: flight.simulation.autopilot.reset_estimator(_ESTIMATE_RESET_ENU_M),
    Fault.PARAMETER: lambda flight, _: _lower_speed_limit(flight),
    Fault.VEHICLE: lambda flight, _: _silence_vehicle(flight),
    Fault.VEHICLE_KILLED: lambda flight, _: _kill_vehicle(flight),
    Fault.VEHICLE_STOPPED_SHORTLY: FaultFlight.hold_vehicle,
    Fault.VEHICLE_STOPPED: FaultFlight.hold_vehicle,
    Fault.VEHICLE_STOPPED_LONG: FaultFlight.hold_vehicle,
    Fault.ROUTER: FaultFlight.cut_vehicle,
    Fault.CLOCK_AHEAD: lambda flight, _: flight.simulation.vehicle.set_clock(_HOUR_S),
    Fault.CLOCK_BACK: lambda flight, _: flight.simulation.vehicle.set_clock(-_HOUR_S),
    Fault.STAMPS: lambda flight, _: flight.set_vehicle_clock(_STAMPS_OFF_S, _SLEW),
    Fault.SLIDE: lambda flight, _: flight.simulation.vehicle.slide_fixes(_SLIDE_ENU_M_S),
    Fault.SPOILT: lambda flight, _: flight.spoil_links(_SPOILT_SHARE),
    Fault.SECOND_COMPANION: lambda flight, _: flight.add_companion(),
    Fault.SECOND_DRONE: lambda flight, _: flight.add_drone(),
    Fault.COMPANION: lambda flight, _: flight.restart_companion(),
    Fault.COMPANION_STOPPED_SHORTLY: FaultFlight.stop_companion,
    Fault.COMPANION_STOPPED: FaultFlight.stop_companion,
    Fault.COMPANION_STOPPED_LONG: FaultFlight.stop_companion,
}

_INJECT_IN_SORTIE: Mapping[Fault, Callable[[SortieFaultFlight], None]] = {
    Fault.BATTERY: lambda flight: flight.empty_battery(_LOW_SHARE),
    Fault.BRAKE: SortieFaultFlight.brake_vehicle,
    Fault.COARSE: lambda flight: flight.lose_corrections(_COARSE_WHITE_M, _COARSE_BIAS_M),
    Fault.RIVAL: SortieFaultFlight.add_rival,
}
