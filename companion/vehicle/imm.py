"""The default estimator: two interacting turning models with the offset between the two receivers' frames.

State, motion and units are in `imm_kernels`, what sensors read in `imm_sensors`, the interaction in `imm_mixing`.
The vehicle's fixes are in the frame of its own receiver and dated by its own clock; sightings of the pad are in the
drone's. The difference of the frames is three states with a slow random walk, that of the clocks is one, so that the
estimate is right for the drone, and stays right when the sightings end. A vehicle that tells nothing is placed by
sightings alone, without either difference. What a receiver states as its error beyond
some decimetres is slow (Gauss-Markov) rather than white, and is let into that walk; the drone's own place then wanders
as well, and from one sighting to the next nothing tells how far.
"""

import math
from dataclasses import dataclass, field
from typing import assert_never

import numpy as np
from msgspec import Struct

from companion.config.estimation import ImmConfig, SwingConfig
from companion.core.data import Array, Forecast, Measurement, Quantity, VehicleEstimate
from companion.vehicle import imm_forecast as forecasts
from companion.vehicle import imm_judgement as judgement
from companion.vehicle import imm_kernels as kernels
from companion.vehicle import imm_mixing as mixing
from companion.vehicle import imm_sensors as sensors
from companion.vehicle.deck_motion import DeckMotion, first_motion, learn, passed
from companion.vehicle.filter_step import Update, wrapped
from companion.vehicle.imm_numbers import Deck, Numbers, noises_with, numbers_of, swing_of
from companion.vehicle.imm_opening import DECK, OFFSET, PLACE, TILT, open_deck, open_place_and_offset, open_states
from companion.vehicle.imm_swing import SIZE
from link.records import replace

KINDS = {
    Quantity.POSITION: sensors.POSITION,
    Quantity.VELOCITY: sensors.VELOCITY,
    Quantity.HEADING: sensors.HEADING,
    Quantity.YAW_RATE: sensors.YAW_RATE,
    Quantity.PAD: sensors.PAD,
    Quantity.ACCELERATION: sensors.ACCELERATION,
    Quantity.TILT: sensors.TILT,
}
SWINGING = np.array([10, 11, *TILT])
CURVATURE, HEADING = 6, 7
TOLD_BY = {  # what is opened to data of a quantity that were rejected for too long
    Quantity.VELOCITY: np.array([2, 3, 4, 5, 9, 11, kernels.BEND]),
    Quantity.HEADING: np.array([HEADING]),
    Quantity.YAW_RATE: np.array([CURVATURE]),
    Quantity.ACCELERATION: np.array([kernels.LEAK]),
    Quantity.TILT: TILT,
}
CLOCK = kernels.CLOCK
TURNS = frozenset({Quantity.HEADING, Quantity.YAW_RATE})
_SETTLED_STD_M_S = 0.3  # of the speed; a receiver's velocity is as good, two fixes in a second are
MOTIONS = frozenset({Quantity.POSITION, Quantity.VELOCITY})
TURN_AGE_MAX_S = 1.0  # of a sensor that is at work: several periods of the slowest


