"""What the flight depends on, in SI units, whatever the firmware calls the parameters behind it."""

from dataclasses import dataclass

from link.messages import Vector3
from sim_autopilot.control.kinds import PositionGains
from sim_autopilot.flight.follow import BEHIND, FollowSettings
from sim_autopilot.flight.modes import Event, Mode
from sim_autopilot.flight.stick_feel import PX4_STICKS, StickFeel
from sim_autopilot.safety.failsafes import NO_FAILSAFES, FailsafeSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class PathLimits:
    """What a shaped path keeps to.

    Attributes:
        speed_m_s: horizontal, of corrections and of flight to a bare position.
        climb_m_s: upwards likewise.
        descent_m_s: downwards likewise.
        acceleration_m_s2: horizontal, of corrections.
        vertical_acceleration_m_s2: of corrections.
        jerk_m_s3: horizontal, of everything.
        vertical_jerk_m_s3: of everything.
        timeout_s: age at which a setpoint's velocity and acceleration are no longer believed.
        throttle_slew_s: in which the throttle rises to full before a take-off.
    """

    speed_m_s: float
    climb_m_s: float
    descent_m_s: float
    acceleration_m_s2: float
    vertical_acceleration_m_s2: float
    jerk_m_s3: float
    vertical_jerk_m_s3: float
    timeout_s: float
    throttle_slew_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class LandingSettings:
    """What the PLND parameters amount to; `moving` is bit 0 of PLND_OPTIONS."""

    enabled: bool = False
    moving: bool = False
    sinks_within_m: float = 2.5


NO_PRECISION = LandingSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class FlightSettings:
    """The present values of the parameters that the flight obeys.

    Attributes:
        speed_max_m_s: horizontal.
        climb_max_m_s: upwards.
        descent_max_m_s: downwards.
        tilt_max_rad: of the thrust axis.
        yaw_rate_max_rad_s: of the commanded heading.
        setpoint_loss_s: silence after which setpoints count as lost.
        setpoint_loss_event: what happens then; None stops the motors.
        spool_up_s: from arming to the first climb.
        takeoff_ramp_s: in which the allowed climb rate grows from zero.
        takeoff_climb_m_s: in the take-off mode.
        takeoff_height_m: of the take-off mode, above where it started.
        land_approach_m_s: of a landing, high above home.
        land_descent_m_s: near the ground.
        land_slow_below_m: above home, where near the ground begins.
        braking_m_s2: with which a mode comes to a stop and sets off.
        return_height_m: above home.
        return_distance_m: nearer than this it returns without climbing.
        return_slope: of the cone about home above which it need not climb, height over distance; 0 is none.
        return_m_s: horizontal speed of the return; None is `cruise_m_s`.
        return_climb_m: that it climbs in any case.
        return_stay_s: over home before it descends.
        disarm_landed_s: from landing to motors off; None never.
        disarm_after_landing_mode_s: the same where a landing mode has done it.
        disarm_idle_s: from arming without a take-off to motors off; None never.
        landed_after_s: how long the signs of a landing must hold.
        landed_speed_max_m_s: horizontal, over ground, above which no landing is detected.
        landed_sink_max_m_s: vertical likewise.
        landed_sink_asked_m_s: least downward velocity setpoint of a landing.
        landed_tilt_max_rad: a drone that is asked to lean farther is not landed; None does not look.
        landed_acceleration_max_m_s2: nor one that accelerates more; None does not look.
        path: limits of the path that setpoints move, where they move one.
        gains: of position control, where the firmware has them as parameters.
        cruise_m_s: horizontal, on the way to a place.
        reached_m: horizontal distance at which a mission's place counts as reached.
        reached_height_m: vertical likewise.
        hover_share: of the full thrust, that a thrust setpoint needs to hover.
        thrust_as_thrust: whether GUIDED's attitude setpoints give a thrust and no climb rate.
        sticks: what they ask for.
        sticks_lost_event: what happens when the sticks of a manual mode are let go of; None holds.
        overridden_modes: that a pilot takes over by moving the sticks.
        sticks_moved_per_s: how fast, in parts of half their way.
        battery_v: of an empty and of a full battery.
        wind_enu_m_s: that the parameters add to the air's own, towards.
        takes_failures: whether failures can be injected.
        landing: by LANDING_TARGET.
        follow: of the mode that follows somebody.
        failsafes: of battery, ground station and fence.
    """

    speed_max_m_s: float
    climb_max_m_s: float
    descent_max_m_s: float
    tilt_max_rad: float
    yaw_rate_max_rad_s: float
    setpoint_loss_s: float
    setpoint_loss_event: Event | None
    spool_up_s: float
    takeoff_ramp_s: float
    takeoff_climb_m_s: float
    takeoff_height_m: float
    land_approach_m_s: float
    land_descent_m_s: float
    land_slow_below_m: float
    braking_m_s2: float
    return_height_m: float
    return_distance_m: float
    disarm_landed_s: float | None
    disarm_after_landing_mode_s: float | None
    disarm_idle_s: float | None
    landed_after_s: float
    landed_speed_max_m_s: float
    landed_sink_max_m_s: float
    landed_sink_asked_m_s: float
    landed_tilt_max_rad: float | None
    landed_acceleration_max_m_s2: float | None
    path: PathLimits | None
    gains: PositionGains | None
    cruise_m_s: float = 5.0
    reached_m: float = 10.0
    reached_height_m: float = 0.8
    hover_share: float = 0.5
    return_slope: float = 0.0
    return_m_s: float | None = None
    return_climb_m: float = 0.0
    return_stay_s: float = 0.0
    thrust_as_thrust: bool = False
    sticks: StickFeel = PX4_STICKS
    sticks_lost_event: Event | None = None
    overridden_modes: frozenset[Mode] = frozenset()
    sticks_moved_per_s: float = 0.3
    battery_v: tuple[float, float] = (14.0, 16.2)
    wind_enu_m_s: Vector3 = (0.0, 0.0, 0.0)
    takes_failures: bool = False
    landing: LandingSettings = NO_PRECISION
    follow: FollowSettings = BEHIND
    failsafes: FailsafeSettings = NO_FAILSAFES
