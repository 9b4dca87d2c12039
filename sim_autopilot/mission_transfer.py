"""The mission protocol as a machine without time or link of its own: messages and instants in, answers and plans out.

Source: https://mavlink.io/en/services/mission.html; what is refused, retried and given up as `MissionRules` says.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from enum import Enum
from types import MappingProxyType

from link.mavlink.dialect import Message, mavlink
from sim_autopilot.missions import (
    NO_PLANS,
    Item,
    MissionRules,
    Plans,
    item_from_message,
    item_message,
    result_of,
)

_ACCEPTED = int(mavlink.MAV_MISSION_ACCEPTED)
_ERROR = int(mavlink.MAV_MISSION_ERROR)
_ALL = int(mavlink.MAV_MISSION_TYPE_ALL)

Target = tuple[int, int]


class Way(Enum):
    """Which way the items go."""

    UPLOAD = 0
    DOWNLOAD = 1


@dataclass(frozen=True, slots=True, kw_only=True)
class Transfer:
    """A transfer under way with `partner` (system, component), last heard at `heard_ns`, last asked at `asked_ns`.

    `whole` says whether items are asked for as integers.
    """

    way: Way
    kind: int
    partner: Target
    count: int
    heard_ns: int
    asked_ns: int
    items: tuple[Item, ...] = ()
    whole: bool = True


@dataclass(frozen=True, slots=True, kw_only=True)
class Library:
    """The plans that the autopilot holds and the transfer under way; `changed` counts new missions."""

    plans: Plans = field(default_factory=lambda: NO_PLANS)
    transfer: Transfer | None = None
    changed: int = 0


NO_LIBRARY = Library()

Result = tuple[Library, tuple[Message, ...]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Arrival:
    """A message of the protocol for this autopilot, when it came, and what decides about it.

    `current` is the index of the mission's current item.
    """

    message: Message
    boot_ns: int
    rules: MissionRules
    current: int

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
        return _acknowledgement(self.partner, result, self.kind)


def take_mission_message(library: Library, arrival: Arrival) -> Result:
    """Return the library after a message of the mission protocol, and what answers it."""
    message_id, kind = arrival.message.get_msgId(), arrival.kind
    handler = _HANDLERS.get(message_id)
    if handler is None:
        return library, ()
    all_allowed = message_id in {mavlink.MAVLINK_MSG_ID_MISSION_CLEAR_ALL, mavlink.MAVLINK_MSG_ID_MISSION_ACK}
    if kind not in arrival.rules.counts_max and not (kind == _ALL and all_allowed):
        return library, (arrival.answer(int(mavlink.MAV_MISSION_UNSUPPORTED)),)
    return handler(library, arrival)


def transfer_passes(library: Library, boot_ns: int, rules: MissionRules) -> Result:
    """Return the library at `boot_ns`, with a missing item asked for again or a silent transfer given up."""
    transfer = library.transfer
    if transfer is None:
        return library, ()
    if (boot_ns - transfer.heard_ns) * 1e-9 > rules.timeout_s:
        told = rules.timeout_answered and transfer.way is Way.UPLOAD
        cancelled = _acknowledgement(transfer.partner, int(mavlink.MAV_MISSION_OPERATION_CANCELLED), transfer.kind)
        return replace(library, transfer=None), (cancelled,) if told else ()
    if transfer.way is Way.UPLOAD and (boot_ns - transfer.asked_ns) * 1e-9 > rules.retry_s:
        return _ask(library, replace(transfer, asked_ns=boot_ns))
    return library, ()


def _acknowledgement(partner: Target, result: int, kind: int) -> Message:
    return mavlink.MAVLink_mission_ack_message(*partner, result, kind)


def _ask(library: Library, transfer: Transfer) -> Result:
    kinds = (mavlink.MAVLink_mission_request_message, mavlink.MAVLink_mission_request_int_message)
    request = kinds[transfer.whole](*transfer.partner, len(transfer.items), transfer.kind)
    return replace(library, transfer=transfer), (request,)


def _is_kept_out(library: Library, arrival: Arrival, way: Way) -> bool:
    """Whether the transfer under way keeps a new one out."""
    transfer = library.transfer
    if transfer is None:
        return False
    if not arrival.rules.one_at_a_time:
        return transfer.way is Way.UPLOAD and transfer.partner != arrival.partner
    again = transfer.way is way and transfer.kind == arrival.kind
    return not (again and (way is Way.DOWNLOAD or not transfer.items))


def _begun(arrival: Arrival, way: Way, count: int) -> Transfer:
    return Transfer(
        way=way,
        kind=arrival.kind,
        partner=arrival.partner,
        count=count,
        heard_ns=arrival.boot_ns,
        asked_ns=arrival.boot_ns,
    )


def _count(library: Library, arrival: Arrival) -> Result:
    count, kind = arrival.message.count, arrival.kind
    if _is_kept_out(library, arrival, Way.UPLOAD):
        return library, (arrival.answer(_ERROR),)
    if count > arrival.rules.counts_max[kind]:
        return library, (arrival.answer(int(mavlink.MAV_MISSION_NO_SPACE)),)
    if count == 0:
        return _store(library, kind, ()), (arrival.answer(_ACCEPTED),)
    return _ask(library, _begun(arrival, Way.UPLOAD, count))


def _store(library: Library, kind: int, items: tuple[Item, ...]) -> Library:
    changed = library.changed + (kind == mavlink.MAV_MISSION_TYPE_MISSION)
    return Library(plans={**library.plans, kind: items}, transfer=None, changed=changed)


def _item(library: Library, arrival: Arrival) -> Result:
    transfer, message = library.transfer, arrival.message
    expected = (Way.UPLOAD, arrival.kind, arrival.partner)
    if transfer is None or (transfer.way, transfer.kind, transfer.partner) != expected:
        return library, (arrival.answer(_ERROR),)
    transfer = replace(transfer, heard_ns=arrival.boot_ns, asked_ns=arrival.boot_ns)
    if message.seq == len(transfer.items):
        return _add(library, transfer, arrival)
    wrong = arrival.rules.wrong_sequence
    if wrong is None:
        return _ask(library, transfer)
    return replace(library, transfer=transfer), (arrival.answer(wrong),)


def _add(library: Library, transfer: Transfer, arrival: Arrival) -> Result:
    try:
        item = item_from_message(arrival.message)
        result = result_of(item, transfer.kind)
    except ValueError:
        return replace(library, transfer=None), (arrival.answer(_ERROR),)
    if result != _ACCEPTED:
        return replace(library, transfer=None), (arrival.answer(result),)
    items = (*transfer.items, item)
    if len(items) < transfer.count:
        return _ask(library, replace(transfer, items=items))
    return _store(library, transfer.kind, items), (arrival.answer(_ACCEPTED),)


def _list(library: Library, arrival: Arrival) -> Result:
    if _is_kept_out(library, arrival, Way.DOWNLOAD):
        return library, (arrival.answer(_ERROR),)
    items = library.plans[arrival.kind]
    if arrival.rules.one_at_a_time:
        library = replace(library, transfer=_begun(arrival, Way.DOWNLOAD, len(items)))
    count = mavlink.MAVLink_mission_count_message(*arrival.partner, len(items), arrival.kind)
    return library, (count,)


def _request(library: Library, arrival: Arrival) -> Result:
    transfer = library.transfer
    if arrival.rules.one_at_a_time:
        if transfer is None or transfer.partner != arrival.partner:
            return library, ()
        if transfer.way is Way.UPLOAD or transfer.kind != arrival.kind:
            return library, (arrival.answer(_ERROR),)
        library = replace(library, transfer=replace(transfer, heard_ns=arrival.boot_ns))
    return _serve(library, arrival)


def _serve(library: Library, arrival: Arrival) -> Result:
    kind, index, items = arrival.kind, arrival.message.seq, library.plans[arrival.kind]
    if index >= len(items):
        wrong = arrival.rules.wrong_sequence
        return replace(library, transfer=None), (arrival.answer(_ERROR if wrong is None else wrong),)
    whole = arrival.message.get_msgId() == mavlink.MAVLINK_MSG_ID_MISSION_REQUEST_INT
    current = kind == mavlink.MAV_MISSION_TYPE_MISSION and index == arrival.current
    return library, (item_message(items[index], index, kind, arrival.partner, current=current, whole=whole),)


def _answered(library: Library, arrival: Arrival) -> Result:
    """Take a partner's MISSION_ACK, by which it ends its download, gives up, or asks for the other form of items."""
    transfer = library.transfer
    if transfer is None or transfer.partner != arrival.partner:
        return library, ()
    if transfer.way is Way.UPLOAD and arrival.message.type == mavlink.MAV_MISSION_UNSUPPORTED:
        now_ns = arrival.boot_ns
        return _ask(library, replace(transfer, whole=not transfer.whole, heard_ns=now_ns, asked_ns=now_ns))
    return replace(library, transfer=None), ()


