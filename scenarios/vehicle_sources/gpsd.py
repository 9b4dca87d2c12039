"""gpsd's JSON reports: TPV for place and velocity, GST for the accuracy that the receiver states, ATT for heading.

The deviations in TPV (epx, epy, epv, eps, epd, epc) have, by gpsd's own documentation, no certain confidence level;
they are taken for standard deviations, which errs on the safe side where they are 95 % bounds. A vertical velocity
without epc is a difference of heights made by gpsd, and is passed over. GST comes after the TPV of its instant, so the
newest one that is not old holds.
Source: gpsd_json(5), protocol version 3.14.
"""

import json
import re
from datetime import datetime
from math import radians
from typing import Any

from link.messages import Fix, FixVelocity, Matrix3
from scenarios.vehicle_sources.receiver import (
    ACCURACY_AGE_MAX_NS,
    Lines,
    Reading,
    are_positive,
    course_velocity,
    diagonal,
    drop_implausible,
    heading_imu,
    is_repeated,
    stated_covariance,
)

_3D = 3
_TIME = re.compile(r"(\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d)(?:\.(\d{1,9}))?Z")
_MISPLACED_TIME = re.compile(rb',,"time":"([^"]*)""')
"""gpsd 3.22 writes an ATT's time behind a comma too many and without the one that follows."""

Report = dict[str, Any]


class GpsdReceiver:
    """A connection to gpsd.

    Args:
        device: the receiver among gpsd's, None for the first that reports a fix.
    """

    def __init__(self, device: str | None = None) -> None:
        self._asked_device = self._device = device
        self._lines = Lines()
        self._reports = self._bad = self._without_place = 0
        self._is_asked = False
        self._reason: str | None = "gpsd reports no receiver: name it on gpsd's command line, and check its cable"
        self._accuracy: tuple[int, Matrix3] | None = None
        self._told_ns = self._heading_ns = 0

    @property
    def complaint(self) -> str | None:
        """Why there are no fixes."""
        return self._reason

    @property
    def counts(self) -> dict[str, int]:
        """What was received."""
        return {
            "reports": self._reports,
            "bad": self._bad + self._lines.overlong,
            "without_place": self._without_place,
        }

    def connected(self) -> None:
        """Restart: gpsd is to be asked again."""
        self._lines.clear()
        self._is_asked, self._device = False, self._asked_device
        self._told_ns = self._heading_ns = 0

    def to_send(self, _t_ns: int) -> bytes:
        """Return, once for each connection, the request for reports."""
        if self._is_asked:
            return b""
        self._is_asked = True
        wanted: Report = {"enable": True, "json": True}
        if self._asked_device is not None:
            wanted["device"] = self._asked_device
        return b"?WATCH=" + json.dumps(wanted, separators=(",", ":")).encode() + b";\n"

    def take(self, data: bytes, _t_ns: int) -> list[Reading]:
        """Return what the reports completed by `data` tell."""
        readings: list[Reading] = []
        for line in self._lines.take(data):
            report = parse_report(line)
            if report is None:
                self._bad += 1
            else:
                self._reports += 1
                readings += self._take(report)
        return readings

    def _take(self, report: Report) -> list[Reading]:
        if self._device is not None and report.get("device", self._device) != self._device:
            return []
        match report.get("class"):
            case "TPV":
                return self._position(report)
            case "GST":
                self._note_accuracy(report)
            case "ATT":
                return self._heading(report)
            case "ERROR":
                self._reason = f"gpsd says: {report.get('message')}"
        return []

    def _position(self, tpv: Report) -> list[Reading]:
        t_ns = utc_ns(tpv.get("time"))
        if tpv.get("mode") in (None, 0, 1) or t_ns is None:
            self._without_place += 1
            self._reason = "the receiver has no fix: check its antenna and give it a view of the sky"
            return []
        if is_repeated(t_ns, self._told_ns):
            return []
        fix, velocity = self._fix(tpv, t_ns), tpv_velocity(tpv, t_ns)
        if fix is None:
            self._without_place += 1
            return []
        if self._device is None:
            self._device = tpv.get("device")
        self._told_ns, self._reason = t_ns, None
        return [fix] if velocity is None else [fix, velocity]

    def _fix(self, tpv: Report, t_ns: int) -> Fix | None:
        latitude_deg, longitude_deg, altitude_m = _number(tpv, "lat"), _number(tpv, "lon"), ellipsoidal_m(tpv)
        if tpv.get("mode") != _3D or altitude_m is None or latitude_deg is None or longitude_deg is None:
            self._reason = (
                "the fix has no height above the ellipsoid (altHAE): it needs more satellites, or a newer gpsd"
            )
            return None
        if abs(latitude_deg) > 90.0 or abs(longitude_deg) > 180.0:
            self._reason = f"gpsd reports {latitude_deg}, {longitude_deg} degrees, which is no place on earth"
            return None
        return Fix(
            t_ns=t_ns,
            latitude_rad=radians(latitude_deg),
            longitude_rad=radians(longitude_deg),
            altitude_m=altitude_m,
            covariance_enu_m2=self._covariance(tpv, t_ns),
        )

    def _covariance(self, tpv: Report, t_ns: int) -> Matrix3 | None:
        if self._accuracy is not None and 0 <= t_ns - self._accuracy[0] <= ACCURACY_AGE_MAX_NS:
            return self._accuracy[1]
        return tpv_covariance(tpv)

    def _note_accuracy(self, gst: Report) -> None:
        t_ns, covariance = utc_ns(gst.get("time")), gst_covariance(gst)
        if t_ns is not None:
            self._accuracy = None if covariance is None else (t_ns, covariance)

    def _heading(self, att: Report) -> list[Reading]:
        heading_deg, t_ns = _number(att, "heading"), utc_ns(att.get("time"))
        stamp_ns = t_ns or self._told_ns
        if (
            not stamp_ns
            or heading_deg is None
            or not 0.0 <= heading_deg <= 360.0
            or is_repeated(stamp_ns, self._heading_ns)
        ):
            return []
        self._heading_ns = stamp_ns
        return [heading_imu(stamp_ns, radians(heading_deg))]


