"""What the flight depends on, in SI units, whatever the firmware calls the parameters behind it."""

from dataclasses import dataclass

from link.messages import Vector3
from sim_autopilot.core.land_settings import DisarmSettings, LandDetectorSettings, LandSettings
from sim_autopilot.core.limits import Envelope, PathLimits, PositionGains
from sim_autopilot.core.modes import Event, Mode
from sim_autopilot.core.pilot_settings import (
    BEHIND,
    NO_TAKEOVER,
    PX4_STICKS,
    FollowSettings,
    StickFeel,
    TakeoverSettings,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class FailsafeSettings:
    """What the failsafes watch for and lead to; an event of None only warns.

    Attributes:
        battery_levels: remaining shares at which the battery is low, critical and in an emergency, falling.
        battery_events: what each of these levels leads to.
        station_lost_s: silence after which the ground station is lost.
        station_event: what a lost ground station leads to in the end.
        station_system: whose heartbeats count; None takes those of every ground station.
        station_spares: modes in which a lost ground station changes nothing.
        hold_s: how long it holds before that; None not at all.
        fence_event: what leaving the fence leads to.
        reach_m: of the cylinder about home; 0 is none.
        height_m: of the same.
        areas_count: whether the uploaded areas do.
    """

    battery_levels: tuple[float, float, float] = (0.15, 0.07, 0.05)
    battery_events: tuple[Event | None, Event | None, Event | None] = (None, None, None)
    station_lost_s: float = 10.0
    station_event: Event | None = None
    station_system: int | None = None
    station_spares: frozenset[Mode] = frozenset()
    hold_s: float | None = 5.0
    fence_event: Event | None = None
    reach_m: float = 0.0
    height_m: float = 0.0
    areas_count: bool = True


NO_FAILSAFES = FailsafeSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class SetpointSettings:
    """Of setpoints.

    Attributes:
        loss_s: silence after which they count as lost.
        loss_event: what happens then; None stops the motors.
        hover_share: of the full thrust, that a thrust setpoint needs to hover.
        thrust_as_thrust: whether GUIDED's attitude setpoints give a thrust and no climb rate.
    """

    loss_s: float
    loss_event: Event | None
    hover_share: float
    thrust_as_thrust: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class TakeoffSettings:
    """Of a take-off.

    Attributes:
        spool_up_s: from arming to the first climb.
        ramp_s: in which the allowed climb rate grows from zero.
        climb_m_s: in the take-off mode.
        height_m: of the take-off mode, above where it started.
    """

    spool_up_s: float
    ramp_s: float
    climb_m_s: float
    height_m: float


@dataclass(frozen=True, slots=True, kw_only=True)
class TravelSettings:
    """Of the way to a place: its horizontal speed, and the distances at which a mission's place counts as reached."""

    cruise_m_s: float
    reached_m: float
    reached_height_m: float = 0.8


@dataclass(frozen=True, slots=True, kw_only=True)
class ReturnSettings:
    """Of the return.

    Attributes:
        height_m: above home.
        distance_m: nearer than this it returns without climbing.
        slope: of the cone about home above which it need not climb, height over distance; 0 is none.
        speed_m_s: horizontal; None is that of every way.
        climb_m: that it climbs in any case.
        stay_s: over home before it descends.
    """

    height_m: float
    distance_m: float
    slope: float = 0.0
    speed_m_s: float | None = None
    climb_m: float = 0.0
    stay_s: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulationSettings:
    """What the parameters say about the simulated drone.

    Attributes:
        battery_v: of an empty and of a full battery.
        wind_enu_m_s: that they add to the air's own, towards.
        takes_failures: whether failures can be injected.
    """

    battery_v: tuple[float, float] = (14.0, 16.2)
    wind_enu_m_s: Vector3 = (0.0, 0.0, 0.0)
    takes_failures: bool = False


AS_SIMULATED = SimulationSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class FlightSettings:
    """The present values of the parameters that the flight obeys, by what they are about.

    Attributes:
        envelope: of the flight controller; with its braking a mode comes to a stop and sets off.
        setpoints: lost, and their thrust.
        takeoff: by a mode or a setpoint.
        travel: to a place.
        returning: to home.
        land: by a mode.
        land_detector: that says when it has.
        disarm: by itself.
        path: limits of the path that setpoints move, where they move one.
        gains: of position control, where the firmware has them as parameters.
        sticks: what they ask for.
        takeover: by sticks, and without them.
        follow: of the mode that follows somebody.
        failsafes: of battery, ground station and fence.
        simulation: of battery, air and failures.
    """

    envelope: Envelope
    setpoints: SetpointSettings
    takeoff: TakeoffSettings
    travel: TravelSettings
    returning: ReturnSettings
    land: LandSettings
    land_detector: LandDetectorSettings
    disarm: DisarmSettings
    path: PathLimits | None = None
    gains: PositionGains | None = None
    sticks: StickFeel = PX4_STICKS
    takeover: TakeoverSettings = NO_TAKEOVER
    follow: FollowSettings = BEHIND
    failsafes: FailsafeSettings = NO_FAILSAFES
    simulation: SimulationSettings = AS_SIMULATED
