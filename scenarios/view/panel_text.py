"""The text of the view's panel: what the landing does now, and what is known of drone, vehicle and links."""

import math
from html import escape

from link.frames.rotations import roll_pitch_yaw_of
from link.messages import BodyTruth, LandingStatus
from link.program.status_rows import link_rows, number, status_rows
from link.records import replace
from scenarios.view.models import BLUE, GREEN, GREY, ORANGE
from scenarios.view.plots import css
from scenarios.view.state import ViewState

_LEGEND = ((BLUE, "flown"), (GREY, "pad's way"), (GREEN, "plan, cone"), (ORANGE, "estimate, forecast"))
_FLOWN_BY = {"companion": "follows the companion", "failsafe": "flies a failsafe", "other": "in a mode of its own"}
_FORECAST_AGE_MAX_NS = 250_000_000  # forecasts are recorded at 10 Hz, and only while the drone descends
_BOX = "padding:.2rem .8rem;font-size:.78rem;line-height:1.35"
_VALUE_MAX = 28  # longer ones are sentences
_PAINT = {
    "descend": "#169146", "touchdown": "#169146", "secured": "#0f6b33", "abort": "#c62828", "hold": "#b26a00",
    "pilot in command": "#c62828",
}  # fmt: skip


def phase_text(state: ViewState, *, stale: bool) -> str:
    """Return the phase and why, as HTML: what an operator reads before a button is pressed."""
    status = state.status
    phase = "no companion" if status is None or stale else status.phase
    reason = "waiting for its status" if status is None or stale else status.reason
    paint = _PAINT.get(phase, "#2563eb")
    return (
        f'<div style="{_BOX}">'
        f'<div id="phase" style="font-size:1.35rem;font-weight:700;color:{paint}">{escape(phase)}</div>'
        f'<div id="reason" style="min-height:2.7em;color:#334">{escape(reason)}</div></div>'
    )


def known_text(state: ViewState, t_s: float) -> str:
    """Return what is known of drone, vehicle and links, and what the colours mean, as HTML."""
    rows = "".join(_row(name, value) for name, value in _rows(state, t_s))
    legend = " ".join(
        f'<span style="white-space:nowrap"><span style="color:{css(color)}">&#9632;</span> {name}</span>'
        for color, name in _LEGEND
    )
    return (
        f'<div style="{_BOX}">'
        f'<table style="width:100%;font-variant-numeric:tabular-nums">{rows}</table>'
        f'<div style="margin-top:.3rem;font-size:.72rem">{legend}</div></div>'
    )


def _row(name: str, value: str) -> str:
    """Return a row of the table; a sentence stands below its name, so that it leaves the others their width."""
    named = f'<span style="color:#667">{escape(name)}</span>'
    if len(value) > _VALUE_MAX:
        return f'<tr><td colspan="2">{named}: {escape(value)}</td></tr>'
    return f'<tr><td>{named}</td><td style="text-align:right;white-space:nowrap">{escape(value)}</td></tr>'


def _rows(state: ViewState, t_s: float) -> list[tuple[str, str]]:
    speed_m_s = None if state.drone is None else math.hypot(*state.drone.velocity_flu_m_s)
    rows = [("time", f"{t_s:.1f} s"), *status_rows(_status_of(state)), ("drone's speed", number(speed_m_s, "m/s"))]
    vehicle_m_s = None
    if state.vehicle_truth is not None:
        vehicle_m_s = math.hypot(*state.vehicle_truth.velocity_flu_m_s)
    elif state.estimate is not None:
        vehicle_m_s = math.hypot(*(float(value) for value in state.estimate.velocity_enu_m_s))
    rows += [("vehicle's speed", number(vehicle_m_s, "m/s")), ("pad seen", seen_text(state))]
    rows += _drone_rows(state.drone, state.status)
    if state.link is not None:
        link = state.link
        rows += link_rows(
            link.messages_received, link.messages_sent, link.lost_messages, link.bad_bytes, link.bad_payloads
        )
    return rows


def _status_of(state: ViewState) -> LandingStatus | None:
    """Return the status; a recorded one with the forecast of the contact that was recorded beside it."""
    status, recorded = state.status, state.recorded_forecast
    if status is None or recorded is None or abs(status.stamp_ns - recorded.t_ns) > _FORECAST_AGE_MAX_NS:
        return status
    return replace(status, contact_forecast=recorded.forecast)


def _drone_rows(drone: BodyTruth | None, status: LandingStatus | None) -> list[tuple[str, str]]:
    """Return how the drone lies in the air, and what its autopilot says; angles in degrees, the heading by compass."""
    attitude, heading = "-", "-"
    if drone is not None:
        roll, pitch, yaw = (math.degrees(angle_rad) for angle_rad in roll_pitch_yaw_of(drone.orientation_wxyz))
        side, nose = "right" if roll > 0.0 else "left", "down" if pitch > 0.0 else "up"
        attitude = f"{abs(roll):.0f}° {side}, {abs(pitch):.0f}° nose {nose}"
        heading = f"{(90.0 - yaw) % 360.0:03.0f}° from north"
    share = None if status is None else status.battery_share
    armed = "-" if status is None else "armed" if status.armed else "not armed"
    flown_by = "" if status is None or not status.flown_by else f", {_FLOWN_BY.get(status.flown_by, status.flown_by)}"
    return [
        ("attitude", attitude),
        ("heading", heading),
        ("autopilot", armed + flown_by),
        ("battery", "-" if share is None else f"{100.0 * share:.0f} %"),
    ]


def seen_text(state: ViewState) -> str:
    """Return how far away the detector last saw the pad, how well, and how long ago."""
    sighting = state.sighting
    if sighting is None:
        return "-"
    age_s = (state.t_ns - sighting.t_ns) * 1e-9
    std_m = math.sqrt(max(0.0, *sighting.position_covariance_m2[::4]))
    return f"{math.hypot(*sighting.position_flu_m):.2f} m away to {std_m:.2f} m, {max(age_s, 0.0):.1f} s ago"
