"""Answers to an operator's commands: what is accepted in which phase, and why not."""

from companion.feasibility import HEIGHTS_APART
from companion.phases import Event, Phase, next_phase
from companion.situation import Situation
from link.messages import Command, CommandReply

_EVENTS = {Command.START: Event.START, Command.ABORT: Event.ABORT, Command.HOLD: Event.HOLD}


def answer(
    command: Command, phase: Phase, situation: Situation, obstacle: str | None = None
) -> tuple[Event | None, CommandReply]:
    """Return the event that the command amounts to, None when it changes no phase, and the reply.

    Args:
        command: the operator's.
        phase: now.
        situation: now.
        obstacle: why no landing can be done, None when one can.
    """
    event = _EVENTS[command]
    if phase is Phase.TAKEOFF and command is not Command.START and not situation.autopilot.armed:
        event = Event.CALLED_OFF  # on the ground there is nothing to hold
    if phase is Phase.ABORT and command is not Command.START:
        return None, CommandReply(accepted=True, reason="")  # the climb goes on, but to no retry
    if next_phase(phase, event) is phase:
        return None, CommandReply(accepted=False, reason=f"nothing to {command.value} in phase {phase.value}")
    missing = (_missing_for_start(situation) or obstacle) if command is Command.START else None
    if missing is not None:
        return None, CommandReply(accepted=False, reason=missing)
    return event, CommandReply(accepted=True, reason="")


def _missing_for_start(situation: Situation) -> str | None:
    if not situation.autopilot.link_up:
        return "no autopilot is connected"
    if situation.autopilot.frame is None:
        return "the autopilot has no origin yet"
    if not situation.autopilot.geoid_known:
        return HEIGHTS_APART
    if situation.drone is None:
        return "the autopilot reports no local position yet"
    if situation.autopilot.failsafe:
        return "the autopilot is in failsafe"
    return None
