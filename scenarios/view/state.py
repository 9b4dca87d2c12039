"""What the view shows at one instant, put together from messages; pure.

The messages are the same on Zenoh and in a recording. World W is ENU; where there is no truth, a value is None.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from link.messages import (
    BodyTruth,
    CompressedPicture,
    ContactForecast,
    LandingStatus,
    PadGeometry,
    PadSighting,
    Plan,
)
from link.payloads import cdr, json_messages
from link.payloads.checks import PayloadError
from link.payloads.decklander_msgs import PACKAGE, fields_of
from link.records import replace
from link.zenoh.keys import Keys
from scenarios.view.fields import Array, finite, number, rows, stamp_ns, vector


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Estimate:
    """The vehicle's antenna at `t_ns` as the companion estimates it: (3,) each in W; an unknown heading is None."""

    t_ns: int
    position_enu_m: Array
    velocity_enu_m_s: Array
    yaw_rad: float | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ForecastPath:
    """The antenna over the horizon: (n, 3) positions in W with their standard deviations."""

    position_enu_m: Array
    std_m: Array


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordedForecast:
    """How the descent was to end, forecast at `t_ns`; live, the status itself has it."""

    t_ns: int
    forecast: ContactForecast


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkCounters:
    """How the companion's links did so far."""

    messages_received: int
    messages_sent: int
    lost_messages: int
    bad_bytes: int
    bad_payloads: int


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ViewState:
    """All that is known at `t_ns`.

    Attributes:
        t_ns: of the newest motion of the drone, or status.
        drone_truth: simulation only, as is the vehicle's.
        own: the drone as its autopilot reports it.
        plan_enu_m: (n, 3).
        sighting: of the pad, by the detector.
        picture: that it was made of: with what was seen drawn in, live; as it was taken, from a recording.
    """

    t_ns: int = 0
    drone_truth: BodyTruth | None = None
    vehicle_truth: BodyTruth | None = None
    own: BodyTruth | None = None
    estimate: Estimate | None = None
    forecast: ForecastPath | None = None
    plan_enu_m: Array | None = None
    status: LandingStatus | None = None
    pad: PadGeometry | None = None
    link: LinkCounters | None = None
    sighting: PadSighting | None = None
    picture: CompressedPicture | None = None
    recorded_forecast: RecordedForecast | None = None

    @property
    def drone(self) -> BodyTruth | None:
        """The drone as it is or, without truth, as its autopilot reports it."""
        return self.drone_truth or self.own


class StateReader:
    """Reads messages by their topics.

    Args:
        keys: of the Zenoh contract.
    """

    def __init__(self, keys: Keys) -> None:
        self._readers: dict[str, Callable[[bytes], dict[str, Any]]] = {
            keys.drone_truth: _drone_truth,
            keys.vehicle_truth: lambda payload: {"vehicle_truth": cdr.decode(BodyTruth, payload)},
            keys.record("own"): _own,
            keys.record("estimate"): _estimate,
            keys.record("forecast"): _forecast,
            keys.record("link"): _link,
            keys.record("plan"): _read_plan,
            keys.record("step"): _step,
            keys.record("contact_forecast"): _contact_forecast,
            keys.landing_plan: _plan,
            keys.landing_status: _status,
            keys.pad: lambda payload: {"pad": json_messages.decode(PadGeometry, payload)},
            keys.pad_pose: lambda payload: {"sighting": cdr.decode(PadSighting, payload)},
            keys.pad_view: _picture,
            keys.camera_compressed: _picture,
        }

    @property
    def topics(self) -> frozenset[str]:
        """What it can read."""
        return frozenset(self._readers)

    def taken(self, state: ViewState, topic: str, payload: bytes) -> ViewState:
        """Return the state with what a message says.

        Raises:
            PayloadError: the bytes are no such message.
        """
        changes = self._readers[topic](payload)
        t_ns = changes.pop("t_ns", 0)
        is_drone = "drone_truth" in changes or (state.drone_truth is None and "own" in changes)
        if is_drone or (state.drone is None and t_ns):
            changes["t_ns"] = t_ns
        return replace(state, **changes)


