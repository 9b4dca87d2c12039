import math

import numpy as np
import pytest

from scenarios.catalogue.catalogue import load_scenario
from scenarios.simulation.vehicle import VehicleMemory, vehicle_at
from scenarios.simulation.vehicle_node import plan_of
from scenarios.tracks.drive_config import HullConfig, VesselTrack
from scenarios.tracks.hull import response
from scenarios.tracks.profiles import Motion
from scenarios.tracks.seaway import draw_waves, seaway_of

HEAD_RAD = math.pi * 0.87
STEP_NS = 1_000_000


@pytest.mark.parametrize(("height_m", "period_s"), [(1.88, 8.8), (7.5, 15.0)])
def test_drawn_sea_has_the_spectrum_s_height_and_zero_crossing_period(height_m: float, period_s: float) -> None:
    times_s = np.arange(0.0, 7200.0, 0.25)
    heights, periods = [], []
    for seed in range(8):
        waves = draw_waves(height_m, period_s, np.random.default_rng(seed))
        z_m = waves.amplitude_m * np.cos(np.outer(times_s, waves.omega_rad_s) + waves.phase_rad).sum(axis=1)
        heights.append(4.0 * z_m.std())
        periods.append(times_s[-1] / np.count_nonzero((z_m[:-1] < 0.0) & (z_m[1:] >= 0.0)))
    # m0 is exact; of 60 waves the second moment, most of which the shortest have, errs by some 5 %.
    assert np.mean(heights) == pytest.approx(height_m, rel=0.02)
    assert np.mean(periods) == pytest.approx(period_s * (5.0 * math.pi / 4.0) ** -0.25, rel=0.05)


def test_long_waves_lift_and_tilt_a_ship_as_they_go() -> None:
    omega = 0.12
    k = omega**2 / 9.81
    answer = response(HullConfig(), omega, HEAD_RAD, 0.0)
    assert answer.heave == pytest.approx(1.0, abs=0.03)
    # z = cos(w t - k x cos(beta)): its slope along the ship, of which nose down is the opposite.
    assert answer.pitch_rad_m == pytest.approx(1j * k * math.cos(HEAD_RAD), rel=0.05)
    assert answer.roll_rad_m == pytest.approx(-1j * k * math.sin(HEAD_RAD), rel=0.1)


def test_short_waves_do_not_move_a_ship() -> None:
    answer = response(HullConfig(), 2.0, HEAD_RAD, 5.0)
    assert max(abs(answer.heave), abs(answer.pitch_rad_m), abs(answer.roll_rad_m)) < 0.01


def test_waves_that_a_ship_outruns_are_refused() -> None:
    with pytest.raises(ValueError, match="overtaken"):
        response(HullConfig(), 2.0, 0.0, 8.0)


@pytest.mark.parametrize("speed_m_s", [0.0, 6.0])
def test_waves_are_met_at_the_frequency_of_encounter(speed_m_s: float) -> None:
    track = VesselTrack(kind="vessel", significant_height_m=3.25, modal_period_s=9.7)
    sea = seaway_of(track, speed_m_s, math.pi, np.random.default_rng(3))
    times_s = np.arange(0.0, 3600.0, 0.2)
    ways = [Motion(s_m=speed_m_s * t, speed_m_s=speed_m_s, acceleration_m_s2=0.0) for t in times_s.tolist()]
    heave = np.array([sea.at(t, way)[0][:2] for t, way in zip(times_s.tolist(), ways, strict=True)])
    met_rad_s = sea.omega_rad_s * (1.0 + sea.omega_rad_s * speed_m_s / 9.81)
    variances = 0.5 * np.abs(sea.motions[0]) ** 2
    assert heave.var(axis=0) == pytest.approx([variances.sum(), (variances * met_rad_s**2).sum()], rel=0.1)


@pytest.mark.parametrize("seconds", [12, 40])
def test_deck_s_velocities_are_how_fast_it_moves(seconds: int) -> None:
    plan, memory = plan_of(load_scenario("ship_ss6"), seed=5), VehicleMemory(started_ns=0, departs_ns=2_000_000_000)
    before, now, after = (vehicle_at(memory, seconds * 10**9 + i * STEP_NS, plan) for i in (-1, 0, 1))
    step_s = 2e-9 * STEP_NS
    moved = (np.array(after.position_enu_m) - np.array(before.position_enu_m)) / step_s
    assert now.velocity_enu_m_s == pytest.approx(moved, abs=1e-5)
    pushed = (np.array(after.velocity_enu_m_s) - np.array(before.velocity_enu_m_s)) / step_s
    assert now.acceleration_enu_m_s2 == pytest.approx(pushed, abs=1e-5)
    assert abs(moved[2]) > 0.01
