"""Answers to an operator's commands: what is accepted in which phase, and why not."""

import math

from companion.config.companion import CompanionConfig
from companion.core.reasons import Cause, Reason, sentence
from companion.integrity.heights import VEHICLE_M
from companion.situation.phases import Event, Phase, next_phase
from companion.situation.situation import Situation, vehicle_stands
from link.messages import Command, CommandReply

_ON_ROOF_M = 1.0  # above or below it: the road is farther below
_EVENTS = {
    Command.START: Event.START,
    Command.START_ANYWAY: Event.START,  # the question that it skips is asked before the step
    Command.ABORT: Event.ABORT,
    Command.HOLD: Event.HOLD,
}


def answer(
    command: Command, phase: Phase, situation: Situation, config: CompanionConfig, obstacle: Cause | None = None
) -> tuple[Event | None, CommandReply]:
    """Return the event that the command amounts to, None when it changes no phase, and the reply.

    Args:
        command: the operator's.
        phase: now.
        situation: now.
        config: all numbers.
        obstacle: why no landing can be done, None when one can.
    """
    event = _EVENTS[command]
    is_start = event is Event.START
    if phase is Phase.TAKEOFF and not is_start and not situation.autopilot.armed:
        event = Event.CALLED_OFF  # on the ground there is nothing to hold
    flies = situation.autopilot.in_control and situation.autopilot.armed
    if phase is Phase.HOLD and is_start and not flies:
        event = Event.START_AGAIN  # called off before the autopilot gave control: it has to be asked for again
    if phase is Phase.ABORT and not is_start:
        return None, CommandReply(accepted=True, reason="")  # the climb goes on, but to no retry
    if next_phase(phase, event) is phase:
        return None, _refuse(Cause(Reason.NOTHING_TO_DO, (command.value, phase.value)))
    missing = None
    if is_start:
        missing = _missing_for_start(situation) or _rides_along(situation, config) or obstacle
    if missing is not None:
        return None, _refuse(missing)
    return event, CommandReply(accepted=True, reason="")


def _refuse(why: Cause) -> CommandReply:
    return CommandReply(accepted=False, reason=sentence(why))


def _rides_along(s: Situation, config: CompanionConfig) -> Cause | None:
    """Return what is said of a drone that stands on a vehicle that drives: a take-off would begin at its speed."""
    is_airborne = s.autopilot.armed and s.autopilot.landed is False
    if s.approach is None or s.pad is None or is_airborne or vehicle_stands(s, config.chase):
        return None
    if s.approach.distance_m > VEHICLE_M or abs(s.approach.height_m) > _ON_ROOF_M:
        return None
    return Cause(Reason.RIDES_ALONG, (math.hypot(*s.pad.velocity_enu_m_s[0, :2].tolist()),))


def _missing_for_start(situation: Situation) -> Cause | None:
    """Return the first thing that is missing for a start, None when nothing is."""
    view, drone = situation.autopilot, situation.drone
    missing = {
        Reason.NO_AUTOPILOT: not view.link_up,
        Reason.NO_ORIGIN: view.frame is None,
        Reason.HEIGHTS_APART: not view.receiver.knows_geoid,
        Reason.NO_OWN_POSITION: drone is None,
        Reason.NO_OWN_ATTITUDE: drone is not None and not drone.attitude_known,
        Reason.IN_FAILSAFE: view.failsafe,
    }
    return next((Cause(reason) for reason, is_missing in missing.items() if is_missing), None)
