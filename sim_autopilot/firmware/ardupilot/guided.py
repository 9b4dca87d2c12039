"""ArduCopter's GUIDED: setpoints lead a shaped path, count in this mode only, and never time out of it."""

from link.mavlink.dialect import Message, mavlink
from sim_autopilot.core.modes import Mode
from sim_autopilot.flight.land_detector import IN_AIR
from sim_autopilot.memory import AutopilotMemory, Course, with_guided
from sim_autopilot.plant.plant import missed_acceleration
from sim_autopilot.setpoints.guided import has_run_up, lift, next_guided, on_the_ground, with_attitude, with_wish
from sim_autopilot.setpoints.guided_attitude import attitude_wish
from sim_autopilot.setpoints.guided_setpoint import STOP, wish_from_message
from sim_autopilot.setpoints.setpoints import local_setpoint

_FRAMES = frozenset(
    {
        mavlink.MAV_FRAME_LOCAL_NED,
        mavlink.MAV_FRAME_LOCAL_OFFSET_NED,
        mavlink.MAV_FRAME_BODY_NED,
        mavlink.MAV_FRAME_BODY_OFFSET_NED,
    }
)


class GuidedFlight:
    """ArduCopter's way with setpoints."""

    def may_begin(self, _memory: AutopilotMemory) -> bool:
        """Return that the mode needs no setpoints."""
        return True

    def are_lost(self, _memory: AutopilotMemory) -> bool:
        """Return that it goes on without them."""
        return False

    def take_local(self, memory: AutopilotMemory, message: Message) -> AutopilotMemory:
        """Return the memory after a SET_POSITION_TARGET_LOCAL_NED; another mode forgets it at once."""
        if memory.modes.mode is not Mode.OFFBOARD:
            return memory
        wish = wish_from_message(message, _FRAMES, memory.places.origin, memory.now)
        return memory if wish is None else with_guided(memory, with_wish(memory.course.guided, wish, memory.now))

    def take_global(self, memory: AutopilotMemory, message: Message) -> AutopilotMemory:
        """Return the memory after a SET_POSITION_TARGET_GLOBAL_INT; one that is not flown stops."""
        local = local_setpoint(message, memory.places.origin, memory.places.home_enu_m, knows_terrain=True)
        if local is not None:
            return self.take_local(memory, local)
        if memory.modes.mode is not Mode.OFFBOARD:
            return memory
        return with_guided(memory, with_wish(memory.course.guided, STOP, memory.now))

    def take_attitude(self, memory: AutopilotMemory, message: Message) -> AutopilotMemory:
        """Return the memory after a SET_ATTITUDE_TARGET; one that is not understood stops."""
        settings, guided, now = memory.tuning.settings, memory.course.guided, memory.now
        if memory.modes.mode is not Mode.OFFBOARD or settings.path is None:
            return memory
        attitude = attitude_wish(message, settings, settings.path)
        taken = with_wish(guided, STOP, now) if attitude is None else with_attitude(guided, attitude, now)
        return with_guided(memory, taken)

    def steer(self, memory: AutopilotMemory, elapsed_s: float) -> Course | None:
        """Return what is followed next; the ground is left by a take-off only, whatever setpoints ask for.

        Raises:
            ValueError: the parameters set no limits of the path.
        """
        settings, course, now = memory.tuning.settings, memory.course, memory.now
        guided, landing = course.guided, course.landing
        if settings.path is None:
            raise ValueError("a firmware with GUIDED has limits of its path")
        if landing.landed and has_run_up(guided, now, settings.path):
            guided, landing = lift(guided, now), IN_AIR
        if landing.landed:
            guided = on_the_ground(guided, now)
            return Course(flight=course.flight, guided=guided, climb=None, landing=landing, following=None)
        missed = missed_acceleration(memory.plant)
        guided, reference = next_guided(guided, now, settings.path, elapsed_s, missed)
        return Course(flight=course.flight, guided=guided, climb=None, landing=landing, following=reference)
