"""NMEA 0183: sentences of one instant put together into a fix, a velocity and a heading.

GGA gives the place (its height over the sea plus the geoid's over the ellipsoid), GST its accuracy, RMC or VTG the
velocity, HDT the heading, RMC or ZDA the date. Sentences of one instant carry the same time of day; which of them
comes last is learnt, so that a fix is told as soon as all of its sentences are there. VTG and HDT carry no time and
belong to the sentences before them.
"""

from math import pi, radians

from link.messages import Fix, FixVelocity, Matrix3
from scenarios.vehicle_sources.nmea_sentences import (
    NANOSECONDS_PER_DAY,
    Sentence,
    angle_rad,
    date_of,
    parse_sentence,
    time_of_day_ns,
)
from scenarios.vehicle_sources.receiver import (
    ACCURACY_AGE_MAX_NS,
    Lines,
    Reading,
    course_velocity,
    heading_imu,
    stated_covariance,
)

_TIMED = {"GGA": 0, "RMC": 0, "GST": 0, "ZDA": 0}  # kind: the field of its time
_UNTIMED = ("VTG", "HDT")
_DATED = ("RMC", "ZDA")
_NO_FIX = ("", "0", "7")  # a place typed in by hand (7) is no measurement
_M_S_PER_KNOT = 1852.0 / 3600.0
_M_S_PER_KM_H = 1.0 / 3.6


