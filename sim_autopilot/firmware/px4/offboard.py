"""PX4's OFFBOARD: each setpoint is followed as it comes, may lift the drone off, and has to be followed by more."""

from link.mavlink.dialect import Message, mavlink
from link.records import replace
from sim_autopilot.core.data import Reference
from sim_autopilot.core.modes import Event
from sim_autopilot.flight.mode_change import change_mode
from sim_autopilot.memory import AutopilotMemory, Course
from sim_autopilot.setpoints.attitude import attitude_from_message
from sim_autopilot.setpoints.setpoints import (
    are_fresh,
    are_streaming,
    local_setpoint,
    reference_from_message,
    with_setpoint,
)

_FRAMES = frozenset({mavlink.MAV_FRAME_LOCAL_NED, mavlink.MAV_FRAME_BODY_NED})
_STREAM_S = 0.0
"""How long setpoints must have come: one is enough, since MAVSDK sends its first and asks for the mode at once."""


class Offboard:
    """PX4's way with setpoints."""

    def may_begin(self, memory: AutopilotMemory) -> bool:
        """Return whether setpoints come so steadily that the mode can be entered."""
        loss_s = memory.tuning.settings.setpoints.loss_s
        return are_streaming(memory.heard.setpoints, memory.now.boot_ns, loss_s, _STREAM_S)

    def are_lost(self, memory: AutopilotMemory) -> bool:
        """Return whether the last setpoint is too old."""
        return not are_fresh(memory.heard.setpoints, memory.now.boot_ns, memory.tuning.settings.setpoints.loss_s)

    def take_local(self, memory: AutopilotMemory, message: Message) -> AutopilotMemory:
        """Return the memory after a SET_POSITION_TARGET_LOCAL_NED."""
        return _follow(memory, reference_from_message(message, _FRAMES, memory.places.origin, memory.now))

    def take_global(self, memory: AutopilotMemory, message: Message) -> AutopilotMemory:
        """Return the memory after a SET_POSITION_TARGET_GLOBAL_INT."""
        local = local_setpoint(message, memory.places.origin, memory.places.home_enu_m)
        return memory if local is None else self.take_local(memory, local)

    def take_attitude(self, memory: AutopilotMemory, message: Message) -> AutopilotMemory:
        """Return the memory after a SET_ATTITUDE_TARGET."""
        return _follow(memory, attitude_from_message(message, memory.tuning.settings.setpoints.hover_share))

    def steer(self, _memory: AutopilotMemory, _elapsed_s: float) -> Course | None:
        """Return None: the setpoint is the mode's wish as any other is."""
        return None


def _follow(memory: AutopilotMemory, reference: Reference | None) -> AutopilotMemory:
    if reference is None:
        return memory
    heard, boot_ns = memory.heard, memory.now.boot_ns
    setpoints = with_setpoint(heard.setpoints, reference, boot_ns, memory.tuning.settings.setpoints.loss_s)
    return change_mode(replace(memory, heard=replace(heard, setpoints=setpoints)), Event.SETPOINTS_BACK)
