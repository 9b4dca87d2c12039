import math
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from link.frames.geodesy import Datum, enu_from_geodetic
from link.frames.rotations import quaternion_from_roll_pitch_yaw, quaternion_from_yaw, rotate, yaw_of
from link.messages import BodyTruth, Fix, FixVelocity, PadSighting, Quaternion, Vector3, VehicleImu
from link.records import replace
from scenarios.config import ClockConfig, FixConfig, ImuConfig, PatternConfig, SensorsConfig, VelocityConfig
from scenarios.simulation.noise import Dropouts, GaussMarkov, named_rng
from scenarios.simulation.sensors import Mounting, Sample, SensorSuite
from scenarios.simulation.vehicle import VehicleState

START_NS = 1_800_000_000_000_000_000
STEP_NS = 10_000_000
DATUM = Datum(latitude_rad=0.916, longitude_rad=0.234, altitude_m=89.0)
AT_CENTRE = Mounting(antenna_flu_m=(0.0, 0.0, 0.0), pad_height_m=0.0)
ON_ROOF = Mounting(antenna_flu_m=(-1.2, 0.5, 1.6), pad_height_m=1.5)
SILENT = FixConfig(rate_hz=1.0, white_m=0.0, loss=1.0)


def vehicle_at(t_ns: int, *, yaw_rad: float = 0.0, yaw_rate_rad_s: float = 0.0, speed_m_s: float = 0.0) -> VehicleState:
    return VehicleState(
        t_ns=t_ns,
        position_enu_m=(12.0, -7.0, 0.5),
        velocity_enu_m_s=(speed_m_s * math.cos(yaw_rad), speed_m_s * math.sin(yaw_rad), 0.0),
        acceleration_enu_m_s2=(0.0, 0.0, 0.0),
        orientation_wxyz=quaternion_from_yaw(yaw_rad),
        angular_velocity_flu_rad_s=(0.0, 0.0, yaw_rate_rad_s),
        yaw_rad=yaw_rad,
        yaw_rate_rad_s=yaw_rate_rad_s,
    )


def drone_at(t_ns: int, position_enu_m: Vector3, attitude: Quaternion = (1.0, 0.0, 0.0, 0.0)) -> BodyTruth:
    return BodyTruth(
        t_ns=t_ns,
        position_enu_m=position_enu_m,
        orientation_wxyz=attitude,
        velocity_flu_m_s=(0.0, 0.0, 0.0),
        angular_velocity_flu_rad_s=(0.0, 0.0, 0.0),
    )


def sampled(
    config: SensorsConfig,
    duration_s: float,
    *,
    seed: int = 5,
    mounting: Mounting = AT_CENTRE,
    vehicle: Callable[[int], VehicleState] = vehicle_at,
    drone: Callable[[int], BodyTruth | None] = lambda _: None,
) -> list[tuple[int, Sample]]:
    suite = SensorSuite(config, seed, mounting=mounting, datum=DATUM)
    times_ns = [START_NS + index * STEP_NS for index in range(round(duration_s * 100))]
    return [(t_ns, sample) for t_ns in times_ns for sample in suite.step(t_ns, vehicle(t_ns), drone(t_ns))]


def position_of(fix: Fix) -> Vector3:
    return enu_from_geodetic(DATUM, fix.latitude_rad, fix.longitude_rad, fix.altitude_m)


def of_kind(samples: list[tuple[int, Sample]], kind: type[Any]) -> list[Any]:
    return [sample for _, sample in samples if isinstance(sample, kind)]


def test_report_fix_errs_by_its_white_noise_on_each_axis() -> None:
    samples = of_kind(sampled(SensorsConfig(fix=FixConfig(rate_hz=100.0, white_m=0.1)), 20.0), Fix)
    errors_m = np.array([position_of(fix) for fix in samples]) - (12.0, -7.0, 0.5)
    assert len(samples) == 2000
    np.testing.assert_allclose(errors_m.std(axis=0), 0.1, rtol=0.06)
    np.testing.assert_allclose(errors_m.mean(axis=0), 0.0, atol=0.01)
    correlation = np.mean(errors_m[1:] * errors_m[:-1]) / np.mean(errors_m**2)
    assert abs(correlation) < 0.05


def test_shared_white_noise_is_one_draw_for_the_three_axes() -> None:
    config = SensorsConfig(fix=FixConfig(rate_hz=100.0, white_m=0.1, white_shared=True))
    samples = of_kind(sampled(config, 20.0), Fix)
    errors_m = np.array([position_of(fix) for fix in samples]) - np.array([12.0, -7.0, 0.5])
    assert np.ptp(errors_m, axis=1).max() < 1e-6
    assert errors_m[:, 0].std() == pytest.approx(0.1, rel=0.06)
    assert abs(np.corrcoef(errors_m[1:, 0], errors_m[:-1, 0])[0, 1]) < 0.06


