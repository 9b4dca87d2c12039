"""Whether the drone stands on the pad, decided by signs that come from different sources; pure.

Three things must agree: the place (the estimates of drone and vehicle say that the feet are at the pad's height, over
the pad), the standstill (against the pad the drone neither moves up or down nor falls, although its setpoint presses
down), and the support (the setpoint has sunk below the drone, or the autopilot says that it has landed). Each fails
for another fault: a wrong height of the vehicle or a stuck place is contradicted by a drone that still follows its
setpoint, a stuck autopilot's word by the height. A drone's own height that is wrong shifts place and support in
opposite directions. A range finder is believed when it agrees; when it sees the pad far below, all else has to agree
for so long that a drone pressed downwards in the air would have fallen. Where it sees what can only be the road beside
the vehicle, the drone is at an edge of it, or in the air.
"""

import math
from enum import Enum

from companion.config.companion import CompanionConfig
from companion.config.touchdown import TouchdownConfig
from companion.landing.decisions.contact_signs import Signs
from companion.vehicle.pad_reach import over_pad_radius_m
from link.records import replace


class Verdict(Enum):
    """What the signs amount to."""

    AIRBORNE = "airborne"
    DISPUTED = "disputed"  # a contact but for the range finder
    AT_EDGE = "at edge"  # a contact but for the range finder, which sees the road beside the vehicle
    CONTACT = "contact"


def verdict(signs: Signs, config: CompanionConfig, *, is_pressed: bool = False) -> Verdict:
    """Return what the signs amount to; what is unknown or no number speaks for the air.

    Args:
        signs: now.
        config: all numbers.
        is_pressed: the drone has been pressed down for so long that in the air it would sink at 2 m/s by now.
    """
    stands = _stands(signs, config.touchdown) or (is_pressed and _stands_pressed(signs, config.touchdown))
    if not (_is_at_pad(signs, config) and stands and _is_supported(signs, config.touchdown)):
        return Verdict.AIRBORNE
    seen_m = signs.range_height_m
    if seen_m is None or seen_m <= config.touchdown.range_finder.contact_height_max_m:
        return Verdict.CONTACT
    return Verdict.AT_EDGE if _is_road(seen_m, signs, config.touchdown) else Verdict.DISPUTED


def trial_press_m_s2(signs: Signs, late_s: float, config: TouchdownConfig) -> float:
    """Return how hard a drone may be pressed down, m/s^2, while the signs of a contact agree for too short a time.

    They may be wrong: an autopilot that has heard nothing for a moment hovers above its setpoint as if on a pad. Then
    the drone falls, no faster than the gear takes: either it touches so where its range finder sees the pad, or it has
    no time to become faster. Without a range finder only the signs themselves tell that it touches.

    Args:
        signs: now.
        late_s: until a press has come to the drone, and what it does has been reported.
        config: of the touchdown.
    """
    seen_m = signs.range_height_m
    if seen_m is None or seen_m <= 0.0:
        return config.try_acceleration_m_s2
    now_m_s = 0.0 if signs.climb_m_s is None else max(-signs.climb_m_s, 0.0)
    by_place_m_s2 = max(config.sink_max_m_s**2 - now_m_s**2, 0.0) / (2.0 * seen_m)
    by_time_m_s2 = max(config.sink_max_m_s - now_m_s, 0.0) / (config.range_finder.disputed_hold_s + late_s)
    return min(config.try_acceleration_m_s2, max(by_place_m_s2, by_time_m_s2))


def trial_s(signs: Signs, press_m_s2: float, late_s: float, config: TouchdownConfig) -> float:
    """Return for how long the signs of a contact have to agree under a press to be believed.

    For so long that in the air the drone would be reported to sink by now: what is pressed for a shorter time than the
    link and the reports are late has not been tried. That is spared where the range finder sees the pad so near that
    even the press of a contact that is believed cannot make the drone faster than its gear takes.
    """
    seen_m = math.inf if signs.range_height_m is None else max(signs.range_height_m, 0.0)
    has_room = 2.0 * config.press_acceleration_m_s2 * seen_m > config.sink_max_m_s**2
    pressed_s = config.pressed_speed_m_s / max(press_m_s2, 1e-3)
    return min(pressed_s + (late_s if has_room else 0.0), config.range_finder.disputed_hold_s)


def is_stopped_by_pad(signs: Signs, config: CompanionConfig) -> bool:
    """Return whether a jolt came from the pad: it is where the drone is, and a range finder or all signs agree.

    One that sees nothing any more is asked what it saw last: no flying explains the jolt, and it was sinking onto that.
    Where there is none the estimated height is asked: an estimator needs 0.1 s to see that the sinking has ended, too.
    """
    # By the report that shows the stop a pad that drives on is up to half a metre farther than it was at the contact.
    if signs.distance_m is not None and signs.passed_m is not None:
        signs = replace(signs, distance_m=min(signs.distance_m, signs.passed_m))
    seen_m = signs.range_carried_m if signs.range_height_m is None else signs.range_height_m
    feet_m = signs.height_m if seen_m is None else seen_m
    touches = feet_m is not None and feet_m <= config.touchdown.range_finder.contact_height_max_m
    return _is_at_pad(signs, config) and (touches or verdict(signs, config) is Verdict.CONTACT)


