"""The robustness margin of a run, from ground truth: how far it stayed from being unsafe, and how far beyond it went.

It is the least of the terms below. Each is a distance to a limit of the score, divided by the scale named with it: 1 at
most, which is far inside, 0 at the limit and negative beyond. The margin is negative exactly when the tier is unsafe.

Before the first contact, from when the drone is first clear of the ground (1 m) on, in the sense of signal temporal
logic (Fainekos and Pappas 2009), "never touches anything beside the pad, and whenever it touches, S1 holds":

- the least distance of feet and blades to the ground, the flanks and the roof outside the pad (0.5 m, S1's own)
- the least, over time, of max(distance to anything that can be touched (0.5 m), what is left to the limits of S1)

so that a wave-off which came low while it swung is less than one from high above, and a landing which was out of the
limits just above the pad is less than one which never was. At the first contact:

- what is left to each limit of S1, as shares of the limit: horizontal error, relative speed, sink rate, tilt over trim

Over the flight:

- at the beginning of every contact, how far inside the pad the touching points are (0.5 m); the same at the first
  sample that touches the ground or a flank, where it is how far outside, or how deep below the roof
- tilt in the air: 80 degrees, over the 35 between the airframe's own limit and that; tilt on the deck: 45 degrees
- height with the motors off (0.3 m); the fence (60 m, in which 25 m/s are stopped by 5 m/s^2)

and of a flight without contact, at its end, the abort's: 1 m of clearance (1 m), tilt 50 degrees and rate 2 rad/s over
the last second. A drone that never took off is below the limit by what it lacks of 0.5 m of rise. A run of tier S0
(under the source report's rule alone) has what is left to its 0.7 m. A fault that truth does not show is -1.

The margin is continuous in the truth as long as the order of events stays: it jumps where a contact becomes none, since
another motion is then judged. It is bounded above only; large negative values mean far beside, not likely or severe.
"""

import math

import numpy as np

from scenarios.scoring import flight_faults as limits
from scenarios.scoring.flight_faults import Flight, tilts_rad
from scenarios.scoring.touch import Box, Touches
from scenarios.scoring.touchdown import S1_LIMITS, Landing, ScoreRules, trims_rad
from scenarios.scoring.truth_log import Array, Indices, TruthLog

LEAST = 1e-6
"""How far below zero an unsafe run is at least: what six digits still show."""
REPORTED = -1.0
"""Of a fault that truth does not show."""

_NEAR_M = S1_LIMITS.horizontal_error_m
_FENCE_SCALE_M = 60.0
_TILT_SCALE_RAD = limits.TIPPED_IN_AIR_RAD - math.radians(45.0)

Terms = dict[str, float]


def margin_terms(log: TruthLog, touched: Touches, flight: Flight, landing: Landing | None, rules: ScoreRules) -> Terms:
    """Return what a run's margin is the least of, by name; what does not apply is left out.

    Args:
        log: the run's truth.
        touched: what it touched.
        flight: its take-off and contacts.
        landing: the first contact, None without one.
        rules: of the score.
    """
    if flight.takeoff is None:
        risen_m = float(touched.height_m.min(axis=1).max())
        return {"never took off": (risen_m - limits.TAKEN_OFF_M) / limits.TAKEN_OFF_M}
    terms = _before_contact(log, touched, flight, flight.takeoff, rules) | _over_flight(
        log, touched, flight.takeoff, rules
    )
    terms |= _touch_terms(touched, flight, flight.takeoff, rules.box)
    if landing is None:
        return terms | _at_end(log, touched)
    return terms | {name: float(_left_share(getattr(landing.touchdown, name), name)) for name in S1_LIMITS.__slots__}


def margin_of(terms: Terms, *, unsafe: bool, reported: bool = False) -> float:
    """Return the margin: the least of `terms`; the tier decides the sign at the limit itself.

    Args:
        terms: as `margin_terms` has them.
        unsafe: whether the tier is.
        reported: whether a fault was reported that truth does not show.
    """
    least = min(1.0, *terms.values(), *([REPORTED] if reported else []))
    return min(least, -LEAST) if unsafe else max(least, 0.0)


def _before_contact(log: TruthLog, touched: Touches, flight: Flight, takeoff: int, rules: ScoreRules) -> Terms:
    clear = np.flatnonzero(touched.height_m[takeoff:].min(axis=1) > limits.CLEAR_M)
    if not len(clear):
        return {}
    first = takeoff + int(clear[0])
    last = len(log.t_ns) if flight.first is None else flight.first.before + 1
    if first >= last:
        return {}
    span = slice(first, last)
    touch_m = np.minimum(touched.height_m[span], touched.from_box_m[span]).min(axis=1)
    terms = {"distance to what is no pad": float(_distance_to_no_pad_m(touched, span, rules.box).min()) / _NEAR_M}
    near = np.flatnonzero(touch_m < _NEAR_M)
    if len(near):
        within = np.min(list(_s1_left(log, first + near, rules).values()), axis=0)
        terms["S1 while near"] = float(np.maximum(touch_m[near] / _NEAR_M, within).min())
    return terms