def test_fix_is_where_the_antenna_is() -> None:
    config = SensorsConfig(fix=FixConfig(rate_hz=10.0, white_m=0.0))
    turned = sampled(config, 0.2, mounting=ON_ROOF, vehicle=lambda t_ns: vehicle_at(t_ns, yaw_rad=0.5 * math.pi))
    assert position_of(of_kind(turned, Fix)[0]) == pytest.approx((12.0 - 0.5, -7.0 - 1.2, 0.5 + 1.6), abs=1e-6)


def test_velocity_holds_the_swing_of_the_antenna() -> None:
    config = SensorsConfig(fix=SILENT, velocity=VelocityConfig(rate_hz=10.0, white_m_s=0.0))
    moving = sampled(
        config, 0.2, mounting=ON_ROOF, vehicle=lambda t_ns: vehicle_at(t_ns, yaw_rate_rad_s=0.4, speed_m_s=5.0)
    )
    assert of_kind(moving, FixVelocity)[0].velocity_enu_m_s == pytest.approx((5.0 - 0.4 * 0.5, -0.4 * 1.2, 0.0))


def test_sample_leaves_when_its_delay_is_over_with_the_time_it_was_taken() -> None:
    config = SensorsConfig(fix=FixConfig(rate_hz=10.0, delay_s=0.06, white_m=0.02))
    samples = sampled(config, 3.0)
    assert len(samples) == 30
    assert {left_ns - sample.t_ns for left_ns, sample in samples} == {60_000_000}
    assert {b.t_ns - a.t_ns for (_, a), (_, b) in pairwise(samples)} == {100_000_000}


def test_rate_that_does_not_divide_the_step_is_kept_on_average() -> None:
    samples = sampled(SensorsConfig(fix=FixConfig(rate_hz=30.0, white_m=0.02)), 10.0)
    assert len(samples) == pytest.approx(300, abs=1)


def test_jitter_beyond_the_period_puts_samples_out_of_order() -> None:
    samples = sampled(SensorsConfig(fix=FixConfig(rate_hz=50.0, delay_s=0.1, jitter_s=0.05, white_m=0.0)), 10.0)
    stamps_ns = [sample.t_ns for _, sample in samples]
    assert stamps_ns != sorted(stamps_ns)
    delays_s = np.array([(left_ns - sample.t_ns) * 1e-9 for left_ns, sample in samples])
    assert 0.05 - 1e-9 <= delays_s.min() <= 0.06 + 1e-9  # they leave at a step, every 10 ms
    assert 0.14 < delays_s.max() <= 0.15 + 0.01


def test_loss_takes_its_share() -> None:
    samples = sampled(SensorsConfig(fix=FixConfig(rate_hz=100.0, loss=0.3, white_m=0.0)), 40.0)
    assert len(samples) / 4000 == pytest.approx(0.7, abs=0.03)


def test_frames_of_the_receivers_are_apart_by_the_offset_in_a_drawn_direction() -> None:
    config = SensorsConfig(fix=FixConfig(rate_hz=10.0, white_m=0.0), frame_offset_m=0.5)
    offsets_m = [
        np.array(position_of(of_kind(sampled(config, 0.1, seed=seed), Fix)[0])) - (12.0, -7.0, 0.5) for seed in (1, 2)
    ]
    for offset_m in offsets_m:
        assert math.hypot(offset_m[0], offset_m[1]) == pytest.approx(0.5, abs=1e-6)
        assert offset_m[2] == pytest.approx(0.0, abs=1e-6)
    assert np.linalg.norm(offsets_m[0] - offsets_m[1]) > 0.01


def test_gauss_markov_bias_has_its_variance_and_memory() -> None:
    process = GaussMarkov(named_rng(9, "bias"), std=1.5, tau_s=6.0)
    values = np.array([process.step(0.2) for _ in range(60_000)])
    np.testing.assert_allclose(values.std(axis=0), 1.5, rtol=0.08)
    lag = 30  # 6 s
    np.testing.assert_allclose((values[lag:] * values[:-lag]).mean() / (values**2).mean(), math.exp(-1.0), atol=0.05)


def test_gauss_markov_bias_is_stationary_from_its_first_value() -> None:
    firsts = [GaussMarkov(named_rng(seed, "bias"), std=1.5, tau_s=60.0).step(0.0) for seed in range(1000)]
    assert np.array(firsts).std() == pytest.approx(1.5, rel=0.05)


