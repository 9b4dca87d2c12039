"""Answers to an operator's commands: what is accepted in which phase, and why not."""

import math

from companion.config.companion import CompanionConfig
from companion.integrity.ground import VEHICLE_M
from companion.landing.feasibility import HEIGHTS_APART
from companion.situation.phases import Event, Phase, next_phase
from companion.situation.situation import Situation, approach, stands
from link.messages import Command, CommandReply

_ON_ROOF_M = 1.0  # above or below it: the road is farther below
_EVENTS = {Command.START: Event.START, Command.ABORT: Event.ABORT, Command.HOLD: Event.HOLD}


def answer(
    command: Command, phase: Phase, situation: Situation, config: CompanionConfig, obstacle: str | None = None
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
    if phase is Phase.TAKEOFF and command is not Command.START and not situation.autopilot.armed:
        event = Event.CALLED_OFF  # on the ground there is nothing to hold
    flies = situation.autopilot.in_control and situation.autopilot.armed
    if phase is Phase.HOLD and command is Command.START and not flies:
        event = Event.START_AGAIN  # called off before the autopilot gave control: it has to be asked for again
    if phase is Phase.ABORT and command is not Command.START:
        return None, CommandReply(accepted=True, reason="")  # the climb goes on, but to no retry
    if next_phase(phase, event) is phase:
        return None, CommandReply(accepted=False, reason=f"nothing to {command.value} in phase {phase.value}")
    missing = None
    if command is Command.START:
        missing = _missing_for_start(situation) or _rides_along(situation, config) or obstacle
    if missing is not None:
        return None, CommandReply(accepted=False, reason=missing)
    return event, CommandReply(accepted=True, reason="")


def _rides_along(s: Situation, config: CompanionConfig) -> str | None:
    """Return what is said of a drone that stands on a vehicle that drives: a take-off would begin at its speed."""
    relative, is_airborne = approach(s), s.autopilot.armed and s.autopilot.landed is False
    if relative is None or s.pad is None or is_airborne or stands(s, config.chase):
        return None
    if relative.distance_m > VEHICLE_M or abs(relative.height_m) > _ON_ROOF_M:
        return None
    speed_m_s = math.hypot(*s.pad.velocity_enu_m_s[0, :2].tolist())
    return f"the drone stands on the vehicle, which drives at {speed_m_s:.1f} m/s: stop it first"


def _missing_for_start(situation: Situation) -> str | None:
    """Return the first thing that is missing for a start, None when nothing is."""
    view, drone = situation.autopilot, situation.drone
    missing = {
        "no autopilot is connected": not view.link_up,
        "the autopilot has no origin yet": view.frame is None,
        HEIGHTS_APART: not view.geoid_known,
        "the autopilot reports no local position yet": drone is None,
        "the autopilot's attitude is too old": drone is not None and not drone.attitude_known,
        "the autopilot is in failsafe": view.failsafe,
    }
    return next((reason for reason, is_missing in missing.items() if is_missing), None)
