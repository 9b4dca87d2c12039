"""What a single forged datagram changes in what the companion knows: all that only signing cures, and nothing more."""

from copy import deepcopy

import pytest

from companion.autopilots.link import AutopilotLink
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink
from link.mavlink.session import MavlinkSession
from link.mavlink.signing import Signing
from scenarios.faults.flight import FaultFlight
from scenarios.faults.trial import SEED, scenario_of

_ARMED, _OFFBOARD, _POSITION, _ACTIVE = 217, 6 << 16, 3 << 16, mavlink.MAV_STATE_ACTIVE
_LATER_NS = 1_000_000


def _heartbeat(base_mode: int = _ARMED, mode: int = _OFFBOARD, state: int = _ACTIVE) -> Message:
    quadrotor, px4 = mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_AUTOPILOT_PX4
    return mavlink.MAVLink_heartbeat_message(quadrotor, px4, base_mode, mode, state, 3)


def _place(boot_ms: int) -> Message:
    return mavlink.MAVLink_local_position_ned_message(boot_ms, 0.3, -0.2, -0.4, 0.0, 0.0, 0.0)


@pytest.fixture(scope="module")
def flight() -> FaultFlight:
    """One whose drone has just been armed, by a companion that knows all of it."""
    flight = FaultFlight(scenario_of("px4"), SEED)
    flight.fly(3.0)
    return flight


def _boot_ms(flight: FaultFlight) -> int:
    boot_ns = flight.companion.autopilot.session.clock.local_to_boot_ns(flight.local_ns)
    assert boot_ns is not None
    return round(boot_ns * 1e-6)


def _spoof(name: str, flight: FaultFlight) -> Message:
    boot_ms = _boot_ms(flight)
    messages = {
        "mode": _heartbeat(mode=_POSITION),
        "disarmed": _heartbeat(base_mode=29),
        "failsafe": _heartbeat(state=mavlink.MAV_STATE_CRITICAL),
        "place": _place(boot_ms + 20),
        "place, 3 s ahead": _place(boot_ms + 3000),
        "place, 3 s behind": _place(max(boot_ms - 2900, 1)),
        "landed": mavlink.MAVLink_extended_sys_state_message(0, mavlink.MAV_LANDED_STATE_ON_GROUND),
        "UTC": mavlink.MAVLink_system_time_message(flight.simulation.t_ns // 1000 + 3_600_000_000, boot_ms),
        "origin": mavlink.MAVLink_gps_global_origin_message(524_000_000, 134_000_000, 100_000),
        "parameter": mavlink.MAVLink_param_value_message(b"COM_OF_LOSS_T", 60.0, 9, 800, 0),
        "acknowledgement": mavlink.MAVLink_command_ack_message(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 0),
        "range": mavlink.MAVLink_distance_sensor_message(boot_ms, 10, 5000, 300, 0, 0, 25, 0),
        "battery": mavlink.MAVLink_battery_status_message(0, 0, 0, 0, [3000] * 10, 0, 0, 0, 1),
    }
    return messages[name]


UNSIGNED = {
    "mode": {"in_control"},
    "disarmed": {"armed"},
    "failsafe": {"failsafe"},
    "place": {"own"},
    "place, 3 s ahead": set(),
    "place, 3 s behind": set(),
    "landed": {"landed"},
    "UTC": {"clock"},
    "origin": {"frame"},
    "parameter": {"timeout_s"},
    "acknowledgement": set(),
    "range": {"range_down"},
    "battery": {"battery_share"},
}
"""What each changes under the autopilot's own address: docs/safety.md, "Who may give orders"."""


def _facts(link: AutopilotLink) -> dict[str, object]:
    view = link.state.view
    names = (
        "in_control",
        "armed",
        "failsafe",
        "landed",
        "frame",
        "range_down",
        "battery_share",
        "link_up",
        "overruled",
    )
    facts: dict[str, object] = {name: getattr(view, name) for name in names}
    return facts | {"own": link.state.own, "timeout_s": link.timeout_s, "clock": link.session.clock}


@pytest.mark.parametrize(("name", "changed"), UNSIGNED.items())
def test_unsigned_datagram_changes_what_it_says_and_nothing_else(
    name: str, changed: set[str], flight: FaultFlight
) -> None:
    link = deepcopy(flight.companion.autopilot)
    before = _facts(link)
    link.receive(MavlinkCodec(1, 1).encode(_spoof(name, flight)), flight.local_ns + _LATER_NS, is_datagram=True)
    now = _facts(link)
    found = {fact for fact in before if now[fact] != before[fact]}
    # What is stamped is mapped by the clock, too.
    assert found - ({"own", "range_down"} if "clock" in changed else set()) == changed


@pytest.mark.parametrize("name", UNSIGNED)
def test_datagram_without_a_signature_or_by_another_key_changes_nothing_where_frames_are_signed(
    name: str, flight: FaultFlight
) -> None:
    session = MavlinkSession(1, target_system_id=1, signing=Signing(bytes(range(32)), link_id=0))
    own = MavlinkCodec(1, 1, signing=Signing(bytes(range(32)), link_id=1))
    assert session.receive(own.encode(_heartbeat()), flight.local_ns, is_datagram=True)
    for stranger in (MavlinkCodec(1, 1), MavlinkCodec(1, 1, signing=Signing(bytes(32), link_id=1))):
        assert (
            session.receive(stranger.encode(_spoof(name, flight)), flight.local_ns + _LATER_NS, is_datagram=True) == []
        )
