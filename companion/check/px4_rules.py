"""What PX4's parameters must be for a landing on a moving vehicle.

Source: PX4 parameter reference, 1.16 and 1.17; effects as measured on its software-in-the-loop simulation.
"""

from companion.check.findings import Level
from companion.check.rules import GRADE_MAX, SPEED_SHARE_ADVISED, ParameterRule, Spelling, at_least, tilt_needed_deg

_CLIMB_M_S = 2.0
_LOSS_S = (0.5, 3.0)
_ACT_HOLD, _ACT_LAST_SAFE = 5, 5
_OVERRIDE_IN_OFFBOARD = 2
_LIFT_OFF_S = 5.0  # from arming: half a second of a quiet deck, a second to spool up, the ramp of MPC_TKO_RAMP_T
_DLL_ACT_STOPS = 5  # flight termination; 6 disarms

PX4_SINK = (Spelling("MPC_Z_VEL_MAX_DN"),)
"""What limits the descent, for `rules.sink_rule`."""

PX4_RULES = (
    at_least(
        lambda v: SPEED_SHARE_ADVISED * v,
        step=1.0,
        spellings=(Spelling("MPC_XY_VEL_MAX"),),
        unit="m/s",
        level=Level.FAIL,
        reason="limits the speed silently: a faster vehicle is never reached",
    ),
    at_least(
        tilt_needed_deg,
        step=5.0,
        spellings=(Spelling("MPC_TILTMAX_AIR"),),
        unit="deg",
        level=Level.FAIL,
        reason="the tilt that holds the speed against drag and still corrects",
    ),
    at_least(
        lambda v: _CLIMB_M_S + GRADE_MAX * v,
        step=0.5,
        spellings=(Spelling("MPC_Z_VEL_MAX_UP"),),
        unit="m/s",
        level=Level.WARN,
        reason="the climb of an abort, away from a deck that drives uphill",
    ),
    at_least(
        lambda v: SPEED_SHARE_ADVISED * v,
        step=1.0,
        spellings=(Spelling("LNDMC_XY_VEL_MAX"),),
        unit="m/s",
        level=Level.WARN,
        reason="above this speed over ground PX4 does not believe in a landing and refuses a plain disarm on the deck",
    ),
    ParameterRule(
        spellings=(Spelling("COM_OF_LOSS_T"),),
        unit="s",
        level=Level.FAIL,
        test=lambda value, _: _LOSS_S[0] <= value <= _LOSS_S[1],
        advised=lambda _: 1.0,
        reason="how long setpoints may stay away: shorter, a hiccup ends the flight; longer, a dead companion flies on",
    ),
    ParameterRule(
        spellings=(Spelling("COM_OBL_RC_ACT"),),
        unit="",
        level=Level.WARN,
        test=lambda value, _: value == _ACT_HOLD,
        is_fatal=lambda value: value > _ACT_LAST_SAFE,
        advised=lambda _: float(_ACT_HOLD),
        reason="what follows the loss of setpoints: 5 hovers; 0 to 2 want a pilot's sticks or land on the road, "
        "4 lands, 3 crosses the traffic, 6 and 7 stop the motors in flight",
    ),
    ParameterRule(
        spellings=(Spelling("NAV_DLL_ACT"),),
        unit="",
        level=Level.WARN,
        test=lambda value, _: value == 0.0,
        is_fatal=lambda value: value >= _DLL_ACT_STOPS,
        advised=lambda _: 0.0,
        reason="a lost ground station would end a landing, in OFFBOARD too; 5 and 6 stop the motors in flight",
    ),
    ParameterRule(
        spellings=(Spelling("COM_DISARM_LAND"),),
        unit="s",
        level=Level.WARN,
        test=lambda value, _: 0.0 < value <= 5.0,
        advised=lambda _: 2.0,
        reason="disarms by itself once PX4 believes in the landing, should the companion fail there",
    ),
    ParameterRule(
        spellings=(Spelling("COM_RC_OVERRIDE"),),
        unit="",
        level=Level.WARN,
        test=lambda value, _: bool(int(value) & _OVERRIDE_IN_OFFBOARD),
        advised=lambda _: 3.0,
        reason="bit 1 lets the pilot's sticks end OFFBOARD; without it only the mode switch does",
    ),
)

PX4_LAUNCH_RULES = (
    ParameterRule(
        spellings=(Spelling("COM_DISARM_PRFLT"),),
        unit="s",
        level=Level.FAIL,
        test=lambda value, _: value <= 0.0 or value >= _LIFT_OFF_S,
        advised=lambda _: 10.0,
        reason="so long after arming PX4 disarms a drone that still stands; 0 or less never does",
    ),
)
"""For a launch from the deck of a vehicle that drives."""