class NmeaReceiver:
    """A receiver that speaks NMEA 0183."""

    def __init__(self) -> None:
        self._lines = Lines()
        self._sentences = self._bad = self._undated = self._without_place = 0
        self._reason: str | None = "no sentence was received"
        self._time_ns: int | None = None
        self._epoch: dict[str, Sentence] = {}
        self._is_told = False
        self._last_kind = self._ending_kind = ""
        self._day_ns: int | None = None
        self._day_of_time_ns = 0  # the time of day at which the date was known
        self._accuracy: tuple[int, Matrix3] | None = None

    @property
    def complaint(self) -> str | None:
        """Why there are no fixes."""
        if not self._sentences and self._bad:
            return "nothing received is a sentence: check the baud rate, and that the receiver sends NMEA"
        return self._reason

    @property
    def counts(self) -> dict[str, int]:
        """What was received."""
        return {
            "sentences": self._sentences,
            "bad": self._bad + self._lines.overlong,
            "undated": self._undated,
            "without_place": self._without_place,
        }

    def connected(self) -> None:
        """Restart."""
        self._lines.clear()
        self._epoch, self._time_ns = {}, None

    def to_send(self, _t_ns: int) -> bytes:
        """Return nothing: NMEA receivers only talk."""
        return b""

    def take(self, data: bytes, _t_ns: int) -> list[Reading]:
        """Return what the sentences completed by `data` tell."""
        readings: list[Reading] = []
        for line in self._lines.take(data):
            sentence = parse_sentence(line)
            if sentence is None:
                self._bad += 1
            else:
                self._sentences += 1
                readings += self._take(sentence)
        return readings

    def _take(self, sentence: Sentence) -> list[Reading]:
        kind, readings = sentence.kind, list[Reading]()
        if kind in _TIMED:
            time_ns = time_of_day_ns(sentence.text(_TIMED[kind]))
            if time_ns is None:
                self._reason = "the receiver does not know the time yet: give it a view of the sky"
                return []
            if time_ns != self._time_ns:
                readings = self._tell()
                self._ending_kind, self._time_ns, self._epoch, self._is_told = self._last_kind, time_ns, {}, False
        elif kind not in _UNTIMED or self._time_ns is None:
            return []
        self._epoch[kind] = sentence
        if kind in _DATED:
            self._note_date(sentence)
        if kind == "HDT":
            return readings + self._heading(sentence)
        self._last_kind = kind
        return readings + self._tell() if kind == self._ending_kind else readings

    def _note_date(self, sentence: Sentence) -> None:
        day_ns = date_of(sentence)
        if day_ns is not None and self._time_ns is not None:
            self._day_ns, self._day_of_time_ns = day_ns, self._time_ns

    def _stamp_ns(self) -> int | None:
        """Return the UTC of the sentences' instant, None before a date was said."""
        if self._day_ns is None or self._time_ns is None:
            return None
        is_next_day = self._day_of_time_ns - self._time_ns > NANOSECONDS_PER_DAY // 2
        return self._day_ns + self._time_ns + (NANOSECONDS_PER_DAY if is_next_day else 0)

    def _tell(self) -> list[Reading]:
        """Return what the instant's sentences tell, once."""
        if self._is_told or self._time_ns is None:
            return []
        self._is_told = True
        t_ns = self._stamp_ns()
        if t_ns is None:
            self._undated += 1
            self._reason = "the receiver says no date: have it send RMC or ZDA"
            return []
        fix, velocity = self._fix(t_ns), self._velocity(t_ns)
        self._without_place += fix is None
        return [reading for reading in (fix, velocity) if reading is not None]

    def _fix(self, t_ns: int) -> Fix | None:
        gga = self._epoch.get("GGA")
        if gga is None:
            self._reason = "the receiver says no height: have it send GGA"
            return None
        if gga.text(5) in _NO_FIX or self._is_void():
            self._reason = "the receiver has no fix: check its antenna and give it a view of the sky"
            return None
        latitude_rad, longitude_rad = angle_rad(gga.text(1), gga.text(2)), angle_rad(gga.text(3), gga.text(4))
        above_sea_m, geoid_m = gga.number(8), gga.number(10)
        if latitude_rad is None or longitude_rad is None or above_sea_m is None or geoid_m is None:
            self._reason = "GGA has no whole place: latitude, longitude, altitude and geoid separation are needed"
            return None
        self._reason = None
        return Fix(
            t_ns=t_ns,
            latitude_rad=latitude_rad,
            longitude_rad=longitude_rad,
            altitude_m=above_sea_m + geoid_m,
            covariance_enu_m2=self._covariance(t_ns),
        )

    def _is_void(self) -> bool:
        rmc = self._epoch.get("RMC")
        return rmc is not None and rmc.text(1) != "A"

    def _covariance(self, t_ns: int) -> Matrix3 | None:
        gst = self._epoch.get("GST")
        if gst is not None:
            covariance = gst_covariance(gst)
            self._accuracy = None if covariance is None else (t_ns, covariance)
        if self._accuracy is None or not 0 <= t_ns - self._accuracy[0] <= ACCURACY_AGE_MAX_NS:
            return None
        return self._accuracy[1]

    def _velocity(self, t_ns: int) -> FixVelocity | None:
        rmc, vtg = self._epoch.get("RMC"), self._epoch.get("VTG")
        if self._is_void():
            return None
        speed_m_s, course_deg = None, None
        if rmc is not None and rmc.number(6) is not None:
            speed_m_s, course_deg = (rmc.number(6) or 0.0) * _M_S_PER_KNOT, rmc.number(7)
        elif vtg is not None and vtg.text(8) != "N":
            km_h = vtg.number(6)
            speed_m_s, course_deg = None if km_h is None else km_h * _M_S_PER_KM_H, vtg.number(0)
        if speed_m_s is None or speed_m_s < 0.0 or course_deg is None:
            return None
        return course_velocity(t_ns, speed_m_s, radians(course_deg))

    def _heading(self, hdt: Sentence) -> list[Reading]:
        t_ns, heading_deg = self._stamp_ns(), hdt.number(0)
        if t_ns is None or heading_deg is None or not 0.0 <= heading_deg <= 360.0:
            return []
        return [heading_imu(t_ns, heading_deg * pi / 180.0)]


def gst_covariance(gst: Sentence) -> Matrix3 | None:
    """Return the position's covariance in ENU, m^2, that a GST states, None when it does not."""
    major, minor, azimuth_deg, north, east, up = (gst.number(index) for index in range(2, 8))
    return stated_covariance((major, minor, azimuth_deg), (east, north, up))