def _picture(payload: bytes) -> dict[str, Any]:
    return {"picture": cdr.decode(CompressedPicture, payload)}


def _drone_truth(payload: bytes) -> dict[str, Any]:
    truth = cdr.decode(BodyTruth, payload)
    return {"t_ns": truth.t_ns, "drone_truth": truth}


def _own(payload: bytes) -> dict[str, Any]:
    own = cdr.decode(BodyTruth, payload)
    return {"t_ns": own.t_ns, "own": own}


def _status(payload: bytes) -> dict[str, Any]:
    status = json_messages.decode(LandingStatus, payload)
    return {"t_ns": status.stamp_ns, "status": status, **_plan_over(status)}


def _plan_over(status: LandingStatus) -> dict[str, Any]:
    """Forget the plan when nothing is flown any more."""
    return {} if status.armed else {"plan_enu_m": None}


def _estimate(payload: bytes) -> dict[str, Any]:
    fields = fields_of(payload, f"{PACKAGE}/VehicleEstimate")
    estimate = Estimate(
        t_ns=stamp_ns(fields),
        position_enu_m=finite(fields["position_m"]),
        velocity_enu_m_s=finite(fields["velocity_m_s"]),
        yaw_rad=number(fields["yaw_rad"]),
    )
    return {"estimate": estimate}


def _forecast(payload: bytes) -> dict[str, Any]:
    fields = fields_of(payload, f"{PACKAGE}/Forecast")
    position_enu_m, std_m = rows(fields["position_m"]), rows(fields["position_std_m"])
    if len(position_enu_m) != len(std_m):
        raise PayloadError(f"{len(position_enu_m)} positions have {len(std_m)} standard deviations")
    return {"forecast": ForecastPath(position_enu_m=position_enu_m, std_m=std_m)}


def _link(payload: bytes) -> dict[str, Any]:
    fields = fields_of(payload, f"{PACKAGE}/LinkStatistics")
    counters = LinkCounters(
        messages_received=int(fields["messages_received"]),
        messages_sent=int(fields["messages_sent"]),
        lost_messages=int(fields["lost_messages"]),
        bad_bytes=int(fields["bad_bytes"]),
        bad_payloads=int(fields["zenoh_bad_payloads"]),
    )
    return {"link": counters}


def _plan(payload: bytes) -> dict[str, Any]:
    poses = cdr.decode(Plan, payload).poses
    return {"plan_enu_m": np.array([pose.position_enu_m for pose in poses]).reshape(-1, 3)}


def _read_plan(payload: bytes) -> dict[str, Any]:
    return {"plan_enu_m": rows(fields_of(payload, f"{PACKAGE}/Trajectory")["position_m"])}


def _step(payload: bytes) -> dict[str, Any]:
    fields = fields_of(payload, f"{PACKAGE}/Step")
    t_ns = stamp_ns(fields)
    status = LandingStatus(
        stamp_ns=t_ns,
        phase=fields["phase"],
        reason=fields["reason"],
        relative_position_enu_m=vector(fields["relative_position_m"]),
        relative_velocity_enu_m_s=vector(fields["relative_velocity_m_s"]),
        height_above_pad_m=number(fields["height_above_pad_m"]),
        time_to_contact_s=number(fields["time_to_contact_s"]),
        armed=bool(fields["armed"]),
        fix_age_s=number(fields["fix_age_s"]),
    )
    return {"t_ns": t_ns, "status": status, **_plan_over(status)}


def _contact_forecast(payload: bytes) -> dict[str, Any]:
    fields = fields_of(payload, f"{PACKAGE}/ContactForecast")
    values = {name: float(fields[name]) for name in ContactForecast.__struct_fields__ if name != "in_s"}
    forecast = ContactForecast(in_s=number(fields["in_s"]), **values)
    return {"recorded_forecast": RecordedForecast(t_ns=stamp_ns(fields), forecast=forecast)}
