from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import pytest

from companion.config.estimation import BufferConfig, LkfConfig
from companion.core.data import Measurement, Quantity
from companion.vehicle.estimator import BufferedEstimator, DelayBuffer, fuse
from companion.vehicle.filter_step import FilterModel, Gaussian, nis_threshold
from companion.vehicle.lkf import LkfModel, WhiteJerkNoise
from link.records import replace
from tests.companion.vehicle.rides import now_ns

MODEL = LkfModel(noise=WhiteJerkNoise(config=LkfConfig()))
CONFIG = BufferConfig()


def fix(t_s: float, x_m: float = 0.0, quantity: Quantity = Quantity.POSITION) -> Measurement:
    return Measurement(
        t_ns=now_ns(t_s), quantity=quantity, value=np.array([x_m, 0.3, -0.2]), covariance=4e-4 * np.eye(3)
    )


def run(measurements: list[Measurement], config: BufferConfig = CONFIG) -> DelayBuffer[Gaussian]:
    buffer: DelayBuffer[Gaussian] | None = None
    for measurement in measurements:
        buffer = fuse(MODEL, config, buffer, [measurement])
    assert buffer is not None
    return buffer


def accepted(buffer: DelayBuffer[Gaussian]) -> int:
    return sum(buffer.newest.tally.accepted)


def rejected(buffer: DelayBuffer[Gaussian]) -> int:
    return sum(buffer.newest.tally.rejected)


def test_buffer_keeps_no_more_than_its_length() -> None:
    buffer = run([fix(0.1 * i) for i in range(100)])
    assert len(buffer.entries) == 16
    assert accepted(buffer) == 100


def test_measurement_older_than_the_buffer_is_dropped_and_counted() -> None:
    buffer = run([fix(0.1 * i) for i in range(100)])
    after = fuse(MODEL, CONFIG, buffer, [fix(5.0, 99.0)])
    assert after is not None
    assert after.late == 1
    assert after.newest is buffer.newest


def test_late_measurement_changes_the_present_as_if_it_had_come_in_time() -> None:
    all_fixes = [fix(0.1 * i, 0.01 * i) for i in range(12)]
    held_back = run([*all_fixes[:7], *all_fixes[8:], all_fixes[7]])
    in_time = run(all_fixes)
    assert held_back.newest.state is not None
    assert in_time.newest.state is not None
    assert np.array_equal(held_back.newest.state.mean, in_time.newest.state.mean)
    assert held_back.newest.tally == in_time.newest.tally


def test_measurements_before_the_first_fix_wait_for_one_that_is_older() -> None:
    velocity = fix(0.05, 1.0, Quantity.VELOCITY)
    buffer = run([velocity, fix(0.1), fix(0.0)])
    assert accepted(buffer) == 3


def test_one_stamp_from_the_future_leaves_the_present_as_it_was() -> None:
    good = [fix(0.1 * i, 0.1 * i) for i in range(20)]
    misled = run([*good[:10], fix(3600.0), *good[10:]])
    before = misled.before(now_ns(2.0)).state
    expected = run(good).newest.state
    assert before is not None
    assert expected is not None
    assert np.array_equal(before.mean, expected.mean)


def test_stamps_from_the_future_do_not_blind_the_filter_for_good() -> None:
    good = [fix(0.1 * i) for i in range(10)]
    more = [fix(1.0 + 0.1 * i) for i in range(CONFIG.late_in_a_row_max + 5)]
    buffer = run([*good, fix(3600.0), fix(7200.0), *more])
    assert buffer.late == CONFIG.late_in_a_row_max + 1
    assert buffer.newest.t_ns == more[-1].t_ns
    assert buffer.newest.state is not None


def test_late_data_of_one_sensor_do_not_take_away_what_the_fixes_tell() -> None:
    late = [fix(0.01 * i, 1.0, Quantity.VELOCITY) for i in range(CONFIG.late_in_a_row_max + 5)]
    buffer = run([*(fix(0.1 * i) for i in range(30)), *late])
    assert buffer.late == len(late)
    assert accepted(buffer) == 30


def test_rejections_for_long_enough_make_the_filter_recover() -> None:
    good = [fix(0.1 * i) for i in range(20)]
    jumped = [fix(2.0 + 0.1 * i, 50.0) for i in range(8)]
    buffer = run([*good, *jumped])
    tally = buffer.newest.tally
    assert (rejected(buffer), tally.recoveries) == (3, 1)
    assert buffer.newest.state is not None
    assert buffer.newest.state.mean[0] == pytest.approx(50.0, abs=0.05)


