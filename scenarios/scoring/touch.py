"""What the drone touches in each sample of a run, and the instant of its first contact.

Eight points of the drone touch: its feet and the outer edges of its rotor discs. A point inside the vehicle's box is on
the roof when it came through the top, else at the flank; the simulated physics makes the same distinction.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scenarios.scoring.truth_log import Array, TruthLog
from sim_autopilot.core.data import Surface
from sim_autopilot.physics.contact import CONTACT_POINTS_FLU_M, EDGE_M
from sim_autopilot.physics.ground import ground_height

Flags = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, kw_only=True)
class Box:
    """The vehicle's body with the pad in the middle of its roof; a roof at height 0 is a pad on the road."""

    roof_size_m: tuple[float, float]
    roof_height_m: float
    pad_size_m: tuple[float, float]
    is_afloat: bool = False


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Touches:
    """Of n samples and 8 points: what each touches, where it is in V, and its height over the face below it.

    Attributes:
        roof: (n, 8).
        side: (n, 8).
        ground: (n, 8).
        points_v_m: (n, 8, 3).
        height_m: (n, 8) over the roof where there is one below, else over the ground.
        from_box_m: (n, 8) from the vehicle's body, in whatever direction it is nearest; 0 within it.
    """

    roof: Flags
    side: Flags
    ground: Flags
    points_v_m: Array
    height_m: Array
    from_box_m: Array

    @property
    def any(self) -> Flags:
        """(n,) whether anything is touched."""
        return np.asarray((self.roof | self.side | self.ground).any(axis=1))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Contact:
    """The beginning of a contact.

    Attributes:
        before: index of the last sample without contact.
        t_ns: the instant, interpolated.
        position_v_m: (3,) of B in V, interpolated.
        surface: what is touched in the first sample; the ground counts before a flank, and that before the roof.
        on_pad: whether every point that touches in the first sample is on the roof and inside the pad.
    """

    before: int
    t_ns: int
    position_v_m: Array
    surface: Surface
    on_pad: bool


def touches(log: TruthLog, box: Box) -> Touches:
    """Return what the drone touches in every sample of `log`."""
    points_v_m = log.position_v_m[:, None, :] + CONTACT_POINTS_FLU_M @ np.swapaxes(log.rotation_vb, 1, 2)
    points_enu_m = log.position_enu_m[:, None, :] + CONTACT_POINTS_FLU_M @ np.swapaxes(log.rotation, 1, 2)
    road_m = np.zeros(len(log.t_ns)) if box.is_afloat else log.vehicle_position_enu_m[:, 2]
    vehicle_m, lowest_m = log.vehicle_position_enu_m[:, :2], np.minimum.accumulate(road_m)
    places = np.column_stack([log.position_enu_m[:, :2], vehicle_m, road_m, lowest_m]).tolist()
    ground_height_m = points_enu_m[..., 2] - np.array([ground_height(*place) for place in places])[:, None]
    across_m = 0.5 * np.array(box.roof_size_m) - np.abs(points_v_m[..., :2])
    over = (across_m > 0.0).all(axis=2)
    roof_height_m = points_v_m[..., 2] - box.roof_height_m
    inside = over & (roof_height_m <= 0.0)
    from_top = (-roof_height_m <= np.maximum(EDGE_M, across_m.min(axis=2))) | (box.roof_height_m <= 0.0)
    return Touches(
        roof=inside & from_top,
        side=inside & ~from_top,
        ground=~over & (ground_height_m <= 0.0),
        points_v_m=points_v_m,
        height_m=np.where(over, roof_height_m, ground_height_m),
        from_box_m=np.sqrt(
            np.square(np.maximum(-across_m, 0.0)).sum(axis=2) + np.square(np.maximum(roof_height_m, 0.0))
        ),
    )


def contact_at(log: TruthLog, touched: Touches, index: int, box: Box) -> Contact:
    """Return the contact that begins between the samples `index` - 1 and `index`."""
    before = index - 1
    points = touched.roof[index] | touched.side[index] | touched.ground[index]
    high_m, low_m = touched.height_m[before][points], touched.height_m[index][points]
    shares = np.clip(high_m / np.maximum(high_m - low_m, 1e-12), 0.0, 1.0)
    share = float(shares.min())
    moved_m = log.position_v_m[index] - log.position_v_m[before]
    where_m = touched.points_v_m[index][points]
    surface = _surface(touched, index)
    in_pad = (np.abs(where_m[:, :2]) <= 0.5 * np.array(box.pad_size_m)).all()
    return Contact(
        before=before,
        t_ns=int(log.t_ns[before]) + round(share * int(log.t_ns[index] - log.t_ns[before])),
        position_v_m=log.position_v_m[before] + share * moved_m,
        surface=surface,
        on_pad=bool(in_pad) and surface is Surface.DECK,
    )


def _surface(touched: Touches, index: int) -> Surface:
    if touched.ground[index].any():
        return Surface.GROUND
    return Surface.SIDE if touched.side[index].any() else Surface.DECK


def contact_starts(t_ns: NDArray[np.int64], touching: Flags, *, from_index: int, apart_s: float) -> list[int]:
    """Return the samples at which contact begins after at least `apart_s` without any, from `from_index` on."""
    starts: list[int] = []
    last_ns: int | None = None
    for index in np.flatnonzero(touching[from_index:]) + from_index:
        if last_ns is None or t_ns[index] - last_ns > apart_s * 1e9:
            starts.append(int(index))
        last_ns = int(t_ns[index])
    return starts
