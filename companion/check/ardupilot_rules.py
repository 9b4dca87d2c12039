"""What ArduCopter's parameters must be for a landing on a moving vehicle, by their names up to 4.6 and from 4.7 on.

Source: ArduCopter parameter reference; 4.7 renamed to SI units (ANGLE_MAX in 0.01 deg became ATC_ANGLE_MAX in deg,
WPNAV_SPEED in cm/s WP_SPD in m/s), and 4.7.1 PSC_JERK_NE and _D once more, to PSC_NE_JERK and PSC_D_JERK. Effects as
measured on its software-in-the-loop simulation.
"""

from companion.check.findings import Level
from companion.check.rules import (
    ParameterRule,
    Spelling,
    at_least,
    climb_rule,
    equals,
    setpoint_loss_rule,
    sortie_speed_rule,
    speed_rule,
    tilt_needed_deg,
    tilt_rule,
)

_CENTI = 100.0
_JERK_M_S3 = 10.0  # its own shaping allows 10.8 m/s^3 by default: 0.5 sqrt(WPNAV_ACCEL by g by ATC_ACCEL_P_MAX)
_VERTICAL_M_S2 = 3.0  # limits.vertical_acceleration_max_m_s2
_VERTICAL_JERK_M_S3 = 25.0  # limits.vertical_jerk_max_m_s3 by the share of it that is planned with, 0.8
_CORRECTED_PER_S = (
    2.0  # jerk by acceleration, as by default; corrected faster, the jitter of setpoints takes all the jerk
)
_NO_STABILISATION = 0b110000  # bits 4 and 5: positions, velocities are not held
_ELLIPSOID_HEIGHTS = 0b10000  # bit 4 (AP_GPS_Backend::set_alt_amsl_cm, AP_GPS::send_mavlink_gps_raw)
_GUIDED_LOSS_S, _GUIDED_LOSS_ADVISED_S = (0.5, 1.5), 1.0
_DISARM_DELAY_MIN_S = 5.0
_EKF_ACTIONS = (1, 3)
_LEVEL_BELOW_M = 1.0  # so high above the deck its own take-off is level; setpoints take over before

_SPEED = (Spelling("WP_SPD"), Spelling("WPNAV_SPEED", _CENTI))
ARDUPILOT_SINK = (Spelling("WP_SPD_DN"), Spelling("WPNAV_SPEED_DN", _CENTI))
"""What limits the descent, for `rules.sink_rule`."""

ARDUPILOT_RULES = (
    tilt_rule((Spelling("ATC_ANGLE_MAX"), Spelling("ANGLE_MAX", _CENTI)), "; 30 degrees end at 10.2 m/s, silently"),
    ParameterRule(
        spellings=(Spelling("PSC_ANGLE_MAX"),),
        unit="deg",
        level=Level.FAIL,
        test=lambda value, speed_m_s: value <= 0.0 or value >= tilt_needed_deg(speed_m_s),
        advised=lambda *_: 0.0,
        reason="a tilt limit of its own for flight by position, beside the general one; 0 leaves it to that",
    ),
    speed_rule(
        _SPEED,
        Level.FAIL,
        "limits the correction of the position beside the speed asked for",
    ),
    at_least(
        lambda _: _JERK_M_S3 / _CORRECTED_PER_S,
        step=0.5,
        spellings=(Spelling("WP_ACC"), Spelling("WPNAV_ACCEL", _CENTI)),
        unit="m/s^2",
        level=Level.WARN,
        reason="what the position is corrected with; half of the jerk, as by default: with less it swings",
    ),
    at_least(
        lambda _: _JERK_M_S3,
        step=1.0,
        spellings=(Spelling("PSC_NE_JERK"), Spelling("PSC_JERK_NE"), Spelling("PSC_JERK_XY")),
        unit="m/s^3",
        level=Level.WARN,
        reason="how quickly it leans otherwise; with 5 a vehicle that brakes or turns is caught up with late",
    ),
    climb_rule((Spelling("WP_SPD_UP"), Spelling("WPNAV_SPEED_UP", _CENTI))),
    at_least(
        lambda _: _VERTICAL_M_S2,
        step=0.5,
        spellings=(Spelling("WP_ACC_Z"), Spelling("WPNAV_ACCEL_Z", _CENTI)),
        unit="m/s^2",
        level=Level.WARN,
        reason="what the height is corrected with; with 1 an abort climbs on for 2.5 s into the next approach",
    ),
    at_least(
        lambda _: _VERTICAL_JERK_M_S3,
        step=1.0,
        spellings=(Spelling("PSC_D_JERK"), Spelling("PSC_JERK_D"), Spelling("PSC_JERK_Z")),
        unit="m/s^3",
        level=Level.WARN,
        reason="how quickly a sink turns into a climb; with 10 an abort low above a pad that brakes still touches it",
    ),
    setpoint_loss_rule(
        (Spelling("GUID_TIMEOUT"),),
        _GUIDED_LOSS_S,
        _GUIDED_LOSS_ADVISED_S,
        Level.WARN,
        "so long it coasts on when setpoints stay away: 21 m from 5 m/s with 3 s",
    ),
    ParameterRule(
        spellings=(Spelling("GUID_OPTIONS"),),
        unit="",
        level=Level.FAIL,
        test=lambda value, _: not int(value) & _NO_STABILISATION,
        advised=lambda value, _: float(int(value) & ~_NO_STABILISATION),
        reason="bits 4 and 5 switch off the holding of position and velocity",
    ),
    ParameterRule(
        spellings=(Spelling("GPS_DRV_OPTIONS"),),
        unit="",
        level=Level.FAIL,
        test=lambda value, _: not int(value) & _ELLIPSOID_HEIGHTS,
        advised=lambda value, _: float(int(value) & ~_ELLIPSOID_HEIGHTS),
        reason="bit 4 flies heights above the ellipsoid and tells them as above the sea: the geoid is counted twice",
    ),
    equals(
        0.0,
        spellings=(Spelling("FS_GCS_ENABLE"),),
        level=Level.WARN,
        reason="a lost ground station would end a landing by a return, or on the road",
    ),
    ParameterRule(
        spellings=(Spelling("FS_EKF_ACTION"),),
        unit="",
        level=Level.WARN,
        test=lambda value, _: value in _EKF_ACTIONS,
        advised=lambda *_: 1.0,
        reason="an estimator that fails must end the flight by itself; without a position nothing can be chased",
    ),
    ParameterRule(
        spellings=(Spelling("DISARM_DELAY"),),
        unit="s",
        level=Level.FAIL,
        test=lambda value, _: value == 0.0 or value >= _DISARM_DELAY_MIN_S,
        advised=lambda *_: 10.0,
        reason="armed and idle it disarms after this; the take-off begins 4 s after arming",
    ),
)

ARDUPILOT_LAUNCH_RULES = (
    sortie_speed_rule(_SPEED),
    equals(
        0.0,
        spellings=(Spelling("INS_GYR_CAL"),),
        level=Level.WARN,
        reason="1 calibrates the gyros at each start, which a base that turns spoils: switch on while it stands, or 0",
    ),
    ParameterRule(
        spellings=(Spelling("WP_NAVALT_MIN"),),
        unit="m",
        level=Level.WARN,
        test=lambda value, _: value >= _LEVEL_BELOW_M,
        advised=lambda *_: _LEVEL_BELOW_M,
        reason="below this height its take-off does not steer: at 0 it brakes against the deck's velocity at once",
    ),
)
"""For a launch from the deck of a vehicle that drives. Source: ArduPilot's parameter descriptions."""
