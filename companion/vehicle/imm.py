"""The default estimator: interacting turning models with the offset between the two receivers' frames.

State, motion and units are in `imm_kernels`, noise in `imm_noise`, sensors in `imm_sensors`, mixing in `imm_mixing`.
The vehicle's fixes are in the frame of its own receiver and dated by its own clock; sightings of the pad are in the
drone's. The difference of the frames is three states with a slow random walk, that of the clocks is one, so that the
estimate is right for the drone, and stays right when the sightings end. A vehicle that tells nothing is placed by
sightings alone, without either difference. What a receiver states as its error beyond
some decimetres is slow (Gauss-Markov) rather than white, and is let into that walk; the drone's own place then wanders
as well, and from one sighting to the next nothing tells how far.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from companion.config.estimation import ImmConfig
from companion.core.data import Array, Forecast, Measurement, Mixture, Quantity, VehicleEstimate
from companion.vehicle import imm_forecast as forecasts
from companion.vehicle import imm_judgement as judgement
from companion.vehicle import imm_mixing as mixing
from companion.vehicle import steady_driving
from companion.vehicle.angle import short_way_round
from companion.vehicle.deck_motion import passed
from companion.vehicle.filter_step import Update, std_of
from companion.vehicle.imm_body import (
    MOTIONS,
    learnt_body,
    motion_of,
    opened_body,
    opened_unit,
    told_modes,
    upright_modes,
)
from companion.vehicle.imm_frames import moved_frame, own_rate_opened_m2_s2, ranged_pad, wandering, without_slow_error
from companion.vehicle.imm_kernels import CURVATURE, HEADING
from companion.vehicle.imm_mixing import Modes
from companion.vehicle.imm_numbers import Deck, Numbers, noises_with, numbers_of, turns_as_modelled
from companion.vehicle.imm_spin import spins, spun, without_spin
from companion.vehicle.imm_state import (
    KINDS,
    OFFSET,
    ImmState,
    is_heading_known,
    largest,
    open_states,
    recover,
    split_fix,
    start_state,
    without_heading,
)
from companion.vehicle.imm_swing import OWN_RATE
from link.records import replace

TURNS = frozenset({Quantity.HEADING, Quantity.YAW_RATE})
HEIGHTS = frozenset({Quantity.PAD, Quantity.SURFACE})
_OUTAGE_S = 1.0  # of what tells how the vehicle moves; a heading is lost by one of several seconds only
TURN_AGE_MAX_S = 1.0  # of a sensor that is at work: several periods of the slowest


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
        """Return the state after a first place."""
        return start_state(place, self.config, self.numbers)

    def predict(self, state: ImmState, dt_s: float) -> ImmState:
        """Return the state `dt_s` later."""
        state = spun(state, dt_s, self.config, self.numbers) if state.spin.told_rad_s else state
        noises, begins_after_s, motion = self._noises(state), self.numbers.begins_after_s, self._motion(state)
        modes = mixing.predict_modes(state.modes, dt_s, noises, begins_after_s, motion, self._known_variance)
        return replace(
            state,
            modes=modes,
            seen_age_s=state.seen_age_s + dt_s,
            height_age_s=state.height_age_s + dt_s,
            turn_age_s=state.turn_age_s + dt_s,
            unmeasured_s=state.unmeasured_s + dt_s,
            driving=steady_driving.passed(state.driving, dt_s),
            deck=None if state.deck is None else passed(state.deck, dt_s),
        )

    def update(self, state: ImmState, measurement: Measurement) -> Update[ImmState] | None:
        """Return the state after any quantity, None of what it is too early for and of a surface beside the pad."""
        if measurement.quantity is Quantity.SURFACE:
            sees_heading = is_heading_known(state, self.config)
            seen = ranged_pad(state, measurement, self.deck, self.numbers.lever_m, sees_heading=sees_heading)
            if seen is None:
                return None
            measurement = seen
        if measurement.quantity is Quantity.ACCELERATION and not is_heading_known(state, self.config):
            return None
        is_afloat = self.deck.is_afloat
        opened_state = opened_body(state, measurement, self.config, self.numbers, is_afloat=is_afloat)
        if opened_state is None:
            return None
        state = opened_state
        if measurement.quantity in HEIGHTS and self.placed_by is Quantity.POSITION:
            opened = np.array([own_rate_opened_m2_s2(state, self.config.receivers)])
            state = replace(state, modes=open_states(state.modes, np.array([OWN_RATE]), opened))
        R = measurement.covariance
        bias_variance, white_variance = state.fix_bias_variance_m2, state.fix_white_variance_m2
        if measurement.quantity is Quantity.POSITION:
            R, bias_variance = split_fix(R, self.config.receivers)
            white_variance = largest(R)
            state = without_slow_error(state, bias_variance, self.config.receivers)
        if measurement.quantity is Quantity.HEADING:
            state = opened_unit(state, measurement)
        state, beside = without_spin(state, measurement, self.config, self.numbers)
        if beside is None:  # as likely as any reading that the filter expects
            return Update(state=state, nis=1.0, gate_nis=1.0, dof=1)
        measurement = beside
        reading = (KINDS[measurement.quantity], _own(measurement.value), _own(R))
        tells_motion = measurement.quantity in MOTIONS
        tells_driving = tells_motion or measurement.quantity is self.placed_by
        modes = self._after_silence(state) if tells_motion and state.unmeasured_s > 0.0 else state.modes
        course = self.numbers.courses[state.turn_age_s < TURN_AGE_MAX_S]
        modes, nis, gate_nis = judgement.take_reading(modes, reading, self.numbers.lever_m, course)
        tells_turn = measurement.quantity in TURNS and self.placed_by is Quantity.POSITION
        deck, sway = learnt_body(state, modes, measurement, self.config, self.numbers, is_afloat=is_afloat)
        updated = replace(
            state,
            modes=modes,
            driving=steady_driving.learn(state.driving, modes, self.config) if tells_driving else state.driving,
            fix_bias_variance_m2=bias_variance,
            fix_white_variance_m2=white_variance,
            seen_age_s=0.0 if measurement.quantity is Quantity.PAD else state.seen_age_s,
            height_age_s=0.0 if measurement.quantity in HEIGHTS else state.height_age_s,
            turn_age_s=0.0 if tells_turn else state.turn_age_s,  # what is only seen to turn is taken for a car
            unmeasured_s=0.0 if tells_motion else state.unmeasured_s,
            deck=deck,
            sway=sway,
        )
        return Update(state=updated, nis=nis, gate_nis=gate_nis, dof=len(measurement.value))

    def move_frame(self, state: ImmState, step: Measurement) -> ImmState:
        """Return the state after W has moved under what is seen from the drone."""
        return moved_frame(state, step, self.config.receivers, self.placed_by)

    def recover(self, state: ImmState, measurement: Measurement) -> ImmState:
        """Return the state open to `measurement`."""
        recovered = recover(state, measurement, self.config, self.numbers, self.placed_by)
        return replace(recovered, driving=steady_driving.without_pair(recovered.driving))

    def describe(self, state: ImmState, t_ns: int) -> VehicleEstimate:
        """Return the mixture of the modes; its parts are of the pad, on a body that stands upright."""
        motion, told_of, known_variance = self._motion(state), told_modes(state), self._known_variance
        x, told, covariance, heading_variance = forecasts.describe_modes(told_of, motion, known_variance)
        pad_off, pad_covariance = forecasts.describe_pad(upright_modes(state), motion, known_variance)
        known = heading_variance < known_variance
        return VehicleEstimate(
            t_ns=t_ns,
            position_enu_m=told[:3],
            velocity_enu_m_s=told[3:6],
            acceleration_enu_m_s2=told[6:],
            covariance=0.5 * (covariance + covariance.T),
            yaw_rad=short_way_round(float(x[HEADING])) if known else None,
            yaw_rate_rad_s=float(x[CURVATURE] * math.hypot(x[2], x[3])) + state.spin.rad_s if known else None,
            mixture=Mixture(weight=state.modes[2], off=pad_off, covariance=pad_covariance),
        )

    def forecast(self, state: ImmState, t_ns: int, offset_s: Array) -> Forecast:
        """Return the future along the present curvature, with an acceleration that fades and stops at standstill."""
        if self.placed_by is Quantity.PAD:
            state = self._as_driven(state, t_ns)
        position, velocity, acceleration, yaw, grade, tilt, std, heading_variance = forecasts.forecast_modes(
            told_modes(state), _own(offset_s), self._noises(state), self._motion(state), self._known_variance
        )
        means, covariances, weights = state.modes
        is_as_modelled = turns_as_modelled(state.modes, turn_is_measured=state.turn_age_s < TURN_AGE_MAX_S)
        return Forecast(
            t_ns=t_ns,
            offset_s=offset_s,
            position_enu_m=position,
            velocity_enu_m_s=velocity,
            acceleration_enu_m_s2=acceleration,
            yaw_rad=yaw if heading_variance < self._known_variance and is_as_modelled and not spins(state) else None,
            position_std_m=std[:, :3],
            climb_std_m_s=std[:, 3],
            is_coarse=state.fix_bias_variance_m2 > 0.0 or self.placed_by is Quantity.PAD,
            grade=grade,
            tilt_rad=None if state.deck is None else tilt,
            tilt_std_rad=None if state.deck is None else std[:, 4:],
            swing=None if state.deck is None else state.deck.oscillators.reshape(3, 3)[:, :2],
            yaw_std_rad=std_of(heading_variance),
            frame_offset_enu_m=(weights @ means)[OFFSET[:2]],
            frame_offset_std_m=std_of(float((weights @ covariances[:, OFFSET[:2], OFFSET[:2]]).max())),
            is_height_told=state.height_age_s < self.config.receivers.own_height_time_s,
            turns_on_spot=spins(state),
        )

    def _after_silence(self, state: ImmState) -> Modes:
        """Return the modes for what moves after nothing told how: any model may have begun meanwhile.

        Of a heading that was lost a velocity tells nothing: from one to the next it may have turned by half a turn.
        """
        modes = state.modes
        if state.unmeasured_s > _OUTAGE_S and not is_heading_known(state, self.config):
            modes = without_heading(modes)
        return judgement.expect_manoeuvres(modes, state.unmeasured_s, self.numbers.begins_after_s, self._noises(state))

    @property
    def _known_variance(self) -> float:
        """Of a heading that is known, rad^2; while it is not, the kernels leave the lever arm out."""
        return self.config.heading.known_std_rad**2

    def _noises(self, state: ImmState) -> Array:
        """The modes' noise, (n, 18), as `imm_noise.process_noise` takes it."""
        return noises_with(
            self.numbers,
            wandering(state, self.config.receivers),
            state.driving.psd_m2_s5(self.numbers.steady_m2_s5),
            2.0 * state.heading_bias_variance_rad2 / self.config.heading.unit_error_time_s,
            turn_is_measured=state.turn_age_s < TURN_AGE_MAX_S,
        )

    def _motion(self, state: ImmState) -> Array:
        return motion_of(state, self.config, self.numbers)

    def _as_driven(self, state: ImmState, t_ns: int) -> ImmState:
        """Return the state with what is known of drivers: how hard they turn.

        What was seen for a second only may as well be a curve that nobody drives, and a vehicle that nothing more is
        heard of would be sought along it. For a forecast only: fused once for each, it would be believed too much.
        """
        straight = steady_driving.driven_straight(state.modes, t_ns, self.config.heading)
        update = self.update(state, straight)
        return state if update is None else update.state


def _own(array: Array) -> Array:
    """A plain copy: kernels are recompiled for read-only or strided arrays, which takes seconds."""
    return np.array(array, dtype=np.float64, order="C")
