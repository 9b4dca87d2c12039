"""What a touchdown was like, measured on ground truth against the deck, and whether the drone stayed.

Positions, speeds and tilt at contact are taken against the deck: horizontal is along it, sinking is across it.
Trim is the tilt of steady flight in the mean air at the contact, atan(drag / weight). That air is the mean wind, and
what the vehicle makes of it.
"""

import math
from dataclasses import dataclass

import numpy as np

from link.messages import Vector3
from scenarios.config import Scenario, VehicleConfig
from scenarios.scoring.flight_faults import motors_off_index
from scenarios.scoring.touch import Box, Contact
from scenarios.scoring.truth_log import Array, Indices, TruthLog
from sim_autopilot.air.airflow import Obstacle, body_of, flow_at
from sim_autopilot.physics.airframe import GRAVITY_M_S2
from sim_autopilot.runtime.physics import airframe_of, superstructure_of

_MOTORS_OFF_MAX_S = 2.0
_STAYS_S = 2.0
_SLIDE_MAX_M = 0.3
_ON_PAD_HEIGHT_M = 0.25  # of the centre of mass; 0.12 m stands on its feet


@dataclass(frozen=True, slots=True, kw_only=True)
class ScoreRules:
    """What the score depends on beside the truth.

    Attributes:
        box: the vehicle and its pad.
        waiting_point_enu_m: whose passing by the vehicle starts the manoeuvre.
        mass_kg: of the drone, for the trim.
        drag_n_s_m: linear drag of the drone on airspeed, for the trim.
        drag_n_s2_m2: quadratic drag, for the trim.
        wind_mean_enu_m_s: mean wind, for the trim.
        obstacle: what the vehicle puts into that wind, None for nothing.
        fence_radius_m: horizontal, about the origin of W.
        fence_drives_along: it is about the vehicle, which is a sortie's home wherever it drives.
        report_rule: S0 counts as a landing.
        carries: the deck carries a drone that has touched it. One that is only said to drive, over ground that stands,
            goes on from under it: what happens after the first contact is no fault then.
    """

    box: Box
    waiting_point_enu_m: Vector3
    mass_kg: float
    drag_n_s_m: float
    drag_n_s2_m2: float = 0.0
    wind_mean_enu_m_s: Vector3 = (0.0, 0.0, 0.0)
    obstacle: Obstacle | None = None
    fence_radius_m: float = math.inf
    fence_drives_along: bool = False
    report_rule: bool = False
    carries: bool = True

    def outward_m(self, log: TruthLog) -> Array:
        """Return how far (n,) the drone is from the middle of the fence."""
        middle = log.vehicle_position_enu_m if self.fence_drives_along else np.zeros(3)
        away = log.position_enu_m - middle
        return np.asarray(np.hypot(away[:, 0], away[:, 1]))


def rules_of(scenario: Scenario, *, wind_mean_enu_m_s: Vector3 = (0.0, 0.0, 0.0)) -> ScoreRules:
    """Return the rules of `scenario`; S0 is a tier where the pad lies on the road, as in the report."""
    vehicle = scenario.vehicle
    airframe = airframe_of(scenario.system.drone)
    return ScoreRules(
        box=Box(
            roof_size_m=(vehicle.length_m, vehicle.width_m),
            roof_height_m=vehicle.roof_height_m,
            pad_size_m=vehicle.pad_size_m,
            is_afloat=vehicle.is_afloat,
        ),
        waiting_point_enu_m=scenario.run.waiting_point_enu_m,
        mass_kg=airframe.mass_kg,
        drag_n_s_m=airframe.drag_n_s_m,
        drag_n_s2_m2=airframe.drag_n_s2_m2,
        wind_mean_enu_m_s=wind_mean_enu_m_s,
        obstacle=_obstacle_of(vehicle),
        fence_radius_m=scenario.run.fence_radius_m,
        report_rule=vehicle.roof_height_m == 0.0,
    )


def _obstacle_of(vehicle: VehicleConfig) -> Obstacle | None:
    if vehicle.superstructure is not None:
        return superstructure_of(vehicle.superstructure, vehicle.roof_height_m)
    return body_of((vehicle.length_m, vehicle.width_m), vehicle.roof_height_m)


@dataclass(frozen=True, slots=True, kw_only=True)
class Touchdown:
    """The first contact: everything but `tilt_rad` (against the deck) and `trim_rad` is what the tiers bound."""

    contact_t_ns: int
    on_pad: bool
    horizontal_error_m: float
    contact_forward_m: float  # from the pad's centre, in V
    contact_left_m: float
    relative_speed_m_s: float
    sink_rate_m_s: float
    tilt_rad: float
    trim_rad: float
    tilt_over_trim_rad: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Landing:
    """The first contact, and what came after it; None where the motors were never off."""

    touchdown: Touchdown
    motors_off_s: float | None
    slid_m: float
    secured: bool


