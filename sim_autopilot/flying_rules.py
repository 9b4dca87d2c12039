"""How a firmware flies what it is told: setpoints and missions."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from link.mavlink.dialect import Message
from sim_autopilot.memory import AutopilotMemory, Course
from sim_autopilot.missions.flight import MissionStep, Progress
from sim_autopilot.missions.items import Item


class SetpointFlight(Protocol):
    """How setpoints are flown in OFFBOARD, as the mode is called here: each as it comes, or by a path of its own."""

    def may_begin(self, memory: AutopilotMemory) -> bool:
        """Return whether the mode can be entered."""

    def are_lost(self, memory: AutopilotMemory) -> bool:
        """Return whether the setpoints of a drone in this mode have ceased, so that the failsafe begins."""

    def take_local(self, memory: AutopilotMemory, message: Message) -> AutopilotMemory:
        """Return the memory after a SET_POSITION_TARGET_LOCAL_NED."""

    def take_global(self, memory: AutopilotMemory, message: Message) -> AutopilotMemory:
        """Return the memory after a SET_POSITION_TARGET_GLOBAL_INT."""

    def take_attitude(self, memory: AutopilotMemory, message: Message) -> AutopilotMemory:
        """Return the memory after a SET_ATTITUDE_TARGET."""

    def steer(self, memory: AutopilotMemory, elapsed_s: float) -> Course | None:
        """Return what an armed drone in this mode follows next; None where it does as in every other mode."""


def _says_nothing(_before: Progress, _step: MissionStep, _items: tuple[Item, ...]) -> tuple[Message, ...]:
    return ()


@dataclass(frozen=True, slots=True, kw_only=True)
class MissionRules:
    """How it flies missions.

    Attributes:
        home_first: whether item 0 is home, whatever is uploaded there, and is not flown.
        returns_itself: whether a return within a mission is flown by the mission's own mode.
        holds_at_the_end: whether the hold mode follows a mission that ends in the air.
        arms_to_start: whether MISSION_START arms.
        describe: what is said of the items that a step of the flight finished or began.
        flies_single_items: whether an item that belongs to no mission is flown to at once.
    """

    home_first: bool
    returns_itself: bool
    holds_at_the_end: bool
    arms_to_start: bool
    describe: Callable[[Progress, MissionStep, tuple[Item, ...]], tuple[Message, ...]] = _says_nothing
    flies_single_items: bool = False
