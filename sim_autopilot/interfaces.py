"""What does not change while it runs: the firmware that it stands in for, and the services beside the flight.

A firmware is data in groups and a few behaviours; each has its folder in `firmware/`. The services answer what only a
ground station asks; the core does not know which there are, and flies without any.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from math import pi
from types import MappingProxyType
from typing import Protocol, TypeAlias

import msgspec
from msgspec import Struct

from link.frames.geodesy import Datum
from link.mavlink.dialect import Message
from link.messages import Vector3
from sim_autopilot.commands.requests import Answer, Request
from sim_autopilot.core.firmware import (
    Condition,
    Identity,
    LinkRules,
    ModeRules,
    OriginRules,
    ParameterRules,
    Results,
)
from sim_autopilot.core.parameters import Values
from sim_autopilot.core.range_finder import RangeFinderModel
from sim_autopilot.core.status_texts import EventCode, Texts
from sim_autopilot.core.streams import Stream
from sim_autopilot.flying_rules import MissionRules, SetpointFlight
from sim_autopilot.memory import AutopilotMemory
from sim_autopilot.plant.config import PlantConfig
from sim_autopilot.plant.own_state import OwnStateModel

Result: TypeAlias = tuple[AutopilotMemory, tuple[Message, ...]]
"""The memory after something, and what is sent because of it."""
Builder: TypeAlias = "Callable[[AutopilotMemory, AutopilotConfig], Message | None]"
"""Makes a message of now; None where there is nothing to tell."""
Handler: TypeAlias = "Callable[[AutopilotMemory, Request, AutopilotConfig], Answer]"
"""Obeys a command."""
Said: TypeAlias = tuple[str, EventCode | None]
"""A text, and its event where the firmware's table has none of that text."""


DescribeFlight: TypeAlias = "Callable[[AutopilotMemory, AutopilotMemory, AutopilotMemory, AutopilotConfig], list[Said]]"
"""Tells what is said about a step by the memory before it, after its messages and at its end."""


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
    builders: Mapping[int, Builder] = field(default_factory=dict)
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

    handlers: Mapping[int, Handler]
    results: Results
    answers_other_components: bool
    reboots: bool


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
    def builders(self) -> Mapping[int, Builder]:
        """What makes these."""

    def begin(self) -> object:
        """Return its memory at boot."""

    def keep(self, station: object) -> object:
        """Return what of its memory outlives a reboot."""

    def handle(self, memory: AutopilotMemory, message: Message, config: "AutopilotConfig") -> Result | None:
        """Return the memory after a message, and what answers it; None for one that is not the services'."""

    def advance(self, memory: AutopilotMemory, config: "AutopilotConfig") -> Result:
        """Return the memory a step on, and what is sent to whoever waits for it."""

    def report(self, memory: AutopilotMemory, config: "AutopilotConfig") -> Result:
        """Return the memory a step on, and what is sent on the link at hand."""


class NoServices:
    """No services: nothing is handled, nothing is sent."""

    streams: Mapping[int, Stream] = MappingProxyType({})
    builders: Mapping[int, Builder] = MappingProxyType({})

    def begin(self) -> object:
        """Return nothing."""
        return None

    def keep(self, station: object) -> object:
        """Return what there is."""
        return station

    def handle(self, _memory: AutopilotMemory, _message: Message, _config: "AutopilotConfig") -> Result | None:
        """Leave every message to the flight."""
        return None

    def advance(self, memory: AutopilotMemory, _config: "AutopilotConfig") -> Result:
        """Send nothing."""
        return memory, ()

    def report(self, memory: AutopilotMemory, _config: "AutopilotConfig") -> Result:
        """Send nothing."""
        return memory, ()


NO_SERVICES = NoServices()


class AutopilotConfig(Struct, frozen=True, kw_only=True):
    """What does not change while the autopilot runs.

    Attributes:
        firmware: which one it stands in for.
        datum: origin of W, a tangent plane, and of the autopilot's local frame at boot.
        plant: the drone; the parameters' limits take the place of its envelope's.
        system_id: MAVLink system.
        instant: ready at once, without the seconds that a boot takes.
        position_enu_m: where the drone stands at boot, its centre of mass.
        yaw_rad: its heading there.
        velocity_enu_m_s: with which what it stands on carries it.
        parameters: values that differ from the firmware's defaults.
        endurance_s: of motors running on one battery.
        own_state: how well it knows where it is.
        range_finder: that looks down.
        links: of each MAVLink link the rates at which it streams, in Hz by message id; None for the firmware's own.
        services: what answers beside the flight.
    """

    firmware: Firmware
    datum: Datum
    plant: PlantConfig = msgspec.field(default_factory=PlantConfig)
    system_id: int = 1
    instant: bool = False
    position_enu_m: Vector3 = (0.0, 0.0, 0.12)
    yaw_rad: float = pi / 2.0
    velocity_enu_m_s: Vector3 = (0.0, 0.0, 0.0)
    parameters: Values = msgspec.field(default_factory=dict)
    endurance_s: float = 1200.0
    own_state: OwnStateModel = msgspec.field(default_factory=OwnStateModel)
    range_finder: RangeFinderModel = msgspec.field(default_factory=RangeFinderModel)
    links: tuple[Mapping[int, float] | None, ...] = (None,)
    services: Services = NO_SERVICES


def has_passed(config: AutopilotConfig, memory: AutopilotMemory, since_boot_s: float) -> bool:
    """Return whether so much time has passed since boot, or need not."""
    return config.instant or memory.now.boot_ns * 1e-9 >= since_boot_s
