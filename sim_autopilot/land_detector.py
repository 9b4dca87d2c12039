"""Tells a landing from the signs that PX4 goes by: asked to sink, not sinking, hardly moving, little thrust.

It knows nothing of the true contact, and it measures speed over ground: on a vehicle that drives faster than the limit
it never reports a landing.
"""

from dataclasses import dataclass

from sim_autopilot.data import Reference
from sim_autopilot.settings import FlightSettings
from sim_autopilot.snapshot import Snapshot

_LANDED_AFTER_S = 1.5
"""How long the signs must hold; measured from contact to ON_GROUND."""
_THRUST_SHARE_MAX = 0.9
"""Of the weight: with more the drone hovers."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Landing:
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


def detect_landing(landing: Landing, now: Snapshot, reference: Reference | None, settings: FlightSettings) -> Landing:
    """Return the memory of a detector in flight after one more instant."""
    if not _shows_signs(now, reference, settings):
        return IN_AIR
    since_ns = now.boot_ns if landing.signs_ns is None else landing.signs_ns
    if (now.boot_ns - since_ns) * 1e-9 < _LANDED_AFTER_S:
        return Landing(landed=False, signs_ns=since_ns)
    return Landing(landed=True, landed_ns=now.boot_ns)


def _shows_signs(now: Snapshot, reference: Reference | None, settings: FlightSettings) -> bool:
    if reference is None or reference.velocity_enu_m_s is None:
        return False
    return bool(
        reference.velocity_enu_m_s[2] <= -settings.landed_sink_asked_m_s
        and abs(now.velocity_enu_m_s[2]) < settings.landed_sink_max_m_s
        and now.speed_m_s < settings.landed_speed_max_m_s
        and now.thrust_share < _THRUST_SHARE_MAX
    )
