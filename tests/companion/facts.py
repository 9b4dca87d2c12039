"""Situations and progress for the tests of decisions: a drone, a pad, and what each test of a phase looks at."""

from typing import Any, TypeVar

import numpy as np
from msgspec import Struct, structs

from companion.autopilots.driver import AutopilotView, Receiver
from companion.config.companion import CompanionConfig
from companion.core.reasons import Reason
from companion.landing.decisions.entries import Decision, update_held
from companion.landing.decisions.events import decide
from companion.landing.state.memory import ControlMemory, Held, Progress, StepMemory
from companion.planning.guidance import ReferenceState
from companion.situation.phases import Phase
from companion.situation.situation import Below, Drone, Following, Situation, VehicleNews
from companion.vehicle.pad import HEADING_UNKNOWN, PadPath
from link.frames.geodesy import Datum, LocalFrame, Projection
from link.messages import ContactForecast, Vector3
from link.records import replace

R = TypeVar("R", Situation, StepMemory)
CONFIG = CompanionConfig()
NOW_NS = 1_795_000_000_000_000_000
TICK_NS = 20_000_000
PAD_ENU_M = np.array([3.0, -2.0, 1.5])
GEAR_M = CONFIG.touchdown.gear_height_m
FLIES = AutopilotView(
    link_up=True,
    armed=True,
    in_control=True,
    failsafe=False,
    landed=False,
    frame=LocalFrame(
        origin=Datum(latitude_rad=0.8, longitude_rad=0.1, altitude_m=100.0), projection=Projection.TANGENT_PLANE
    ),
    receiver=Receiver(knows_geoid=True),
)


def pad_at(velocity_enu_m_s: Vector3 = (4.0, 1.0, 0.0), *, std_m: float = 0.05, placed: bool = True) -> PadPath:
    offsets = np.arange(0.0, 1.0, 0.2)
    velocity = np.tile(velocity_enu_m_s, (len(offsets), 1))
    return PadPath(
        offset_s=offsets,
        position_enu_m=PAD_ENU_M + velocity * offsets[:, None],
        velocity_enu_m_s=velocity,
        acceleration_enu_m_s2=np.zeros_like(velocity),
        yaw_rad=0.2,
        position_std_m=np.full_like(velocity, std_m),
        half_width_m=0.75,
        unplaced=None if placed else HEADING_UNKNOWN,
    )


def braking_pad(deceleration_m_s2: float) -> PadPath:
    pad = pad_at((5.0, 0.0, 0.0))
    slowing = np.tile([-deceleration_m_s2, 0.0, 0.0], (len(pad.offset_s), 1))
    return replace(pad, acceleration_enu_m_s2=slowing)


def drone_at(
    height_m: float, beside_m: float = 0.0, relative_velocity_enu_m_s: Vector3 = (0.0, 0.0, 0.0), *, pad: PadPath
) -> Drone:
    """A drone whose feet are `height_m` above the pad and `beside_m` east of its centre."""
    return Drone(
        position_enu_m=pad.position_enu_m[0] + np.array([beside_m, 0.0, height_m + GEAR_M]),
        velocity_enu_m_s=pad.velocity_enu_m_s[0] + np.array(relative_velocity_enu_m_s),
        yaw_rad=0.1,
        age_s=0.02,
    )


def reference_at(height_m: float) -> ReferenceState:
    return ReferenceState(
        position_enu_m=PAD_ENU_M + np.array([0.0, 0.0, height_m + GEAR_M]),
        velocity_enu_m_s=np.zeros(3),
        acceleration_enu_m_s2=np.zeros(3),
    )


def situation(height_m: float = 1.5, beside_m: float = 0.0, pad: PadPath | None = None) -> Situation:
    """Everything in order: the drone above the pad, fresh data, the autopilot in control."""
    pad = pad_at() if pad is None else pad
    return Situation(
        t_ns=NOW_NS,
        monotonic_ns=NOW_NS,
        autopilot=FLIES,
        drone=drone_at(height_m, beside_m, pad=pad),
        pad=pad,
        vehicle=VehicleNews(fix_age_s=0.1, is_alive=True),
        below=Below(),
        feet_offset_m=GEAR_M,
        following=Following(error_m=0.05, error_max_m=1.0, reference=reference_at(height_m)),
        waiting_point_enu_m=np.array([0.0, 0.0, 5.0]),
    )


def forecast_of(unsafe: float, in_s: float = 0.5, broken_off: float = 0.0) -> ContactForecast:
    """The forecast of a contact that is beside the pad's middle or broken off with these probabilities, else in S2."""
    return ContactForecast(
        in_s=in_s,
        s1=1.0 - unsafe - broken_off,
        s2=1.0 - unsafe - broken_off,
        unsafe=unsafe,
        broken_off=broken_off,
        misses_position=unsafe,
        misses_speed=0.0,
        misses_sink=0.0,
        misses_tilt=0.0,
    )


LONG_HEARD = {Reason.HEARD: NOW_NS - round(1e9 * CONFIG.abort.heard_hold_s)}
"""Vehicle and autopilot, for as long as another approach asks for."""


IN_CONTROL = ControlMemory(was_in_control=True, was_armed=True)


def progress(phase: Phase, in_phase_s: float = 1.0) -> Progress:
    return Progress(phase=phase, since_ns=NOW_NS - round(in_phase_s * 1e9))


def changed(record: R, **changes: Any) -> R:
    """The same record with other fields, its own or those of its groups."""
    own = {name: value for name, value in changes.items() if name in _names(record)}
    groups = {
        one.name: getattr(record, one.name)
        for one in structs.fields(record)
        if isinstance(getattr(record, one.name), Struct)
    }
    for name, value in ((name, value) for name, value in changes.items() if name not in own):
        (group,) = (group for group, inner in groups.items() if name in _names(inner))
        own[group] = replace(own.get(group, groups[group]), **{name: value})
    return replace(record, **own)


def _names(record: Any) -> set[str]:
    return {one.name for one in structs.fields(record)}


def decided(now: Progress, facts: Situation, held: Held | None = None) -> Decision | None:
    """What is decided by a companion that has the autopilot's control and, unless told, nothing that holds."""
    return decide(replace(now, held=held or {}), IN_CONTROL, facts, CONFIG)


def at_time(facts: Situation, t_ns: int) -> Situation:
    return replace(facts, t_ns=t_ns, monotonic_ns=t_ns)


def later(facts: Situation, by_ns: int) -> Situation:
    return at_time(facts, facts.t_ns + by_ns)


def first_decision(phase: Phase, facts: Situation, limit_s: float) -> tuple[Decision | None, int]:
    """Return the first decision on facts that stay as they are, and after how many ticks it came."""
    held: Held = {}
    ticks = 0
    for ticks in range(round(limit_s * 1e9 / TICK_NS) + 1):
        now = later(facts, ticks * TICK_NS)
        held = update_held(held, phase, now, CONFIG)
        decision = decided(progress(phase, 0.0), now, held)
        if decision is not None:
            return decision, ticks
    return None, ticks