def _s1_left(log: TruthLog, samples: Indices, rules: ScoreRules) -> dict[str, Array]:
    """Return, for each of the samples, what would be left to each limit of S1 in a contact."""
    position_m, velocity_m_s = log.position_v_m[samples], log.velocity_v_m_s[samples]
    measures = {
        "horizontal_error_m": np.hypot(position_m[:, 0], position_m[:, 1]),
        "relative_speed_m_s": np.hypot(velocity_m_s[:, 0], velocity_m_s[:, 1]),
        "sink_rate_m_s": -velocity_m_s[:, 2],
        "tilt_over_trim_rad": tilts_rad(log.rotation_vb[samples]) - trims_rad(log, samples, rules),
    }
    return {name: _left_share(values, name) for name, values in measures.items()}


def _left_share(value: Array | float, name: str) -> Array:
    return np.asarray(1.0 - np.asarray(value) / getattr(S1_LIMITS, name))


def _distance_to_no_pad_m(touched: Touches, span: slice, box: Box) -> Array:
    """Return the distance (n,) of the nearest point of the drone to the ground, a flank or the roof outside the pad.

    Of a point over the roof the distance to the roof beside the pad; the road below that edge is farther.
    """
    points_v_m, height_m = touched.points_v_m[span], touched.height_m[span]
    over = (np.abs(points_v_m[..., :2]) < 0.5 * np.array(box.roof_size_m)).all(axis=2)
    over_pad_m = np.hypot(np.maximum(_room_m(points_v_m, box), 0.0), np.maximum(height_m, 0.0))
    beside_m = np.minimum(height_m, touched.from_box_m[span])
    return np.asarray(np.where(over, over_pad_m, beside_m).min(axis=1))


def _room_m(points_v_m: Array, box: Box) -> Array:
    """Return how far inside the pad's edges points (..., 3) in V are, seen from above; negative outside."""
    return np.asarray((0.5 * np.array(box.pad_size_m) - np.abs(points_v_m[..., :2])).min(axis=-1))


def _touch_terms(touched: Touches, flight: Flight, takeoff: int, box: Box) -> Terms:
    """Return how far inside the pad the points are that begin a contact, and those first on the ground or a flank."""
    starts = [contact.before + 1 for contact in flight.contacts]
    for flags in (touched.ground, touched.side):
        starts += (np.flatnonzero(flags[takeoff:].any(axis=1))[:1] + takeoff).tolist()
    if not starts:
        return {}
    return {"inside the pad": min(_touching_room_m(touched, index, box) for index in starts) / _NEAR_M}


def _touching_room_m(touched: Touches, index: int, box: Box) -> float:
    roof, side, ground = touched.roof[index], touched.side[index], touched.ground[index]
    points_v_m = touched.points_v_m[index]
    room_m = np.where(side, np.minimum(_room_m(points_v_m, box), touched.height_m[index]), _room_m(points_v_m, box))
    return float(room_m[roof | side | ground].min())


def _over_flight(log: TruthLog, touched: Touches, takeoff: int, rules: ScoreRules) -> Terms:
    tilt_rad, on_deck = tilts_rad(log.rotation[takeoff:]), touched.any[takeoff:]
    terms = {"tilt in the air": (limits.TIPPED_IN_AIR_RAD - float(tilt_rad.max())) / _TILT_SCALE_RAD}
    if on_deck.any():
        leaning_rad = float(tilts_rad(log.rotation_vb[takeoff:])[on_deck].max())
        terms["tilt on the deck"] = 1.0 - leaning_rad / limits.TIPPED_ON_DECK_RAD
    if log.rotor_speed_rad_s is not None:
        off = (log.rotor_speed_rad_s[takeoff:] < limits.MOTORS_OFF_RAD_S).all(axis=1)
        if off.any():
            highest_m = float(touched.height_m[takeoff:][off].min(axis=1).max())
            terms["height with motors off"] = 1.0 - highest_m / limits.IN_AIR_M
    if math.isfinite(rules.fence_radius_m):
        terms["fence"] = (rules.fence_radius_m - float(rules.outward_m(log)[takeoff:].max())) / _FENCE_SCALE_M
    return terms


def _at_end(log: TruthLog, touched: Touches) -> Terms:
    clear_m = float(np.minimum(touched.height_m[-1], touched.from_box_m[-1]).min())
    last = log.t_ns >= log.t_ns[-1] - round(limits.STABLE_S * 1e9)
    return {
        "clear at the end": (clear_m - limits.CLEAR_M) / limits.CLEAR_M,
        "tilt at the end": 1.0 - float(tilts_rad(log.rotation[last]).max()) / limits.STABLE_TILT_RAD,
        "rate at the end": 1.0 - float(log.rate_rad_s[last].max()) / limits.STABLE_RATE_RAD_S,
    }
