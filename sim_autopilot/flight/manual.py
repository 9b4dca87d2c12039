"""The pilot's sticks: MANUAL_CONTROL and RC_CHANNELS_OVERRIDE, and what the manual modes make of them.

In the position mode they ask for velocity along the heading, and let go they hold the place; in the altitude mode for
tilt and climb rate; stabilised for tilt and thrust; in acro for turn rates and thrust. How much: `StickFeel`.
"""

from dataclasses import dataclass
from math import cos, sin

import numpy as np

from link.frames.rotations import quaternion_from_roll_pitch_yaw
from link.mavlink.dialect import Message, mavlink
from link.records import replace
from sim_autopilot.core.data import Reference
from sim_autopilot.core.modes import Mode
from sim_autopilot.core.pilot_settings import StickFeel
from sim_autopilot.core.settings import FlightSettings
from sim_autopilot.flight.flight import ModeFlight
from sim_autopilot.physics.airframe import GRAVITY_M_S2
from sim_autopilot.plant.snapshot import Snapshot
from sim_autopilot.setpoints.attitude import attitude_reference, holding_thrust_m_s2

_FULL = 1000.0
_UNSAID = 32767
_PWM_MIDDLE_US, _PWM_SPAN_US = 1500.0, 500.0
_PWM_IGNORED = frozenset({0, 65535})
NO_OTHERS_US = (1500,) * 4
"""The channels 5 to 8 before anybody says something else."""
_SOONEST_S = 0.01
_LEAD_M = 1.0
"""How far the held place runs ahead of a drone that cannot follow it."""
_PLACED = frozenset({Mode.POSITION, Mode.POSHOLD, Mode.ZIGZAG})
MANUAL_MODES = _PLACED | {Mode.ALTITUDE, Mode.STABILIZED, Mode.MANUAL, Mode.ACRO, Mode.DRIFT}


@dataclass(frozen=True, slots=True, kw_only=True)
class Sticks:
    """The sticks at `received_ns` since boot, each from -1 to 1: right, forward, up and clockwise are positive.

    `moved_per_s` is how fast the fastest of them moved since the message before, `others_us` the channels 5 to 8.
    """

    received_ns: int
    roll: float
    pitch: float
    throttle: float
    yaw: float
    moved_per_s: float = 0.0
    others_us: tuple[int, ...] = NO_OTHERS_US


def sticks_from_message(message: Message, boot_ns: int, before: Sticks | None) -> Sticks | None:
    """Return the sticks after a MANUAL_CONTROL or RC_CHANNELS_OVERRIDE; an axis that is not told stays."""
    sticks = _read(message, boot_ns, before)
    if sticks is None or before is None or sticks is before:
        return sticks
    pairs = ((sticks.roll, before.roll), (sticks.pitch, before.pitch), (sticks.yaw, before.yaw))
    elapsed_s = max(_SOONEST_S, (boot_ns - before.received_ns) * 1e-9)
    return replace(sticks, moved_per_s=max(abs(new - old) for new, old in pairs) / elapsed_s)


def _read(message: Message, boot_ns: int, before: Sticks | None) -> Sticks | None:
    kept = before or Sticks(received_ns=boot_ns, roll=0.0, pitch=0.0, throttle=0.0, yaw=0.0)
    if message.get_msgId() == mavlink.MAVLINK_MSG_ID_MANUAL_CONTROL:
        roll, pitch, yaw = (
            old if value == _UNSAID else _bound(value / _FULL)
            for value, old in ((message.y, kept.roll), (message.x, kept.pitch), (message.r, kept.yaw))
        )
        throttle = kept.throttle if message.z == _UNSAID else _bound(message.z / _FULL * 2.0 - 1.0)
        return replace(kept, received_ns=boot_ns, roll=roll, pitch=pitch, throttle=throttle, yaw=yaw, moved_per_s=0.0)
    channels = (message.chan1_raw, message.chan2_raw, message.chan3_raw, message.chan4_raw)
    if all(value in _PWM_IGNORED for value in channels):
        return before
    roll, pitch, throttle, yaw = (
        old if value in _PWM_IGNORED else _bound((value - _PWM_MIDDLE_US) / _PWM_SPAN_US)
        for value, old in zip(channels, (kept.roll, -kept.pitch, kept.throttle, kept.yaw), strict=True)
    )
    told_us = (message.chan5_raw, message.chan6_raw, message.chan7_raw, message.chan8_raw)
    others_us = tuple(
        old if value in _PWM_IGNORED else value for value, old in zip(told_us, kept.others_us, strict=True)
    )
    return Sticks(received_ns=boot_ns, roll=roll, pitch=-pitch, throttle=throttle, yaw=yaw, others_us=others_us)


def are_held(sticks: Sticks | None, boot_ns: int, feel: StickFeel) -> bool:
    """Return whether somebody moves the sticks."""
    return sticks is not None and (boot_ns - sticks.received_ns) * 1e-9 <= feel.lost_s


def sticks_in_effect(sticks: Sticks | None, boot_ns: int, feel: StickFeel) -> Sticks | None:
    """Return the sticks that a manual mode obeys, None where it holds."""
    if sticks is not None and are_held(sticks, boot_ns, feel):
        return sticks
    if feel.idle_throttle is None:
        return None
    return Sticks(received_ns=boot_ns, roll=0.0, pitch=0.0, throttle=feel.idle_throttle, yaw=0.0)


