"""Listening to the detector of the pad on the drone, and judging what it tells; no I/O."""

import math
import statistics

from companion.check.findings import Finding, Level, pass_line
from companion.check.observation import DetectorFacts
from companion.config.companion import CompanionConfig
from companion.config.integrity import ReceiverFrames
from link.messages import PadSighting
from link.payloads import cdr
from link.payloads.checks import PayloadError

_RATE_MIN_HZ = 5.0  # with fewer, a sighting is older than what a descent allows for between two of them
_AGE_MAX_S = 0.3  # in it a comfortable brake of 2.5 m/s^2 makes 0.75 of the 1.0 m/s that a contact may have


class DetectorReader:
    """Takes a detector's sightings."""

    def __init__(self) -> None:
        self._arrived_ns: list[int] = []
        self._ages_s: list[float] = []
        self._stds_m: list[float] = []
        self._refused_why: str | None = None

    def sighting(self, payload: bytes, arrived_ns: int, utc_ns: int | None) -> None:
        """Take a sighting that arrived at local time `arrived_ns`, UTC `utc_ns` where that is known."""
        try:
            seen = cdr.decode(PadSighting, payload)
        except PayloadError as error:
            self._refused_why = str(error)
            return
        self._arrived_ns.append(arrived_ns)
        if utc_ns is not None:
            self._ages_s.append((utc_ns - seen.t_ns) * 1e-9)
        self._stds_m.append(math.sqrt(max(0.0, *seen.position_covariance_m2[::4])))

    def facts(self, *, is_alive: bool) -> DetectorFacts:
        """Return what is known now, with whether `pad-detector` shows that it runs."""
        span_s = (self._arrived_ns[-1] - self._arrived_ns[0]) * 1e-9 if self._arrived_ns else 0.0
        return DetectorFacts(
            is_alive=is_alive,
            sightings=len(self._arrived_ns),
            rate_hz=(len(self._arrived_ns) - 1) / span_s if span_s > 0.0 else 0.0,
            age_s=statistics.median(self._ages_s) if self._ages_s else None,
            std_m=statistics.median(self._stds_m) if self._stds_m else None,
            refused_why=self._refused_why,
        )


def judge_detector(seen: DetectorFacts, speed_m_s: float, config: CompanionConfig) -> list[Finding]:
    """Return the lines on the detector, for a vehicle of `speed_m_s`, and on what cannot be known without one."""
    if seen.sightings:
        return [_rate(seen), *_age(seen, config), *_accuracy(seen, config)]
    if seen.refused_why is not None:
        return [_line("detector", f"refused: {seen.refused_why}", Level.FAIL, "see what it publishes on pad_pose")]
    if seen.is_alive:
        return [_line("detector", "runs, sees no pad", Level.WARN, "hold the drone over the pad to see how good it is")]
    if config.silent_vehicle is not None:
        return [_line("detector", "none", Level.FAIL, "start pad-detector: nothing else places a silent vehicle")]
    if config.integrity.receiver_frames is ReceiverFrames.ONE:
        return [pass_line("detector", "none, and both receivers have one frame"), _stamps(speed_m_s, config)]
    advice = "start pad-detector, or check --drone and -e; without one only RTK of one source places the pad"
    return [_line("detector", "none", Level.WARN, advice), _stamps(speed_m_s, config)]


def _stamps(speed_m_s: float, config: CompanionConfig) -> Finding:
    off_m, room_m = speed_m_s * config.integrity.fix_ahead_max_s, config.descent.cone.radius_at_pad_m
    found = f"off by {1e3 * config.integrity.fix_ahead_max_s:.0f} ms they put the pad {off_m:.2f} m off"
    advice = (
        "let the vehicle's receiver date its fixes by GNSS, not a program as they arrive; only a detector would tell"
    )
    return _line("vehicle stamps", found, Level.PASS if off_m <= room_m else Level.WARN, advice)


def _line(name: str, found: str, level: Level, advice: str) -> Finding:
    return (
        pass_line(name, found) if level is Level.PASS else Finding(name=name, level=level, found=found, advice=advice)
    )


def _rate(seen: DetectorFacts) -> Finding:
    level = Level.PASS if seen.rate_hz >= _RATE_MIN_HZ else Level.WARN
    return _line("detector", f"{seen.rate_hz:.1f} sightings a second", level, "use smaller pictures, or more light")


def _age(seen: DetectorFacts, config: CompanionConfig) -> list[Finding]:
    if seen.age_s is None:
        return [_line("detector age", "unknown", Level.WARN, "needs the autopilot's time of day")]
    is_early, is_late = seen.age_s < -config.integrity.fix_ahead_max_s, seen.age_s > _AGE_MAX_S
    advice = "set its clock by GNSS or NTP, see --latency" if is_early else "use smaller pictures or a faster computer"
    level = Level.FAIL if is_early else Level.WARN if is_late else Level.PASS
    return [_line("detector age", f"{1e3 * seen.age_s:.0f} ms", level, advice)]


def _accuracy(seen: DetectorFacts, config: CompanionConfig) -> list[Finding]:
    std_m = seen.std_m or 0.0
    level = Level.PASS if std_m <= config.descent.unseen.std_max_m else Level.FAIL
    return [_line("detector accuracy", f"{std_m:.3f} m", level, "come nearer, calibrate, see rotation_std_rad")]
