"""A body that sways and does not tell its tilt: its antenna's sway is learnt, and not taken for driving."""

import math

import numpy as np
import pytest

from companion.config.estimation import EstimatorConfig, ImmConfig
from companion.core.data import Array, Measurement, Quantity
from companion.vehicle.body_sway import BodySway, first_sway, learn_sway
from companion.vehicle.estimator import BufferedEstimator, DelayBuffer
from companion.vehicle.imm import ImmModel
from companion.vehicle.imm_mixing import Modes
from companion.vehicle.imm_numbers import Deck
from companion.vehicle.imm_state import ImmState
from companion.vehicle.imm_swing import HEAVE_RATE, PITCH_RATE, ROLL_RATE, SIZE
from link.records import replace
from tests.companion.vehicle.drives import TRUTH_STEP_S, Drive, Sensors, drive, sense
from tests.companion.vehicle.rides import now_ns

CONFIG = ImmConfig()
HEIGHT_M = 3.9  # of a lorry's roof
LORRY = Deck(antenna_to_pad_m=(0.0, 0.0, -0.1), pad_height_m=HEIGHT_M)
GOOD = Sensors(fix_std_m=0.01, velocity_std_m_s=0.03, heading_std_rad=0.01, yaw_rate_std_rad_s=0.01, rate_hz=20.0)
SPEED_M_S, SWAY_M_S, SWAY_RAD_S = 18.0, 0.15, 2.0 * math.pi * 1.7
BRAKES_AT_S, BRAKES_M_S2 = 25.0, 6.0

Memory = DelayBuffer[ImmState]


def braking() -> Drive:
    """Steady driving, then a brake."""
    return drive(27.0, lambda t: SPEED_M_S - BRAKES_M_S2 * min(max(t - BRAKES_AT_S, 0.0), 1.0), lambda _: 0.0)


def shaken(truth: Drive, rate_m_s: float, rad_s: float, axis: Array) -> Drive:
    """The same with an antenna that goes to and fro along an axis (3,)."""
    t = np.arange(len(truth.yaw)) * TRUTH_STEP_S
    place, rate = rate_m_s * np.sin(rad_s * t) / rad_s, rate_m_s * np.cos(rad_s * t)
    return replace(
        truth, position=truth.position + np.outer(place, axis), velocity=truth.velocity + np.outer(rate, axis)
    )


def swaying(sway_m_s: float, sway_rad_s: float = SWAY_RAD_S) -> Drive:
    """A brake of a vehicle whose antenna sways along the straight track."""
    truth = braking()
    along = np.array([math.cos(truth.yaw[0]), math.sin(truth.yaw[0]), 0.0])
    return shaken(truth, sway_m_s, sway_rad_s, along)


CLIMBS_AT_S, CLIMBS_WITHIN_S = 12.0, 2.0


def climbing(grade: float) -> Drive:
    """Steady driving on a level road, and then within two seconds up a grade."""
    truth = drive(15.0, lambda _: SPEED_M_S, lambda _: 0.0)
    t = np.arange(len(truth.yaw)) * TRUTH_STEP_S
    rate = SPEED_M_S * grade * np.clip((t - CLIMBS_AT_S) / CLIMBS_WITHIN_S, 0.0, 1.0)
    up = np.column_stack([np.zeros((len(t), 2)), rate])
    return replace(truth, position=truth.position + np.cumsum(up, axis=0) * TRUTH_STEP_S, velocity=truth.velocity + up)


class Watcher:
    """The filter and what it has been told."""

    def __init__(self, truth: Drive, deck: Deck = LORRY, sensors: Sensors = GOOD) -> None:
        self.chosen = BufferedEstimator(model=ImmModel(config=CONFIG, deck=deck), config=EstimatorConfig().buffer)
        self._waiting = sense(truth, sensors, 7)[::-1]
        self.memory: Memory | None = None

    def until(self, t_s: float) -> None:
        batch: list[Measurement] = []
        while self._waiting and self._waiting[-1][0] <= now_ns(t_s):
            batch.append(self._waiting.pop()[1])
        self.memory = self.chosen.fuse(self.memory, batch)

    def motion_at(self, t_s: float) -> tuple[float, float]:
        """Speed and acceleration along the track, by the forecast."""
        self.until(t_s)
        forecast = self.chosen.forecast(self.memory, now_ns(t_s), np.array([0.0, 0.1]))
        assert forecast is not None
        along = np.array([math.cos(0.3), math.sin(0.3), 0.0])
        return float(forecast.velocity_enu_m_s[0] @ along), float(forecast.acceleration_enu_m_s2[0] @ along)

    @property
    def state(self) -> ImmState:
        assert self.memory is not None
        assert self.memory.newest.state is not None
        return self.memory.newest.state


