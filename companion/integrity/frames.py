"""Whether the drone's and the vehicle's receivers place things in one frame; pure.

Each receiver states its error within its own frame. How far these are apart neither states: centimetres where both are
corrected by one base station or network, and metres without corrections. Phases that are fixed on both are taken for
corrections of one source, for that is how they are flown; who has two base stations says so (`receiver_frames`).
Otherwise only sightings of the pad tell the offset, which the estimate has as unknown until then.

A fixed carrier phase errs by a quarter of its wavelength at most, which is what reflections do to it
(Hofmann-Wellenhof, Lichtenegger and Collins, "GPS: Theory and Practice", 5th edition, multipath): who states more has
not fixed it.
"""

from collections.abc import Sequence

from msgspec import Struct

from companion.config.integrity import ReceiverFrames
from companion.core.data import Measurement, Quantity
from link.records import replace

_LIGHT_M_S = 299_792_458.0
_L1_HZ = 1575.42e6
FIXED_STD_MAX_M = 0.25 * _LIGHT_M_S / _L1_HZ
"""Horizontal, that a receiver with fixed phases states at most: 0.048 m."""

_HOLD_S = 2.0  # two of the autopilot's reports of its receiver


class FixedPhases(Struct, frozen=True, kw_only=True):
    """What both receivers say of their phases.

    Attributes:
        vehicle_std_m: that the newest fix of the vehicle states horizontally, None before the first.
        since_ns: monotonic, since when both have had fixed phases without a break; None while one has not.
    """

    vehicle_std_m: float | None = None
    since_ns: int | None = None


def update_fixed_phases(
    before: FixedPhases, measurements: Sequence[Measurement], monotonic_ns: int, *, drone_is_fixed: bool
) -> FixedPhases:
    """Return what both receivers say by now.

    Args:
        before: by the step before.
        measurements: of the vehicle since then.
        monotonic_ns: now.
        drone_is_fixed: the drone's receiver has fixed phases, as its autopilot tells.
    """
    fixes = [one for one in measurements if one.quantity is Quantity.POSITION]
    std_m = before.vehicle_std_m
    if fixes:
        newest = max(fixes, key=lambda fix: fix.t_ns)
        std_m = max(newest.covariance.diagonal().tolist()[:2]) ** 0.5
    if std_m is None or std_m > FIXED_STD_MAX_M or not drone_is_fixed:
        return FixedPhases(vehicle_std_m=std_m)
    since_ns = monotonic_ns if before.since_ns is None else before.since_ns
    return replace(before, vehicle_std_m=std_m, since_ns=since_ns)


def are_frames_one(phases: FixedPhases, configured: ReceiverFrames, monotonic_ns: int) -> bool:
    """Return whether both receivers' positions can be compared without a sighting."""
    match configured:
        case ReceiverFrames.ONE:
            return True
        case ReceiverFrames.APART:
            return False
        case ReceiverFrames.AUTO:
            return phases.since_ns is not None and (monotonic_ns - phases.since_ns) * 1e-9 >= _HOLD_S