class ImmState(Struct, frozen=True, kw_only=True, eq=False):
    """The filter.

    Attributes:
        modes: both.
        fix_bias_variance_m2: the slow part of the fixes' variance.
        turn_age_s: how long ago a sensor told the heading or the yaw rate.
        unmeasured_s: how long ago place or velocity was told.
        deck: how the deck swings; None until the vehicle has told its tilt.
    """

    modes: mixing.Modes
    fix_bias_variance_m2: float
    turn_age_s: float = math.inf
    unmeasured_s: float = 0.0
    deck: DeckMotion | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ImmModel:
    """The filter as a model for the delay buffer.

    Attributes:
        config: its numbers.
        deck: what the vehicle tells of its pad; it turns about the pad's centre, and sightings are of it.
        placed_by: what it starts on: fixes, or sightings of a vehicle that tells nothing.
        numbers: the same as the kernels take them, derived.
    """

    config: ImmConfig
    deck: Deck = field(default_factory=Deck)
    placed_by: Quantity = Quantity.POSITION
    numbers: Numbers = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Derive the kernels' numbers."""
        object.__setattr__(self, "numbers", numbers_of(self.config, self.deck))

    def start(self, place: Measurement) -> ImmState:
        """Return the state after a first place: anything may be true of the rest.

        A sighting is in the drone's own frame and dated by its clock, so that it leaves nothing between the two.
        """
        is_fix = place.quantity is Quantity.POSITION
        white, bias_variance = self._split(place.covariance) if is_fix else (place.covariance, 0.0)
        offset_variance = self.config.receivers.frame_offset_std_m**2 + bias_variance if is_fix else 0.0
        mean = np.zeros(SIZE)
        mean[PLACE] = place.value
        covariance = np.diag(self.numbers.prior_variances)
        covariance[DECK, DECK] = 0.0
        covariance[np.ix_(PLACE, PLACE)] = white
        covariance[CLOCK, CLOCK] = self.config.receivers.clock_std_s**2 if bias_variance else 0.0
        covariances = open_place_and_offset(np.stack([covariance, covariance]), offset_variance * np.eye(3))
        dwell_s = self.numbers.dwell_s
        modes = (np.stack([mean, mean]), covariances, dwell_s / dwell_s.sum())
        return ImmState(modes=modes, fix_bias_variance_m2=bias_variance)

    def predict(self, state: ImmState, dt_s: float) -> ImmState:
        """Return the state `dt_s` later."""
        numbers = self.numbers
        modes = mixing.predict_modes(
            state.modes, dt_s, self._noises(state), numbers.dwell_s, self._motion(state), self._known_variance
        )
        return replace(
            state,
            modes=modes,
            turn_age_s=state.turn_age_s + dt_s,
            unmeasured_s=state.unmeasured_s + dt_s,
            deck=None if state.deck is None else passed(state.deck, dt_s),
        )

    def update(self, state: ImmState, measurement: Measurement) -> Update[ImmState] | None:
        """Return the state after any quantity, None of an acceleration or a tilt for which it is too early."""
        if measurement.quantity is Quantity.ACCELERATION and not self._is_heading_known(state):
            return None
        if measurement.quantity is Quantity.TILT and state.deck is None:
            if not self._has_settled(state):
                return None
            state = self._with_deck(state, measurement)
        R, bias_variance = measurement.covariance, state.fix_bias_variance_m2
        if measurement.quantity is Quantity.POSITION:
            R, bias_variance = self._split(R)
        reading = (KINDS[measurement.quantity], _own(measurement.value), _own(R))
        numbers = self.numbers
        tells_motion = measurement.quantity in MOTIONS
        modes = state.modes
        if tells_motion and state.unmeasured_s > 0.0:
            noise = self._noises(state)[1]
            modes = judgement.expect_manoeuvre(modes, state.unmeasured_s, numbers.dwell_s, noise)
        modes, nis, gate_nis = judgement.take_reading(modes, reading, numbers.lever_m, numbers.course)
        tells_turn = measurement.quantity in TURNS and self.placed_by is Quantity.POSITION
        turn_age_s = 0.0 if tells_turn else state.turn_age_s  # what is only seen to turn is taken for a car
        deck = state.deck
        if deck is not None and measurement.quantity is Quantity.TILT:
            deck = learn(deck, (modes[2] @ modes[0])[SWINGING].tolist(), self._swing.lag_s)
        updated = ImmState(
            modes=modes,
            fix_bias_variance_m2=bias_variance,
            turn_age_s=turn_age_s,
            unmeasured_s=0.0 if tells_motion else state.unmeasured_s,
            deck=deck,
        )
        return Update(state=updated, nis=nis, gate_nis=gate_nis, dof=len(measurement.value))

    def recover(self, state: ImmState, measurement: Measurement) -> ImmState:
        """Open what `measurement` contradicts.

        A sighting that contradicts everything means that the drone's frame has stepped: place and offset move
        together. A fix that does is the receiver's step if the place is known from sightings, else a new start, as is
        a sighting where nothing else places the vehicle.
        """
        match measurement.quantity:
            case Quantity.PAD:
                is_start = self.placed_by is Quantity.PAD
                return self._restart(state, measurement) if is_start else self._move_frame(state, measurement)
            case Quantity.POSITION:
                if self._is_placed_by_sightings(state):
                    return replace(
                        state,
                        modes=open_states(state.modes, OFFSET, np.full(3, self._step_size(state, measurement) ** 2)),
                    )
                return self._restart(state, measurement)
            case Quantity.VELOCITY | Quantity.HEADING | Quantity.YAW_RATE | Quantity.ACCELERATION | Quantity.TILT:
                told = TOLD_BY[measurement.quantity]
                return replace(state, modes=open_states(state.modes, told, self.numbers.prior_variances[told]))
            case _:
                assert_never(measurement.quantity)

    def describe(self, state: ImmState, t_ns: int) -> VehicleEstimate:
        """Return the mixture of both modes."""
        x, P, position, velocity, acceleration, G, heading_variance = forecasts.describe_modes(
            state.modes, self._motion(state), self._known_variance
        )
        covariance = G @ P @ G.T
        known = heading_variance < self._known_variance
        return VehicleEstimate(
            t_ns=t_ns,
            position_enu_m=position[0],
            velocity_enu_m_s=velocity[0],
            acceleration_enu_m_s2=acceleration[0],
            covariance=0.5 * (covariance + covariance.T),
            yaw_rad=wrapped(float(x[HEADING])) if known else None,
            yaw_rate_rad_s=float(x[CURVATURE] * math.hypot(x[2], x[3])) if known else None,
        )

    def forecast(self, state: ImmState, t_ns: int, offset_s: Array) -> Forecast:
        """Return the future along the present curvature, with an acceleration that fades and stops at standstill."""
        if self.placed_by is Quantity.PAD:
            state = self._as_driven(state, t_ns)
        position, velocity, acceleration, yaw, grade, tilt, std, heading_variance = forecasts.forecast_modes(
            state.modes, _own(offset_s), self._noises(state), self._motion(state), self._known_variance
        )
        means, covariances, weights = state.modes
        return Forecast(
            t_ns=t_ns,
            offset_s=offset_s,
            position_enu_m=position,
            velocity_enu_m_s=velocity,
            acceleration_enu_m_s2=acceleration,
            yaw_rad=yaw if heading_variance < self._known_variance else None,
            position_std_m=std,
            is_coarse=state.fix_bias_variance_m2 > 0.0 or self.placed_by is Quantity.PAD,
            grade=grade,
            tilt_rad=None if state.deck is None else tilt,
            yaw_std_rad=math.sqrt(heading_variance),
            frame_offset_enu_m=(weights @ means)[OFFSET[:2]],
            frame_offset_std_m=math.sqrt(float((weights @ covariances[:, OFFSET, OFFSET]).max())),
        )

    def _split(self, fix_covariance: Array) -> tuple[Array, float]:
        """A fix's covariance as its white part (3, 3) and the variance of the slow rest, m^2."""
        stated = float(fix_covariance.diagonal().max())
        white = min(stated, self.config.receivers.fix_white_std_max_m**2)
        return fix_covariance * (white / stated), stated - white

    @property
    def _known_variance(self) -> float:
        """Of a heading that is known, rad^2; while it is not, the kernels leave the lever arm out."""
        return self.config.heading.known_std_rad**2

    def _is_heading_known(self, state: ImmState) -> bool:
        return bool(mixing.is_heading_known(state.modes, self._known_variance))

    def _noises(self, state: ImmState) -> Array:
        """Both modes' noise, (2, 16), as `imm_kernels.process_noise` takes it."""
        walk_m2_s = 2.0 * state.fix_bias_variance_m2 / self.config.receivers.fix_bias_time_s
        receiver_m2_s = self.config.receivers.frame_offset_walk_m2_s + walk_m2_s
        return noises_with(
            self.numbers,
            receiver_m2_s,
            self.config.receivers.own_walk_share * walk_m2_s,
            turn_is_measured=state.turn_age_s < TURN_AGE_MAX_S,
        )

    @property
    def _swing(self) -> SwingConfig:
        return swing_of(self.config, is_afloat=self.deck.is_afloat)

    def _motion(self, state: ImmState) -> Array:
        """Return the numbers (16,) of the motion, with what has been learnt of the deck's."""
        if state.deck is None:
            return self.numbers.motion
        motion = self.numbers.motion.copy()
        motion[1:4], motion[10:16] = state.deck.oscillators[:3], state.deck.oscillators[3:]
        return motion

    def _has_settled(self, state: ImmState) -> bool:
        """Whether the first fixes are in: what a vehicle of any speed does would be learnt about its tilt, too."""
        _, covariances, _ = state.modes
        speed_variance = float((covariances[:, 2, 2] + covariances[:, 3, 3]).max())
        return self._is_heading_known(state) and speed_variance < _SETTLED_STD_M_S**2

    def _with_deck(self, state: ImmState, tilt: Measurement) -> ImmState:
        """Return the state of a vehicle that begins to tell its tilt; what it states may err for ever, too."""
        variances = np.append(self.numbers.prior_variances[TILT], tilt.covariance.diagonal()[:2])
        modes = open_deck(state.modes, self.numbers.lever_m, variances)
        return replace(state, modes=modes, deck=first_motion(self._swing))

    def _step_size(self, state: ImmState, measurement: Measurement) -> float:
        """How far, m, a measured place is from the expected one; at least the prior of the offset."""
        means, _, weights = state.modes
        expected, _ = sensors.observe(KINDS[measurement.quantity], weights @ means, self.numbers.lever_m, False)
        return max(float(np.linalg.norm(measurement.value - expected)), self.config.receivers.frame_offset_std_m)

    def _is_placed_by_sightings(self, state: ImmState) -> bool:
        """Whether the place is known better than the fixes alone could tell it in the drone's frame."""
        _, covariances, weights = state.modes
        variance = float(weights @ covariances[:, 0, 0])
        return variance < 0.25 * (self.config.receivers.frame_offset_std_m**2 + state.fix_bias_variance_m2)

    def _as_driven(self, state: ImmState, t_ns: int) -> ImmState:
        """Return the state with what is known of drivers: how hard they turn.

        What was seen for a second only may as well be a curve that nobody drives, and a vehicle that nothing more is
        heard of would be sought along it. For a forecast only: fused once for each, it would be believed too much.
        """
        means, _, weights = state.modes
        speed_m_s = max(math.hypot(*(weights @ means)[2:4].tolist()), self.config.heading.course_speed_min_m_s)
        straight = Measurement(
            t_ns=t_ns,
            quantity=Quantity.YAW_RATE,
            value=np.zeros(1),
            covariance=np.array([[(self.config.heading.turning_std_m_s2 / speed_m_s) ** 2]]),
        )
        update = self.update(state, straight)
        return state if update is None else update.state

    def _move_frame(self, state: ImmState, sighting: Measurement) -> ImmState:
        """Open place and offset as one unknown."""
        step = self._step_size(state, sighting) ** 2 * np.eye(3)
        means, covariances, weights = state.modes
        return replace(state, modes=(means, open_place_and_offset(covariances, step), weights))

    def _restart(self, state: ImmState, place: Measurement) -> ImmState:
        """A new start at `place` that keeps offset, heading and clock."""
        x, P = mixing.combine(*state.modes)
        means, covariances, weights = self.start(place).modes
        means[:, PLACE] += x[OFFSET]
        means[:, OFFSET] = x[OFFSET]
        for kept in (HEADING, CLOCK, *DECK):
            means[:, kept], covariances[:, kept, kept] = x[kept], P[kept, kept]
        return replace(state, modes=(means, covariances, weights))


def _own(array: Array) -> Array:
    """A plain copy: kernels are compiled anew for read-only or strided arrays, which takes seconds."""
    return np.array(array, dtype=np.float64, order="C")