def test_one_good_fix_among_outliers_prevents_recovery() -> None:
    mixed = [fix(0.1 * i, 50.0 if i > 20 and i % 3 else 0.0) for i in range(40)]
    buffer = run(mixed)
    assert buffer.newest.tally.recoveries == 0
    assert rejected(buffer) == 12


def test_measurement_that_is_not_a_number_is_gated() -> None:
    broken = replace(fix(1.0), value=np.array([np.nan, 0.0, 0.0]))
    buffer = run([*(fix(0.1 * i) for i in range(8)), broken])
    assert rejected(buffer) == 1
    assert buffer.newest.state is not None
    assert np.isfinite(buffer.newest.state.mean).all()


def test_gate_is_the_chi_square_quantile_of_printed_tables() -> None:
    assert nis_threshold(0.95, 1) == pytest.approx(3.841, abs=5e-4)
    assert nis_threshold(0.99, 3) == pytest.approx(11.345, abs=5e-4)
    assert nis_threshold(None, 3) == np.inf


FORGOTTEN_S = CONFIG.forget_after_s + 0.1


@dataclass(frozen=True)
class Counted:
    """The model, which tells over how long it has been asked to predict."""

    asked_s: list[float]

    def predict(self, state: Gaussian, dt_s: float) -> Gaussian:
        self.asked_s.append(dt_s)
        return MODEL.predict(state, dt_s)

    def __getattr__(self, name: str) -> Any:
        return getattr(MODEL, name)


@pytest.mark.parametrize(
    "silent_s", [FORGOTTEN_S, 3600.0, now_ns(0.0) * 1e-9], ids=["just too long", "hour", "stamp 0"]
)
def test_vehicle_that_was_silent_for_long_is_forgotten_and_its_next_fix_begins_anew(silent_s: float) -> None:
    counted = Counted([])
    estimator = BufferedEstimator(model=cast(FilterModel[Gaussian], counted), config=CONFIG)
    before, now = fix(-silent_s, 5.0), fix(0.0, 1.0)
    memory = estimator.fuse(None, [before])
    assert estimator.estimate(memory, now.t_ns) is None
    assert estimator.forecast(memory, now.t_ns, np.array([0.0, 0.2])) is None
    memory = estimator.fuse(memory, [now])
    assert memory is not None
    assert memory.newest.state is not None
    assert np.array_equal(memory.newest.state.mean, MODEL.start(now).mean)
    assert accepted(memory) == 2
    assert not counted.asked_s


def test_what_only_the_drone_tells_keeps_no_silent_vehicle_in_mind() -> None:
    estimator = BufferedEstimator(model=MODEL, config=CONFIG)
    before, now = fix(-FORGOTTEN_S, 5.0), fix(0.0, 1.0)
    ranges = [fix(0.5 - FORGOTTEN_S + 0.5 * i, 9.0, Quantity.SURFACE) for i in range(2 * int(FORGOTTEN_S))]
    memory = estimator.fuse(None, [before])
    for one in ranges:
        memory = estimator.fuse(memory, [one])
        assert memory is None or len(memory.entries) <= 2.0 * CONFIG.keep_s + 2
    assert estimator.forecast(memory, now.t_ns, np.array([0.0, 0.2])) is None
    memory = estimator.fuse(memory, [now])
    assert memory is not None
    assert memory.newest.state is not None
    assert np.array_equal(memory.newest.state.mean, MODEL.start(now).mean)


def test_vehicle_that_was_silent_for_a_while_is_not_forgotten() -> None:
    estimator = BufferedEstimator(model=MODEL, config=CONFIG)
    memory = estimator.fuse(None, [fix(0.0), fix(0.1)])
    assert estimator.estimate(memory, now_ns(CONFIG.forget_after_s)) is not None


def test_velocity_after_a_long_silence_waits_for_a_place() -> None:
    buffer = run([fix(0.0), fix(FORGOTTEN_S, 1.0, Quantity.VELOCITY)])
    assert buffer.newest.state is None
    assert run([fix(0.0), fix(FORGOTTEN_S, 1.0, Quantity.VELOCITY), fix(FORGOTTEN_S + 0.1)]).newest.state is not None
