"""Whether the drone stands on the vehicle and is carried off by it, so that no take-off may go on there; pure."""

import math

from companion.autopilots.messages import is_arming
from companion.config.companion import CompanionConfig
from companion.core.reasons import Cause, Reason
from companion.integrity.heights import VEHICLE_M
from companion.landing.decisions.conditions import Condition, cause_of, holds
from companion.landing.decisions.entries import Decision
from companion.landing.sortie.over_vehicle import ON_ROOF_M, stands_on_deck
from companion.landing.state.memory import ControlMemory, Held
from companion.situation.phases import Event, Phase
from companion.situation.situation import Situation, vehicle_stands


def has_not_left_deck(s: Situation, config: CompanionConfig) -> bool:
    """Return whether the drone stands on the deck still, by its autopilot's word and, where it is known, its place.

    Of an autopilot that says nothing a range finder has to see the deck: else it may as well fly.
    """
    if s.approach is None:
        return s.autopilot.landed is True
    stands = _touches(s, config) if s.autopilot.landed is None else s.autopilot.landed
    return stands and stands_on_deck(s, VEHICLE_M, ON_ROOF_M)


def _touches(s: Situation, config: CompanionConfig) -> bool:
    seen_m = s.below.range_height_m
    return seen_m is not None and seen_m <= config.touchdown.range_finder.contact_height_max_m


def rides_along(s: Situation, config: CompanionConfig) -> bool:
    """Return whether the drone stands on a vehicle that drives: a take-off would begin at its speed."""
    is_airborne = s.autopilot.armed and s.autopilot.landed is False
    if is_airborne or vehicle_stands(s, config.chase):
        return False
    return stands_on_deck(s, VEHICLE_M, ON_ROOF_M)


def tell_riding(s: Situation, _: CompanionConfig) -> Cause:
    """Return what is said of that."""
    return Cause(Reason.RIDES_ALONG, () if s.pad is None else (s.pad.ground_speed_m_s,))


def _is_carried_off(s: Situation, config: CompanionConfig) -> bool:
    """Return whether the vehicle drives off under a drone that stands still, and moves with it, not with the ground.

    A vehicle may be beside the drone whose place or speed is known only vaguely. An autopilot whose motors speed up may
    say that it has left the ground while its range finder still sees the deck at its feet.
    """
    a, drone = s.approach, s.drone
    if a is None or drone is None or a.speed_m_s >= math.hypot(*drone.velocity_enu_m_s[:2].tolist()):
        return False
    stands = not s.autopilot.armed or s.autopilot.landed is True or _touches(s, config)
    return stands and not vehicle_stands(s, config.chase) and stands_on_deck(s, VEHICLE_M, ON_ROOF_M)


CARRIED_OFF = Condition(
    reason=Reason.RIDES_ALONG,
    phases=frozenset({Phase.TAKEOFF}),
    is_true=_is_carried_off,
    hold_s=lambda _, c: c.chase.driving_hold_s,
    cause=tell_riding,
)
"""The vehicle drives off before the drone has lifted off."""


def call_off(held: Held, control: ControlMemory, s: Situation, config: CompanionConfig) -> Decision | None:
    """Return the end of a take-off from a vehicle that has driven off, with the motors off.

    Motors that were just asked for may turn although nothing has told so yet.
    """
    if not holds(CARRIED_OFF, held, s, config):
        return None
    may_turn = s.autopilot.armed or is_arming(control.driver, s.monotonic_ns)
    return Event.CARRIED_OFF if may_turn else Event.CALLED_OFF, cause_of(CARRIED_OFF, s, config)
