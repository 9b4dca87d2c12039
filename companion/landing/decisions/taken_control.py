"""Whether somebody else flies the drone: the pilot, a failsafe, or nobody as its motors have stopped; pure."""

from companion.autopilots.messages import was_arming_undone, was_control_undone
from companion.core.reasons import Cause, Reason
from companion.landing.decisions.entries import Decision
from companion.landing.state.memory import ControlMemory
from companion.situation.phases import FLYING_PHASES, Event, Phase
from companion.situation.situation import Situation


def find_taken_control(phase: Phase, control: ControlMemory, s: Situation) -> Decision | None:
    """Return that somebody else flies, with the reason; None while the companion does, or is still to begin."""
    if phase not in FLYING_PHASES:
        return None
    is_killed = s.autopilot.killed and phase is not Phase.TOUCHDOWN  # on the pad that is as wanted
    reason = Reason.MOTORS_KILLED if is_killed else _why_taken(phase, control, s)
    return None if reason is None else (Event.PILOT_TOOK_OVER, Cause(reason))


def is_held_on_ground(phase: Phase, control: ControlMemory, s: Situation) -> bool:
    """Return whether a take-off was broken off before the drone has left the ground: there it has nothing to hold."""
    return phase is Phase.HOLD and not control.has_flown and s.autopilot.landed is True


def _why_taken(phase: Phase, control: ControlMemory, s: Situation) -> Reason | None:
    """Return why somebody else flies, None if nobody else does."""
    if not (control.was_in_control or _is_switched(control, s)):
        return None
    if s.autopilot.failsafe or s.autopilot.overruled:
        return Reason.AUTOPILOT_FAILSAFE
    is_off_told = s.autopilot.disarm_told or not s.autopilot.armed
    may_stop = phase is Phase.ON_DECK or is_held_on_ground(phase, control, s)
    is_off_wanted = phase is Phase.TOUCHDOWN or (may_stop and control.driver.disarm_asked)
    if is_off_wanted and is_off_told:
        return None  # a mode that changes with it is not the pilot's
    if not s.autopilot.in_control:
        return _why_not_in_control(control, s, is_off_told=is_off_told)
    # On a deck, too, unless the companion asked: a person did it, or the autopilot's time was over, and nobody expects
    # the motors to start again.
    is_undone = was_arming_undone(control.driver, s.autopilot, s.monotonic_ns)
    return Reason.DISARMED if is_undone or (control.was_armed and not s.autopilot.armed) else None


def _why_not_in_control(control: ControlMemory, s: Situation, *, is_off_told: bool) -> Reason:
    """Return why another mode is flown: one that comes with motors that have stopped is no pilot's choice."""
    if s.autopilot.restarted:
        return Reason.AUTOPILOT_RESTARTED
    return Reason.DISARMED if control.was_armed and is_off_told else Reason.MODE_CHANGED


def _is_switched(control: ControlMemory, s: Situation) -> bool:
    """Return whether somebody has changed the mode before the autopilot has told of the companion's.

    It is a third one, or the one before although the autopilot had accepted to leave it.
    """
    is_third = not s.autopilot.in_control and s.autopilot.mode != control.mode_before
    return is_third or was_control_undone(control.driver, s.autopilot, s.monotonic_ns)
