"""What the flight depends on, in SI units, whatever the firmware calls the parameters behind it."""

from dataclasses import dataclass

from sim_autopilot.modes import Event


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
        land_descent_m_s: near the ground.
        return_height_m: above home.
        return_distance_m: nearer than this it returns without climbing.
        disarm_landed_s: from landing to motors off; None never.
        disarm_idle_s: from arming without a take-off to motors off; None never.
        landed_speed_max_m_s: horizontal, over ground, above which no landing is detected.
        landed_sink_max_m_s: vertical likewise.
        landed_sink_asked_m_s: least downward velocity setpoint of a landing.
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
    land_descent_m_s: float
    return_height_m: float
    return_distance_m: float
    disarm_landed_s: float | None
    disarm_idle_s: float | None
    landed_speed_max_m_s: float
    landed_sink_max_m_s: float
    landed_sink_asked_m_s: float
