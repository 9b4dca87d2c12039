"""What PX4's events say, for clients that read their names and words from its component metadata.

Source of the format: https://mavlink.io/en/services/events.html and libevents' definition files. Only events that are
sent here are described.
"""

from collections.abc import Mapping
from types import MappingProxyType

from link.mavlink.event_ids import event_id
from sim_autopilot.firmware.px4_events import DISARM_REASONS, EVENTS

EVENTS_PATH = "etc/extras/all_events.json.xz"
_AUTOPILOT, _NAMESPACE = "1", "px4"
_ID_BITS = 0x00FF_FFFF
_REASON = "arm_disarm_reason_t"
_MODES = "uint32_t"
_WITH_ARGUMENTS: Mapping[str, tuple[str, tuple[str, ...]]] = MappingProxyType(
    {
        "commander_armed_by": ("Armed by {1}", (f"{_NAMESPACE}::{_REASON}",)),
        "commander_disarmed_by": ("Disarmed by {1}", (f"{_NAMESPACE}::{_REASON}",)),
        "navigator_takeoff_default_alt": ("Using default takeoff altitude: {1:.2m}", ("float",)),
        "vrtl_return_at": ("RTL: start return at {1m_v} ({2m_v} above destination)", ("int32_t", "int32_t")),
        "check_modes_offboard_signal": ("No offboard signal", (_MODES,)),
        "commander_failsafe_enter_generic_hold": (
            "Failsafe activated: entering Hold for {3} seconds",
            (_MODES, "uint8_t", "uint16_t"),
        ),
        "logger_open_file_time": (
            "logging: opening log file {1}-{2}-{3}/{4}_{5}_{6}.ulg",
            ("uint16_t", *("uint8_t",) * 5),
        ),
    }
)
"""Words, with a number for each argument, and the arguments' types."""


def events_description() -> dict[str, object]:
    """Return the definition of all events that are sent, as libevents reads it."""
    words = {code.name: text for text, code in EVENTS.items()}
    plain = {name: (text, ()) for name, text in words.items() if name not in _WITH_ARGUMENTS}
    events = {
        str(event_id(name) & _ID_BITS): _described(name, message, types)
        for name, (message, types) in sorted({**plain, **_WITH_ARGUMENTS}.items())
    }
    entries = {str(number): {"name": name, "description": said} for number, (name, said) in DISARM_REASONS.items()}
    component = {
        "namespace": _NAMESPACE,
        "enums": {_REASON: {"type": "uint8_t", "entries": entries}},
        "event_groups": {"default": {"events": events}},
    }
    return {"version": 2, "components": {_AUTOPILOT: component}}


def _described(name: str, message: str, types: tuple[str, ...]) -> dict[str, object]:
    described: dict[str, object] = {"name": name, "message": message}
    if types:
        described["arguments"] = [{"name": f"arg{place}", "type": kind} for place, kind in enumerate(types)]
    return described
