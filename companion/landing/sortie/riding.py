"""A drone that stands on the vehicle: what carries it off, where its setpoints are, what shows the pad; pure."""

import math

import numpy as np

from companion.autopilots.messages import may_turn
from companion.config.companion import CompanionConfig
from companion.core.data import Measurement, Quantity
from companion.core.reasons import Cause, Reason
from companion.integrity.heights import VEHICLE_M
from companion.landing.decisions.conditions import Condition, cause_of, holds
from companion.landing.decisions.entries import Decision
from companion.landing.sortie.over_vehicle import ON_ROOF_M, stands_on_deck
from companion.landing.state.memory import ControlMemory, Held, VehicleMemory
from companion.landing.state.step_data import StepInputs, System
from companion.planning.guidance import ReferenceState
from companion.situation.phases import Event, Phase
from companion.situation.situation import Drone, Situation, driving_hold_s, vehicle_stands
from companion.vehicle.pad import PadPath
from link.records import replace

_LIFT_M = 0.3  # so far above it a drone on the deck is asked to be, for PX4 takes off towards a setpoint above it


def has_not_left_deck(s: Situation, config: CompanionConfig) -> bool:
    """Return whether the drone stands on the deck still, by its autopilot's word and, where it is known, its place.

    Of an autopilot that says nothing a range finder has to see the deck: else it may as well fly.
    """
    if s.approach is None:
        return s.autopilot.landed is True
    stands = _touches(s, config) if s.autopilot.landed is None else s.autopilot.landed
    return stands and stands_on_deck(s, VEHICLE_M, ON_ROOF_M)


def is_carried_by_deck(phase: Phase, s: Situation, config: CompanionConfig) -> bool:
    """Return whether the drone is on the deck in a phase that begins there."""
    return phase is Phase.ON_DECK or (phase is Phase.LIFT_OFF and has_not_left_deck(s, config))


def model_on_deck(drone: Drone, phase: Phase, s: Situation, config: CompanionConfig) -> ReferenceState:
    """Return the model of a drone that is carried by the deck: below it, or above it to lift off, at its velocity.

    The setpoint has the deck's velocity from the first instant, so that no lift-off begins with a brake.
    """
    velocity = drone.velocity_enu_m_s if s.pad is None else s.pad.velocity_enu_m_s[0]
    up_m = _LIFT_M if phase is Phase.LIFT_OFF else -config.descent.sink.press_depth_m
    return ReferenceState(
        position_enu_m=drone.position_enu_m + np.array([0.0, 0.0, up_m]),
        velocity_enu_m_s=velocity,
        acceleration_enu_m_s2=np.zeros(3),
    )


def _touches(s: Situation, config: CompanionConfig) -> bool:
    seen_m = s.below.range_height_m
    return seen_m is not None and seen_m <= config.touchdown.range_finder.contact_height_max_m


def rides_along(s: Situation, config: CompanionConfig) -> bool:
    """Return whether the drone stands on a vehicle that drives: a take-off would begin at its speed.

    An autopilot whose motors turn on a deck that drives may say that it flies.
    """
    says_it_flies = s.autopilot.armed and s.autopilot.landed is False
    if vehicle_stands(s, config.chase) or (says_it_flies and not _seems_to_stand(s, config)):
        return False
    return stands_on_deck(s, VEHICLE_M, ON_ROOF_M)


def _seems_to_stand(s: Situation, config: CompanionConfig) -> bool:
    """Return whether the drone moves with the deck as near to it as a contact is believed."""
    if s.approach is None or not _moves_along(s):
        return False
    sees_gap = s.below.range_height_m is not None and not _touches(s, config)
    return s.approach.height_m <= config.touchdown.height_max_m and not sees_gap


def _moves_along(s: Situation) -> bool:
    """Return whether the drone moves with the vehicle rather than stand still above the ground."""
    a, drone = s.approach, s.drone
    return a is not None and drone is not None and a.speed_m_s < math.hypot(*drone.velocity_enu_m_s[:2].tolist())


def tell_riding(s: Situation, _: CompanionConfig) -> Cause:
    """Return what is said of that."""
    return Cause(Reason.RIDES_ALONG, () if s.pad is None else (s.pad.ground_speed_m_s,))


def _is_carried_off(s: Situation, config: CompanionConfig) -> bool:
    """Return whether the vehicle drives off under a drone that stands still, and moves with it, not with the ground.

    A vehicle may be beside the drone whose place or speed is known only vaguely. An autopilot whose motors speed up may
    say that it has left the ground while its range finder still sees the deck at its feet.
    """
    if not _moves_along(s):
        return False
    stands = not s.autopilot.armed or s.autopilot.landed is True or _touches(s, config)
    return stands and not vehicle_stands(s, config.chase) and stands_on_deck(s, VEHICLE_M, ON_ROOF_M)


CARRIED_OFF = Condition(
    reason=Reason.RIDES_ALONG,
    phases=frozenset({Phase.TAKEOFF}),
    is_true=_is_carried_off,
    hold_s=driving_hold_s,
    cause=tell_riding,
)
"""The vehicle drives off before the drone has lifted off."""


def call_off(held: Held, control: ControlMemory, s: Situation, config: CompanionConfig) -> Decision | None:
    """Return the end of a take-off from a vehicle that has driven off, with the motors off.

    Motors that were just asked for may turn although nothing has told so yet.
    """
    if not holds(CARRIED_OFF, held, s, config):
        return None
    turns = may_turn(s.autopilot, control.driver, s.monotonic_ns)
    return Event.CARRIED_OFF if turns else Event.CALLED_OFF, cause_of(CARRIED_OFF, s, config)


def place_by_deck(vehicle: VehicleMemory, pad: PadPath | None, inputs: StepInputs, system: System) -> VehicleMemory:
    """Return what is known of the vehicle once a drone is about to lift off its pad: how far apart the frames are.

    Where they are one, what is missing to the pad's middle is how the drone was put there.
    """
    own, config = inputs.own, system.config
    if own is None or pad is None or pad.has_one_frame or vehicle.estimator is None:
        return vehicle
    feet_enu_m = own.position_enu_m - np.array([0.0, 0.0, config.touchdown.gear_height_m])
    stands = Measurement(
        t_ns=own.t_ns,
        quantity=Quantity.PAD,
        value=feet_enu_m,
        covariance=config.sortie.launch.placed_std_m**2 * np.eye(3),
    )
    estimator = system.estimator.fuse(vehicle.estimator, [stands])
    counted = system.estimator.health(estimator).counts(Quantity.PAD)  # it is none of a detector's
    sightings = replace(vehicle.sightings, counted=counted, is_confirmed=True)
    return replace(vehicle, estimator=estimator, sightings=sightings)
