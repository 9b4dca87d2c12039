"""Single forged datagrams of an autopilot: what each changes in what the companion knows, unsigned and signed.

What an unsigned one changes under the autopilot's own address, only signing cures.
"""

from collections.abc import Callable, Iterator, Mapping
from copy import deepcopy
from dataclasses import dataclass

from companion.autopilots.link import AutopilotLink
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink
from link.mavlink.sequence import NUMBERS
from link.mavlink.session import MavlinkSession
from link.mavlink.signing import Signing
from link.messages import Command
from scenarios.attack.attempt import Attempt
from scenarios.catalogue.catalogue import load_changed_scenario
from scenarios.faults.flight import FaultFlight
from scenarios.faults.trial import SCENARIO, SEED

_ARMED, _DISARMED, _OFFBOARD, _POSITION = 217, 29, 6 << 16, 3 << 16
_HOUR_US = 3_600_000_000
_LATER_NS = 1_000_000
_NUMBERS_APART = 32  # one of them is ahead of the autopilot's by so little that it is not late
_ARMED_S = 3.0  # from the start until the companion knows of an armed drone
_FACTS = (
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
_DATED = frozenset({"own", "range_down"})  # what is stamped is mapped by the clock, too
_KEY, _OTHER_KEY = bytes(range(32)), bytes(32)
_SWITCH_CHANNEL = 7
_PULSES_US = {Command.ABORT: 1000, Command.HOLD: 1500, Command.START: 2000}
_FORGED_S = 1.0  # at each position of the switch
_FORGED_STEP_MS = 10
_TRUE_STEPS = 10  # between two reports of a transmitter that is heard: ten a second, as they are asked for


@dataclass(frozen=True, slots=True, kw_only=True)
class Now:
    """The autopilot's clocks."""

    boot_ms: int
    utc_us: int


def heartbeat(
    base_mode: int = _ARMED, mode: int = _OFFBOARD, state: int = mavlink.MAV_STATE_ACTIVE
) -> mavlink.MAVLink_heartbeat_message:
    """Return the heartbeat of a quadrotor with PX4."""
    return mavlink.MAVLink_heartbeat_message(
        mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_AUTOPILOT_PX4, base_mode, mode, state, 3
    )


def _place(boot_ms: int) -> Message:
    return mavlink.MAVLink_local_position_ned_message(boot_ms, 0.3, -0.2, -0.4, 0.0, 0.0, 0.0)


def _receiver() -> Message:
    """Of one that has the sea 60 m above the ellipsoid."""
    at = (524_000_000, 134_000_000, 40_000)
    return mavlink.MAVLink_gps_raw_int_message(0, 3, *at, 80, 80, 0, 0, 12, alt_ellipsoid=100_000)


def _receiver_without_fix() -> Message:
    return mavlink.MAVLink_gps_raw_int_message(0, mavlink.GPS_FIX_TYPE_NO_FIX, 0, 0, 0, 65535, 65535, 0, 0, 0)


def _switched(to: Command, boot_ms: int) -> Message:
    pulses_us = [1500] * 18
    pulses_us[_SWITCH_CHANNEL - 1] = _PULSES_US[to]
    return mavlink.MAVLink_rc_channels_message(boot_ms, 18, *pulses_us, 255)


SPOOFS: Mapping[str, Callable[[Now], Message]] = {
    "mode": lambda _: heartbeat(mode=_POSITION),
    "disarmed": lambda _: heartbeat(base_mode=_DISARMED),
    "failsafe": lambda _: heartbeat(state=mavlink.MAV_STATE_CRITICAL),
    "place": lambda now: _place(now.boot_ms + 20),
    "place, 3 s ahead": lambda now: _place(now.boot_ms + 3000),
    "place, 3 s behind": lambda now: _place(max(now.boot_ms - 2900, 1)),
    "landed": lambda _: mavlink.MAVLink_extended_sys_state_message(0, mavlink.MAV_LANDED_STATE_ON_GROUND),
    "UTC": lambda now: mavlink.MAVLink_system_time_message(now.utc_us + _HOUR_US, now.boot_ms),
    "origin": lambda _: mavlink.MAVLink_gps_global_origin_message(524_000_000, 134_000_000, 100_000),
    "parameter": lambda _: mavlink.MAVLink_param_value_message(b"COM_OF_LOSS_T", 60.0, 9, 800, 0),
    "acknowledgement": lambda _: mavlink.MAVLink_command_ack_message(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 0),
    "range": lambda now: mavlink.MAVLink_distance_sensor_message(now.boot_ms, 10, 5000, 300, 0, 0, 25, 0),
    "battery": lambda _: mavlink.MAVLink_battery_status_message(0, 0, 0, 0, [3000] * 10, 0, 0, 0, 1),
    "pilot's switch": lambda now: _switched(Command.START, now.boot_ms),
    "geoid": lambda _: _receiver(),
    "no fix": lambda _: _receiver_without_fix(),
}

UNSIGNED: Mapping[str, frozenset[str]] = {
    "mode": frozenset({"in_control"}),
    "disarmed": frozenset(),
    "failsafe": frozenset({"failsafe"}),
    "place": frozenset({"own", "range_down"}),  # a distance stays, but nobody knows from where it was seen
    "place, 3 s ahead": frozenset(),
    "place, 3 s behind": frozenset(),
    "landed": frozenset({"landed"}),
    "UTC": frozenset({"clock"}),
    "origin": frozenset(),
    "parameter": frozenset({"timeout_s"}),
    "acknowledgement": frozenset(),
    "range": frozenset({"range_down"}),
    "battery": frozenset(),
    "pilot's switch": frozenset(),
    "geoid": frozenset(),
    "no fix": frozenset(),
}
"""What each changes under the autopilot's own address: docs/safety.md, "Who may give orders"."""


def armed_flight() -> FaultFlight:
    """Return one whose drone has just been armed, by a companion that knows all of it and hears a pilot's switch."""
    channel = f"system.companion.autopilot.pilot_switch.channel={_SWITCH_CHANNEL}"
    flight = FaultFlight(load_changed_scenario(f"{SCENARIO}+firmware=px4", [channel]), SEED)
    flight.fly(_ARMED_S)
    return flight


def changed_by(name: str, flight: FaultFlight) -> frozenset[str]:
    """Return which facts an unsigned spoof changes, under the autopilot's own address, whatever its number is."""
    by_number = (_changed_by_number(name, flight, number) for number in range(0, NUMBERS, _NUMBERS_APART))
    return frozenset[str]().union(*by_number)


def _changed_by_number(name: str, flight: FaultFlight, number: int) -> frozenset[str]:
    link = deepcopy(flight.companion.autopilot)
    before = _facts(link)
    forged = MavlinkCodec(1, 1, first_number=number).encode(SPOOFS[name](_now(flight)))
    link.receive(forged, flight.local_ns + _LATER_NS, is_datagram=True)
    now = _facts(link)
    changed = frozenset(fact for fact in before if now[fact] != before[fact])
    return changed - _DATED if "clock" in UNSIGNED[name] else changed


def switched_by(command: Command, flight: FaultFlight, *, is_heard: bool) -> Command | None:
    """Return what a forged switch commands that goes to `command` and stays there for a while, unsigned.

    Args:
        command: that its position gives.
        flight: of the companion.
        is_heard: whether a transmitter is, whose switch stays elsewhere.
    """
    link, codec = deepcopy(flight.companion.autopilot), MavlinkCodec(1, 1)
    elsewhere = Command.ABORT if command is Command.START else Command.START
    steps = round(_FORGED_S * 1000.0 / _FORGED_STEP_MS)
    commanded = None
    for step in range(1, 2 * steps + 1):
        forged = [elsewhere if step <= steps else command]
        for position in [elsewhere, *forged] if is_heard and step % _TRUE_STEPS == 0 else forged:
            report = codec.encode(_switched(position, _now(flight).boot_ms + step * _FORGED_STEP_MS))
            link.receive(report, flight.local_ns + step * _FORGED_STEP_MS * 1_000_000, is_datagram=True)
        commanded = link.pilot_switch.take() or commanded
    return commanded


def heard_though_signed(name: str, flight: FaultFlight) -> int:
    """Return how many events a spoof brings to a session that takes signed frames: unsigned, and by another key."""
    session = MavlinkSession(1, target_system_id=1, signing=Signing(_KEY, link_id=0))
    own = MavlinkCodec(1, 1, signing=Signing(_KEY, link_id=1))
    if not session.receive(own.encode(heartbeat()), flight.local_ns, is_datagram=True):
        raise ValueError("a signed heartbeat was not taken")
    spoof = SPOOFS[name](_now(flight))
    strangers = (MavlinkCodec(1, 1), MavlinkCodec(1, 1, signing=Signing(_OTHER_KEY, link_id=1)))
    frames = [stranger.encode(spoof) for stranger in strangers]
    return sum(len(session.receive(frame, flight.local_ns + _LATER_NS, is_datagram=True)) for frame in frames)


def attempts() -> Iterator[Attempt]:
    """Try each spoof under the autopilot's own address, unsigned and where frames are signed."""
    flight = armed_flight()
    for name, expected in UNSIGNED.items():
        seen = changed_by(name, flight)
        yield Attempt(by="MAVLink, unsigned", what=f"forges {name}", expected=_words(expected), seen=_words(seen))
    for command in _PULSES_US:
        for is_heard in (True, False):
            yield _by_switch(command, flight, is_heard=is_heard)
    for name in UNSIGNED:
        heard = heard_though_signed(name, flight)
        seen_words = f"is heard {heard} times" if heard else "is not heard"
        yield Attempt(by="MAVLink, signed", what=f"forges {name}", expected="is not heard", seen=seen_words)


def _by_switch(command: Command, flight: FaultFlight, *, is_heard: bool) -> Attempt:
    expected = "commands nothing" if is_heard else f"commands {command.value}"
    given = switched_by(command, flight, is_heard=is_heard)
    return Attempt(
        by="MAVLink, unsigned",
        what=f"forges a switch to {command.value}, {'beside a transmitter' if is_heard else 'no transmitter is heard'}",
        expected=expected,
        seen="commands nothing" if given is None else f"commands {given.value}",
    )


def _words(facts: frozenset[str]) -> str:
    return f"changes {', '.join(sorted(facts))}" if facts else "changes nothing"


def _now(flight: FaultFlight) -> Now:
    boot_ns = flight.companion.autopilot.session.clock.local_to_boot_ns(flight.local_ns)
    if boot_ns is None:
        raise ValueError("the autopilot's clock is not known yet")
    return Now(boot_ms=round(boot_ns * 1e-6), utc_us=flight.simulation.t_ns // 1000)


def _facts(link: AutopilotLink) -> dict[str, object]:
    view = link.state.view
    facts: dict[str, object] = {name: getattr(view, name) for name in _FACTS}
    facts["has_fix"] = view.receiver.has_fix
    return facts | {"own": link.state.own, "timeout_s": link.timeout_s, "clock": link.session.clock}
