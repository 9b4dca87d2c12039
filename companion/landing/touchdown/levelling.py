"""Levels a drone that leans into a curve or against a gust before it touches the pad; pure.

In a curve the drone leans as the deck does not: 18 degrees on a circle of 20 m at 8 m/s. So in its last moments it
turns less than the pad does, and takes the speed against it that it gains so. What counts is the lean beside the deck's
upright, beyond that of steady flight: one that leans against a fast vehicle's wind comes upright as it brakes, and
brakes with all that it can; one over a deck that tilts away from it leans less.
"""

import math

import numpy as np
from msgspec import Struct

from companion.config.companion import CompanionConfig
from companion.core.data import GRAVITY_M_S2, Array
from companion.forecast.steering import lean_change
from companion.landing.state.memory import StepMemory
from companion.landing.state.step_data import StepInputs
from companion.landing.steering.flown_plan import FlownPlan
from companion.planning.envelope import LEFT_MIN_SHARE
from companion.planning.guidance import Leaning, PlanRequest
from companion.situation.own_drone import lowest_foot
from companion.situation.phases import Phase
from companion.situation.situation import Approach, Situation
from companion.vehicle.pad import PadPath, slope_at
from companion.vehicle.pad_reach import over_pad_radius_m
from link.records import replace

_SEEN_OFF_MAX_M = 1.0  # what a range finder sees farther off is not the pad: a roof is 1.5 m above the road


class Levelling(Struct, frozen=True, kw_only=True, eq=False):
    """How a drone leans that levels, as horizontal thrust by mass.

    Attributes:
        leans_max_m_s2: beside the deck's upright.
        beside_enu_m_s2: (2,) that it leans beside the deck's upright while its path accelerates by nothing.
        jerk_max_m_s3: how fast that changes.
    """

    leans_max_m_s2: float
    beside_enu_m_s2: Array
    jerk_max_m_s3: float


def levelling_now(
    memory: StepMemory, situation: Situation, inputs: StepInputs, config: CompanionConfig
) -> Levelling | None:
    """Return how the drone levels, None of one that does not: just above the pad it turns less than the deck.

    A drone that leans touches with its lowest foot, so it begins that much higher. It begins earlier by the time that
    it takes to come upright at the largest jerk, by which its lean lags, by which the plan begins later, and by which
    nearly every setpoint is late at most. One that breaks off climbs before it leans.
    """
    pad, relative, limits = situation.pad, situation.approach, inputs.limits
    is_low = memory.progress.phase in (Phase.DESCEND, Phase.ABORT)
    if not is_low or pad is None or relative is None or situation.drone is None:
        return None
    escape_m = 0.0 if memory.progress.phase is Phase.DESCEND else config.descent.commit_height_m
    asked = np.zeros(2) if memory.model.reference is None else memory.model.reference.acceleration_enu_m_s2[:2]
    tracking = memory.model.tracking
    beside = tracking.holds_enu_m_s2 + GRAVITY_M_S2 * slope_at(pad, _to_contact_s(memory, relative, config))
    most_m_s2, below_m = level_end(pad, relative, tracking.air_enu_m_s2, inputs, config)
    takes_s = max(math.hypot(*(asked + beside).tolist()) - most_m_s2, 0.0) / limits.jerk_max_m_s3
    early_m = max(-relative.climb_m_s, 0.0) * (takes_s + inputs.ahead_s(config))
    if lowest_foot_m(situation, relative, config) > below_m + early_m + escape_m:
        return None
    return Levelling(leans_max_m_s2=most_m_s2, beside_enu_m_s2=beside, jerk_max_m_s3=limits.jerk_max_m_s3)


def _to_contact_s(memory: StepMemory, relative: Approach, config: CompanionConfig) -> float:
    """Return when the drone touches; one that breaks off is level with the deck as it is."""
    if memory.progress.phase is Phase.ABORT:
        return 0.0
    return max(relative.height_m, 0.0) / max(-relative.climb_m_s, config.descent.sink.contact_rate_m_s)


def level_end(
    pad: PadPath, relative: Approach, air_enu_m_s2: Array, inputs: StepInputs, config: CompanionConfig
) -> tuple[float, float]:
    """Return how much a drone that levels leans at most, m/s^2, and the lowest foot's height to begin.

    One that turns with the pad leans by the vector sum of that and of what holds against the air: a turn across the air
    takes less lean than one along it. From that much it comes upright as far as the speed allows that this brings.

    Args:
        pad: that it lands on.
        relative: to it.
        air_enu_m_s2: (2,) horizontal thrust by mass that holds against the air.
        inputs: of the step.
        config: the companion's.
    """
    limits, level = inputs.limits, config.touchdown.level
    steady_m_s2 = math.hypot(*air_enu_m_s2.tolist())
    turning_m_s2 = math.hypot(*(pad.acceleration_enu_m_s2[0, :2] + air_enu_m_s2).tolist())
    most_m_s2 = max(steady_m_s2 + level.acceleration_m_s2, turning_m_s2 - _less_m_s2(limits.jerk_max_m_s3, config))
    lag_s = 0.0 if inputs.response is None else inputs.response.cascade.lean_lag_s
    early_m = max(-relative.climb_m_s, 0.0) * (lag_s + level.late_stds * inputs.link_delay.std_s)
    return min(most_m_s2, limits.tilt_acceleration_m_s2), level.height_m + early_m


