"""Flights that are broken off, one for each reason that the companion can have: what goes wrong in which phase.

A setting is tightened where no fault can be told from luck; everything else is what a link, an autopilot, a vehicle or
an operator does. Nothing is tried again, and a flight is over a moment after the climb.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from companion.core.reasons import Reason
from companion.situation.phases import Phase
from link.mavlink.dialect import mavlink
from link.messages import Command
from link.program.toml_config import merge, validate
from link.records import replace
from scenarios.catalogue.catalogue import load_scenario
from scenarios.config import Scenario
from scenarios.faults.flight import FaultFlight
from tests.golden.wrong_data import every_third_sighting_is_beside, sightings_are_stamped_late, velocity_is_in_ned

SEED = 1
_PARKED = {"chase": {"parked_wait_s": 0.5}}
_STAYS_TOO_FAST = {"near_speed_max_m_s": 1e-3}  # to end its alignment
_ANTENNA_OVER_PAD = {"antenna_flu_m": (0.0, 0.0, 1.6)}  # no heading is needed to place the pad
_RAISED_M = 3.0
_FAR_WRONG_M = 1.6  # more than a range finder is believed to correct: half of that pad's height over its road
_WRONG_M = 1.2  # more than what a range finder sees may be off the height of a pad that is told wrong
_BESIDE_M = 0.4
_OVER_EDGE_M = 2.25  # from the middle of a roof of 4.2 m: what looks down sees the road, and a foot is on the roof
_COMMITTED_M = 0.4  # of the drone above the roof: its feet are 0.28 m above
_UNHEARD_S = 3.0
_STOPS_ABOVE_M = 0.5  # of the drone above the roof: from there ArduCopter, left alone, stops with its feet 0.27 m above
_AHEAD_S = 0.3
_LIMIT_M_S = 4.0  # less than the vehicle's 5 m/s
_CLIMB_S = 12.0  # a little more than the abort's own time limit
_AFTER_S = 3.0  # to brake, and to be seen airborne and stable

Fault = Callable[[FaultFlight], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Abort:
    """A flight that is to be broken off.

    Attributes:
        reason: of the abort.
        scenario: what is flown.
        companion: settings that differ.
        vehicle: likewise, of the vehicle.
        phase: in which the fault happens.
        fault: what goes wrong, None where a setting alone breaks the flight off.
        within_s: from the fault to the abort.
        touches: the vehicle is touched before.
    """

    reason: Reason
    scenario: str = "straight_5"
    companion: Mapping[str, Any] = field(default_factory=dict)
    vehicle: Mapping[str, Any] = field(default_factory=dict)
    phase: Phase = Phase.DESCEND
    fault: Fault | None = None
    within_s: float = 6.0
    touches: bool = False


def fly(abort: Abort) -> FaultFlight:
    """Fly until the abort's climb is over, or nothing more is to be expected."""
    companion = merge({"abort": {"retries_max": 0}}, dict(abort.companion))
    changes = {"system": {"companion": companion}, "vehicle": dict(abort.vehicle)}
    table = merge(load_scenario(abort.scenario).model_dump(mode="json"), changes)
    flight = FaultFlight(validate(Scenario, table, source=abort.scenario), SEED)
    if abort.fault is not None:
        flight.fly_to(abort.phase)
        abort.fault(flight)
    else:
        flight.fly_to(Phase.CHASE)
    _fly_until(flight, Phase.ABORT, abort.within_s)
    _fly_until(flight, Phase.HOLD, _CLIMB_S)
    flight.fly(_AFTER_S)
    return flight


def _fly_until(flight: FaultFlight, phase: Phase, limit_s: float) -> None:
    end_s = flight.recording.elapsed_s + limit_s
    while flight.phase is not phase and flight.recording.elapsed_s < end_s:
        flight.step()


def _vehicle_falls_silent(flight: FaultFlight) -> None:
    flight.vehicle_is_silent = True