def _clear(library: Library, arrival: Arrival) -> Result:
    rules = arrival.rules
    if rules.one_at_a_time and library.transfer is not None:
        return library, (arrival.answer(_ERROR),)
    for kind in rules.counts_max if arrival.kind == _ALL else (arrival.kind,):
        library = _store(library, kind, ())
    return library, (arrival.answer(_ACCEPTED),)


_HANDLERS: Mapping[int, Callable[[Library, Arrival], Result]] = MappingProxyType(
    {
        mavlink.MAVLINK_MSG_ID_MISSION_COUNT: _count,
        mavlink.MAVLINK_MSG_ID_MISSION_ITEM: _item,
        mavlink.MAVLINK_MSG_ID_MISSION_ITEM_INT: _item,
        mavlink.MAVLINK_MSG_ID_MISSION_REQUEST_LIST: _list,
        mavlink.MAVLINK_MSG_ID_MISSION_REQUEST: _request,
        mavlink.MAVLINK_MSG_ID_MISSION_REQUEST_INT: _request,
        mavlink.MAVLINK_MSG_ID_MISSION_ACK: _answered,
        mavlink.MAVLINK_MSG_ID_MISSION_CLEAR_ALL: _clear,
    }
)
MESSAGE_IDS = frozenset(_HANDLERS)
"""The messages of the protocol."""
