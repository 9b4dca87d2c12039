"""What every payload from a peer must pass before its numbers are believed."""

from collections.abc import Sequence
from functools import lru_cache
from math import hypot, isfinite

from link.messages import Matrix3, Quaternion
from link.units import NS_PER_S

_UNIT_TOLERANCE = 1e-3
"""Publishers that round to three decimals pass, quaternions that were never set do not."""

_COVARIANCE_TOLERANCE = 1e-6
"""Relative to the trace: the rounding of a covariance that was carried in single precision."""


class PayloadError(ValueError):
    """Bytes from a peer that are not the message they should be; they are counted and dropped."""


def check_finite(name: str, values: Sequence[float]) -> None:
    """Check that all of `values` are finite.

    Raises:
        PayloadError: If one is not.
    """
    for value in values:
        if not isfinite(value):
            raise PayloadError(f"{name} is not finite: {value}")


def t_ns_of(seconds: int, nanoseconds: int) -> int:
    """Return a ROS 2 stamp as UTC nanoseconds.

    Raises:
        PayloadError: If the stamp is before 1970 or its nanoseconds are not below one second.
    """
    if seconds < 0 or not 0 <= nanoseconds < NS_PER_S:
        raise PayloadError(f"the stamp {seconds} s + {nanoseconds} ns is out of range")
    return seconds * NS_PER_S + nanoseconds


def checked_quaternion(quaternion: Quaternion) -> Quaternion:
    """Return a received quaternion at unit length and with w >= 0.

    Raises:
        PayloadError: If its length is not 1 within 0.1 %.
    """
    w, x, y, z = quaternion
    length = hypot(w, x, y, z)
    if not abs(length - 1.0) <= _UNIT_TOLERANCE:
        raise PayloadError(f"the quaternion's length is {length}, not 1")
    if w < 0.0:
        length = -length
    if abs(abs(length) - 1.0) < 1e-12:  # as sent by this project: not a bit is changed
        length = round(length)
    return (w / length, x / length, y / length, z / length)


def checked_covariance(name: str, covariance: Matrix3) -> Matrix3 | None:
    """Return a received covariance, or None for the zero matrix, which in ROS means unknown.

    Raises:
        PayloadError: If it is not finite, not symmetric or not positive semidefinite.
    """
    return covariance if _is_known_covariance(name, covariance) else None


@lru_cache(maxsize=64)  # most sensors state the same one again and again
def _is_known_covariance(name: str, covariance: Matrix3) -> bool:
    """Return whether a covariance is not the zero matrix; raise PayloadError if it is none."""
    if not any(covariance):
        return False
    check_finite(name, covariance)
    a, b, c, d, e, f, g, h, i = covariance
    trace = a + e + i
    slack = _COVARIANCE_TOLERANCE * abs(trace)
    if max(abs(b - d), abs(c - g), abs(f - h)) > slack:
        raise PayloadError(f"{name} is not symmetric: {covariance}")
    # Sylvester: a symmetric matrix is positive semidefinite if no principal minor is negative
    minors = (a * e - b * d, a * i - c * g, e * i - f * h)
    determinant = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    if min(a, e, i) < 0.0 or min(minors) < -slack * trace or determinant < -slack * trace * trace:
        raise PayloadError(f"{name} is not positive semidefinite: {covariance}")
    return True
