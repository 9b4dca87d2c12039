"""Speed profiles as chains of legs of constant acceleration, evaluated in closed form at any time.

State along the road: arc length s (m), speed (m/s), acceleration (m/s²), at a time in seconds after departure.
Source of the waypoint legs: constant acceleration between waypoints, v² - u² = 2 a d.
"""

from bisect import bisect_right
from collections.abc import Sequence

from msgspec import Struct

from link.errors import UserError


class Leg(Struct, frozen=True, kw_only=True):
    """A time of constant acceleration that starts at `t_s` at `s_m` with `speed_m_s`."""

    t_s: float
    s_m: float
    speed_m_s: float
    acceleration_m_s2: float


class Motion(Struct, frozen=True, kw_only=True):
    """Where along the road, how fast and with which acceleration."""

    s_m: float
    speed_m_s: float
    acceleration_m_s2: float


class Profile(Struct, frozen=True, kw_only=True):
    """Legs in order of time; the last one lasts for ever, and before the first the vehicle stands."""

    legs: tuple[Leg, ...]
    starts_s: tuple[float, ...]

    def at(self, t_s: float) -> Motion:
        """Return the motion `t_s` seconds after departure."""
        if t_s < 0.0:
            return Motion(s_m=self.legs[0].s_m, speed_m_s=0.0, acceleration_m_s2=0.0)
        leg = self.legs[bisect_right(self.starts_s, t_s) - 1]
        s_m, speed_m_s = _after(leg, t_s - leg.t_s)
        return Motion(s_m=s_m, speed_m_s=speed_m_s, acceleration_m_s2=leg.acceleration_m_s2)


def _after(leg: Leg, duration_s: float) -> tuple[float, float]:
    """Return arc length and speed `duration_s` into `leg`."""
    return (
        leg.s_m + (leg.speed_m_s + 0.5 * leg.acceleration_m_s2 * duration_s) * duration_s,
        leg.speed_m_s + leg.acceleration_m_s2 * duration_s,
    )


def profile_of(steps: Sequence[tuple[float, float]], *, speed_m_s: float = 0.0) -> Profile:
    """Return the profile that starts at s = 0 and goes through `steps`, then keeps its speed.

    Args:
        steps: (duration in s, acceleration in m/s²) of each leg; those without duration are left out.
        speed_m_s: at the start.

    Raises:
        ValueError: a negative duration or a step that would drive backwards.
    """
    legs: list[Leg] = []
    t_s, s_m = 0.0, 0.0
    for duration_s, acceleration_m_s2 in steps:
        if duration_s < 0.0:
            raise ValueError(f"a leg cannot last {duration_s} s")
        if duration_s == 0.0:
            continue
        legs.append(Leg(t_s=t_s, s_m=s_m, speed_m_s=speed_m_s, acceleration_m_s2=acceleration_m_s2))
        s_m, speed_m_s = _after(legs[-1], duration_s)
        t_s += duration_s
        speed_m_s = _forward(speed_m_s)
    legs.append(Leg(t_s=t_s, s_m=s_m, speed_m_s=speed_m_s, acceleration_m_s2=0.0))
    return Profile(legs=tuple(legs), starts_s=tuple(leg.t_s for leg in legs))


def _forward(speed_m_s: float) -> float:
    """Return the speed with rounding below zero removed."""
    if speed_m_s < -1e-9:
        raise ValueError(f"the vehicle does not drive backwards, at {speed_m_s} m/s")
    return 0.0 if speed_m_s < 1e-9 else speed_m_s


def waypoint_steps(distances_m: Sequence[float], speeds_m_s: Sequence[float]) -> list[tuple[float, float]]:
    """Return the steps that pass waypoints at given speeds with constant acceleration in between.

    Args:
        distances_m: (n - 1) between neighbouring waypoints.
        speeds_m_s: (n) at the waypoints.

    Raises:
        ValueError: the lengths do not match, or two neighbouring speeds are both zero.
    """
    if len(speeds_m_s) != len(distances_m) + 1:
        raise ValueError(f"{len(distances_m)} distances need {len(distances_m) + 1} speeds, not {len(speeds_m_s)}")
    steps: list[tuple[float, float]] = []
    for distance_m, before_m_s, after_m_s in zip(distances_m, speeds_m_s, speeds_m_s[1:], strict=False):
        if before_m_s + after_m_s <= 0.0:
            raise ValueError("a vehicle that stands at two neighbouring waypoints never arrives")
        duration_s = 2.0 * distance_m / (before_m_s + after_m_s)
        steps.append((duration_s, (after_m_s - before_m_s) / duration_s))
    return steps


def cruise_steps(
    *, speed_m_s: float, distance_m: float, acceleration_m_s2: float, braking_m_s2: float
) -> list[tuple[float, float]]:
    """Return the steps that speed up to `speed_m_s`, keep it, and stand `distance_m` after the start.

    Raises:
        UserError: the distance is too short to reach the speed and stop again.
    """
    speed_up_s, brake_s = speed_m_s / acceleration_m_s2, speed_m_s / braking_m_s2
    cruise_m = distance_m - 0.5 * speed_m_s * (speed_up_s + brake_s)
    if cruise_m < 0.0:
        raise UserError(
            f"the road of {distance_m:g} m is too short to reach {speed_m_s:g} m/s and to stop again:"
            " raise track.road_min_m, or lower track.speed_m_s"
        )
    return [(speed_up_s, acceleration_m_s2), (cruise_m / speed_m_s, 0.0), (brake_s, -braking_m_s2)]
