"""What the mission protocol remembers: the plans, and the transfer of one under way."""

from dataclasses import dataclass, field
from enum import Enum

from link.mavlink.dialect import Message, mavlink
from sim_autopilot.ground_station.missions.rules import TransferRules
from sim_autopilot.missions.items import NO_PLANS, Item, Plans

Target = tuple[int, int]


class Way(Enum):
    """Which way the items go."""

    UPLOAD = 0
    DOWNLOAD = 1


@dataclass(frozen=True, slots=True, kw_only=True)
class Transfer:
    """A transfer under way with `partner` (system, component), last heard at `heard_ns`, last asked at `asked_ns`.

    `whole` says whether items are asked for as integers, `part` whether the plan's other items stay.
    """

    way: Way
    kind: int
    partner: Target
    count: int
    heard_ns: int
    asked_ns: int
    items: tuple[Item, ...] = ()
    whole: bool = True
    part: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Library:
    """The plans that the autopilot holds and the transfer under way; `changed` counts new missions."""

    plans: Plans = field(default_factory=lambda: NO_PLANS)
    transfer: Transfer | None = None
    changed: int = 0


NO_LIBRARY = Library()


@dataclass(frozen=True, slots=True, kw_only=True)
class Arrival:
    """A message of the protocol for this autopilot, when it came, and what decides about it.

    `current` is the index of the mission's current item, `home` stands for item 0 where home is that.
    """

    message: Message
    boot_ns: int
    rules: TransferRules
    current: int
    home: Item | None = None

    @property
    def partner(self) -> Target:
        """Who sent it."""
        return self.message.get_srcSystem(), self.message.get_srcComponent()

    @property
    def kind(self) -> int:
        """The MAV_MISSION_TYPE; MAVLink 1 knows missions only."""
        return int(self.message.mission_type)

    def answer(self, result: int) -> Message:
        """Return the MISSION_ACK to it."""
        return acknowledgement(self.partner, result, self.kind)


def acknowledgement(partner: Target, result: int, kind: int) -> Message:
    """Return a MISSION_ACK."""
    return mavlink.MAVLink_mission_ack_message(*partner, result, kind)


def is_kept_out(library: Library, arrival: Arrival, way: Way) -> bool:
    """Return whether the transfer under way keeps a new one out."""
    transfer = library.transfer
    if transfer is None:
        return False
    if not arrival.rules.one_at_a_time:
        return transfer.way is Way.UPLOAD and transfer.partner != arrival.partner
    again = transfer.way is way and transfer.kind == arrival.kind
    return not (again and (way is Way.DOWNLOAD or not transfer.items))


def begun(arrival: Arrival, way: Way, count: int) -> Transfer:
    """Return a transfer that begins with `arrival`."""
    return Transfer(
        way=way,
        kind=arrival.kind,
        partner=arrival.partner,
        count=count,
        heard_ns=arrival.boot_ns,
        asked_ns=arrival.boot_ns,
        whole=arrival.rules.asks_whole,
    )