def rms(values: list[float]) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def test_sway_of_an_antenna_is_not_taken_for_driving() -> None:
    watcher = Watcher(swaying(SWAY_M_S))
    motions = [watcher.motion_at(t_s) for t_s in np.arange(15.0, BRAKES_AT_S, 0.05)]
    assert rms([acceleration for _, acceleration in motions]) < 0.25 * SWAY_M_S * SWAY_RAD_S / math.sqrt(2.0)
    assert rms([speed - SPEED_M_S for speed, _ in motions]) < 0.5 * SWAY_M_S / math.sqrt(2.0)


@pytest.mark.parametrize("rate_hz", [5.0, 10.0])
@pytest.mark.parametrize("sway_m_s", [0.0, 0.6])
def test_sway_is_followed_from_the_first_seconds_on_whatever_the_rate_and_the_road(
    rate_hz: float, sway_m_s: float
) -> None:
    receiver = Sensors(fix_std_m=0.02, velocity_std_m_s=0.05, rate_hz=rate_hz)
    watcher = Watcher(swaying(sway_m_s), sensors=receiver)
    watcher.until(2.0)
    assert watcher.state.sway is not None


@pytest.mark.parametrize("rate_hz", [5.0, 20.0])
@pytest.mark.parametrize("sway_m_s", [0.3, 0.8])
def test_sway_far_larger_than_it_was_taken_to_be_is_not_driving(sway_m_s: float, rate_hz: float) -> None:
    car = Deck(antenna_to_pad_m=(0.0, 0.0, -0.1), pad_height_m=1.5)
    receiver = Sensors(fix_std_m=0.02, velocity_std_m_s=0.05, rate_hz=rate_hz)
    watcher = Watcher(swaying(sway_m_s), car, receiver)
    speeds = [watcher.motion_at(t_s)[0] for t_s in np.arange(8.0, 18.0, 0.1)]
    assert rms([speed - SPEED_M_S for speed in speeds]) < 0.4 * sway_m_s / math.sqrt(2.0)


@pytest.mark.parametrize("rate_hz", [5.0, 10.0, 20.0])
@pytest.mark.parametrize("sway_hz", [0.7, 1.0])
def test_slow_sway_is_not_driving_either(sway_hz: float, rate_hz: float) -> None:
    sway_m_s, car = 0.5, Deck(antenna_to_pad_m=(0.0, 0.0, -0.1), pad_height_m=1.5)
    receiver = Sensors(fix_std_m=0.02, velocity_std_m_s=0.05, rate_hz=rate_hz)
    watcher = Watcher(swaying(sway_m_s, 2.0 * math.pi * sway_hz), car, receiver)
    speeds = [watcher.motion_at(t_s)[0] for t_s in np.arange(8.0, 18.0, 0.1)]
    assert rms([speed - SPEED_M_S for speed in speeds]) < 0.5 * sway_m_s / math.sqrt(2.0)
    assert watcher.state.sway is not None
    assert watcher.state.sway.pitch.frequency_rad_s == pytest.approx(2.0 * math.pi * sway_hz, rel=0.25)


@pytest.mark.parametrize("rate_hz", [5.0, 10.0])
@pytest.mark.parametrize("heave_hz", [0.5, 0.7, 1.0])
def test_heave_is_no_grade(heave_hz: float, rate_hz: float) -> None:
    heave_m_s, heave_rad_s = 0.3, 2.0 * math.pi * heave_hz
    receiver = Sensors(fix_std_m=0.02, velocity_std_m_s=0.05, rate_hz=rate_hz)
    watcher = Watcher(shaken(braking(), heave_m_s, heave_rad_s, np.array([0.0, 0.0, 1.0])), sensors=receiver)
    errors_m_s = []
    for t_s in np.arange(10.0, 20.0, 0.1):
        watcher.until(t_s)
        forecast = watcher.chosen.forecast(watcher.memory, now_ns(t_s), np.array([0.0, 0.4]))
        assert forecast is not None
        true_m_s = heave_m_s * np.cos(heave_rad_s * (t_s + np.array([0.0, 0.4])))
        errors_m_s.append(forecast.velocity_enu_m_s[:, 2] - true_m_s)
    now, later = np.sqrt(np.mean(np.square(errors_m_s), axis=0))
    assert now < 0.6 * heave_m_s / math.sqrt(2.0)
    assert later < 1.3 * heave_m_s / math.sqrt(2.0)  # taken for a grade it is 1.7 to 2.2


def test_how_much_a_body_sways_is_learnt() -> None:
    found = []
    for sway_m_s in (0.0, SWAY_M_S):
        watcher = Watcher(swaying(sway_m_s))
        watcher.until(BRAKES_AT_S)
        assert watcher.state.sway is not None
        found.append(math.sqrt(watcher.state.sway.pitch.rate_variance))
    still, swings = found
    assert swings == pytest.approx(SWAY_M_S / HEIGHT_M / math.sqrt(2.0), rel=0.3)
    assert still < 0.5 * swings


def test_brake_of_a_body_that_sways_is_known_as_soon() -> None:
    speeds = []
    for sway_m_s in (0.0, SWAY_M_S):
        watcher = Watcher(swaying(sway_m_s))
        speeds.append(watcher.motion_at(BRAKES_AT_S + 0.4)[0])
    assert speeds == pytest.approx([SPEED_M_S - 0.4 * BRAKES_M_S2] * 2, abs=0.3)