def does_not_fall(signs: Signs, config: CompanionConfig) -> bool:
    """Return whether a drone that is pressed down is held up, by whatever has stopped it."""
    return signs.acceleration_up_m_s2 is not None and _is_no_fall(signs.acceleration_up_m_s2, config.touchdown)


def may_force_motors_off(
    signs: Signs, since_contact_s: float, config: CompanionConfig, *, stopped_and_held: bool = False
) -> bool:
    """Return whether the evidence is complete: the motors may be stopped though the autopilot refuses.

    Args:
        signs: now, all of them again but the place, which was the pad's when the contact was believed: a drone whose
            motors still carry it slides, and one that stands beside the pad is to slide no farther.
        since_contact_s: for how long a contact has been believed.
        config: all numbers.
        stopped_and_held: the contact was a jolt from the pad, and the drone was pressed down for long enough since
            without falling. The pad may be gone then, and the stop itself makes estimated speeds wrong for seconds.
    """
    if signs.height_m is None or not signs.height_m < config.descent.commit_height_m:
        return False
    if stopped_and_held:
        return True
    # Without accelerations in its setpoints an autopilot is not pressed down so hard that it would fall.
    is_pressed = since_contact_s >= config.touchdown.stopped_hold_s and not config.setpoints.position_only
    match verdict(replace(signs, distance_m=0.0), config, is_pressed=is_pressed):
        case Verdict.CONTACT:
            return True
        case Verdict.DISPUTED:
            return since_contact_s >= config.touchdown.range_finder.disputed_hold_s
        case Verdict.AIRBORNE | Verdict.AT_EDGE:
            return False


def is_over_road(signs: Signs, config: CompanionConfig) -> bool:
    """Return whether a drone that is about to touch what is said to be the pad has the road below it.

    A lever arm of the wrong sign, a wrong heading or clock lead beside the vehicle so: nothing there stops the drone.
    """
    seen_m, height_m, distance_m = signs.range_height_m, signs.height_m, signs.distance_m
    if seen_m is None or height_m is None or distance_m is None or height_m >= config.descent.commit_height_m:
        return False
    is_over = distance_m < over_pad_radius_m(signs.pad_half_width_m, config)
    return is_over and _is_road(seen_m - height_m, signs, config.touchdown)


def _is_road(seen_m: float, signs: Signs, config: TouchdownConfig) -> bool:
    """Return whether a range finder sees the road beside the vehicle; a low roof might be mistaken for it."""
    road_m, off_m = signs.road_below_m, config.range_finder.off_max_m
    return road_m is not None and road_m > 2.0 * off_m and abs(seen_m - road_m) < off_m


def _is_at_pad(signs: Signs, config: CompanionConfig) -> bool:
    if signs.height_m is None or signs.distance_m is None:
        return False
    lowest_m = -config.descent.sink.press_depth_m - config.touchdown.height_max_m
    is_low = lowest_m <= signs.height_m <= config.touchdown.height_max_m
    return is_low and signs.distance_m < over_pad_radius_m(signs.pad_half_width_m, config)


def _stands(signs: Signs, config: TouchdownConfig) -> bool:
    if signs.climb_m_s is None or not abs(signs.climb_m_s) < config.blocked_speed_m_s:
        return False
    return signs.acceleration_up_m_s2 is None or _is_no_fall(signs.acceleration_up_m_s2, config)


def _stands_pressed(signs: Signs, config: TouchdownConfig) -> bool:
    """Return whether a drone that is pressed down stands, although speeds are not known well enough to show it.

    Over poor data the difference of two climb rates is off by 0.2 m/s. The range finder has to see the pad for it.
    """
    seen_m, climb_m_s = signs.range_height_m, signs.climb_m_s
    if seen_m is None or climb_m_s is None or not seen_m <= config.range_finder.contact_height_max_m:
        return False
    falls = signs.acceleration_up_m_s2 is not None and not _is_no_fall(signs.acceleration_up_m_s2, config)
    return abs(climb_m_s) < config.pressed_speed_m_s and not falls


def _is_no_fall(acceleration_up_m_s2: float, config: TouchdownConfig) -> bool:
    return acceleration_up_m_s2 > -config.falling_acceleration_m_s2


def _is_supported(signs: Signs, config: TouchdownConfig) -> bool:
    """Return whether something holds the drone up above its setpoint.

    One that sinks as fast as it may does not follow a setpoint that sinks faster: over a deck that falls as fast it
    seems to stand. Only the range finder tells then whether it does.
    """
    sunk = signs.setpoint_below_m is not None and signs.setpoint_below_m > config.blocked_depth_m
    seen_m = signs.range_height_m
    touches = seen_m is not None and seen_m <= config.range_finder.contact_height_max_m
    return (sunk and (touches or signs.sink_left_m_s > config.blocked_speed_m_s)) or signs.landed is True
