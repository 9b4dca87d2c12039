"""What the step is given besides its memory: the firmware that it stands in for, and the services beside the flight.

A firmware is data in groups and a few behaviours; each has its folder in `firmware/`. The services answer what only a
ground station asks; the core does not know which there are, and flies without any.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Protocol, TypeAlias

from link.mavlink.dialect import Message
from sim_autopilot.core.firmware import (
    Condition,
    Identity,
    LinkRules,
    ModeRules,
    OriginRules,
    ParameterRules,
    Results,
)
from sim_autopilot.core.status_texts import EventCode, Texts
from sim_autopilot.core.streams import Stream

if TYPE_CHECKING:
    from sim_autopilot.commands.requests import Handler
    from sim_autopilot.memory import AutopilotConfig, AutopilotMemory, Course
    from sim_autopilot.missions.flight import MissionStep, Progress
    from sim_autopilot.missions.items import Item

Result: TypeAlias = "tuple[AutopilotMemory, tuple[Message, ...]]"
"""The memory after something, and what is sent because of it."""
Builder: TypeAlias = "Callable[[AutopilotMemory, AutopilotConfig], Message | None]"
"""Makes a message of now; None where there is nothing to tell."""
Said: TypeAlias = "tuple[str, EventCode | None]"
"""A text, and its event where the firmware's table has none of that text."""


DescribeFlight: TypeAlias = "Callable[[AutopilotMemory, AutopilotMemory, AutopilotMemory, AutopilotConfig], list[Said]]"
"""Tells what is said about a step by the memory before it, after its messages and at its end."""


class SetpointFlight(Protocol):
    """How setpoints are flown in OFFBOARD, as the mode is called here: each as it comes, or by a path of its own."""

    def may_begin(self, memory: "AutopilotMemory") -> bool:
        """Return whether the mode can be entered."""

    def are_lost(self, memory: "AutopilotMemory") -> bool:
        """Return whether the setpoints of a drone in this mode have ceased, so that the failsafe begins."""

    def take_local(self, memory: "AutopilotMemory", message: Message) -> "AutopilotMemory":
        """Return the memory after a SET_POSITION_TARGET_LOCAL_NED."""

    def take_global(self, memory: "AutopilotMemory", message: Message) -> "AutopilotMemory":
        """Return the memory after a SET_POSITION_TARGET_GLOBAL_INT."""

    def take_attitude(self, memory: "AutopilotMemory", message: Message) -> "AutopilotMemory":
        """Return the memory after a SET_ATTITUDE_TARGET."""

    def steer(self, memory: "AutopilotMemory", elapsed_s: float) -> "Course | None":
        """Return what an armed drone in this mode follows next; None where it does as in every other mode."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StreamRules:
    """What it can send of itself, and how often.

    Attributes:
        messages: every message that it can send, by id, with default rates.
        builders: of messages that only this firmware sends, or fills in its own way.
        groups: message ids by the MAV_DATA_STREAM that starts them.
        group_parameters: ends of the names of the parameters that keep a group's rate, by MAV_DATA_STREAM.
        on_contact: message ids that begin only when somebody has spoken.
        rate_max_hz: that a SET_MESSAGE_INTERVAL gets at most.
        silent: ids whose rate can be set, with nothing to tell of.
        answers_silent: whether one of these can be asked for as well.
    """

    messages: Mapping[int, Stream]
    builders: "Mapping[int, Builder]" = field(default_factory=dict)
    groups: Mapping[int, tuple[int, ...]] = field(default_factory=dict)
    group_parameters: Mapping[int, str] = field(default_factory=dict)
    on_contact: frozenset[int] = frozenset()
    rate_max_hz: float
    silent: frozenset[int]
    answers_silent: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class CommandRules:
    """The commands that it obeys.

    Attributes:
        handlers: by MAV_CMD; what is not here is a service's, or unsupported.
        results: of refusals.
        answers_other_components: whether it answers what is for another component of its system, and commands for all.
        reboots: whether a command makes it reboot.
    """

    handlers: "Mapping[int, Handler]"
    results: Results
    answers_other_components: bool
    reboots: bool


def _says_nothing(_before: "Progress", _step: "MissionStep", _items: "tuple[Item, ...]") -> tuple[Message, ...]:
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
    describe: "Callable[[Progress, MissionStep, tuple[Item, ...]], tuple[Message, ...]]" = _says_nothing
    flies_single_items: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Firmware:
    """An autopilot firmware.

    Attributes:
        name: as `--firmware` takes it.
        identity: of build and board.
        modes: that it has.
        condition: that it tells.
        streams: of messages.
        parameters: and what they amount to.
        texts: of what it says when.
        events: that it sends besides texts, by their text.
        describe_flight: what it says about a step; None says nothing.
        commands: that it obeys.
        setpoints: how they are flown.
        origin: of the local frame.
        missions: how they are flown.
        links: and how they are treated.
    """

    name: str
    identity: Identity
    modes: ModeRules
    condition: Condition
    streams: StreamRules
    parameters: ParameterRules
    texts: Texts
    events: Mapping[str, EventCode] = field(default_factory=dict)
    describe_flight: "DescribeFlight | None" = None
    commands: CommandRules
    setpoints: SetpointFlight
    origin: OriginRules
    missions: MissionRules
    links: LinkRules


class Services(Protocol):
    """What answers beside the flight. Its own memory is carried as one object that only it can read."""

    @property
    def streams(self) -> Mapping[int, Stream]:
        """The messages that it can send besides the firmware's, by id."""

    @property
    def builders(self) -> "Mapping[int, Builder]":
        """What makes these."""

    def begin(self) -> object:
        """Return its memory at boot."""

    def keep(self, station: object) -> object:
        """Return what of its memory outlives a reboot."""

    def handle(self, memory: "AutopilotMemory", message: Message, config: "AutopilotConfig") -> "Result | None":
        """Return the memory after a message, and what answers it; None for one that is not the services'."""

    def advance(self, memory: "AutopilotMemory", config: "AutopilotConfig") -> "Result":
        """Return the memory a step on, and what is sent to whoever waits for it."""

    def report(self, memory: "AutopilotMemory", config: "AutopilotConfig") -> "Result":
        """Return the memory a step on, and what is sent on the link at hand."""


class NoServices:
    """No services: nothing is handled, nothing is sent."""

    streams: Mapping[int, Stream] = MappingProxyType({})
    builders: "Mapping[int, Builder]" = MappingProxyType({})

    def begin(self) -> object:
        """Return nothing."""
        return None

    def keep(self, station: object) -> object:
        """Return what there is."""
        return station

    def handle(self, _memory: "AutopilotMemory", _message: Message, _config: "AutopilotConfig") -> "Result | None":
        """Leave every message to the flight."""
        return None

    def advance(self, memory: "AutopilotMemory", _config: "AutopilotConfig") -> "Result":
        """Send nothing."""
        return memory, ()

    def report(self, memory: "AutopilotMemory", _config: "AutopilotConfig") -> "Result":
        """Send nothing."""
        return memory, ()


NO_SERVICES = NoServices()