def _token_is_lost(flight: FaultFlight) -> None:
    _vehicle_falls_silent(flight)
    flight.vehicle_is_alive = False


def _own_position_stops(flight: FaultFlight) -> None:
    _stream_stops(flight, mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED)


def _stream_stops(flight: FaultFlight, number: int) -> None:
    interval = mavlink.MAV_CMD_SET_MESSAGE_INTERVAL
    flight.tell(mavlink.MAVLink_command_long_message(1, 1, interval, 0, number, -1.0, 0, 0, 0, 0, 0))


def _vehicles_clock_is_set(ahead_s: float) -> Fault:
    return lambda flight: flight.simulation.vehicle.set_clock(ahead_s)


def _limit_is_lowered(flight: FaultFlight) -> None:
    kind = mavlink.MAV_PARAM_TYPE_REAL32
    flight.tell(mavlink.MAVLink_param_set_message(1, 1, b"MPC_XY_VEL_MAX", _LIMIT_M_S, kind))


def _pad_is_described(forward_m: float, up_m: float, over_road_m: float = 0.0) -> Fault:
    """Let the vehicle describe its pad anew: its centre is elsewhere than it said before, or higher over its road."""

    def describe(flight: FaultFlight) -> None:
        pad = flight.simulation.vehicle.pad
        x_m, y_m, z_m = pad.antenna_to_pad_m
        arm_m, height_m = (x_m + forward_m, y_m, z_m + up_m), pad.height_m + over_road_m
        flight.companion.receive_pad(replace(pad, antenna_to_pad_m=arm_m, height_m=height_m))

    return describe


def _when_below(height_m: float, fault: Fault) -> Fault:
    """Let the fault wait until the drone is so low above the roof."""

    def descend(flight: FaultFlight) -> None:
        above_m = flight.scenario.vehicle.roof_height_m + height_m
        while flight.height_m > above_m:
            flight.step()
        fault(flight)

    return descend


def _operator(command: Command) -> Fault:
    return lambda flight: flight.companion.request(command)


