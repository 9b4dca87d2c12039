"""What a check has seen of an autopilot, a vehicle and a detector of the pad, as plain data."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType


@dataclass(frozen=True, slots=True, kw_only=True)
class AutopilotFacts:
    """What was read of the autopilot; None where it said nothing.

    Attributes:
        autopilot_id: MAV_AUTOPILOT.
        vehicle_type: MAV_TYPE.
        version: major, minor, patch.
        can_arm: its own word on whether it would.
        is_id_shared: another autopilot answers under its system id.
        has_origin: of its local frame.
        has_position: in its local frame.
        geoid_height_m: of mean sea level above the ellipsoid, by its receiver.
        round_trips: TIMESYNC answers.
        utc_known: it tells the time of day.
        utc_ahead_s: of the date of the computer that checks.
        clock_std_s: of its boot clock on the companion's.
        rates_hz: of the messages that the companion asks for, by name.
        latency_s: median from a position's stamp to its arrival.
        has_range_finder: it tells what one sees that looks down.
        range_at_rest_m: what that sees while the motors are off; None with motors on, or where it sees nothing.
        battery_share: left, 0 to 1.
        parameters: by name, in its own units.
    """

    autopilot_id: int
    vehicle_type: int
    version: tuple[int, int, int] | None = None
    can_arm: bool | None = None
    is_id_shared: bool = False
    has_origin: bool = False
    has_position: bool = False
    geoid_height_m: float | None = None
    round_trips: int = 0
    utc_known: bool = False
    utc_ahead_s: float | None = None
    clock_std_s: float | None = None
    rates_hz: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    latency_s: float | None = None
    has_range_finder: bool = False
    range_at_rest_m: float | None = None
    battery_share: float | None = None
    parameters: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))


@dataclass(frozen=True, slots=True, kw_only=True)
class VehicleFacts:
    """What was received of the vehicle; None where nothing was.

    Attributes:
        key: that its fixes were expected on.
        rate_hz: of its fixes.
        fix_refused_why: what was wrong with the last one that was refused, None where none was.
        age_s: median from a fix's stamp to its arrival.
        std_m: the largest standard deviation, of any axis, that a fix states.
        has_velocity: it sends its velocity as well.
        tells_acceleration: along its own axes; an inertial unit's.
        acceleration_refused_why: what is wrong with it, None where nothing is or there is none.
        describes_pad: it answered for its pad.
        pad_refused_why: what was wrong with an answer, None where nothing was.
        antenna_behind_pad_m: by which the antenna is behind the pad's middle, as the vehicle describes it; 0 before.
        tells_heading: it does.
        heading_off_rad: mean angle from its course to its heading while it drove; None when it stood or told none.
        compared_speed_m_s: mean speed over ground at which these were compared; 0 when none were.
        pad_width_m: of the pad's narrower side, as it describes it; infinite before.
        is_afloat: it is a vessel, as it describes itself; not before it does.
    """

    key: str
    rate_hz: float = 0.0
    fix_refused_why: str | None = None
    age_s: float | None = None
    std_m: float | None = None
    has_velocity: bool = False
    tells_acceleration: bool = False
    acceleration_refused_why: str | None = None
    describes_pad: bool = False
    pad_refused_why: str | None = None
    antenna_behind_pad_m: float = 0.0
    tells_heading: bool = False
    heading_off_rad: float | None = None
    compared_speed_m_s: float = 0.0
    is_afloat: bool = False
    pad_width_m: float = math.inf


@dataclass(frozen=True, slots=True, kw_only=True)
class DetectorFacts:
    """What was received of a detector of the pad; None where nothing was.

    Attributes:
        is_alive: `pad-detector` shows that it runs, whether it sees the pad or not.
        sightings: how many came.
        rate_hz: of the sightings.
        age_s: median from the picture to the sighting's arrival.
        std_m: median of the largest standard deviation of any axis.
        refused_why: what was wrong with the last one that was refused, None where none was.
    """

    is_alive: bool = False
    sightings: int = 0
    rate_hz: float = 0.0
    age_s: float | None = None
    std_m: float | None = None
    refused_why: str | None = None
