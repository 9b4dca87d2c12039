"""What PX4's events say, for clients that read their names and words from its component metadata.

Source of the format: https://mavlink.io/en/services/events.html and libevents' definition files. Only events that are
sent here are described.
"""

from collections.abc import Mapping
from types import MappingProxyType

from link.mavlink.dialect import event_id
from sim_autopilot.core.modes import Mode
from sim_autopilot.firmware.px4.events import DISARM_REASONS, EVENTS
from sim_autopilot.ground_station.px4.health_bits import ARMING_SUMMARY, COMPONENTS, HEALTH_SUMMARY, MODE_STATES

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


_HEALTH, _GROUP = "health_component_t", "navigation_mode_group_t"
_PARTS, _STATES = f"{_NAMESPACE}::{_HEALTH}", f"{_NAMESPACE}::{_GROUP}"
_SUMMARIES = (
    ("arming_check", ARMING_SUMMARY, ("uint8_t", _PARTS, _PARTS, _STATES, _STATES)),
    ("health", HEALTH_SUMMARY, ("uint8_t", _PARTS, _PARTS, _PARTS)),
)
"""Of the report on arming: group, name, arguments' types."""


def events_description(custom_modes: Mapping[Mode, int]) -> dict[str, object]:
    """Return the definition of all events that are sent, as libevents reads it, with the modes' numbers."""
    words = {code.name: text for text, code in EVENTS.items()}
    plain = {name: (text, ()) for name, text in words.items() if name not in _WITH_ARGUMENTS}
    events = {
        str(event_id(name) & _ID_BITS): _describe(name, message, types)
        for name, (message, types) in sorted({**plain, **_WITH_ARGUMENTS}.items())
    }
    entries = {str(number): {"name": name, "description": said} for number, (name, said) in DISARM_REASONS.items()}
    component = {
        "namespace": _NAMESPACE,
        "enums": {
            _REASON: {"type": "uint8_t", "entries": entries},
            _HEALTH: _bitfield(COMPONENTS),
            _GROUP: _bitfield({number: (name, name) for number, name in MODE_STATES.values()}),
        },
        "event_groups": {"default": {"events": events}, **_summaries()},
        "supported_protocols": ["health_and_arming_check"],
        "navigation_mode_groups": {
            "groups": {str(MODE_STATES[mode][0]): [number] for mode, number in custom_modes.items()}
        },
    }
    return {"version": 2, "components": {_AUTOPILOT: component}}


def _summaries() -> dict[str, object]:
    groups: dict[str, object] = {}
    for group, name, types in _SUMMARIES:
        described = _describe(name, "Summary", types) | {"type": "summary"}
        groups[group] = {"events": {str(event_id(name) & _ID_BITS): described}}
    return groups


def _bitfield(names: Mapping[int, tuple[str, str]]) -> dict[str, object]:
    entries = {str(1 << number): {"name": name, "description": said} for number, (name, said) in names.items()}
    return {"type": "uint32_t", "is_bitfield": True, "entries": entries}


def _describe(name: str, message: str, types: tuple[str, ...]) -> dict[str, object]:
    described: dict[str, object] = {"name": name, "message": message}
    if types:
        described["arguments"] = [{"name": f"arg{place}", "type": kind} for place, kind in enumerate(types)]
    return described