def test_dropouts_take_their_share_in_stretches_of_their_mean() -> None:
    chain = Dropouts(named_rng(2, "dropouts"), share=0.25, mean_s=0.5)
    hidden = np.array([chain.step(0.1) for _ in range(60_000)])
    assert hidden.mean() == pytest.approx(0.25, abs=0.02)
    dropouts = np.count_nonzero(np.diff(hidden.astype(int)) == 1)
    # seen at 10 Hz a dropout lasts 1 / (1 - exp(-0.1 / 0.5)) samples on average
    assert hidden.sum() / dropouts == pytest.approx(1.0 / -math.expm1(-0.2), rel=0.06)


def test_another_sensor_changes_nothing_about_the_others() -> None:
    fix = FixConfig(rate_hz=10.0, white_m=0.3, bias_m=1.5, loss=0.1, delay_s=0.1, jitter_s=0.05)
    alone = sampled(SensorsConfig(fix=fix), 5.0)
    velocity = VelocityConfig(rate_hz=10.0, white_m_s=0.1)
    imu = ImuConfig(rate_hz=50.0, heading_white_rad=0.1, yaw_rate_white_rad_s=0.1)
    together = sampled(SensorsConfig(fix=fix, velocity=velocity, imu=imu), 5.0)
    assert [(t_ns, sample) for t_ns, sample in together if isinstance(sample, Fix)] == alone


def test_same_seed_gives_the_same_samples_and_another_seed_others() -> None:
    config = SensorsConfig(fix=FixConfig(rate_hz=10.0, white_m=0.3))
    assert sampled(config, 1.0, seed=3) == sampled(config, 1.0, seed=3)
    assert sampled(config, 1.0, seed=3) != sampled(config, 1.0, seed=4)


def test_clock_offset_and_drift_are_in_the_stamps() -> None:
    clock = ClockConfig(offset_max_s=0.1, drift_max=5e-5)
    samples = sampled(SensorsConfig(fix=FixConfig(rate_hz=1.0, white_m=0.0), clock=clock), 100.0)
    errors_s = [(sample.t_ns - left_ns) * 1e-9 for left_ns, sample in samples]
    assert 0.0 < abs(errors_s[0]) <= 0.1
    drift = (errors_s[-1] - errors_s[0]) / 99.0
    assert 0.0 < abs(drift) <= 5e-5


def test_heading_errs_by_its_noise_and_states_it() -> None:
    imu = ImuConfig(rate_hz=50.0, heading_white_rad=0.02, yaw_rate_white_rad_s=0.009)
    turning = sampled(
        SensorsConfig(fix=SILENT, imu=imu), 40.0, vehicle=lambda t_ns: vehicle_at(t_ns, yaw_rad=3.1, yaw_rate_rad_s=0.2)
    )
    samples = of_kind(turning, VehicleImu)
    headings_rad = [math.remainder(yaw_of(sample.orientation_wxyz) - 3.1, math.tau) for sample in samples]
    rates_rad_s = [sample.angular_velocity_flu_rad_s[2] - 0.2 for sample in samples]
    assert np.std(headings_rad) == pytest.approx(0.02, rel=0.06)
    assert np.std(rates_rad_s) == pytest.approx(0.009, rel=0.06)
    assert samples[0].orientation_covariance_rad2[8] == pytest.approx(0.02**2)


def test_force_has_gravity_in_it_by_the_pitch_and_states_the_noise_only() -> None:
    imu = ImuConfig(
        rate_hz=50.0,
        heading_white_rad=0.0,
        yaw_rate_white_rad_s=0.0,
        acceleration_white_m_s2=0.3,
        acceleration_bias_m_s2=0.2,
    )

    def braking(t_ns: int) -> VehicleState:
        attitude = quaternion_from_roll_pitch_yaw(0.0, 0.05, 1.1)
        slows = (-2.5 * math.cos(1.1), -2.5 * math.sin(1.1), 0.0)
        return replace(vehicle_at(t_ns, yaw_rad=1.1), orientation_wxyz=attitude, acceleration_enu_m_s2=slows)

    runs = [
        of_kind(sampled(SensorsConfig(fix=SILENT, imu=imu), 4.0, seed=seed, vehicle=braking), VehicleImu)
        for seed in range(40)
    ]
    forces_m_s2 = np.array([[sample.specific_force_flu_m_s2[0] for sample in run] for run in runs])
    offsets_m_s2 = forces_m_s2.mean(axis=1)
    assert offsets_m_s2.mean() == pytest.approx(-2.5 * math.cos(0.05) - 9.80665 * math.sin(0.05), abs=0.1)
    assert offsets_m_s2.std() == pytest.approx(0.2, rel=0.4)
    assert (forces_m_s2 - offsets_m_s2[:, None]).std() == pytest.approx(0.3, rel=0.05)
    assert runs[0][0].specific_force_covariance_m2_s4[0] == pytest.approx(0.3**2)