def levelled(flown: FlownPlan, levelling: Levelling) -> FlownPlan:
    """Return a plan whose drone leans by no more than it may, once its lean has changed to that."""
    path = flown.trajectory
    beside_x, beside_y = levelling.beside_enu_m_s2.tolist()
    position, velocity = path.position_enu_m.copy(), path.velocity_enu_m_s.copy()
    acceleration = path.acceleration_enu_m_s2.copy()
    for node, dt_s in enumerate(np.diff(path.offset_s).tolist(), start=1):
        (before_x, before_y, _), (asked_x, asked_y, _) = acceleration[node - 1 : node + 1].tolist()
        change = lean_change(
            (asked_x, asked_y),
            (before_x, before_y),
            (beside_x, beside_y),
            levelling.leans_max_m_s2,
            levelling.jerk_max_m_s3 * dt_s,
        )
        before = acceleration[node - 1, :2]
        now = before + change
        since_m_s = velocity[node - 1, :2] * dt_s
        position[node, :2] = position[node - 1, :2] + since_m_s + (before / 3.0 + now / 6.0) * dt_s**2
        velocity[node, :2] = velocity[node - 1, :2] + 0.5 * (before + now) * dt_s
        acceleration[node, :2] = now
    return replace(
        flown,
        trajectory=replace(
            path, position_enu_m=position, velocity_enu_m_s=velocity, acceleration_enu_m_s2=acceleration
        ),
    )


def limit_tilt(request: PlanRequest, holds_enu_m_s2: Array) -> PlanRequest:
    """Return the request with what the largest tilt leaves of the acceleration.

    Of the horizontal thrust by mass R some holds against the air and makes up for the deviation, w. Along the unit
    vector d there is left `-(d w) + sqrt(R^2 - w^2 + (d w)^2)`: less to go faster, more to brake. The request's limits
    get what is left in the direction in which it is needed, which is by how much the way to a far target brakes.

    Args:
        request: of the plan; its target tells what is needed, in a second's time.
        holds_enu_m_s2: (2,) what the drone leans beyond what its path accelerates by.
    """
    limits, state, target = request.limits, request.state, request.target
    most_m_s2 = limits.tilt_acceleration_m_s2
    if not math.isfinite(most_m_s2):
        return request
    needed = target.acceleration_enu_m_s2[0] + target.velocity_enu_m_s[0] - state.velocity_enu_m_s
    needed = (needed + target.position_enu_m[0] - state.position_enu_m)[:2]
    left_m_s2 = max(_left_m_s2(needed, holds_enu_m_s2, most_m_s2), LEFT_MIN_SHARE * most_m_s2)
    path_max_m_s2 = limits.acceleration_max_m_s2
    leaning = Leaning(path_max_m_s2=path_max_m_s2, most_m_s2=most_m_s2, holds_enu_m_s2=holds_enu_m_s2)
    limits = replace(limits, acceleration_max_m_s2=min(path_max_m_s2, left_m_s2))
    return replace(request, limits=limits, leaning=leaning)


def _left_m_s2(direction: Array, holds_enu_m_s2: Array, most_m_s2: float) -> float:
    size, (wx, wy) = math.hypot(*direction.tolist()), holds_enu_m_s2.tolist()
    along_m_s2 = float(direction @ holds_enu_m_s2) / size if size > 0.0 else 0.0
    return math.sqrt(max(most_m_s2**2 - wx**2 - wy**2 + along_m_s2**2, 0.0)) - along_m_s2


def lowest_foot_m(situation: Situation, relative: Approach, config: CompanionConfig) -> float:
    """Return how high the lowest foot of a leaning drone is above the pad, by a range finder that has just seen it."""
    seen_m, height_m = situation.below.range_carried_m, relative.height_m
    is_over = relative.distance_m < over_pad_radius_m(relative.pad_half_width_m, config)
    if situation.below.range_height_m is not None and seen_m is not None and is_over:
        height_m = seen_m if abs(seen_m - height_m) < _SEEN_OFF_MAX_M else height_m
    return height_m - lowest_foot(situation.drone, config.touchdown)[0]


def _less_m_s2(jerk_m_s3: float, config: CompanionConfig) -> float:
    """Return by how much less than the pad a drone may turn.

    Turning less by x gains the drone x^2 / 2j against the pad while it changes, and x t in the time t that is left.
    That bounds x.
    """
    level = config.touchdown.level
    left_s = level.height_m / config.descent.sink.contact_rate_m_s
    return math.sqrt((jerk_m_s3 * left_s) ** 2 + 2.0 * jerk_m_s3 * level.speed_max_m_s) - jerk_m_s3 * left_s
