"""The mission protocol as a machine without time or link of its own: messages and instants in, answers and plans out.

Source: https://mavlink.io/en/services/mission.html; what is refused, retried and given up as `TransferRules` says.
"""

from collections.abc import Callable, Mapping
from types import MappingProxyType

from link.mavlink.dialect import Message, mavlink
from link.records import replace
from sim_autopilot.ground_station.missions.library import (
    Arrival,
    Library,
    Transfer,
    Way,
    acknowledgement,
    begun,
    is_kept_out,
)
from sim_autopilot.ground_station.missions.rules import TransferRules
from sim_autopilot.ground_station.missions.stored import encloses_nothing, leads_nowhere, restore_item, store_item
from sim_autopilot.missions.items import FENCE, Item, item_from_message, item_message, result_of, unreadable

_ACCEPTED = int(mavlink.MAV_MISSION_ACCEPTED)
_ERROR = int(mavlink.MAV_MISSION_ERROR)
_ALL = int(mavlink.MAV_MISSION_TYPE_ALL)

Result = tuple[Library, tuple[Message, ...]]


def take_mission_message(library: Library, arrival: Arrival) -> Result:
    """Return the library after a message of the mission protocol, and what answers it."""
    message_id, kind = arrival.message.get_msgId(), arrival.kind
    handler = _HANDLERS.get(message_id)
    if handler is None:
        return library, ()
    clears = message_id == mavlink.MAVLINK_MSG_ID_MISSION_CLEAR_ALL and arrival.rules.clears_all
    all_allowed = clears or message_id == mavlink.MAVLINK_MSG_ID_MISSION_ACK
    if kind not in arrival.rules.counts_max and not (kind == _ALL and all_allowed):
        return library, (arrival.answer(int(mavlink.MAV_MISSION_UNSUPPORTED)),)
    return handler(library, arrival)


def transfer_passes(library: Library, boot_ns: int, rules: TransferRules) -> Result:
    """Return the library at `boot_ns`, with a missing item asked for again or a silent transfer given up."""
    transfer = library.transfer
    if transfer is None:
        return library, ()
    if (boot_ns - transfer.heard_ns) * 1e-9 > rules.timeout_s:
        is_told = rules.timeout_answered and transfer.way is Way.UPLOAD
        cancelled = acknowledgement(transfer.partner, int(mavlink.MAV_MISSION_OPERATION_CANCELLED), transfer.kind)
        return replace(library, transfer=None), (cancelled,) if is_told else ()
    if transfer.way is Way.UPLOAD and (boot_ns - transfer.asked_ns) * 1e-9 > rules.retry_s:
        return _ask(library, replace(transfer, asked_ns=boot_ns))
    return library, ()


def _ask(library: Library, transfer: Transfer) -> Result:
    kinds = (mavlink.MAVLink_mission_request_message, mavlink.MAVLink_mission_request_int_message)
    request = kinds[transfer.whole](*transfer.partner, len(transfer.items), transfer.kind)
    return replace(library, transfer=transfer), (request,)


def _count(library: Library, arrival: Arrival) -> Result:
    count, kind = arrival.message.count, arrival.kind
    if is_kept_out(library, arrival, Way.UPLOAD):
        return library, (arrival.answer(_ERROR),)
    if count > arrival.rules.counts_max[kind]:
        return library, (arrival.answer(int(mavlink.MAV_MISSION_NO_SPACE)),)
    if count == 0:
        return _store(library, kind, ()), (arrival.answer(_ACCEPTED),)
    if kind in arrival.rules.stores_at_once:
        library = _keep(library, kind, library.plans[kind][:count])
    return _ask(library, begun(arrival, Way.UPLOAD, count))


def _part(library: Library, arrival: Arrival) -> Result:
    """Take some items of a plan again; the others stay."""
    first, last, items = arrival.message.start_index, arrival.message.end_index, library.plans[arrival.kind]
    if not arrival.rules.takes_parts:
        return library, ()
    if is_kept_out(library, arrival, Way.UPLOAD) or not 0 <= first <= last < len(items):
        return library, (arrival.answer(_ERROR),)
    return _ask(library, replace(begun(arrival, Way.UPLOAD, last + 1), items=items[:first], part=True))