def follow_sticks(  # noqa: PLR0917 (who, how, by what, where, within what, how long)
    flight: ModeFlight, mode: Mode, sticks: Sticks, now: Snapshot, settings: FlightSettings, elapsed_s: float
) -> tuple[ModeFlight, Reference]:
    """Return the memory of a manual mode and what it follows for the next `elapsed_s`."""
    flight = replace(flight, goal=None, stop_s=0.0, anchor=_lead(flight.anchor, mode, sticks, now, settings, elapsed_s))
    anchor, feel = flight.anchor, settings.sticks
    yaw_rate = -_dead(sticks.yaw, feel.dead_zone) * feel.yaw_rate_rad_s
    if mode in _PLACED:
        return flight, anchor
    if mode is Mode.ACRO:
        rates = np.array((sticks.roll, sticks.pitch, -sticks.yaw)) * feel.acro_rate_rad_s
        return flight, attitude_reference(None, rates, _thrust_m_s2(sticks, settings))
    yaw_rad = now.yaw_rad if anchor.yaw_rad is None else anchor.yaw_rad
    q = np.array(quaternion_from_roll_pitch_yaw(sticks.roll * feel.tilt_rad, sticks.pitch * feel.tilt_rad, yaw_rad))
    thrust_m_s2 = _thrust_m_s2(sticks, settings)
    if mode is Mode.ALTITUDE:
        thrust_m_s2 = _holding_m_s2(anchor, now, cos(sticks.roll * feel.tilt_rad) * cos(sticks.pitch * feel.tilt_rad))
    return flight, attitude_reference(q, np.array((0.0, 0.0, yaw_rate)), thrust_m_s2)


def _lead(  # noqa: PLR0917 (the arguments of its caller)
    anchor: Reference, mode: Mode, sticks: Sticks, now: Snapshot, settings: FlightSettings, elapsed_s: float
) -> Reference:
    """The held place and heading, moved as the sticks ask."""
    feel = settings.sticks
    yaw_rate = -_dead(sticks.yaw, feel.dead_zone) * feel.yaw_rate_rad_s
    yaw_rad = (now.yaw_rad if anchor.yaw_rad is None else anchor.yaw_rad) + yaw_rate * elapsed_s
    ahead, left = (_dead(stick, feel.dead_zone) * feel.speed_m_s for stick in (sticks.pitch, -sticks.roll))
    rise = _dead(sticks.throttle, feel.throttle_dead_zone)
    climb_m_s = settings.envelope.climb_max_m_s if feel.climb_m_s is None else feel.climb_m_s
    descent_m_s = settings.envelope.descent_max_m_s if feel.descent_m_s is None else feel.descent_m_s
    up = rise * (climb_m_s if rise > 0.0 else descent_m_s)
    c, s = cos(now.yaw_rad), sin(now.yaw_rad)
    wanted = np.array((c * ahead - s * left, s * ahead + c * left, up))
    at = np.array(now.position_enu_m)
    velocity = np.array(now.velocity_enu_m_s) if anchor.velocity_enu_m_s is None else anchor.velocity_enu_m_s
    level, lift = (
        settings.envelope.braking_m_s2 if most is None else most for most in (feel.acceleration_m_s2, feel.lift_m_s2)
    )
    most = elapsed_s * np.array((level, level, lift))
    change = np.clip(wanted - velocity, -most, most)
    velocity = velocity + change
    place = at if anchor.position_enu_m is None else anchor.position_enu_m + elapsed_s * velocity
    if mode not in _PLACED:
        place = np.array((*at[:2], place[2]))
    return replace(
        anchor,
        position_enu_m=at + np.clip(place - at, -_LEAD_M, _LEAD_M),
        velocity_enu_m_s=velocity,
        acceleration_enu_m_s2=change / elapsed_s,
        yaw_rad=yaw_rad,
    )


def _holding_m_s2(anchor: Reference, now: Snapshot, level: float) -> float:
    """Specific thrust that follows the anchor's height and climb rate."""
    place, velocity = anchor.position_enu_m, anchor.velocity_enu_m_s
    if place is None or velocity is None:
        return GRAVITY_M_S2
    return holding_thrust_m_s2(float(place[2]), float(velocity[2]), now, level)


def _thrust_m_s2(sticks: Sticks, settings: FlightSettings) -> float:
    """Specific thrust of the throttle stick, whose middle carries the drone."""
    share, hover = 0.5 * (sticks.throttle + 1.0), settings.setpoints.hover_share
    full_m_s2 = GRAVITY_M_S2 / hover
    if share <= 0.5:
        return GRAVITY_M_S2 * share / 0.5
    return GRAVITY_M_S2 + (full_m_s2 - GRAVITY_M_S2) * (share - 0.5) / 0.5


def _dead(value: float, zone: float) -> float:
    if abs(value) <= zone:
        return 0.0
    return (value - zone if value > 0.0 else value + zone) / (1.0 - zone)


def _bound(value: float) -> float:
    return max(-1.0, min(1.0, value))
