"""What the flight depends on, in SI units, whatever the firmware calls the parameters behind it."""

from dataclasses import dataclass

from link.messages import Vector3
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
        battery_events: what each of them leads to.
        station_lost_s: silence after which the ground station is lost.
        station_event: what that leads to in the end.
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
class PrecisionSettings:
    """What the PLND parameters amount to; `moving` is bit 0 of PLND_OPTIONS."""

    enabled: bool = False
    moving: bool = False
    sinks_within_m: float = 2.5


NO_PRECISION = PrecisionSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class TargetSettings:
    """What the PLD parameters amount to.

    Attributes:
        lost_s: after which a target is lost.
        within_m: of the target, north and east, where it sinks.
        final_m: above the target, below which it lands where that was lost.
        search_m: above home, from where it looks for it.
        search_s: how long.
        searches_max: how often.
    """

    lost_s: float = 5.0
    within_m: float = 0.2
    final_m: float = 0.1
    search_m: float = 10.0
    search_s: float = 10.0
    searches_max: int = 3


PX4_TARGET = TargetSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class LandSettings:
    """Of a landing.

    Attributes:
        approach_m_s: sink rate high above home.
        descent_m_s: near the ground.
        slow_below_m: above home, where near the ground begins.
        precision: by LANDING_TARGET.
        target: likewise, of a mode of its own.
    """

    approach_m_s: float
    descent_m_s: float
    slow_below_m: float
    precision: PrecisionSettings = NO_PRECISION
    target: TargetSettings = PX4_TARGET


@dataclass(frozen=True, slots=True, kw_only=True)
class LandDetectorSettings:
    """Of the land detector.

    Attributes:
        after_s: how long the signs of a landing must hold.
        speed_max_m_s: horizontal, over ground, above which no landing is detected.
        sink_max_m_s: vertical likewise.
        sink_asked_m_s: least downward velocity setpoint of a landing.
        tilt_max_rad: a drone that is asked to lean farther is not landed; None does not look.
        acceleration_max_m_s2: nor one that accelerates more; None does not look.
    """

    after_s: float
    speed_max_m_s: float
    sink_max_m_s: float
    sink_asked_m_s: float
    tilt_max_rad: float | None = None
    acceleration_max_m_s2: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class DisarmSettings:
    """When the motors stop by themselves: after a landing, after one by a landing mode, after arming; None never."""

    landed_s: float | None
    after_landing_mode_s: float | None
    idle_s: float | None


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