def _keep(library: Library, kind: int, items: tuple[Item, ...]) -> Library:
    """Change a plan whose upload goes on."""
    return replace(library, plans={**library.plans, kind: items})


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
    result = unreadable(arrival.message) if arrival.rules.items.needs_numbers else None
    try:
        item = item_from_message(arrival.message)
        item = store_item(item, transfer.kind) if arrival.rules.items.keeps_little else item
        result = (
            result_of(item, transfer.kind, arrival.rules.items.commands, arrival.rules.items.frames)
            if result is None
            else result
        )
    except ValueError:
        return replace(library, transfer=None), (arrival.answer(_ERROR),)
    items = (*transfer.items, item)
    if result == _ACCEPTED and arrival.rules.items.keeps_little and _makes_no_sense(library, transfer, items):
        result = _ERROR
    if result != _ACCEPTED:
        return replace(library, transfer=None), (arrival.answer(result),)
    if transfer.kind in arrival.rules.stores_at_once:
        library = _keep(library, transfer.kind, (*items, *library.plans[transfer.kind][len(items) :]))
    if len(items) < transfer.count:
        whole = arrival.rules.asks_whole and arrival.message.get_msgId() == mavlink.MAVLINK_MSG_ID_MISSION_ITEM_INT
        return _ask(library, replace(transfer, items=items, whole=whole))
    rest = library.plans[transfer.kind][len(items) :] if transfer.part else ()
    return _store(library, transfer.kind, (*items, *rest)), (arrival.answer(_ACCEPTED),)


def _makes_no_sense(library: Library, transfer: Transfer, items: tuple[Item, ...]) -> bool:
    if transfer.kind == mavlink.MAV_MISSION_TYPE_MISSION:
        kept = len(library.plans[transfer.kind]) if transfer.part else 0
        return leads_nowhere(items[-1], max(transfer.count, kept))
    is_fence = transfer.kind == mavlink.MAV_MISSION_TYPE_FENCE
    return is_fence and len(items) == transfer.count and encloses_nothing(items)


def _list(library: Library, arrival: Arrival) -> Result:
    if is_kept_out(library, arrival, Way.DOWNLOAD):
        return library, (arrival.answer(_ERROR),)
    items = library.plans[arrival.kind]
    if arrival.rules.one_at_a_time:
        library = replace(library, transfer=begun(arrival, Way.DOWNLOAD, len(items)))
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
    if kind == mavlink.MAV_MISSION_TYPE_MISSION and arrival.home is not None:
        items = (arrival.home, *items[1:])
    if index >= len(items):
        wrong = arrival.rules.wrong_sequence
        return replace(library, transfer=None), (arrival.answer(_ERROR if wrong is None else wrong),)
    whole = arrival.message.get_msgId() == mavlink.MAVLINK_MSG_ID_MISSION_REQUEST_INT
    marked = kind == mavlink.MAV_MISSION_TYPE_MISSION and not arrival.rules.items.keeps_little
    current = marked and index == arrival.current
    item = restore_item(items[index]) if arrival.rules.items.keeps_little else items[index]
    if whole:
        frame = arrival.rules.items.told_frames.get(item.frame, item.frame)
        item = replace(item, frame=arrival.rules.items.told_fence_frame or frame if kind == FENCE else frame)
    return library, (item_message(item, index, kind, arrival.partner, current=current, whole=whole),)


def _take_acknowledgement(library: Library, arrival: Arrival) -> Result:
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
        mavlink.MAVLINK_MSG_ID_MISSION_WRITE_PARTIAL_LIST: _part,
        mavlink.MAVLINK_MSG_ID_MISSION_ITEM: _item,
        mavlink.MAVLINK_MSG_ID_MISSION_ITEM_INT: _item,
        mavlink.MAVLINK_MSG_ID_MISSION_REQUEST_LIST: _list,
        mavlink.MAVLINK_MSG_ID_MISSION_REQUEST: _request,
        mavlink.MAVLINK_MSG_ID_MISSION_REQUEST_INT: _request,
        mavlink.MAVLINK_MSG_ID_MISSION_ACK: _take_acknowledgement,
        mavlink.MAVLINK_MSG_ID_MISSION_CLEAR_ALL: _clear,
    }
)
MESSAGE_IDS = frozenset(_HANDLERS)
"""The messages of the protocol."""