def test_accelerations_change_nothing_about_headings_and_yaw_rates() -> None:
    plain = ImuConfig(rate_hz=50.0, heading_white_rad=0.1, heading_bias_rad=0.05, yaw_rate_white_rad_s=0.1)
    feeling = plain.model_copy(update={"acceleration_white_m_s2": 0.2, "acceleration_bias_m_s2": 0.2})
    without, with_force = (
        of_kind(sampled(SensorsConfig(fix=SILENT, imu=imu), 1.0), VehicleImu) for imu in (plain, feeling)
    )
    assert all(sample.specific_force_flu_m_s2 is None for sample in without)
    assert [
        replace(sample, specific_force_flu_m_s2=None, specific_force_covariance_m2_s4=None) for sample in with_force
    ] == [replace(sample, specific_force_covariance_m2_s4=None) for sample in without]


def pattern_config(**changes: Any) -> SensorsConfig:
    return SensorsConfig(fix=SILENT, pattern=PatternConfig(rate_hz=30.0, **changes))


def sightings(config: SensorsConfig, position_enu_m: Vector3, duration_s: float = 1.0, **options: Any) -> list[Any]:
    attitude = options.pop("attitude", (1.0, 0.0, 0.0, 0.0))
    samples = sampled(
        config, duration_s, mounting=ON_ROOF, drone=lambda t_ns: drone_at(t_ns, position_enu_m, attitude), **options
    )
    return of_kind(samples, PadSighting)


def test_sighting_is_the_pad_in_the_drones_body_frame() -> None:
    attitude = quaternion_from_roll_pitch_yaw(0.1, -0.2, 2.0)
    config = pattern_config(range_share=0.0, white_m=0.0, white_rad=0.0)
    seen = sightings(config, (12.5, -7.5, 5.0), attitude=attitude, vehicle=lambda t_ns: vehicle_at(t_ns, yaw_rad=0.7))
    away_enu_m = rotate(attitude, seen[0].position_flu_m)
    assert away_enu_m == pytest.approx((-0.5, 0.5, 2.0 - 5.0))
    nose = rotate(attitude, rotate(seen[0].orientation_wxyz, (1.0, 0.0, 0.0)))
    assert nose == pytest.approx((math.cos(0.7), math.sin(0.7), 0.0), abs=1e-12)


def test_sighting_errs_by_one_percent_of_range_and_a_centimetre() -> None:
    seen = sightings(pattern_config(), (12.0, -7.0, 8.0), 60.0)
    errors_m = np.array([sighting.position_flu_m for sighting in seen]) - (0.0, 0.0, -6.0)
    np.testing.assert_allclose(errors_m.std(axis=0), 0.07, rtol=0.08)
    assert seen[0].position_covariance_m2[0] == pytest.approx(0.07**2)


@pytest.mark.parametrize(("height_m", "count"), [(0.29, 0), (0.31, 30), (11.9, 30), (12.1, 0)])
def test_pattern_is_seen_inside_its_range_only(height_m: float, count: int) -> None:
    assert len(sightings(pattern_config(), (12.0, -7.0, 2.0 + height_m))) == count


@pytest.mark.parametrize(("angle_rad", "count"), [(0.69, 30), (0.71, 0)])
def test_pattern_is_seen_inside_the_field_of_view_only(angle_rad: float, count: int) -> None:
    assert len(sightings(pattern_config(), (12.0 + 4.0 * math.tan(angle_rad), -7.0, 6.0))) == count


def test_tilted_drone_looks_aside() -> None:
    level, tilted = (1.0, 0.0, 0.0, 0.0), quaternion_from_roll_pitch_yaw(0.0, 0.8, 0.0)
    assert len(sightings(pattern_config(), (12.0, -7.0, 6.0), attitude=level)) == 30
    assert sightings(pattern_config(), (12.0, -7.0, 6.0), attitude=tilted) == []


def test_old_truth_of_the_drone_is_carried_to_the_vehicle_of_its_time() -> None:
    samples = sampled(
        pattern_config(range_share=0.0, white_m=0.0, white_rad=0.0),
        0.1,
        mounting=ON_ROOF,
        vehicle=lambda t_ns: vehicle_at(t_ns, speed_m_s=10.0),
        drone=lambda t_ns: drone_at(t_ns - 20_000_000, (12.0, -7.0, 5.0)),
    )
    sighting = of_kind(samples, PadSighting)[0]
    assert sighting.t_ns == START_NS - 20_000_000
    assert sighting.position_flu_m == pytest.approx((-0.2, 0.0, -3.0))


def test_pattern_is_not_seen_by_a_drone_that_is_gone() -> None:
    gone = sampled(pattern_config(), 1.0, drone=lambda t_ns: drone_at(t_ns - 200_000_000, (12.0, -7.0, 5.0)))
    assert gone == []
