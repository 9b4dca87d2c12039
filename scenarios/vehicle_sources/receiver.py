"""What every receiver on a vehicle is to the loop: bytes in, readings out, and a word on what is missing.

Covariances are what the receiver says of itself, None where it says nothing; the companion then takes its own.
"""

from collections.abc import Sequence
from math import cos, isfinite, radians, sin
from typing import Protocol

from link.frames.rotations import quaternion_from_yaw, yaw_enu_from_ned
from link.messages import Fix, FixVelocity, Matrix3, VehicleImu

Reading = Fix | FixVelocity | VehicleImu

ACCURACY_AGE_MAX_NS = 2_000_000_000
"""How long the last statement of a receiver about its accuracy is taken to hold; many make it once a second."""

_REPEATED_NS = 1_000_000_000

_NUMBER_MAX = 1e7  # m, m/s or degrees; no receiver on or near the earth measures more

_TILT_VARIANCE_RAD2 = 9.9  # pi squared: roll and pitch are not known at all


class Receiver(Protocol):
    """A receiver's protocol as a machine without I/O; no bytes whatever make it raise."""

    @property
    def complaint(self) -> str | None:
        """Why there are no fixes although something is received, and what to look at; None when there are."""

    @property
    def counts(self) -> dict[str, int]:
        """What was received and what was wrong with it, by name."""

    def connected(self) -> None:
        """Restart: what was half received will not be finished."""

    def take(self, data: bytes, t_ns: int) -> list[Reading]:
        """Return what `data`, received at local time `t_ns`, tells; stamps are the receiver's UTC."""

    def to_send(self, t_ns: int) -> bytes:
        """Return what the receiver is to be told by now."""


def diagonal(east: float, north: float, up: float) -> Matrix3:
    """Return a covariance of three standard deviations that have nothing to do with each other."""
    return (east**2, 0.0, 0.0, 0.0, north**2, 0.0, 0.0, 0.0, up**2)


def turn_covariance(along: float, across: float, azimuth_rad: float, up: float) -> Matrix3:
    """Return the covariance in ENU of standard deviations along and across a horizontal direction, and upwards.

    Args:
        along: standard deviation in the direction.
        across: the one at right angles to it.
        azimuth_rad: of the direction, clockwise from north.
        up: vertical standard deviation.
    """
    s, c = sin(azimuth_rad), cos(azimuth_rad)
    east, north = (along * s) ** 2 + (across * c) ** 2, (along * c) ** 2 + (across * s) ** 2
    both = (along**2 - across**2) * s * c
    return (east, both, 0.0, both, north, 0.0, 0.0, 0.0, up**2)


def stated_covariance(ellipse: Sequence[float | None], deviations: Sequence[float | None]) -> Matrix3 | None:
    """Return the covariance in ENU, m^2, that a GST states, None when it does not say enough.

    Args:
        ellipse: of errors: major and minor half axis, m, and the major one's azimuth in degrees; preferred.
        deviations: standard deviations east, north and up, m.
    """
    major, minor, azimuth_deg = ellipse
    east, north, up = deviations
    if up is None or not are_positive((up,)):
        return None
    if major is not None and minor is not None and azimuth_deg is not None and are_positive((major, minor)):
        return turn_covariance(major, minor, radians(azimuth_deg), up)
    if east is not None and north is not None and are_positive((east, north)):
        return diagonal(east, north, up)
    return None


def course_velocity(
    t_ns: int,
    speed_m_s: float,
    course_rad: float,
    *,
    speed_std_m_s: float | None = None,
    course_std_rad: float | None = None,
    up_m_s: float | None = None,
    up_std_m_s: float | None = None,
) -> FixVelocity:
    """Return the velocity by speed and course over ground.

    Args:
        t_ns: of validity, UTC.
        speed_m_s: horizontal.
        course_rad: clockwise from true north.
        speed_std_m_s: None when the receiver does not say; the velocity then has no covariance.
        course_std_rad: None when the receiver does not say; the speed's is then taken for both directions.
        up_m_s: vertical velocity, taken for measured only with its deviation.
        up_std_m_s: of the vertical velocity.
    """
    is_vertical_measured = up_m_s is not None and up_std_m_s is not None
    covariance = None
    if speed_std_m_s is not None:
        across = speed_std_m_s if course_std_rad is None else max(speed_m_s * course_std_rad, speed_std_m_s)
        covariance = turn_covariance(
            speed_std_m_s, across, course_rad, (up_std_m_s or 0.0) if is_vertical_measured else 0.0
        )
    up = up_m_s if is_vertical_measured and up_m_s is not None else 0.0
    return FixVelocity(
        t_ns=t_ns,
        velocity_enu_m_s=(speed_m_s * sin(course_rad), speed_m_s * cos(course_rad), up),
        velocity_covariance_enu_m2_s2=covariance,
        is_vertical_measured=is_vertical_measured,
    )


def heading_imu(t_ns: int, heading_rad: float, std_rad: float | None = None) -> VehicleImu:
    """Return a heading, clockwise from true north, as the attitude of a level vehicle."""
    known = std_rad is not None
    covariance = (_TILT_VARIANCE_RAD2, 0.0, 0.0, 0.0, _TILT_VARIANCE_RAD2, 0.0, 0.0, 0.0, (std_rad or 0.0) ** 2)
    return VehicleImu(
        t_ns=t_ns,
        orientation_wxyz=quaternion_from_yaw(yaw_enu_from_ned(heading_rad)),
        orientation_covariance_rad2=covariance if known else None,
    )


def is_repeated(t_ns: int, told_ns: int) -> bool:
    """Return whether an instant is not newer than the last one told; far before it, the receiver has set its clock."""
    return told_ns - _REPEATED_NS < t_ns <= told_ns


def drop_implausible(value: float) -> float | None:
    """Return a receiver's number, None where it is NaN or larger than anything that one measures."""
    return value if abs(value) <= _NUMBER_MAX else None


def are_positive(values: Sequence[float | None]) -> bool:
    """Return whether all of a receiver's deviations are there and above zero, which stands for unknown."""
    return all(value is not None and isfinite(value) and value > 0.0 for value in values)


_LINE_BYTES_MAX = 16384  # gpsd's longest report, with all satellites in view, is about 10 kB


class Lines:
    """Collects lines; one that never ends is thrown away and counted in `overlong`."""

    def __init__(self) -> None:
        self.overlong = 0
        self._rest = b""
        self._is_skipping = False

    def clear(self) -> None:
        """Forget the line that has begun."""
        self._rest, self._is_skipping = b"", False

    def take(self, data: bytes) -> list[bytes]:
        """Return the lines that `data` completes, without their ends and without empty ones."""
        *whole, self._rest = (self._rest + data).replace(b"\r", b"\n").split(b"\n")
        if whole and self._is_skipping:
            del whole[0]
            self._is_skipping = False
        if len(self._rest) > _LINE_BYTES_MAX:
            self.overlong += not self._is_skipping
            self._rest, self._is_skipping = b"", True
        return [line for line in whole if line]
