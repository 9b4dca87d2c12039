"""A landing's status as rows of words, for whatever shows it to people."""

import math

from link.messages import ContactForecast, LandingStatus, Vector3

Row = tuple[str, str]


def status_rows(status: LandingStatus | None) -> list[Row]:
    """Return names and values, all of the same names whatever is known; unknown is a dash."""
    position = None if status is None else status.relative_position_enu_m
    velocity = None if status is None else status.relative_velocity_enu_m_s
    return [
        ("height above the pad", number(None if position is None else position[2], "m")),
        ("horizontal distance", number(None if position is None else math.hypot(*position[:2]), "m")),
        ("east, north, up", _vector(position, "m")),
        ("relative velocity", _vector(velocity, "m/s")),
        ("time to touchdown", number(None if status is None else status.time_to_contact_s, "s")),
        ("keeps ahead, left, up", _vector(None if status is None else status.station_offset_m, "m")),
        ("contact, if it goes on", _forecast(None if status is None else status.contact_forecast)),
        ("age of the last fix", number(None if status is None else status.fix_age_s, "s")),
        ("refused data", "-" if status is None or not status.links.refused else status.links.refused),
        ("not verified", "-" if status is None or not status.unverified else "; ".join(status.unverified)),
    ]


def link_rows(received: int, sent: int, lost: int, bad_bytes: int, bad_payloads: int) -> list[Row]:
    """Return how the companion's links did: MAVLink messages, bytes that were none, and payloads that were refused."""
    return [
        ("messages in, out, lost", f"{received}, {sent}, {lost}"),
        ("bad bytes, payloads", f"{bad_bytes}, {bad_payloads}"),
    ]


def number(value: float | None, unit: str) -> str:
    """Return a value with its unit, a dash for an unknown one."""
    return "-" if value is None else f"{round(value, 2) + 0.0:.2f} {unit}"


def _forecast(forecast: ContactForecast | None) -> str:
    if forecast is None:
        return "-"
    return f"{100.0 * forecast.s2:.0f} % S2, {100.0 * forecast.unsafe:.1f} % unsafe"


def _vector(vector: Vector3 | None, unit: str) -> str:
    return "-" if vector is None else ", ".join(f"{round(part, 2) + 0.0:+.2f}" for part in vector) + f" {unit}"
