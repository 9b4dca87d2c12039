"""Tells a landing from the signs that autopilots go by: asked to sink, not sinking, little thrust.

PX4 also wants it to hardly move over ground, so that it never reports a landing on a vehicle that drives faster than
the limit. ArduCopter does not look at the speed, but at the tilt that is asked for: against the wind of a fast vehicle
that is too much. Neither knows of the true contact.
"""

from math import hypot

from msgspec import Struct

from link.frames.rotations import rotate
from sim_autopilot.core.data import Reference
from sim_autopilot.core.settings import FlightSettings
from sim_autopilot.physics.airframe import GRAVITY_M_S2
from sim_autopilot.plant.snapshot import Snapshot

_THRUST_SHARE_MAX = 0.9
"""Of the weight: with more the drone hovers."""
_IDLE_SHARE = 0.3
"""Of the weight: a pilot who asks for less thrust wants it to stay on the ground (PX4's low throttle)."""


class Landing(Struct, frozen=True, kw_only=True):
    """Whether the drone counts as landed; times in ns since boot, None where it does not apply.

    Attributes:
        landed: ON_GROUND.
        landed_ns: when it landed.
        signs_ns: since when all signs of a landing hold.
    """

    landed: bool = True
    landed_ns: int | None = None
    signs_ns: int | None = None


IN_AIR = Landing(landed=False)


def detect_landing(
    landing: Landing, now: Snapshot, reference: Reference | None, settings: FlightSettings, asked_tilt_rad: float
) -> Landing:
    """Return the memory of a detector in flight after one more instant.

    Args:
        landing: the memory.
        now: the drone.
        reference: what it follows.
        settings: the limits.
        asked_tilt_rad: how far the position controller wants it to lean.
    """
    if not _shows_signs(now, reference, settings) or _is_moved(now, settings, asked_tilt_rad):
        return IN_AIR
    since_ns = now.boot_ns if landing.signs_ns is None else landing.signs_ns
    if (now.boot_ns - since_ns) * 1e-9 < settings.land_detector.after_s:
        return Landing(landed=False, signs_ns=since_ns)
    return Landing(landed=True, landed_ns=now.boot_ns)


def _is_moved(now: Snapshot, settings: FlightSettings, asked_tilt_rad: float) -> bool:
    """Whether it leans on purpose, or accelerates, more than a landed drone does, where the firmware looks at that."""
    tilt_rad, acceleration_m_s2 = settings.land_detector.tilt_max_rad, settings.land_detector.acceleration_max_m_s2
    if tilt_rad is not None and asked_tilt_rad > tilt_rad:
        return True
    x, y, z = rotate(now.orientation_wxyz, now.specific_force_flu_m_s2)
    return acceleration_m_s2 is not None and hypot(x, y, z - GRAVITY_M_S2) > acceleration_m_s2


def _shows_signs(now: Snapshot, reference: Reference | None, settings: FlightSettings) -> bool:
    return bool(
        _asks_to_sink(reference, settings)
        and abs(now.velocity_enu_m_s[2]) < settings.land_detector.sink_max_m_s
        and now.speed_m_s < settings.land_detector.speed_max_m_s
        and now.thrust_share < _THRUST_SHARE_MAX
    )


def _asks_to_sink(reference: Reference | None, settings: FlightSettings) -> bool:
    if reference is None:
        return False
    if reference.attitude is not None:
        return reference.attitude.thrust_m_s2 < _IDLE_SHARE * GRAVITY_M_S2
    velocity = reference.velocity_enu_m_s
    return velocity is not None and bool(velocity[2] <= -settings.land_detector.sink_asked_m_s)