ABORTS: dict[str, Abort] = {
    "vehicle_silent": Abort(reason=Reason.VEHICLE_DATA_OLD, phase=Phase.ALIGN, fault=_vehicle_falls_silent),
    "vehicle_uncertain": Abort(
        reason=Reason.VEHICLE_UNCERTAIN,
        companion={"abort": {"fix_age_max_s": 20.0, **_STAYS_TOO_FAST}},
        phase=Phase.ALIGN,
        fault=_vehicle_falls_silent,
    ),
    "token_lost": Abort(reason=Reason.VEHICLE_LINK_LOST, phase=Phase.CHASE, fault=_token_is_lost),
    "own_position_stops": Abort(reason=Reason.OWN_POSITION_OLD, phase=Phase.ALIGN, fault=_own_position_stops),
    "clock_ahead": Abort(
        reason=Reason.VEHICLE_CLOCK_AHEAD,
        companion={"abort": _STAYS_TOO_FAST},
        phase=Phase.ALIGN,
        fault=_vehicles_clock_is_set(_AHEAD_S),
    ),
    "heading_unknown": Abort(
        reason=Reason.HEADING_UNKNOWN,
        scenario="static+sensors=rtk",
        vehicle=_ANTENNA_OVER_PAD,
        companion=_PARKED,
        fault=_pad_is_described(forward_m=_BESIDE_M, up_m=0.0),
    ),
    "not_followed": Abort(  # flown for half a second later than it is: the drone is ahead of where it is asked to be
        reason=Reason.SETPOINT_NOT_FOLLOWED,
        companion={"setpoints": {"lead_s": 0.5, "corrects_lag": False}, "abort": {"tracking_stds_max": 4.0}},
    ),
    "would_blow_off": Abort(
        reason=Reason.WOULD_BLOW_OFF, scenario="straight_15", companion={"touchdown": {"gear_friction": 0.2}}
    ),
    "contact_risky": Abort(
        reason=Reason.CONTACT_RISKY,
        fault=_when_below(_COMMITTED_M, _pad_is_described(forward_m=1.5 * _BESIDE_M, up_m=0.0)),
    ),
    "stamps_stepped": Abort(
        reason=Reason.STAMPS_STEPPED, scenario="straight_15", phase=Phase.CHASE, fault=_vehicles_clock_is_set(-0.1)
    ),
    "contradicting": Abort(
        reason=Reason.VEHICLE_CONTRADICTS_ITSELF,
        companion={"abort": _STAYS_TOO_FAST},
        phase=Phase.ALIGN,
        fault=velocity_is_in_ned,
    ),
    "outrun": Abort(reason=Reason.VEHICLE_OUTRUNS, phase=Phase.ALIGN, fault=_limit_is_lowered),
    "below_pad": Abort(reason=Reason.BELOW_PAD, fault=_pad_is_described(forward_m=0.0, up_m=_RAISED_M)),
    "nothing_touched": Abort(
        reason=Reason.NOTHING_TOUCHED,
        phase=Phase.CHASE,
        fault=_pad_is_described(forward_m=0.0, up_m=_FAR_WRONG_M, over_road_m=_FAR_WRONG_M),
        within_s=12.0,
    ),
    "setpoints_unheard": Abort(
        reason=Reason.SETPOINTS_UNHEARD,
        scenario="static+firmware=ardupilot",
        fault=_when_below(_STOPS_ABOVE_M, lambda flight: flight.cut_way_up(_UNHEARD_S)),
    ),
    "road_below": Abort(
        reason=Reason.ROAD_BELOW,
        scenario="straight_15",
        phase=Phase.IDLE,
        fault=_vehicles_clock_is_set(-_OVER_EDGE_M / 15.0),
        within_s=40.0,
    ),
    "offset_unknown": Abort(
        reason=Reason.OFFSET_UNKNOWN,
        companion={"integrity": {"receiver_frames": "apart"}, "chase": {"unseen_hold_s": 2.0}},
    ),
    "seen_elsewhere": Abort(
        reason=Reason.SEEN_ELSEWHERE,
        scenario="straight_5+sensors=nominal",
        companion={"integrity": {"receiver_frames": "one"}},
    ),
    "sightings_disagree": Abort(
        reason=Reason.SIGHTINGS_DISAGREE,
        scenario="straight_5+sensors=nominal",
        companion={
            "integrity": {"receiver_frames": "apart"},
            "abort": _STAYS_TOO_FAST,
        },
        phase=Phase.ALIGN,
        fault=every_third_sighting_is_beside,
    ),
    "sightings_impossible": Abort(
        reason=Reason.SIGHTINGS_IMPOSSIBLE,
        scenario="straight_5+sensors=nominal+camera=day+detector=model+telemetry=none",
        phase=Phase.WAITING,
        fault=sightings_are_stamped_late,
        within_s=20.0,
    ),
    "seen_too_near": Abort(
        reason=Reason.SEEN_TOO_NEAR,
        phase=Phase.ALIGN,
        fault=_pad_is_described(forward_m=0.0, up_m=-_WRONG_M, over_road_m=-_WRONG_M),
    ),
    "contact_lost": Abort(
        reason=Reason.ABOVE_AFTER_CONTACT,
        phase=Phase.TOUCHDOWN,
        fault=_pad_is_described(forward_m=0.0, up_m=-_RAISED_M),
        touches=True,
    ),
    "descent_too_long": Abort(reason=Reason.DESCENT_TOO_LONG, companion={"descent": {"time_limit_s": 1.0}}),
    "operator_aborts": Abort(reason=Reason.OPERATOR_ABORTS, phase=Phase.CHASE, fault=_operator(Command.ABORT)),
}