def modes_of(rate_variance: float, rate_rad_s: float = 0.0, speed_m_s: float = 10.0) -> Modes:
    """One mode that knows so much of both rates."""
    mean, covariance = np.zeros((1, SIZE)), np.zeros((1, SIZE, SIZE))
    mean[0, 2], mean[0, [ROLL_RATE, PITCH_RATE]] = speed_m_s, rate_rad_s
    covariance[0, [ROLL_RATE, PITCH_RATE], [ROLL_RATE, PITCH_RATE]] = rate_variance
    return mean, covariance, np.ones(1)


def learn_all(sway: BodySway, modes: Modes, seconds: float) -> BodySway:
    for _ in range(round(seconds / 0.05)):
        sway = learn_sway(sway, modes, 0.05, CONFIG)
    return sway


def learnt(sway: BodySway, modes: Modes, seconds: float) -> Array:
    sway = learn_all(sway, modes, seconds)
    return np.array([sway.roll.rate_variance, sway.pitch.rate_variance])


def test_sway_that_nothing_shows_stays_as_it_was_taken_to_be() -> None:
    sway = first_sway(CONFIG.sway)
    before = sway.roll.rate_variance
    assert learnt(sway, modes_of(before), 30.0) == pytest.approx(np.full(2, before))


def test_what_is_known_of_a_rate_and_what_is_not_make_its_variance_together() -> None:
    sway = first_sway(CONFIG.sway)
    assert learnt(sway, modes_of(0.0003, rate_rad_s=0.02), 600.0) == pytest.approx(np.full(2, 0.0007), rel=1e-3)


def test_heave_is_a_smooth_roads_until_more_of_it_is_seen() -> None:
    sway = first_sway(CONFIG.sway)
    modes = modes_of(sway.roll.rate_variance)
    modes[1][0, HEAVE_RATE, HEAVE_RATE] = sway.heave.rate_variance
    assert math.sqrt(learn_all(sway, modes, 30.0).heave.rate_variance) == pytest.approx(0.047, abs=0.001)
    modes[0][0, HEAVE_RATE], modes[1][0, HEAVE_RATE, HEAVE_RATE] = 0.2, 0.01
    shaken = learn_all(sway, modes, 600.0)
    assert shaken.heave.rate_variance == pytest.approx(0.2**2 + 0.01, rel=1e-3)
    assert [shaken.roll.rate_variance, shaken.pitch.rate_variance] == pytest.approx([sway.roll.rate_variance] * 2)


@pytest.mark.parametrize("grade", [0.12, -0.12])
def test_road_that_begins_to_climb_is_no_heave(grade: float) -> None:
    watcher = Watcher(climbing(grade))
    watcher.until(CLIMBS_AT_S + 0.7)
    forecast = watcher.chosen.forecast(watcher.memory, now_ns(CLIMBS_AT_S + 0.7), np.array([0.0, 0.5]))
    assert forecast is not None
    true_m_s = SPEED_M_S * grade * 0.7 / CLIMBS_WITHIN_S
    now, later = forecast.velocity_enu_m_s[:, 2] / true_m_s
    assert now == pytest.approx(1.0, abs=0.15)
    assert later > 1.1  # a heave would swing back by then


@pytest.mark.parametrize(("speed_m_s", "dt_s"), [(0.5, 0.05), (10.0, 5.0), (10.0, 0.0)])
def test_vehicle_that_stands_and_a_silence_teach_nothing(speed_m_s: float, dt_s: float) -> None:
    sway = first_sway(CONFIG.sway)
    assert learn_sway(sway, modes_of(0.0, rate_rad_s=0.1, speed_m_s=speed_m_s), dt_s, CONFIG) is sway


def test_tilt_that_is_told_takes_the_place_of_a_sway_that_was_not() -> None:
    watcher = Watcher(swaying(SWAY_M_S))
    watcher.until(10.0)
    t_s, antenna_m = 9.9, HEIGHT_M + 0.1  # with the newest fix
    pitch_rad = SWAY_M_S / SWAY_RAD_S * math.sin(SWAY_RAD_S * t_s) / antenna_m
    tilt = np.array([0.0, 0.0, pitch_rad, SWAY_M_S * math.cos(SWAY_RAD_S * t_s) / antenna_m])
    told_tilt = Measurement(t_ns=now_ns(t_s), quantity=Quantity.TILT, value=tilt, covariance=1e-4 * np.eye(4))
    watcher.memory = watcher.chosen.fuse(watcher.memory, [told_tilt])
    told = watcher.state
    assert told.sway is None
    assert told.deck is not None


def test_vessel_has_to_tell_its_tilt() -> None:
    watcher = Watcher(swaying(SWAY_M_S), Deck(antenna_to_pad_m=(0.0, 0.0, -0.1), pad_height_m=HEIGHT_M, is_afloat=True))
    watcher.until(20.0)
    assert watcher.state.sway is None
