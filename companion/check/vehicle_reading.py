"""Listening to a vehicle: how often, how late and how exactly it tells where it is; no I/O."""

import cmath
import math
import statistics

from companion.check.observation import VehicleFacts
from companion.config.integrity import IntegrityConfig
from companion.core.data import Quantity
from companion.vehicle.imu_inputs import imu_measurements
from companion.vehicle.inputs import VELOCITY_STD_M_S
from companion.vehicle.unit_watch import UnitWatch
from link.frames.rotations import yaw_of
from link.messages import Fix, FixVelocity, VehicleImu
from link.payloads import cdr
from link.payloads.checks import PayloadError
from link.zenoh.pad_question import PadQuestion

_HEADING_AGE_MAX_NS = 300_000_000
_COMPARED_MIN = 5


class VehicleReader:
    """Takes a vehicle's samples.

    Args:
        key: of its fixes.
        config: from which speed on it has a course.
    """

    def __init__(self, key: str, config: IntegrityConfig) -> None:
        self._key = key
        self._course_speed_min_m_s = config.course_speed_min_m_s
        self._arrived_ns: list[int] = []
        self._ages_s: list[float] = []
        self._fix_refused_why: str | None = None
        self._std_m: float | None = None
        self._has_velocity = False
        self._tells_acceleration = False
        self._unit = UnitWatch()
        self._heading: tuple[int, float] | None = None
        self._offs: list[complex] = []
        self._speeds_m_s: list[float] = []

    def fix(self, payload: bytes, arrived_ns: int, utc_ns: int | None) -> None:
        """Take a fix that arrived at local time `arrived_ns`, UTC `utc_ns` where that is known."""
        try:
            fix = cdr.decode(Fix, payload)
        except PayloadError as error:
            self._fix_refused_why = str(error)
            return
        self._arrived_ns.append(arrived_ns)
        if utc_ns is not None:
            self._ages_s.append((utc_ns - fix.t_ns) * 1e-9)
        if fix.covariance_enu_m2 is not None:
            # The estimator goes by the worst axis, and a receiver's is the vertical one.
            variance = max(fix.covariance_enu_m2[0], fix.covariance_enu_m2[4], fix.covariance_enu_m2[8])
            if math.isfinite(variance) and variance > 0.0:
                self._std_m = max(self._std_m or 0.0, math.sqrt(variance))

    def velocity(self, payload: bytes) -> None:
        """Take a velocity: that there is one, and of a vehicle that drives how its heading compares with its course."""
        self._has_velocity = True
        try:
            message = cdr.decode(FixVelocity, payload)
        except PayloadError:
            return
        covariance = message.velocity_covariance_enu_m2_s2
        variance = VELOCITY_STD_M_S**2 if covariance is None else covariance[0]
        self._unit.pushes.take_velocity(message.t_ns, message.velocity_enu_m_s, variance)
        east_m_s, north_m_s, _ = message.velocity_enu_m_s
        speed_m_s = math.hypot(east_m_s, north_m_s)
        if self._heading is None or speed_m_s < self._course_speed_min_m_s:
            return
        heard_ns, yaw_rad = self._heading
        if abs(message.t_ns - heard_ns) <= _HEADING_AGE_MAX_NS:
            self._offs.append(cmath.rect(1.0, yaw_rad - math.atan2(north_m_s, east_m_s)))
            self._speeds_m_s.append(speed_m_s)

    def imu(self, payload: bytes) -> None:
        """Take its heading, and that it tells its acceleration, where it does."""
        try:
            message = cdr.decode(VehicleImu, payload)
        except PayloadError:
            return
        measurements = imu_measurements(message, self._unit)
        self._tells_acceleration |= any(one.quantity is Quantity.ACCELERATION for one in measurements)
        if message.orientation_wxyz is not None:
            self._heading = (message.t_ns, yaw_of(message.orientation_wxyz))

    @property
    def is_heard(self) -> bool:
        """Whether a fix of it has come."""
        return bool(self._arrived_ns)

    def facts(self, pad: PadQuestion) -> VehicleFacts:
        """Return what is known now, with what came of the question for its pad."""
        span_s = (self._arrived_ns[-1] - self._arrived_ns[0]) * 1e-9 if self._arrived_ns else 0.0
        return VehicleFacts(
            key=self._key,
            rate_hz=(len(self._arrived_ns) - 1) / span_s if span_s > 0.0 else 0.0,
            fix_refused_why=self._fix_refused_why,
            age_s=statistics.median(self._ages_s) if self._ages_s else None,
            std_m=self._std_m,
            has_velocity=self._has_velocity,
            tells_acceleration=self._tells_acceleration,
            acceleration_refused_why=self._unit.doubts().get("acceleration"),
            describes_pad=pad.is_answered,
            pad_refused_why=pad.refused_why,
            antenna_behind_pad_m=0.0 if pad.pad is None else pad.pad.antenna_to_pad_m[0],
            tells_heading=self._heading is not None,
            heading_off_rad=cmath.phase(sum(self._offs)) if len(self._offs) >= _COMPARED_MIN else None,
            compared_speed_m_s=statistics.fmean(self._speeds_m_s) if self._speeds_m_s else 0.0,
            pad_width_m=math.inf if pad.pad is None else min(pad.pad.size_m),
            is_afloat=pad.pad is not None and pad.pad.is_afloat,
        )
