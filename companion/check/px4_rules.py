"""What PX4's parameters must be for a landing on a moving vehicle.

Source: PX4 parameter reference, 1.16 and 1.17; effects as measured on its software-in-the-loop simulation.
"""

from companion.check.findings import Level
from companion.check.rules import (
    ParameterRule,
    Spelling,
    climb_rule,
    equals,
    setpoint_loss_rule,
    sortie_speed_rule,
    speed_rule,
    tilt_rule,
)

_SPEED = (Spelling("MPC_XY_VEL_MAX"),)
_LOSS_S, _LOSS_ADVISED_S = (0.5, 3.0), 3.0
_ACT_HOLD, _ACT_LAST_SAFE = 5, 5
_OVERRIDE_IN_OFFBOARD = 2
_LIFT_OFF_S = 5.0  # from arming: half a second of a quiet deck, a second to spool up, the ramp of MPC_TKO_RAMP_T
_DLL_ACT_STOPS = 5  # flight termination; 6 disarms

PX4_SINK = (Spelling("MPC_Z_VEL_MAX_DN"),)
"""What limits the descent, for `rules.sink_rule`."""

PX4_RULES = (
    speed_rule(_SPEED, Level.FAIL, "limits the speed silently: a faster vehicle is never reached"),
    tilt_rule((Spelling("MPC_TILTMAX_AIR"),), " and still corrects"),
    climb_rule((Spelling("MPC_Z_VEL_MAX_UP"),)),
    speed_rule(
        (Spelling("LNDMC_XY_VEL_MAX"),),
        Level.WARN,
        "above this speed over ground PX4 does not believe in a landing and refuses a plain disarm on the deck",
    ),
    setpoint_loss_rule(
        (Spelling("COM_OF_LOSS_T"),),
        _LOSS_S,
        _LOSS_ADVISED_S,
        Level.FAIL,
        "how long it stands at the last setpoint without a new one: shorter, a hiccup ends the flight; longer, "
        "nobody flies the drone",
    ),
    equals(
        float(_ACT_HOLD),
        spellings=(Spelling("COM_OBL_RC_ACT"),),
        level=Level.WARN,
        is_fatal=lambda value: value > _ACT_LAST_SAFE,
        reason="what follows the loss of setpoints: 5 hovers; 0 to 2 want a pilot's sticks or land on the road, "
        "4 lands, 3 crosses the traffic, 6 and 7 stop the motors in flight",
    ),
    equals(
        0.0,
        spellings=(Spelling("NAV_DLL_ACT"),),
        level=Level.WARN,
        is_fatal=lambda value: value >= _DLL_ACT_STOPS,
        reason="a lost ground station would end a landing, in OFFBOARD too; 5 and 6 stop the motors in flight",
    ),
    ParameterRule(
        spellings=(Spelling("COM_DISARM_LAND"),),
        unit="s",
        level=Level.WARN,
        test=lambda value, _: 0.0 < value <= 5.0,
        advised=lambda *_: 2.0,
        reason="disarms by itself once PX4 believes in the landing, should the companion fail there",
    ),
    ParameterRule(
        spellings=(Spelling("COM_RC_OVERRIDE"),),
        unit="",
        level=Level.WARN,
        test=lambda value, _: bool(int(value) & _OVERRIDE_IN_OFFBOARD),
        advised=lambda value, _: float(int(value) | _OVERRIDE_IN_OFFBOARD),
        reason="bit 1 lets the pilot's sticks end OFFBOARD; without it only the mode switch does",
    ),
)

PX4_LAUNCH_RULES = (
    sortie_speed_rule(_SPEED),
    ParameterRule(
        spellings=(Spelling("COM_DISARM_PRFLT"),),
        unit="s",
        level=Level.FAIL,
        test=lambda value, _: value <= 0.0 or value >= _LIFT_OFF_S,
        advised=lambda *_: 10.0,
        reason="so long after arming PX4 disarms a drone that still stands; 0 or less never does",
    ),
)
"""For a launch from the deck of a vehicle that drives."""
