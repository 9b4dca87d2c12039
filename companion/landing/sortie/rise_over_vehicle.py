"""A drone that will be nearer to the vehicle than its cylinder allows is raised over the roof in time; pure.

Aims beside the vehicle bound the way, not the drone: a vehicle that turns towards a drone lower than its roof drives it
over. Where the drone is to be by its last plan, or will be within a second as it flies now, tells by the forecast how
far it is to be inside the cylinder. With each part of the margin that it loses there it is aimed as much higher: that
of the roof's clearance before its rotors reach the vehicle.
"""

import numpy as np

from companion.config.companion import CompanionConfig
from companion.core.data import Array
from companion.landing.steering.flown_plan import FlownPlan
from companion.landing.steering.targets import Aim
from companion.situation.situation import Drone
from companion.sortie.station import KeepOut
from companion.vehicle.pad import PadPath
from link.records import replace

_OWN_S = 1.0  # for which the drone goes on as it flies: a copter has turned its thrust and lost some m/s in that
_LOST_SHARE = 0.5  # of the margin, after which it is over the roof: the rest of 0.5 m is for rotors that reach 0.35 m


def rise_over_vehicle(
    aim: Aim,
    flown: FlownPlan | None,
    drone: Drone | None,
    pad: PadPath,
    keep_out: KeepOut,
    *,
    monotonic_ns: int,
    feet_offset_m: float,
    config: CompanionConfig,
) -> Aim:
    """Return the aim with target and floor raised where the drone would be inside the vehicle's cylinder.

    Args:
        aim: in W, at the offsets of the pad's path.
        flown: the last plan; None before the first.
        drone: now; None while unknown.
        pad: its path.
        keep_out: the cylinder about it.
        monotonic_ns: now.
        feet_offset_m: of the reported position above the feet.
        config: with the margin of the cylinder.
    """
    offset_s, pad_enu_m = pad.offset_s, pad.position_enu_m
    inside_m = np.zeros(len(offset_s))
    if flown is not None:
        path = flown.trajectory
        path_s = path.offset_s + (flown.starts_ns - monotonic_ns) * 1e-9
        place = np.column_stack([np.interp(offset_s, path_s, path.position_enu_m[:, k]) for k in (0, 1)])
        inside_m = np.maximum(inside_m, _inside_m(place, pad_enu_m, keep_out))
    if drone is not None:
        place = drone.position_enu_m[:2] + offset_s[:, None] * drone.velocity_enu_m_s[:2]
        own_m = _inside_m(place, pad_enu_m, keep_out)
        inside_m = np.maximum(inside_m, np.where(offset_s <= _OWN_S, own_m, 0.0))
    if not inside_m.any():
        return aim
    share = np.minimum(inside_m / (_LOST_SHARE * config.sortie.keep_out_margin_m), 1.0)
    over_enu_m = pad_enu_m[:, 2] + feet_offset_m + keep_out.over_m
    position = aim.target.position_enu_m.copy()
    position[:, 2] = _raised(position[:, 2], over_enu_m, share)
    floor = _raised(aim.floor_enu_m, over_enu_m, share)
    return replace(aim, target=replace(aim.target, position_enu_m=position), floor_enu_m=floor)


def _inside_m(place: Array, pad_enu_m: Array, keep_out: KeepOut) -> Array:
    """Return (n,) how far inside the cylinder places (n, 2) are, 0 outside."""
    away = place - pad_enu_m[:, :2]
    return np.maximum(keep_out.radius_m - np.hypot(away[:, 0], away[:, 1]), 0.0)


def _raised(height_m: Array, over_m: Array, share: Array) -> Array:
    """Return heights (n,) raised by a share of what they lack to `over_m`."""
    return np.asarray(height_m + share * np.maximum(over_m - height_m, 0.0))