def parse_report(line: bytes) -> Report | None:
    """Return the report of a line, None when it is none."""
    try:
        report = json.loads(_MISPLACED_TIME.sub(rb',"time":"\1","', line))
    except (ValueError, RecursionError):
        return None
    return report if isinstance(report, dict) else None


def utc_ns(text: object) -> int | None:
    """Return an ISO 8601 time as UTC nanoseconds, None when it is none."""
    match = _TIME.fullmatch(text) if isinstance(text, str) else None
    if match is None:
        return None
    try:
        whole = datetime.fromisoformat(match[1] + "+00:00")
    except ValueError:
        return None
    return int(whole.timestamp()) * 10**9 + int((match[2] or "").ljust(9, "0"))


def ellipsoidal_m(tpv: Report) -> float | None:
    """Return the height above the ellipsoid, None when the report has none."""
    altitude_m, above_sea_m, geoid_m = (_number(tpv, name) for name in ("altHAE", "altMSL", "geoidSep"))
    if altitude_m is None and above_sea_m is not None and geoid_m is not None:
        return above_sea_m + geoid_m
    return altitude_m


def tpv_covariance(tpv: Report) -> Matrix3 | None:
    """Return the position's covariance in ENU, m^2, by a TPV, None when it does not say."""
    either = _number(tpv, "eph")
    east = _number(tpv, "epx") or either
    north = _number(tpv, "epy") or either
    up = _number(tpv, "epv")
    if east is None or north is None or up is None or not are_positive((east, north, up)):
        return None
    return diagonal(east, north, up)


def gst_covariance(gst: Report) -> Matrix3 | None:
    """Return the position's covariance in ENU, m^2, by a GST, None when it does not say."""
    ellipse = [_number(gst, name) for name in ("major", "minor", "orient")]
    return stated_covariance(ellipse, [_number(gst, name) for name in ("lon", "lat", "alt")])


def tpv_velocity(tpv: Report, t_ns: int) -> FixVelocity | None:
    """Return the velocity by a TPV, None when it has no speed and course."""
    speed_m_s, course_deg, course_std_deg = (_number(tpv, name) for name in ("speed", "track", "epd"))
    if speed_m_s is None or speed_m_s < 0.0 or course_deg is None:
        return None
    return course_velocity(
        t_ns,
        speed_m_s,
        radians(course_deg),
        speed_std_m_s=_number(tpv, "eps") or None,
        course_std_rad=None if course_std_deg is None else radians(course_std_deg),
        up_m_s=_number(tpv, "climb"),
        up_std_m_s=_number(tpv, "epc") or None,
    )


def _number(report: Report, name: str) -> float | None:
    value = report.get(name)
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        return drop_implausible(float(value))
    except OverflowError:
        return None
