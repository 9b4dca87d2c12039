from collections.abc import Callable

import numpy as np
import pytest

from sim_autopilot.control.lqr import linear_model, linear_step, measured_step, report_gains
from sim_autopilot.control.parameters import ControllerKind
from sim_autopilot.core.data import Reference
from sim_autopilot.physics.airframe import BENCHMARK_AIRFRAME, REPORT_AIRFRAME
from sim_autopilot.plant.config import PlantConfig
from tests.sim_autopilot.flights import flown, going, holding, hovering

LQR = PlantConfig(airframe=REPORT_AIRFRAME, controller=ControllerKind.LQR)
FEEDFORWARD = PlantConfig(controller=ControllerKind.LQR_FEEDFORWARD)


def stepping(axis: int, size: float, yaw: float = 0.0) -> Callable[[float], Reference]:
    goal = np.array([0.0, 0.0, 20.0])
    goal[axis] += size
    return lambda _: holding(goal, yaw)


# report: 2 % settling times x, y, z, yaw; overshoot 8 to 11 %, recomputed from its matrices
@pytest.mark.parametrize(
    ("output", "settling_s", "recomputed_s", "overshoot"),
    [(0, 1.41, 1.408, 0.112), (1, 1.33, 1.330, 0.109), (2, 1.53, 1.536, 0.080), (3, 0.62, 0.615, 0.081)],
)
def test_linear_loop_reproduces_the_published_step_responses(
    output: int, settling_s: float, recomputed_s: float, overshoot: float
) -> None:
    response = measured_step(*linear_step(REPORT_AIRFRAME, output))
    assert response.settling_s == pytest.approx(settling_s, abs=0.01)
    assert response.settling_s == pytest.approx(recomputed_s, abs=0.002)
    assert response.overshoot == pytest.approx(overshoot, abs=0.001)


def test_report_loop_is_stable() -> None:
    A, B, C = linear_model(REPORT_AIRFRAME)
    K, Ki = report_gains(REPORT_AIRFRAME)
    closed = np.block([[A - B @ K, B @ Ki], [-C, np.zeros((4, 4))]])
    assert np.linalg.eigvals(closed).real.max() < -0.1


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_lqr_flies_small_steps_as_linear_theory_says(axis: int) -> None:
    size = 0.02
    flight = flown(LQR, hovering(LQR, (0, 0, 20)), stepping(axis, size), 5.0)
    start = 20.0 if axis == 2 else 0.0
    flew = measured_step(flight.t_s, (flight.position_m[:, axis] - start) / size)
    theory = measured_step(*linear_step(REPORT_AIRFRAME, axis))
    assert flew.settling_s == pytest.approx(theory.settling_s, abs=0.03)
    assert flew.overshoot == pytest.approx(theory.overshoot, abs=0.01)


def test_lqr_starts_anywhere_without_a_bump() -> None:
    flight = flown(LQR, hovering(LQR, (70.0, -40.0, 12.0)), lambda _: holding((70.0, -40.0, 12.0)), 3.0)
    np.testing.assert_allclose(flight.position_m, flight.wanted_m, atol=1e-9)


def test_lqr_trails_a_moving_position_for_it_has_no_feedforward() -> None:
    flight = flown(LQR, hovering(LQR, (0, 0, 20)), lambda t: going((2.0 * t, 0, 20), (2.0, 0, 0)), 12.0)
    assert flight.error_m(10.0).min() > 0.2


def test_lqr_as_published_loses_the_drone_on_a_metre_once_motors_saturate() -> None:
    config = PlantConfig(airframe=BENCHMARK_AIRFRAME, controller=ControllerKind.LQR)
    fine = flown(config, hovering(config, (0, 0, 20)), stepping(0, 0.3), 5.0)
    lost = flown(config, hovering(config, (0, 0, 20)), stepping(0, 1.0), 5.0)
    assert fine.error_m(3.0).max() < 0.01
    assert lost.error_m(3.0).max() > 1.0


@pytest.mark.parametrize(
    ("airframe", "yaw", "axis"), [(BENCHMARK_AIRFRAME, 1.2, 0), (REPORT_AIRFRAME, 1.2, 1), (BENCHMARK_AIRFRAME, 0.0, 2)]
)
def test_feedforward_settles_unit_steps_in_1_5_s_with_2_percent_overshoot(
    axis: int, yaw: float, airframe: object
) -> None:
    config = PlantConfig(airframe=airframe, controller=ControllerKind.LQR_FEEDFORWARD)  # type: ignore[arg-type]  # by its name
    flight = flown(config, hovering(config, (0, 0, 20), yaw), stepping(axis, 1.0, yaw), 6.0)
    response = measured_step(flight.t_s, flight.position_m[:, axis] - (20.0 if axis == 2 else 0.0))
    assert response.settling_s <= 1.5
    assert response.overshoot <= 0.02


def test_feedforward_settles_a_hundred_metres_with_a_wind_of_10_m_s() -> None:
    wind = np.array([-6.0, 8.0, 0.0])
    flight = flown(
        FEEDFORWARD, hovering(FEEDFORWARD, (0, 0, 20)), lambda _: holding((100, 40, 20)), 30.0, wind_at=lambda _: wind
    )
    assert flight.error_m(25.0).max() < 0.01
    assert (flight.position_m[:, 0] - 100.0).max() < 0.5
    assert np.abs(flight.position_m[:, 2] - 20.0).max() < 0.5


def test_feedforward_chases_15_m_s_from_100_m_behind() -> None:
    flight = flown(
        FEEDFORWARD,
        hovering(FEEDFORWARD, (0, 0, 20)),
        lambda t: going((100.0 + 15.0 * t, 0, 20), (15.0, 0, 0), (0, 0, 0)),
        40.0,
    )
    assert flight.error_m(35.0).max() < 0.01
    assert np.linalg.norm(flight.velocity_m_s[:, :2], axis=1).max() < 30.5


def test_feedforward_tracks_a_ramp_in_side_wind() -> None:
    wind = np.array([0.0, 5.0, 0.0])

    def ramp(t_s: float) -> Reference:
        rising = min(t_s, 5.0)
        along = 1.5 * rising**2 + 15.0 * (t_s - rising)
        return going((along, 0, 20), (3.0 * rising, 0, 0), (3.0 if t_s < 5.0 else 0.0, 0, 0))

    settled = flown(
        FEEDFORWARD, hovering(FEEDFORWARD, (0, 0, 20)), lambda _: holding((0, 0, 20)), 6.0, wind_at=lambda _: wind
    )
    flight = flown(FEEDFORWARD, settled.end, ramp, 15.0, wind_at=lambda _: wind)
    assert flight.error_m().max() < 0.15
    assert flight.error_m(12.0).max() < 0.01


def test_feedforward_hovers_without_error_in_wind() -> None:
    wind = np.array([10.0, 0.0, -1.0])
    flight = flown(
        FEEDFORWARD, hovering(FEEDFORWARD, (0, 0, 20)), lambda _: holding((0, 0, 20)), 10.0, wind_at=lambda _: wind
    )
    assert flight.error_m(8.0).max() < 1e-3