def landing_of(log: TruthLog, contact: Contact, rules: ScoreRules) -> Landing:
    """Return what came of `contact`; it is secured when motors go off in time and the drone then stays."""
    off = motors_off_index(log, contact.before + 1)
    motors_off_s = None if off is None else (int(log.t_ns[off]) - contact.t_ns) * 1e-9
    touchdown = _touchdown(log, contact, rules)
    stays = False
    after = slice(contact.before + 1, None)
    if off is not None:
        checked = int(np.searchsorted(log.t_ns, log.t_ns[off] + round(_STAYS_S * 1e9)))
        after = slice(contact.before + 1, checked + 1)
        stays = checked < len(log.t_ns) and _on_pad(log.position_v_m[checked], rules.box)
    slid_m = float(np.linalg.norm(log.position_v_m[after, :2] - contact.position_v_m[:2], axis=1).max())
    in_time = motors_off_s is not None and motors_off_s <= _MOTORS_OFF_MAX_S
    return Landing(
        touchdown=touchdown,
        motors_off_s=motors_off_s,
        slid_m=slid_m,
        secured=in_time and stays and slid_m <= _SLIDE_MAX_M,
    )


def trims_rad(log: TruthLog, samples: Indices, rules: ScoreRules) -> Array:
    """Return the tilts (n,) of steady flight at the velocities of n samples, in the mean air where the drone is."""
    air_m_s = np.array([_air_enu_m_s(log, k, rules) for k in samples.tolist()]).reshape(-1, 3)
    airspeed_m_s = np.linalg.norm((log.velocity_enu_m_s[samples] - air_m_s)[:, :2], axis=1)
    drag_n = (rules.drag_n_s_m + rules.drag_n_s2_m2 * airspeed_m_s) * airspeed_m_s
    return np.asarray(np.arctan(drag_n / (rules.mass_kg * GRAVITY_M_S2)))


def _air_enu_m_s(log: TruthLog, k: int, rules: ScoreRules) -> Array:
    """Return the mean air (3,), m/s in W, at sample `k`."""
    wind = np.array(rules.wind_mean_enu_m_s)
    if rules.obstacle is None:
        return wind
    rotation_vw = log.rotation_vb[k] @ log.rotation[k].T
    along, across, _ = (rotation_vw @ (wind - log.vehicle_velocity_enu_m_s[k])).tolist()
    x_m, y_m, z_m = log.position_v_m[k].tolist()
    flow = flow_at(rules.obstacle, (x_m, y_m, z_m), (along, across))
    return np.asarray(wind + rotation_vw.T @ np.array(flow.change_m_s))


def _on_pad(position_v_m: Array, box: Box) -> bool:
    """Return whether a drone at `position_v_m` (3,) stands on the pad."""
    x_m, y_m, z_m = position_v_m
    inside = abs(x_m) <= 0.5 * box.pad_size_m[0] and abs(y_m) <= 0.5 * box.pad_size_m[1]
    return bool(inside and z_m - box.roof_height_m <= _ON_PAD_HEIGHT_M)


def _touchdown(log: TruthLog, contact: Contact, rules: ScoreRules) -> Touchdown:
    """Return the first contact's measures; velocity and attitude are those just before it."""
    k = contact.before
    velocity_v_m_s = log.velocity_v_m_s[k]
    trim_rad = float(trims_rad(log, np.array([k]), rules)[0])
    tilt_rad = math.acos(min(1.0, max(-1.0, float(log.rotation_vb[k, 2, 2]))))
    return Touchdown(
        contact_t_ns=contact.t_ns,
        on_pad=contact.on_pad,
        horizontal_error_m=math.hypot(contact.position_v_m[0], contact.position_v_m[1]),
        contact_forward_m=float(contact.position_v_m[0]),
        contact_left_m=float(contact.position_v_m[1]),
        relative_speed_m_s=math.hypot(velocity_v_m_s[0], velocity_v_m_s[1]),
        sink_rate_m_s=float(-velocity_v_m_s[2]),
        tilt_rad=tilt_rad,
        trim_rad=trim_rad,
        tilt_over_trim_rad=tilt_rad - trim_rad,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """The largest values, each of the measure of that name of a `Touchdown`."""

    horizontal_error_m: float
    relative_speed_m_s: float
    sink_rate_m_s: float
    tilt_over_trim_rad: float


S1_LIMITS = Limits(
    horizontal_error_m=0.50, relative_speed_m_s=1.0, sink_rate_m_s=1.0, tilt_over_trim_rad=math.radians(15.0)
)
S2_LIMITS = Limits(
    horizontal_error_m=0.30, relative_speed_m_s=0.5, sink_rate_m_s=0.7, tilt_over_trim_rad=math.radians(10.0)
)


def find_exceeded(touchdown: Touchdown, limits: Limits) -> list[str]:
    """Return the measures of `touchdown` that exceed `limits`, with their values."""
    names = Limits.__dataclass_fields__
    return [
        f"{name} {getattr(touchdown, name):.3g}" for name in names if getattr(touchdown, name) > getattr(limits, name)
    ]
