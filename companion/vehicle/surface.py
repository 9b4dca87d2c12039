"""What the drone's range finder says of the surface below it, as a measurement of the place that it sees; pure.

Over the pad that is the deck, beside it the vehicle's roof or the road: which of them, only who knows the pad can tell
(`pad_height_seen`). It is the one sensor that sees a deck rise or sink at once: the vehicle's own data come later, and
ten times a second.
"""

import math

import numpy as np

from companion.config.touchdown import TouchdownConfig
from companion.core.data import Array, Measurement, Quantity, RangeReading
from companion.vehicle.range_watch import RangeWatch, beam_of, lowest_over_m
from link.messages import PadGeometry
from link.records import replace

_AGE_MAX_NS = 500_000_000  # what is older says nothing new
_TOO_HIGH_M = 1.0  # what is so far above the pad is not the pad: a person, a load, a bridge
_TOO_LOW_M = 2.0  # two standard deviations of how far apart heights are before anything told them
_STDS = 2.0
_STEP_MIN_M = 0.6  # an own height wanders by as much in the time that is looked back: that is no step to a roof
_ROOF_TOO_HIGH_M = 4.0  # and so far above, what rises from the road by as much as the pad does is not it either


def surface_measurements(
    seen: RangeReading, rises_m: float, t_ns: int, config: TouchdownConfig, frames_apart_std_m: float
) -> tuple[Measurement, ...]:
    """Return the place that a range finder sees, nothing where the drone's own place or attitude was not known.

    A stamp from the future would make all that the vehicle tells too late for the filter.

    Args:
        seen: the reading.
        rises_m: how far the surface is above the lowest that was seen lately.
        t_ns: now.
        config: where the range finder is, and how good.
        frames_apart_std_m: standard deviation of how far W may be from the frame of the vehicle's fixes, horizontally.
    """
    own = seen.own
    is_now = 0 <= t_ns - seen.t_ns <= _AGE_MAX_NS
    beam = None if own is None else beam_of(own)
    if own is None or beam is None or not is_now:
        return ()
    place = np.array(own.position_enu_m) + seen.distance_m * np.array(beam)
    place[2] += config.range_finder.height_m - config.gear_height_m
    apart_m2, range_m2 = frames_apart_std_m**2, config.range_finder.std_m**2
    return (
        Measurement(
            t_ns=seen.t_ns,
            quantity=Quantity.SURFACE,
            value=np.append(place, rises_m),
            covariance=np.diag([apart_m2, apart_m2, range_m2, 2.0 * range_m2]),
        ),
    )


def pad_height_seen(
    surface: Measurement,
    pad_enu_m: Array,
    *,
    pad_std_m: float,
    slope_enu: tuple[float, float],
    half_width_m: float,
    above_road_m: float,
) -> Measurement | None:
    """Return the height (1,) in W, m, that a surface gives the pad's centre; None if it may be of something else.

    Args:
        surface: the place that was seen, and how far it rises above what was seen lately.
        pad_enu_m: (3,) the pad's centre, as it is known.
        pad_std_m: standard deviation of its horizontal place.
        slope_enu: by which the deck rises towards east and north, m per m.
        half_width_m: from the pad's centre to the nearest edge.
        above_road_m: the pad's height above the road or the water: what is nearer to these is not the pad, unless it
            rises by more than half of that, and 0.6 m. What rises by just as much is the pad, however high it is.
    """
    east_m, north_m, up_m = (surface.value[:3] - pad_enu_m).tolist()
    half_m, rises_m = 0.5 * above_road_m, float(surface.value[3])
    may_be_road = half_m > 0.0 and rises_m < max(half_m, _STEP_MIN_M)
    lowest_m = -min(half_m, _TOO_LOW_M) if may_be_road else -_TOO_LOW_M
    is_roof = not may_be_road and half_m > 0.0 and abs(rises_m - above_road_m) < _STEP_MIN_M
    is_beside = math.hypot(east_m, north_m) + _STDS * pad_std_m > half_width_m
    if is_beside or not lowest_m < up_m < (_ROOF_TOO_HIGH_M if is_roof else _TOO_HIGH_M):
        return None
    height_m = float(surface.value[2]) - slope_enu[0] * east_m - slope_enu[1] * north_m
    return replace(surface, value=np.array([height_m]), covariance=surface.covariance[2:3, 2:3])


def higher_by_road_m(watch: RangeWatch, t_ns: int, pad: PadGeometry | None, config: TouchdownConfig) -> float:
    """Return by how much the pad is higher than it is said to be, by the road that was seen lately; 0 for a lower one.

    The road is the lowest that was seen, so that neither a roof nor what stands beside the road counts for it.

    Args:
        watch: of the range finder.
        t_ns: now.
        pad: on the vehicle, None until that has described it.
        config: where the range finder is.
    """
    over_m = lowest_over_m(watch, t_ns)
    if pad is None or pad.is_afloat or over_m is None:
        return 0.0
    road_m = over_m + config.range_finder.height_m - config.gear_height_m
    return max(road_m + pad.height_m - pad.antenna_to_pad_m[2], 0.0)
